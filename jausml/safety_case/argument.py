"""The argument: a goal for each hazard and element, with answers, what evidence says, and gaps."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
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
from jausml.safety_case import evidence as kinds
from jausml.safety_case.evidence import RULES, Evidence, GeneratedTests
from jausml.safety_case.hazards import HAZARDS, Answer, Hazard, Row, carried_maps
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

_ASSIGNMENT = re.compile(r"/to(Ros|Jaus)\[")
MARGIN = 1.0
"""Seconds that a stop in a fault run may come later than the model says: those of its watch."""


@dataclass(frozen=True)
class Support:
    """The support of a goal by a piece of evidence."""

    evidence: str
    holds: bool
    text: str


@dataclass(frozen=True)
class Concern:
    """A hazard at an element (`places`: paths by names of the element and its maps)."""

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
        without = [] if self.hazard.properties else [kinds.MODEL_CHECK]
        if _is_of_a_person(self.answers):
            # What stands has no stop that could be seen.
            without += [kinds.TEST_RUN, kinds.FAULT_RUNS, kinds.MUTATIONS]
        return [kind for kind in self.row.kinds if kind not in without]

    def has(self, path: str) -> bool:
        """Tells whether a path is that of the element, of a map, within them, or of the owner."""
        inside = (path == place or path.startswith(f"{place}/") for place in self.places)
        return path == self.owner or any(inside)


def supports(concern: Concern, report: Report, evidence: Sequence[Evidence]) -> Iterator[Support]:
    """Yields the support of a hazard at an element by evidence of the model as it is."""
    for evidence_item in evidence:
        if evidence_item.kind == kinds.RULES:
            yield Support(evidence_item.id, *_rules(concern, report))
        elif evidence_item.kind in concern.kinds and not evidence_item.stale:
            try:
                said = list(_READERS[evidence_item.kind](concern, evidence_item.content))
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                what = f"{evidence_item.path} holds no {evidence_item.kind} that can be read"
                raise kinds.EvidenceError(f"{what}: {type(error).__name__} {error}") from error
            yield from (Support(evidence_item.id, *one) for one in said)


_Said = tuple[bool, str]


def _rules(concern: Concern, report: Report) -> _Said:
    rules = concern.hazard.rules.split()
    diagnostics = [e for e in report.diagnostics if e.rule in rules and concern.has(e.element)]
    if diagnostics:
        return False, "; ".join(
            f"{diagnostic.rule} {diagnostic.message}" for diagnostic in diagnostics
        )
    aside = [e for e in report.set_aside if e.diagnostic.rule in rules]
    aside = [exclusion for exclusion in aside if concern.has(exclusion.diagnostic.element)]
    notes = (
        f"; {exclusion.diagnostic.rule} {exclusion.ground.value}: {exclusion.reason}"
        for exclusion in aside
    )
    return True, f"{', '.join(rules)} hold{''.join(notes)}"


def _tests(concern: Concern, content: dict[str, Any]) -> Iterator[_Said]:
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
    findings = [e if isinstance(e, dict) else {"rule": "", "message": e} for e in entries]
    chosen = [finding for finding in findings if not rules or finding.get("rule") in rules]
    return "; ".join(f"{e.get('rule', '')} {e.get('message', '')}".strip() for e in chosen)


def _proof(concern: Concern, content: dict[str, Any]) -> Iterator[_Said]:
    for map_result in content["maps"]:
        if map_result["name"] in concern.maps:
            tried = [int(one["tried"]) for one in map_result["fields"]]
            whole = sum(one["tried"] == one["total"] for one in map_result["fields"])
            about = f"{len(tried)} numbers, {whole} of them whole, {sum(tried):,} values"
            against = _against(map_result)
            text = against or f"{about}, no findings"
            yield not against, f"map {map_result['name']}: {text}"


def _model_check(concern: Concern, content: dict[str, Any]) -> Iterator[_Said]:
    rules = concern.hazard.properties
    for product in content["products"]:
        name = str(product["name"])
        if name == concern.name or name.startswith((f"{concern.name} to ", f"{concern.name}: ")):
            against = _against(product, rules)
            if against or product["complete"] is True:
                text = against or f"{', '.join(rules)} hold in all states"
                yield not against, f"{name}: {text}"


def _mutations(concern: Concern, content: dict[str, Any]) -> Iterator[_Said]:
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


def _fault_runs(concern: Concern, content: dict[str, Any]) -> Iterator[_Said]:
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
    kinds.TEST_RUN: _tests,
    kinds.PROOF: _proof,
    kinds.MODEL_CHECK: _model_check,
    kinds.MUTATIONS: _mutations,
    kinds.FAULT_RUNS: _fault_runs,
}


SUPPORTED, BY_RULES = "supported by evidence that ran", "held by rules alone"
OF_A_PERSON, UNDEVELOPED = "held by the word of a person", "undeveloped"
_STANDINGS = (SUPPORTED, BY_RULES, OF_A_PERSON, UNDEVELOPED)


def _is_of_a_person(answers: Sequence[Answer]) -> bool:
    return bool(answers) and all(answer.reason for answer in answers)


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
        answered: Whether the model answers it, without a gap and with nothing against it.
        supported: Whether it is answered, and evidence that ran shows that: neither the silence of
            rules nor a reason of a person does.
        gaps: What the model lacks, and decisions that are open.
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
        return OF_A_PERSON if _is_of_a_person(self.answers) else BY_RULES

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
    plain = asdict(replace(case, evidence=[replace(e, content={}) for e in case.evidence]))
    for evidence_item in plain["evidence"]:
        del evidence_item["content"]
    for plain_goal in (goal for hazard in plain["hazards"] for goal in hazard["goals"]):
        del plain_goal["location"]
    content: dict[str, Any] = json.loads(json.dumps(plain))
    return content


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
        for at, hazard in enumerate(HAZARDS, start=1):
            goals = tuple(_goals(hazard, f"G{at}", known))
            answered = all(goal.answered for goal in goals)
            supported = all(goal.supported for goal in goals)
            hazards.append(
                HazardCase(hazard.id, f"G{at}", hazard.title, answered, supported, goals)
            )
    paths = {test.path: test.sha256 for test in tests}
    own = name_of(model), __version__, digests(model)
    return SafetyCase(*own, ASSUMPTIONS, known.evidence, paths, tuple(hazards))


def _goals(hazard: Hazard, number: str, known: _Known) -> Iterator[Goal]:
    kinds = {evidence.id: evidence.kind for evidence in known.evidence}
    pairs = [(row, element) for row in hazard.rows for element in row.find(known.subject)]
    for at, (row, element) in enumerate(pairs, start=1):
        concern = _concern(hazard, row, element, known)
        statements = tuple(supports(concern, known.report, known.evidence))
        gaps = tuple(_gaps(row, element, concern.answers))
        shown = {kinds[support.evidence] for support in statements if support.holds}
        answered = not gaps and all(said.holds for said in statements)
        has_run = bool(shown - {RULES}) and not _is_of_a_person(concern.answers)
        yield Goal(
            f"{hazard.id}/{concern.name}",
            f"{number}.{at}",
            f"Upon {hazard.title.lower()}, {row.claim.format(concern.name)}",
            concern.places[0],
            answered,
            answered and has_run,
            concern.answers,
            gaps,
            statements,
            tuple(kind for kind in concern.kinds if kind not in shown),
            known.report.model.location(element),
        )


def _concern(hazard: Hazard, row: Row[Any], element: Any, known: _Known) -> Concern:
    owner, name, path = element.eContainer(), str(element.name), known.subject.path
    is_part, maps = not isinstance(element, jaus.Component), carried_maps(element)
    prefix = snake_case(name)
    tests = {
        PurePath(test.path).stem: [
            f"test_{prefix}{rest}"
            for rest in test.names.get(prefix, ())
            if fnmatchcase(rest, hazard.checks)
        ]
        for test in known.tests
        if is_part and test.owner == owner.name
    }
    return Concern(
        hazard,
        row,
        f"{owner.name}.{name}" if is_part else name,
        tuple(map(path, (element, *maps))),
        path(owner) if is_part else "",
        tuple(str(attribute_map.name) for attribute_map in maps),
        tuple(stated for answer in row.answers if (stated := answer(element)) is not None),
        tests,
    )


def _gaps(row: Row[Any], element: Any, answers: Sequence[Answer]) -> Iterator[str]:
    if not answers:
        yield row.gap if isinstance(row.gap, str) else row.gap(element)
    for owner in (element, *carried_maps(element)):
        if isinstance(owner, bridge.DecisionOwner):
            yield from (f"open decision: {decision.text}" for decision in owner.openDecisions)
