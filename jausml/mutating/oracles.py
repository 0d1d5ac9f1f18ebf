"""Oracles: what proofs and model checks find in a broken model, and not in the sound one."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jausml.generation.errors import NoSystemError
from jausml.generation.native import compiler
from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge
from jausml.language.model import Model
from jausml.language.model.names import around
from jausml.language.validation.rule import Report
from jausml.live.workers.worker import WorkerError
from jausml.model_checking.checking import BOUND_MET, check_system, without_allowed
from jausml.proving.compiled_form import ProgramError
from jausml.proving.results import findings
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove

_MODEL_CHECK_STATES = 100_000
_MODEL_CHECK_BUDGET = 10.0  # seconds; what is not searched by then is no finding here

_PROOF_BUDGET = 1.0  # seconds for all values of wide numbers; a mistake shows in the chosen ones


class ModelCheckOracle:
    """Finds the first property that a broken model violates and the sound one keeps.

    Attributes:
        remarks: What of the sound model could not be checked, so that nothing is noticed by it.
    """

    def __init__(self, model: Model) -> None:
        """Begins without a check: the sound model is checked when it is first needed."""
        self.remarks: list[str] = []
        self._model = model
        self._baseline: _ModelCheck | None = None

    def new_violation(self, model: Model) -> str:
        """Returns the first new violation in a broken model; empty for none."""
        if self._baseline is None:
            self._baseline = _model_check(self._model)
            self.remarks += [
                f"the check of {product} was cut off without a mutation: it notices nothing"
                for product in sorted(self._baseline.unfinished)
            ]
        baseline = self._baseline
        for (rule, product), text in _model_check(model).violations.items():
            # What an unfinished search has not found may be there all the same.
            if product not in baseline.unfinished and (rule, product) not in baseline.violations:
                return text
        return ""


@dataclass(frozen=True)
class _ModelCheck:
    """Texts of violations by rule and product, and the products of which not all was searched."""

    violations: Mapping[tuple[str, str], str]
    unfinished: frozenset[str]


def _model_check(model: Model) -> _ModelCheck:
    try:
        system = system_of(model)
    except NoSystemError:
        return _ModelCheck({}, frozenset())
    end = time.monotonic() + _MODEL_CHECK_BUDGET
    checked = check_system(system, _MODEL_CHECK_STATES, lambda: time.monotonic() > end)
    violations = {
        (
            example.rule,
            outcome.subject.name,
        ): f"{example.rule} {outcome.subject.name}: {example.message}"
        for outcome in without_allowed(checked, model)
        for example in outcome.found
        if example.rule != BOUND_MET
    }
    unfinished = (outcome.subject.name for outcome in checked if not outcome.is_complete)
    return _ModelCheck(violations, frozenset(unfinished))


class ProofOracle:
    """Finds by proofs the faults in a map of a broken model that the sound one does not have.

    Attributes:
        remarks: Which maps of the sound model have no proof, so that nothing is noticed by it.
    """

    def __init__(self, report: Report) -> None:
        """Begins without a proof: a map of the sound model is proved when it is first needed."""
        self.remarks: list[str] = []
        self._report = report
        self._baselines: dict[str, _Proof | None] = {}

    def new_finding(self, report: Report, element: Any) -> str:
        """Returns the first new finding once an element was changed; empty for none."""
        name = _provable_map(element)
        if not name or compiler() is None:
            return ""
        if name not in self._baselines:
            self._baselines[name] = self._baseline(name)
        baseline = self._baselines[name]
        if baseline is None:
            return ""
        try:
            proof = _proof(report, name)
        except (ProgramError, WorkerError) as error:
            return str(error)
        return next((text for key, text in proof.items() if key not in baseline), "")

    def _baseline(self, name: str) -> _Proof | None:
        try:
            return _proof(self._report, name)
        except (ProgramError, WorkerError) as error:
            self.remarks.append(f"{name} cannot be proved without a mutation: {error}")
            return None


_Proof = Mapping[tuple[str, str, str], str]
"""Texts of findings by rule, and by side and path of the number."""


def _provable_map(element: Any) -> str:
    """Returns the name of the map around an element whose proof can find a mistake."""
    map_ = around(element, bridge.AttributeMap)
    if map_ is None:
        return ""
    # Proofs hold what comes back into fields of JAUS against a precision, nothing in ROS.
    is_precise = any(getattr(assignment, "precision", 0) for assignment in map_.toJaus)
    return str(map_.name) if is_precise or (map_.toRos and map_.toJaus) else ""


def _proof(report: Report, name: str) -> _Proof:
    """Returns the findings of the proof of a map."""
    trips = [round_trip for round_trip in round_trips(report.model) if round_trip.name == name]
    settings = Settings(str(compiler()), _PROOF_BUDGET, jobs=1)
    # By their numbers: places move with an assignment, and messages hold what was measured.
    return {
        (finding.rule, finding.side, finding.path): f"{finding.rule} {finding.message}"
        for trip, result in zip(trips, prove(report.model, trips, settings), strict=True)
        for finding in findings(trip, result)
    }
