"""What became of mutations: what checks find, the matrix, what survives, as text and as a page."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from jausml import __version__
from jausml.generation.errors import NoSystemError
from jausml.generation.native import compiler
from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge
from jausml.language.model import Model
from jausml.language.validation.rule import Report
from jausml.live.workers.worker import WorkerError
from jausml.model_checking.checking import BOUND_MET, check_system, without_allowed
from jausml.mutating.operators import OPERATORS
from jausml.proving.compiled_form import ProgramError
from jausml.proving.results import PROOF_RULES, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove
from jausml.views import pages

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
        (
            example.rule,
            outcome.subject.name,
        ): f"{example.rule} {outcome.subject.name}: {example.message}"
        for outcome in without_allowed(checked, model)
        for example in outcome.found
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
    precise = any(getattr(assignment, "precision", 0) for assignment in element.toJaus)
    return str(element.name) if precise or (element.toRos and element.toJaus) else ""


def _found(report: Report, name: str) -> dict[tuple[str, str], str]:
    """Returns what proofs find of a map, by rule and place."""
    trips = [round_trip for round_trip in round_trips(report.model) if round_trip.name == name]
    settings = Settings(str(compiler()), _PROOF_BUDGET, jobs=1)
    judged = with_proofs(report, trips, list(prove(report.model, trips, settings)))
    return {
        (diagnostic.rule, diagnostic.fragment): f"{diagnostic.rule} {diagnostic.message}"
        for diagnostic in judged.diagnostics
        if diagnostic.rule in PROOF_RULES
    }


VALIDATE, GENERATE, TESTS, PROVE = "validate", "generate", "tests", "prove"
CHECK, RUN = "check", "run"
WARNING, EQUAL, NOTHING = "warning", "equal", "nothing"

NOTICED_BY = {
    VALIDATE: "a rule finds an error",
    GENERATE: "nothing can be generated",
    TESTS: "a generated test of the model fails",
    PROVE: "a proof of its map finds what that of the model does not",
    CHECK: "a product check finds a violation that the model does not have",
    RUN: "the command of `--run` fails",
    WARNING: "a rule warns, and nothing else notices it",
    EQUAL: "the same code is generated",
    NOTHING: "it survives",
}
"""What can become of a mutation, in the order in which it is tried; the first one counts."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutation (`noticed_by`: a key of `NOTICED_BY`)."""

    operator: str
    place: str
    words: str
    noticed_by: str
    by: str = ""
    files: tuple[str, ...] = ()


@dataclass
class Campaign:
    """What became of the mutations of a model."""

    model: str
    possible: int = 0
    chosen: int = 0
    outcomes: list[Outcome] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def matrix(self) -> dict[str, Counter[str]]:
        """Returns how many mutations of each operator were noticed by what."""
        names = dict.fromkeys(operator.name for operator in OPERATORS)
        rows = {name: Counter[str]() for name in names}
        for outcome in self.outcomes:
            rows[outcome.operator][outcome.noticed_by] += 1
        return {name: row for name, row in rows.items() if row}

    def survivors(self) -> Sequence[Outcome]:
        """Returns what nothing noticed."""
        return [outcome for outcome in self.outcomes if outcome.noticed_by == NOTHING]

    def to_json(self) -> dict[str, Any]:
        """Returns all that is known, for programs."""
        return {
            "model": self.model,
            "version": __version__,
            "possible": self.possible,
            "chosen": self.chosen,
            "tried": len(self.outcomes),
            "matrix": {name: dict(row) for name, row in self.matrix().items()},
            "outcomes": [asdict(outcome) for outcome in self.outcomes],
            "remarks": self.remarks,
        }


_MOST_FILES = 3


def render(campaign: Campaign) -> str:
    """Returns a campaign as text."""
    lines = [summary(campaign), "", *_table(campaign)]
    for remark in campaign.remarks:
        lines += ["", f"note: {remark}"]
    survivors = campaign.survivors()
    if survivors:
        lines += ["", "nothing notices:"]
        lines += [f"  {told(survivor)}" for survivor in survivors]
    return "\n".join(lines)


def summary(campaign: Campaign) -> str:
    """Returns how many mutations there are, and how many of those tried survive."""
    tried, survive = len(campaign.outcomes), len(campaign.survivors())
    missing = campaign.chosen - tried
    late = f"; the time was over before {missing} more" if missing else ""
    return (
        f"{campaign.model}: {tried} of {campaign.possible} possible mutations tried{late}; "
        f"nothing notices {survive}"
    )


def told(survivor: Outcome) -> str:
    """Returns what survived, and what of the generated files it changes."""
    more = len(survivor.files) - _MOST_FILES
    files = ", ".join(survivor.files[:_MOST_FILES]) + (f" and {more} more" if more > 0 else "")
    reason = f"; {survivor.by}" if survivor.by else ""
    return f"{survivor.operator}: {survivor.place} {survivor.words} (changes {files}{reason})"


def rows(campaign: Campaign) -> Iterator[tuple[str, list[int]]]:
    """Yields how many mutations of each operator were noticed by what, and of all of them."""
    matrix = campaign.matrix()
    for name, row in matrix.items():
        yield name, [row[column] for column in NOTICED_BY]
    yield "all", [sum(row[column] for row in matrix.values()) for column in NOTICED_BY]


def _table(campaign: Campaign) -> Iterator[str]:
    found = list(rows(campaign))
    wide = max(len(name) for name, _ in found)
    yield " ".join([" " * wide, *(f"{column:>8}" for column in NOTICED_BY)]).rstrip()
    for name, counts in found:
        yield " ".join([f"{name:{wide}}", *(f"{count or '.':>8}" for count in counts)])


def page(campaign: Campaign) -> str:
    """Returns the page of a campaign."""
    known = {
        "campaign": campaign,
        "summary": summary(campaign),
        "ways": list(NOTICED_BY),
        "rows": [
            [name, *(str(count or "") for count in counts)] for name, counts in rows(campaign)
        ],
        "survivors": list(map(told, campaign.survivors())),
    }
    return pages.page("jausml.mutating", "campaign", f"Mutations of {campaign.model}", known)
