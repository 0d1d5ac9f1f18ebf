"""Supports of goals: what evidence says of a hazard at an element."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from jausml.language.validation.rule import Report
from jausml.safety_case.answers import Answer
from jausml.safety_case.evidence import (
    FAULT_RUNS,
    MODEL_CHECK,
    MUTATIONS,
    PROOF,
    RULES,
    TEST_RUN,
    Evidence,
    EvidenceError,
)
from jausml.safety_case.hazards import Hazard, Row

_ASSIGNMENT = re.compile(r"/to(Ros|Jaus)\[")
MARGIN = 1.0
"""Seconds that a stop in a fault run may come later than the model says: those of its watch."""


def is_of_a_person(answers: Sequence[Answer]) -> bool:
    """Whether all answers are reasons that people state; none are not."""
    return bool(answers) and all(answer.reason for answer in answers)


@dataclass(frozen=True)
class Support:
    """The support of a goal by a piece of evidence.

    Attributes:
        evidence: Id of the piece.
        holds: Whether it speaks for the goal; otherwise against it.
        text: What it says.
    """

    evidence: str
    holds: bool
    text: str


@dataclass(frozen=True)
class Concern:
    """A hazard at an element.

    Attributes:
        name: Name of the element; that of a part of a component behind the one of the component.
        places: Paths by names of the element and of its maps.
        owner: Path of the component that has the element; empty for a component.
        maps: Names of its maps.
        answers: What the model does about the hazard.
        tests: Names of the generated tests that show it, by their module.
    """

    hazard: Hazard
    row: Row[Any]
    name: str
    places: tuple[str, ...]
    owner: str
    maps: tuple[str, ...]
    answers: tuple[Answer, ...]
    tests: Mapping[str, Sequence[str]]

    @property
    def kinds(self) -> list[str]:
        """The kinds of evidence that could show its answers, besides rules."""
        without = [] if self.hazard.properties else [MODEL_CHECK]
        if is_of_a_person(self.answers):
            # What stands has no stop that could be seen.
            without += [TEST_RUN, FAULT_RUNS, MUTATIONS]
        return [kind for kind in self.row.kinds if kind not in without]

    def has(self, path: str) -> bool:
        """Tells whether a path is that of the element, of a map, within them, or of the owner."""
        inside = (path == place or path.startswith(f"{place}/") for place in self.places)
        return path == self.owner or any(inside)


def supports(concern: Concern, report: Report, evidence: Sequence[Evidence]) -> Iterator[Support]:
    """Yields the supports of a hazard at an element by evidence of the model as it is.

    Raises:
        EvidenceError: The content of a piece is not what its kind has.
    """
    for piece in evidence:
        if piece.kind == RULES:
            yield Support(piece.id, *_rules(concern, report))
        elif piece.kind in concern.kinds and not piece.stale:
            try:
                statements = list(_READERS[piece.kind](concern, piece.content))
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                what = f"{piece.path} holds no {piece.kind} that can be read"
                raise EvidenceError(f"{what}: {type(error).__name__} {error}") from error
            yield from (Support(piece.id, *statement) for statement in statements)


# Whether a piece of evidence speaks for the goal, and what it says.
_Statement = tuple[bool, str]


def _rules(concern: Concern, report: Report) -> _Statement:
    rules = concern.hazard.rules
    findings = [
        f"{diagnostic.rule} {diagnostic.message}"
        for diagnostic in report.diagnostics
        if diagnostic.rule in rules and concern.has(diagnostic.element)
    ]
    if findings:
        return False, "; ".join(findings)
    notes = [
        f"; {exclusion.diagnostic.rule} {exclusion.ground.value}: {exclusion.reason}"
        for exclusion in report.set_aside
        if exclusion.diagnostic.rule in rules and concern.has(exclusion.diagnostic.element)
    ]
    return True, f"{', '.join(rules)} hold{''.join(notes)}"


def _tests(concern: Concern, content: dict[str, Any]) -> Iterator[_Statement]:
    for module, names in concern.tests.items():
        outcomes = {name: content["tests"].get(f"{module}.{name}") for name in names}
        bad = [name for name, outcome in outcomes.items() if outcome in ("failure", "error")]
        if bad:
            yield False, f"{', '.join(bad)} failed"
        elif {*outcomes.values()} == {"passed"}:
            number = names[0] if len(names) == 1 else f"{len(names)} tests"
            yield True, f"{number} of {module} passed"


def _against(subject: dict[str, Any], rules: Sequence[str] = ()) -> str:
    """Returns the findings about a subject of evidence, by some rules or by any."""
    entries = subject["found"] if isinstance(subject["found"], list) else []
    findings = [
        entry if isinstance(entry, dict) else {"rule": "", "message": entry} for entry in entries
    ]
    chosen = [finding for finding in findings if not rules or finding.get("rule") in rules]
    return "; ".join(
        f"{finding.get('rule', '')} {finding.get('message', '')}".strip() for finding in chosen
    )


def _proof(concern: Concern, content: dict[str, Any]) -> Iterator[_Statement]:
    for map_result in content["maps"]:
        if map_result["name"] in concern.maps:
            tried = [int(number["tried"]) for number in map_result["fields"]]
            whole = sum(number["tried"] == number["total"] for number in map_result["fields"])
            about = f"{len(tried)} numbers, {whole} of them whole, {sum(tried):,} values"
            against = _against(map_result)
            text = against or f"{about}, no findings"
            if against or tried:
                yield not against, f"map {map_result['name']}: {text}"


def _model_check(concern: Concern, content: dict[str, Any]) -> Iterator[_Statement]:
    rules = concern.hazard.properties
    for product in content["products"]:
        name = str(product["name"])
        if name == concern.name or name.startswith((f"{concern.name} to ", f"{concern.name}: ")):
            against = _against(product, rules)
            allowed = {finding["rule"] for finding in product.get("allowed", ())}
            if against or (product["complete"] is True and allowed.isdisjoint(rules)):
                text = against or f"{', '.join(rules)} hold in all states"
                yield not against, f"{name}: {text}"


def _mutations(concern: Concern, content: dict[str, Any]) -> Iterator[_Statement]:
    """Yields the outcomes of mutations: of assignments for the meaning of maps, else for stops."""
    is_of_maps = concern.hazard.checks == "*"
    tried = [
        outcome
        for outcome in content["outcomes"]
        if concern.has(str(outcome["place"]))
        and (is_of_maps or not _ASSIGNMENT.search(str(outcome["place"])))
    ]
    alive = [outcome for outcome in tried if outcome["verdict"] == "nothing"]
    if alive:
        descriptions = (
            f"{outcome['change']} ({outcome.get('detail') or 'for no known reason'})"
            for outcome in alive
        )
        yield False, f"nothing notices: {'; '.join(descriptions)}"
    elif tried:
        yield True, f"{len(tried)} mutations, all noticed or of no effect"


def _fault_runs(concern: Concern, content: dict[str, Any]) -> Iterator[_Statement]:
    """Yields the slowest stop of the runs that provoke the hazard."""
    runs = {run: result.get("stopped") for run, result in content["faults"].items()}
    runs |= content["guardian"] if isinstance(content.get("guardian"), dict) else {}
    name = concern.name.rpartition(".")[2]
    times = {
        run: float(result[name])
        for run, result in runs.items()
        if isinstance(result, dict)
        and isinstance(result.get(name), int | float)
        and any(fnmatchcase(run, pattern) for pattern in concern.hazard.runs)
    }
    if times:
        run, slowest = max(times.items(), key=lambda item: item[1])
        stated = max((answer.seconds for answer in concern.answers), default=0.0)
        holds = not stated or slowest <= stated + MARGIN
        late = "" if holds else f", the model says {stated:g} s"
        yield holds, f"{len(times)} runs; slowest stop after {slowest:.2f} s ({run}){late}"


_READERS = {
    TEST_RUN: _tests,
    PROOF: _proof,
    MODEL_CHECK: _model_check,
    MUTATIONS: _mutations,
    FAULT_RUNS: _fault_runs,
}
