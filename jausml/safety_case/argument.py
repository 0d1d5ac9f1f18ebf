"""The argument of a safety case: a goal for each hazard at each element."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import PurePath
from typing import Any

from jausml import __version__
from jausml.generation.target import name_of
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import Location
from jausml.language.model.model import digests
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.validation.rule import Report
from jausml.safety_case.answers import Answer
from jausml.safety_case.elements import carried_maps
from jausml.safety_case.evidence import RULES, Evidence, GeneratedTests
from jausml.safety_case.hazards import HAZARDS, Hazard, Row
from jausml.safety_case.supports import Concern, Support, is_of_a_person, supports
from jausml_generators.python.names import snake_case

ASSUMPTIONS = (
    "Components, nodes and code of users outside of what is generated behave as the model says.",
    "JAUS has no authentication: who can forge addresses on the network is outside of this case.",
    "Who may publish and call in ROS is decided by SROS 2, and not by the model.",
    "Power, kernel, cables and hosts may fail: time-outs in what is commanded have to cover it.",
    "A stop that the model states does stop the machine: only who knows the machine can say so.",
    "Each range, rate and time-out is one that the machine can do with.",
    "Where both ends state a unit, a frame or a name of a value, neither definition is mistaken.",
    "A test vector, a reason and an @allow of a person are true, and so is what moves nothing.",
)
"""Claims that no part of a model can argue, as no check can know them."""

SUPPORTED, BY_RULES = "supported by evidence that ran", "held by rules alone"
OF_A_PERSON, UNDEVELOPED = "held by the word of a person", "undeveloped"
_STANDINGS = (SUPPORTED, BY_RULES, OF_A_PERSON, UNDEVELOPED)


def counted(goals: Sequence[Goal]) -> str:
    """Returns the number of goals by the kind of their support, supported ones first."""
    counts = {standing: sum(goal.standing == standing for goal in goals) for standing in _STANDINGS}
    more = [
        f"{count} {standing}"
        for standing, count in counts.items()
        if count and standing != SUPPORTED
    ]
    summary = f"{counts[SUPPORTED]} of {len(goals)} goals {SUPPORTED}"
    return f"{summary}; {', '.join(more)}" if more else summary


@dataclass(frozen=True)
class Goal:
    """The claim that a hazard is answered at an element.

    Attributes:
        number: Its number in the document, e.g. `G2.1`.
        element: Path of the element.
        answered: Whether the model answers it, without a gap and with nothing against it.
        supported: Whether it is answered, and evidence that ran shows that: neither the silence of
            rules nor a reason of a person does.
        gaps: What the model lacks, and decisions that are open.
        supports: What evidence says, for the goal and against it.
        lacks: Kinds of evidence that could show it and were not found.
    """

    id: str
    number: str
    claim: str
    element: str
    answered: bool
    supported: bool
    answers: tuple[Answer, ...]
    gaps: tuple[str, ...]
    supports: tuple[Support, ...]
    lacks: tuple[str, ...]
    location: Location = field(repr=False)

    @property
    def standing(self) -> str:
        """The kind of its support."""
        if self.supported:
            return SUPPORTED
        if not self.answered:
            return UNDEVELOPED
        return OF_A_PERSON if is_of_a_person(self.answers) else BY_RULES

    @property
    def against(self) -> list[str]:
        """Why it is not answered."""
        return [*self.gaps, *(support.text for support in self.supports if not support.holds)]


@dataclass(frozen=True)
class HazardCase:
    """A hazard with the goals of all elements that it concerns."""

    id: str
    number: str
    title: str
    answered: bool
    supported: bool
    goals: tuple[Goal, ...]


@dataclass(frozen=True)
class SafetyCase:
    """A safety case.

    Attributes:
        model: Digests of the files of the model, by path.
        tests: Digests of the tests that are generated of it, by path.
    """

    system: str
    jausml: str
    model: dict[str, str]
    assumptions: tuple[str, ...]
    evidence: Sequence[Evidence]
    tests: dict[str, str]
    hazards: tuple[HazardCase, ...]

    @property
    def goals(self) -> list[Goal]:
        """The goals of all hazards."""
        return [goal for hazard in self.hazards for goal in hazard.goals]

    @property
    def summary(self) -> str:
        """How many goals are supported, and what the others rest on."""
        return counted(self.goals)


def to_plain(case: SafetyCase) -> dict[str, Any]:
    """Returns a safety case as JSON has it."""
    plain = asdict(replace(case, evidence=[replace(piece, content={}) for piece in case.evidence]))
    for piece in plain["evidence"]:
        del piece["content"]
    for goal in (goal for hazard in plain["hazards"] for goal in hazard["goals"]):
        del goal["location"]
    content: dict[str, Any] = json.loads(json.dumps(plain))
    return content


@dataclass(frozen=True)
class _Basis:
    """What a case is made of: the checked model, all evidence, and the tests that there are."""

    report: Report
    subject: Subject
    evidence: tuple[Evidence, ...]
    tests: Sequence[GeneratedTests]


def safety_case(
    report: Report, evidence: Sequence[Evidence], tests: Sequence[GeneratedTests]
) -> SafetyCase:
    """Returns the safety case of a model that was read without an error."""
    model, hazards = report.model, []
    basis = _Basis(report, Subject(model), (Evidence("E0", RULES), *evidence), tests)
    with remembering():
        for at, hazard in enumerate(HAZARDS, start=1):
            goals = tuple(_goals(hazard, f"G{at}", basis))
            answered = all(goal.answered for goal in goals)
            supported = all(goal.supported for goal in goals)
            hazards.append(
                HazardCase(hazard.id, f"G{at}", hazard.title, answered, supported, goals)
            )
    paths = {test.path: test.sha256 for test in tests}
    own = name_of(model), __version__, digests(model)
    return SafetyCase(*own, ASSUMPTIONS, basis.evidence, paths, tuple(hazards))


def _goals(hazard: Hazard, number: str, basis: _Basis) -> Iterator[Goal]:
    kinds = {piece.id: piece.kind for piece in basis.evidence}
    pairs = [(row, element) for row in hazard.rows for element in row.find(basis.subject)]
    for at, (row, element) in enumerate(pairs, start=1):
        concern = _concern(hazard, row, element, basis)
        evidence = tuple(supports(concern, basis.report, basis.evidence))
        gaps = tuple(_gaps(row, element, concern.answers))
        shown = {kinds[support.evidence] for support in evidence if support.holds}
        answered = not gaps and all(support.holds for support in evidence)
        has_run = bool(shown - {RULES}) and not is_of_a_person(concern.answers)
        yield Goal(
            id=f"{hazard.id}/{concern.name}",
            number=f"{number}.{at}",
            claim=f"Upon {hazard.title.lower()}, {row.claim.format(concern.name)}",
            element=concern.places[0],
            answered=answered,
            supported=answered and has_run,
            answers=concern.answers,
            gaps=gaps,
            supports=evidence,
            lacks=tuple(kind for kind in concern.kinds if kind not in shown),
            location=basis.report.model.location(element),
        )


def _concern(hazard: Hazard, row: Row[Any], element: Any, basis: _Basis) -> Concern:
    owner, name, path = element.eContainer(), str(element.name), basis.subject.path
    is_part, maps = not isinstance(element, jaus.Component), carried_maps(element)
    prefix = snake_case(name)
    tests = {
        PurePath(test.path).stem: [
            f"test_{prefix}{rest}"
            for rest in test.names.get(prefix, ())
            if fnmatchcase(rest, hazard.checks)
        ]
        for test in basis.tests
        if is_part and test.owner == owner.name
    }
    return Concern(
        hazard=hazard,
        row=row,
        name=f"{owner.name}.{name}" if is_part else name,
        places=tuple(map(path, (element, *maps))),
        owner=path(owner) if is_part else "",
        maps=tuple(str(attribute_map.name) for attribute_map in maps),
        answers=tuple(stated for answer in row.answers if (stated := answer(element)) is not None),
        tests=tests,
    )


def _gaps(row: Row[Any], element: Any, answers: Sequence[Answer]) -> Iterator[str]:
    if not answers:
        yield row.gap if isinstance(row.gap, str) else row.gap(element)
    for owner in (element, *carried_maps(element)):
        if isinstance(owner, bridge.DecisionOwner):
            yield from (f"open decision: {decision.text}" for decision in owner.openDecisions)
