"""All rules: what the decorator `rule` has made in the modules that the folders list."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.validation.rule import Rule
from jausml.language.validation.rules import bridge, jaus, names, ros, system

if TYPE_CHECKING:
    from types import ModuleType

MODULES: tuple[ModuleType, ...] = (
    *jaus.MODULES,
    *ros.MODULES,
    *bridge.MODULES,
    names,
    system,
)
"""The modules whose rules are in force."""


def all_rules() -> tuple[Rule, ...]:
    """Returns all rules, ordered by id."""
    found = (each for module in MODULES for each in vars(module).values())
    return tuple(sorted((each for each in found if isinstance(each, Rule)), key=lambda e: e.id))
