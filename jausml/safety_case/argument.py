"""The argument: a goal for each hazard and element, with answers, evidence, and what is missing."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.generation.system import name_of
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.model import digests
from jausml.language.semantics.subject import Subject, remembering
from jausml.safety_case.evidence import RULES, Evidence
from jausml.safety_case.hazards import ASSUMPTIONS, HAZARDS, Answer, carried_maps
from jausml.safety_case.supports import Concern, Support, supports
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model import Location
    from jausml.language.validation.rule import Report
    from jausml.safety_case.generated import GeneratedTests
    from jausml.safety_case.hazards import Hazard, Row


@dataclass(frozen=True)
class Goal:
    """That a hazard is answered at an element.

    Attributes:
        id: Hazard and element, which stays while others come and go.
        number: Its number in pictures and documents.
        element: Path of the element by names.
        supported: Whether it has an answer and evidence for it, and nothing against it.
        gaps: What the model lacks, and decisions that are open.
        lacks: Kinds of evidence that could show it and were not found.
    """

    id: str
    number: str
    claim: str
    element: str
    supported: bool
    answers: tuple[Answer, ...]
    gaps: tuple[str, ...]
    supports: tuple[Support, ...]
    lacks: tuple[str, ...]
    location: Location = field(repr=False)

    @property
    def against(self) -> list[str]:
        """Why it is not supported."""
        return [*self.gaps, *(each.text for each in self.supports if not each.holds)]


@dataclass(frozen=True)
class HazardCase:
    """A hazard with the goals of all elements that it concerns."""

    id: str
    number: str
    title: str
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
        return [goal for each in self.hazards for goal in each.goals]

    @property
    def summary(self) -> str:
        """How many goals are supported."""
        return f"{sum(each.supported for each in self.goals)} of {len(self.goals)} goals supported"


def to_plain(case: SafetyCase) -> dict[str, Any]:
    """Returns a safety case as JSON has it."""
    plain = asdict(replace(case, evidence=[replace(e, content={}) for e in case.evidence]))
    for each in plain["evidence"]:
        del each["content"]
    for each in (goal for hazard in plain["hazards"] for goal in hazard["goals"]):
        del each["location"]
    found: dict[str, Any] = json.loads(json.dumps(plain))
    return found


@dataclass(frozen=True)
class _Known:
    report: Report
    subject: Subject
    evidence: tuple[Evidence, ...]
    tests: Sequence[GeneratedTests]


def safety_case(
    report: Report, evidence: Sequence[Evidence], tests: Sequence[GeneratedTests]
) -> SafetyCase:
    """Returns the safety case of a model that was read without an error."""
    model, hazards = report.model, []
    known = _Known(report, Subject(model), (Evidence("E0", RULES), *evidence), tests)
    with remembering():
        for at, each in enumerate(HAZARDS, start=1):
            goals = tuple(_goals(each, f"G{at}", known))
            supported = all(goal.supported for goal in goals)
            hazards.append(HazardCase(each.id, f"G{at}", each.title, supported, goals))
    paths = {each.path: each.sha256 for each in tests}
    own = name_of(model), __version__, digests(model)
    return SafetyCase(*own, ASSUMPTIONS, known.evidence, paths, tuple(hazards))


def _goals(hazard: Hazard, number: str, known: _Known) -> Iterator[Goal]:
    kinds = {each.id: each.kind for each in known.evidence}
    pairs = [(row, element) for row in hazard.rows for element in row.find(known.subject)]
    for at, (row, element) in enumerate(pairs, start=1):
        concern = _concern(hazard, row, element, known)
        found = tuple(supports(concern, known.report, known.evidence))
        gaps = tuple(_gaps(row, element, concern.answers))
        shown = {kinds[each.evidence] for each in found if each.holds}
        yield Goal(
            f"{hazard.id}/{concern.name}",
            f"{number}.{at}",
            f"Upon {hazard.title.lower()}, {row.claim.format(concern.name)}",
            concern.places[0],
            not gaps and all(each.holds for each in found),
            concern.answers,
            gaps,
            found,
            tuple(kind for kind in concern.kinds if kind not in shown),
            known.report.model.location(element),
        )


def _concern(hazard: Hazard, row: Row[Any], element: Any, known: _Known) -> Concern:
    owner, name, path = element.eContainer(), str(element.name), known.subject.path
    is_part, maps = not isinstance(element, jaus.Component), carried_maps(element)
    prefix = snake_case(name)
    tests = {
        PurePath(each.path).stem: [
            f"test_{prefix}{rest}"
            for rest in each.names.get(prefix, ())
            if fnmatchcase(rest, hazard.checks)
        ]
        for each in known.tests
        if is_part and each.owner == owner.name
    }
    return Concern(
        hazard,
        row,
        f"{owner.name}.{name}" if is_part else name,
        tuple(map(path, (element, *maps))),
        path(owner) if is_part else "",
        tuple(str(each.name) for each in maps),
        tuple(each for answer in row.answers if (each := answer(element)) is not None),
        tests,
    )


def _gaps(row: Row[Any], element: Any, answers: Sequence[Answer]) -> Iterator[str]:
    if not answers:
        yield row.gap if isinstance(row.gap, str) else row.gap(element)
    for owner in (element, *carried_maps(element)):
        if isinstance(owner, bridge.DecisionOwner):
            yield from (f"open decision: {each.text}" for each in owner.openDecisions)
