"""What proofs of the maps of a broken model find that those of the unbroken one do not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.generation.native import compiler
from jausml.language.metamodel.classes import bridge
from jausml.live.workers.worker import WorkerError
from jausml.proving.compiled_form import ProgramError
from jausml.proving.findings import PROOF_RULES, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.validation.rule import Report

_BUDGET = 1.0
"""Seconds for all values of wide numbers; a mistake shows in the chosen ones."""


class Proofs:
    """Proofs of the maps of a model that is not broken, each made when it is first asked for."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._known: dict[str, Mapping[tuple[str, str], str]] = {}

    def noticed(self, report: Report, element: Any) -> str:
        """Returns what proofs find after an element was changed; empty for nothing new.

        Args:
            report: That of the broken model.
            element: The element as the unbroken model has it.
        """
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
    settings = Settings(str(compiler()), _BUDGET, jobs=1)
    judged = with_proofs(report, trips, list(prove(report.model, trips, settings)))
    return {
        (each.rule, each.fragment): f"{each.rule} {each.message}"
        for each in judged.diagnostics
        if each.rule in PROOF_RULES
    }
