"""Hazards as a table: whom each concerns in a model, what answers it, and what can show that."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import KW_ONLY, dataclass
from typing import Any, Generic, TypeVar

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.subject import Subject
from jausml.safety_case.answers import (
    Answer,
    age_limit,
    by_guardian,
    control_lapse,
    fixed_sources,
    freshness,
    held,
    keeps_control,
    known_hosts,
    known_peers,
    lapse_of_peers,
    meaning,
    most_rate,
    obeys_controller,
    on_lapse,
    on_lost_control,
    on_silence,
    rate_cap,
    told_of_loss,
    told_of_silence,
    unjudged_targets,
)
from jausml.safety_case.elements import (
    Carrier,
    aging,
    asking,
    bridges,
    carriers,
    commandable,
    commands_to_jaus,
    commands_to_ros,
    jaus_messages,
    moved_components,
    published,
    reports,
    taken_messages,
)
from jausml.safety_case.evidence import FAULT_RUNS, MODEL_CHECK, MUTATIONS, PROOF, TEST_RUN

ElementT = TypeVar("ElementT")


@dataclass(frozen=True)
class Row(Generic[ElementT]):
    """Elements of one kind that a hazard concerns.

    Attributes:
        claim: What is to hold of each; `{}` in it is the name of the element.
        find: Returns the elements in a model.
        gap: What is missing where nothing answers, or what returns that of an element.
        answers: Return each the answer of an element; None if it has none.
        kinds: Kinds of evidence that could show the answers, besides rules.
    """

    claim: str
    find: Callable[[Subject], Iterable[ElementT]]
    gap: str | Callable[[ElementT], str]
    answers: tuple[Callable[[ElementT], Answer | None], ...]
    _: KW_ONLY
    kinds: tuple[str, ...] = ()


@dataclass(frozen=True)
class Hazard:
    """A hazard.

    Attributes:
        id: Its name in ids of goals.
        rules: Rules that have to hold at the elements.
        rows: The elements that it concerns.
        runs: Patterns of the names of fault runs that provoke it.
        properties: Rules of a product check that exclude it.
        checks: Pattern of what stands behind connections in the names of tests that show it.
    """

    id: str
    title: str
    rules: tuple[str, ...]
    rows: tuple[Row[Any], ...]
    runs: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    checks: str = "_safe_value"


def _unfresh(connection: bridge.Connection) -> str:
    if "keep" in (connection.whenStale.name, connection.map.whenStale.name):
        return "the last report stands (whenStale keep): a person has to accept that"
    return "no freshness: the last report stands"


def _meaningless(carrier: Carrier) -> str:
    listing = ", ".join(
        f"{target} (no rule: it lacks {missing})"
        for target, missing in unjudged_targets(carrier).items()
    )
    return f"nothing says what is right of {listing}, and no test vector"


_STOPS, _OBEYS = "what {} commands stops", "{} obeys it no longer"
_NO_STOP = "nothing stops it, and nobody says why its last command may stand"
_NO_GUARDIAN = "no guardian with a stop, and nobody says why its last command may stand"
_NO_LAPSE = "control never lapses, or nobody knows whether it does"
_NO_LIMIT = "no ageLimit: what was late on its way passes like a new message"
_NO_PEERS = "anybody who gets control may command: no peers, no allowedHosts"
_NO_DEADLINE = "neither a safe value nor a deadline: readers have to notice by themselves"
_UNGUARDED = "anyone may give some command of its services"
_ANYBODY = "neither allowedHosts nor fixedSources: datagrams of anybody are taken"
_SENDS_ON, _NOT_TOLD = "control false: it sends on", "no silenceTimeout"
_NO_CAP = "neither rateCap nor maxRate"
_MAPPED, _RUN, _SEARCHED = (TEST_RUN, PROOF, MUTATIONS), (FAULT_RUNS,), (MODEL_CHECK,)
_OF_OTHERS = (MODEL_CHECK, FAULT_RUNS)
_SHOWN = (TEST_RUN, MODEL_CHECK, FAULT_RUNS, MUTATIONS)
_STOPPED = Row(_STOPS, commands_to_ros, _NO_STOP, (on_silence, on_lapse, held), kinds=_SHOWN)
_LAPSING = Row(_OBEYS, moved_components, _NO_LAPSE, (control_lapse,), kinds=_SEARCHED)
_OF_VALUES = (
    "JML431", "JML432", "JML433", "JML434", "JML437", "JML438", "JML440",
    "JML441", "JML448", "JML449", "JML458", "JML515", "JML518",
)  # fmt: skip

HAZARDS = (
    Hazard(
        "link",
        "Loss of the link",
        rules=("JML451", "JML452", "JML453", "JML454", "JML497", "JML516"),
        rows=(
            _STOPPED,
            Row(_STOPS, commands_to_jaus, _NO_LAPSE, (lapse_of_peers, held), kinds=_OF_OTHERS),
            _LAPSING,
        ),
        runs=("network cut*", "TCP, held*", "TCP, connections cut*", "node manager killed"),
        properties=("JML931", "JML932", "JML933"),
    ),
    Hazard(
        "operator",
        "Loss of the operator",
        rules=("JML451", "JML452", "JML453", "JML454", "JML497", "JML516", "JML364", "JML366"),
        rows=(
            _STOPPED,
            Row(_STOPS, commands_to_jaus, _NO_STOP, (on_silence, held), kinds=_SHOWN),
            _LAPSING,
        ),
        runs=("*operator killed", "operator halted*", "operator restarted", "ros *"),
        properties=("JML933",),
    ),
    Hazard(
        "sensor",
        "Loss of a sensor",
        rules=("JML455", "JML456", "JML459", "JML465"),
        rows=(
            Row("{} reports no old value", reports, _unfresh, (freshness,), kinds=_RUN),
            Row("readers of {} learn it", published, _NO_DEADLINE, (told_of_loss,), kinds=_RUN),
            Row("who asks by {} learns it", asking, _NOT_TOLD, (told_of_silence,)),
        ),
        runs=("*vehicle killed", "*vehicle halted*", "ros killed", "ros halted*"),
    ),
    Hazard(
        "stale",
        "Stale data",
        rules=("JML456", "JML490", "JML494"),
        rows=(
            Row("{} does not pass it as new", aging, _NO_LIMIT, (age_limit,)),
            Row("{} does not report it as new", reports, _unfresh, (freshness, age_limit)),
        ),
    ),
    Hazard(
        "unit",
        "Wrong unit, sign or frame",
        rules=_OF_VALUES,
        rows=(
            Row(
                "a rule or a test of {} shows it", carriers, _meaningless, (meaning,), kinds=_MAPPED
            ),
        ),
        checks="*",
    ),
    Hazard(
        "preemption",
        "Preemption",
        rules=("JML353", "JML364", "JML368", "JML427", "JML516"),
        rows=(
            Row(_STOPS, commands_to_ros, _NO_STOP, (on_lost_control, held), kinds=_SHOWN),
            Row("{} commands no longer", commands_to_jaus, _SENDS_ON, (keeps_control,)),
        ),
        runs=("*taken over", "emergency*"),
        properties=("JML933", "JML934"),
    ),
    Hazard(
        "foreign",
        "Foreign command",
        rules=("JML351", "JML356", "JML362", "JML477", "JML478", "JML479"),
        rows=(
            Row("{} does not obey", commandable, _NO_PEERS, (known_peers, known_hosts)),
            Row(
                "{} does not obey",
                moved_components,
                _UNGUARDED,
                (obeys_controller,),
                kinds=_SEARCHED,
            ),
        ),
        properties=("JML934",),
    ),
    Hazard(
        "crash",
        "Crash of the bridge",
        rules=("JML451", "JML452", "JML516"),
        rows=(
            Row(_STOPS, commands_to_ros, _NO_GUARDIAN, (by_guardian, held), kinds=_SHOWN),
            Row(_STOPS, jaus_messages, _NO_GUARDIAN, (by_guardian, held), kinds=_SHOWN),
        ),
        runs=("*bridge killed", "bridge halted*", "bridge restarted", "kill -9", "halted for*"),
    ),
    Hazard(
        "overload",
        "Overload",
        rules=("JML477", "JML478", "JML480", "JML489", "JML490", "JML491", "JML492", "JML493"),
        rows=(
            Row("others beside {} go on", taken_messages, _NO_CAP, (rate_cap, most_rate)),
            Row("peers of {} are heard", bridges, _ANYBODY, (known_hosts, fixed_sources)),
        ),
    ),
)
