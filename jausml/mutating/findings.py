"""What proofs and product checks of a broken model find that those of the unbroken do not."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from jausml.generation.errors import NoSystemError
from jausml.generation.native import compiler
from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge
from jausml.live.workers.worker import WorkerError
from jausml.model_checking.checking import BOUND_MET, check_system, without_allowed
from jausml.proving.compiled_form import ProgramError
from jausml.proving.results import PROOF_RULES, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model import Model
    from jausml.language.validation.rule import Report

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


_PROOF_BUDGET = 1.0
"""Seconds for all values of wide numbers; a mistake shows in the chosen ones."""


class Proofs:
    """Proofs of the maps of a model that is not broken, each made when it is first asked for."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._known: dict[str, Mapping[tuple[str, str], str]] = {}

    def noticed(self, report: Report, element: Any) -> str:
        """Returns what proofs find after an element was changed; empty for nothing new."""
        name = _demanding_map(element)
        if not name or compiler() is None:
            return ""
        if name not in self._known:
            self._known[name] = _found(self._report, name)
        try:
            found = _found(report, name)
        except (ProgramError, WorkerError) as error:
            return str(error)
        return next((text for key, text in found.items() if key not in self._known[name]), "")


def _demanding_map(element: Any) -> str:
    """Returns the name of the map around an element whose proof can find a mistake."""
    while element is not None and not isinstance(element, bridge.AttributeMap):
        element = element.eContainer()
    if element is None:
        return ""
    precise = any(getattr(each, "precision", 0) for each in element.toJaus)
    return str(element.name) if precise or (element.toRos and element.toJaus) else ""


def _found(report: Report, name: str) -> dict[tuple[str, str], str]:
    """Returns what proofs find of a map, by rule and place."""
    trips = [each for each in round_trips(report.model) if each.name == name]
    settings = Settings(str(compiler()), _PROOF_BUDGET, jobs=1)
    judged = with_proofs(report, trips, list(prove(report.model, trips, settings)))
    return {
        (each.rule, each.fragment): f"{each.rule} {each.message}"
        for each in judged.diagnostics
        if each.rule in PROOF_RULES
    }
