"""All rules: what the decorator `rule` has made in the modules of this folder and those below."""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module

from jausml.language.validation.rule import Rule


@cache
def all_rules() -> tuple[Rule, ...]:
    """Returns all rules, ordered by id."""
    modules = (import_module(each.name) for each in pkgutil.walk_packages(__path__, f"{__name__}."))
    found = (each for module in modules for each in vars(module).values())
    return tuple(sorted((each for each in found if isinstance(each, Rule)), key=lambda e: e.id))
