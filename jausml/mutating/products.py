"""What product checks of a broken model find that those of the unbroken one do not."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from jausml.generation.errors import NoSystemError
from jausml.generation.system import system_of
from jausml.model_checking.checking import BOUND_MET, check_system, without_allowed

if TYPE_CHECKING:
    from jausml.language.model import Model

_STATES = 100_000
_BUDGET = 10.0
"""Seconds; what is not searched by then is no finding here."""


class Products:
    """The products of a model that is not broken, checked when it is first asked for."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._known: dict[tuple[str, str], str] | None = None

    def noticed(self, model: Model) -> str:
        """Returns which property a broken model violates, and the other keeps; empty for none."""
        if self._known is None:
            self._known = _violated(self._model)
        found = _violated(model)
        return next((text for key, text in found.items() if key not in self._known), "")


def _violated(model: Model) -> dict[tuple[str, str], str]:
    """Returns what is violated, by rule and product."""
    try:
        system = system_of(model)
    except NoSystemError:
        return {}
    end = time.monotonic() + _BUDGET
    checked = check_system(system, _STATES, lambda: time.monotonic() > end)
    return {
        (example.rule, each.subject.name): f"{example.rule} {each.subject.name}: {example.message}"
        for each in without_allowed(checked, model)
        for example in each.found
        if example.rule != BOUND_MET
    }
