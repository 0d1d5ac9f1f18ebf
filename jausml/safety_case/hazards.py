"""Hazards as a table: whom each concerns in a model, what answers it, and what can show that."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeAlias, TypeVar, cast

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.assignments.meanings import unknown_targets
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.hold_reasons import is_reason
from jausml.language.semantics.connections.reports import freshness_of, is_report
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import (
    controlled_by_nobody,
    is_command,
    is_published,
    obeys_controller_alone,
)
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.paths.scopes import sound_connections
from jausml.language.semantics.subject import Subject
from jausml.safety_case.evidence import FAULT_RUNS, MODEL_CHECK, MUTATIONS, PROOF, TEST_RUN

Commander: TypeAlias = "bridge.Connection | bridge.RosActionConnection"
Carrier: TypeAlias = "Commander | bridge.RosServiceConnection"

ElementT = TypeVar("ElementT")


@dataclass(frozen=True)
class Answer:
    """The answer of an element to a hazard: in some seconds, or for a reason that a person gave."""

    text: str
    seconds: float = 0.0
    reason: str = ""


@dataclass(frozen=True)
class Row(Generic[ElementT]):
    """Elements of one kind that a hazard concerns; `{}` in the claim is the name of each."""

    claim: str
    find: Callable[[Subject], Iterable[ElementT]]
    gap: str | Callable[[ElementT], str]
    answers: tuple[Callable[[ElementT], Answer | None], ...]
    kinds: tuple[str, ...] = ()


@dataclass(frozen=True)
class Hazard:
    """A hazard.

    Attributes:
        rules: Rules that have to hold at the elements.
        runs: Patterns of the names of fault runs that provoke it.
        properties: Rules of a product check that exclude it.
        checks: Pattern of what stands behind connections in the names of tests that show it.
    """

    id: str
    title: str
    rules: str
    rows: tuple[Row[Any], ...]
    runs: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    checks: str = "_safe_value"


def carried_maps(element: object) -> list[bridge.AttributeMap]:
    """Returns the maps of a connection, none of other elements."""
    carriers = (bridge.Connection, bridge.RosServiceConnection, bridge.RosActionConnection)
    return [map_ for map_, _ in _map_directions(element)] if isinstance(element, carriers) else []


def _map_directions(carrier: Carrier) -> list[tuple[bridge.AttributeMap, bool]]:
    if isinstance(carrier, bridge.RosServiceConnection):
        return [(half.map, half.to_ros) for half in calls.halves(carrier)]
    map_ = carrier.map if isinstance(carrier, bridge.Connection) else carrier.element
    return [(map_, is_to_ros(carrier))]


def _owner(carrier: Carrier) -> bridge.Bridge:
    return cast("bridge.Bridge", carrier.eContainer())


def _after(seconds: float, before: str, after: str = "") -> Answer | None:
    """Returns an answer that names its seconds between two texts; None for no time."""
    return Answer(f"{before} {seconds:g} s{after}", float(seconds)) if seconds > 0 else None


def _stated(feature: str, before: str, after: str = "") -> Callable[[Any], Answer | None]:
    return lambda element: _after(float(getattr(element, feature)), before, after)


def _limited(feature: str, text: str) -> Callable[[Any], Answer | None]:
    """Returns the answer of a feature that is a rate, and no time."""

    def answer_of(element: Any) -> Answer | None:
        rate = float(getattr(element, feature))
        return Answer(text.format(rate)) if rate > 0 else None

    return answer_of


def _when(holds: Callable[[Any], object], text: str) -> Callable[[Any], Answer | None]:
    return lambda element: Answer(text) if holds(element) else None


def _stop(commander: Commander) -> str:
    if isinstance(commander, bridge.RosActionConnection):
        return "cancels its goal"
    return f"sends its stop ({stops.stop_text(commander)})" if stops.has_stop(commander) else ""


def _on_silence(commander: Commander) -> Answer | None:
    if not isinstance(commander, bridge.Connection) or not stops.has_stop(commander):
        return None
    return _after(stops.silence_timeout(commander), f"{_stop(commander)} after", " of silence")


def _on_lapse(commander: Commander) -> Answer | None:
    what, seconds = _stop(commander), int(_owner(commander).controlTimeout)
    return _after(seconds if what else 0, f"{what} when control is not renewed for")


def _on_end(commander: Commander) -> Answer | None:
    what = _stop(commander)
    return Answer(f"{what} when its controller loses control") if what else None


def _by_guardian(commander: Commander) -> Answer | None:
    what = _stop(commander) if _owner(commander).guardian else ""
    return Answer(f"its guardian {what} when the bridge is dead or stands still") if what else None


def _held(commander: Commander) -> Answer | None:
    if not isinstance(commander, bridge.Connection) or not stops.keeps_last_command(commander):
        return None
    message = commander.map.message
    if not message.moves:
        own = "" if is_published(message) else "its definition says so (moves false)"
        return Answer(f"{message.name} sets nothing in motion", reason=own)
    reason = stops.hold_reason(commander).strip()
    return Answer("the last command stands", reason=reason) if is_reason(reason) else None


def _peers_lapse(commander: Commander) -> Answer | None:
    times = [int(peer.controlTimeout) for peer in commander.peers]
    lapse = max(times) if times and all(times) and commander.control else 0
    is_external = any(peer.external for peer in commander.peers)
    said = " (external: if they do what the model says)" if is_external else ""
    return _after(lapse, "control of its peers lapses when it is not renewed for", said)


def _moving(component: jaus.Component) -> Iterator[tuple[jaus.MessageDef, jaus.Service]]:
    for service in with_inherited(component.provides):
        if str(service.urn) not in SERVED_BY_RUNTIME:
            yield from ((e, service) for e in service.inputs if is_command(e) and e.moves)


def _known_peers(carrier: Carrier) -> Answer | None:
    names = ", ".join(str(peer.name) for peer in carrier.peers)
    names = "components that it has found" if carrier.search is not None else names
    return Answer(f"takes messages of {names} alone") if names else None


def _known_hosts(element: Carrier | bridge.Bridge) -> Answer | None:
    owner = element if isinstance(element, bridge.Bridge) else _owner(element)
    hosts = ", ".join(map(str, owner.allowedHosts))
    return Answer(f"hears {hosts} and its own host alone") if hosts else None


def _fresh(connection: bridge.Connection) -> Answer | None:
    seconds = freshness_of(connection) or stops.silence_timeout(connection)
    return _after(seconds, "reports nothing older than", ", but what is safe in its place")


def _loss_told(connection: bridge.Connection) -> Answer | None:
    silence = stops.silence_timeout(connection) if connection.safeValue else 0.0
    topics = [topic.qos for topic in connection.topics if topic.join is None]
    deadline = min((float(qos.deadline) if qos is not None else 0.0 for qos in topics), default=0)
    answer = _after(silence, "publishes its safe value after", " of silence")
    return answer or _after(deadline, "its topic has a deadline of")


def _unknown(carrier: Carrier) -> dict[str, str]:
    """Returns the targets that cannot be judged, each with the reason."""
    directions = (unknown_targets(map_, to_ros=to_ros) for map_, to_ros in _map_directions(carrier))
    return {target: lack for pairs in directions for target, lack in pairs}


def _connections(
    wanted: Callable[[bridge.Connection], bool],
) -> Callable[[Subject], list[bridge.Connection]]:
    return lambda subject: [
        connection for connection in sound_connections(subject) if wanted(connection)
    ]


def _commanders(*, to_ros: bool, lists: bool = True) -> Callable[[Subject], list[Commander]]:
    def find(subject: Subject) -> list[Commander]:
        commanders: list[Commander] = [
            connection
            for connection in sound_connections(subject)
            if stops.carries_commands(connection)
        ]
        commanders += subject.instances(bridge.RosActionConnection) if lists else []
        return [connection for connection in commanders if is_to_ros(connection) == to_ros]

    return find


_obeyed, _given = _commanders(to_ros=True), _commanders(to_ros=False)
_sent = _commanders(to_ros=False, lists=False)
_aged = _connections(lambda connection: is_to_ros(connection) or stops.carries_commands(connection))
_taken = _connections(
    lambda connection: is_to_ros(connection) and connection.exchange.name == "message"
)
_published = _connections(
    lambda connection: is_to_ros(connection) and not stops.carries_commands(connection)
)
_reports = _connections(is_report)


def _carriers(subject: Subject) -> list[Carrier]:
    calls_ = subject.instances(bridge.RosServiceConnection)
    return [*sound_connections(subject), *calls_, *subject.instances(bridge.RosActionConnection)]


def _commandable(subject: Subject) -> list[Carrier]:
    carriers: list[Carrier] = list(_obeyed(subject))
    for ros_service_connection in subject.instances(bridge.RosServiceConnection):
        asking = calls.asking(ros_service_connection)
        carriers += (
            [ros_service_connection]
            if is_to_ros(ros_service_connection) and asking is not None and is_command(asking)
            else []
        )
    return carriers


def _components(subject: Subject) -> list[jaus.Component]:
    components = [
        component for component in subject.instances(jaus.Component) if not component.external
    ]
    return [e for e in components if not isinstance(e, bridge.Bridge) and any(_moving(e))]


def _instances(kind: type[Any]) -> Callable[[Subject], list[Any]]:
    return lambda subject: subject.instances(kind)


_asking, _bridges = _instances(jaus.ServiceConnection), _instances(bridge.Bridge)


def _unfresh(connection: bridge.Connection) -> str:
    if "keep" in (connection.whenStale.name, connection.map.whenStale.name):
        return "the last report stands (whenStale keep): a person has to accept that"
    return "no freshness: the last report stands"


def _meaningless(carrier: Carrier) -> str:
    listing = ", ".join(
        f"{target} (no rule: it lacks {e})" for target, e in _unknown(carrier).items()
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
_MAPPED = (TEST_RUN, PROOF, MUTATIONS)
_SHOWN = (TEST_RUN, MODEL_CHECK, FAULT_RUNS, MUTATIONS)
_keeps_control = _when(lambda e: e.control, "sends only while it has control of the peer")
_fixed_sources = _when(lambda e: e.fixedSources, "hears each component from one endpoint alone")
_obeys_controller = _when(
    lambda e: (
        all(obeys_controller_alone(*pair) for pair in _moving(e))
        and not any(map(controlled_by_nobody, with_inherited(e.provides)))
    ),
    "obeys what moves it from its controller alone",
)
_meaning = _when(
    lambda e: not _unknown(e),
    "rules know units, axes and names of both ends, or test vectors say what is right",
)
_lapses = _stated("controlTimeout", "its control lapses when it is not renewed for")
_age = _stated("ageLimit", "passes no message older than")
_told = _stated("silenceTimeout", "is told after", " of silence")
_cap = _limited("rateCap", "takes {:g} messages/s of one source at most")
_rate = _limited("maxRate", "passes {:g} messages/s at most")

HAZARDS = (
    Hazard(
        "link",
        "Loss of the link",
        "JML451 JML452 JML453 JML454 JML497 JML516",
        (
            Row(_STOPS, _obeyed, _NO_STOP, (_on_silence, _on_lapse, _held), _SHOWN),
            Row(_STOPS, _given, _NO_LAPSE, (_peers_lapse, _held), (MODEL_CHECK, FAULT_RUNS)),
            Row(_OBEYS, _components, _NO_LAPSE, (_lapses,), (MODEL_CHECK,)),
        ),
        ("network cut*", "TCP, held*", "TCP, connections cut*", "node manager killed"),
        ("JML931", "JML932", "JML933"),
    ),
    Hazard(
        "operator",
        "Loss of the operator",
        "JML451 JML452 JML453 JML454 JML497 JML516 JML364 JML366",
        (
            Row(_STOPS, _obeyed, _NO_STOP, (_on_silence, _on_lapse, _held), _SHOWN),
            Row(_STOPS, _given, _NO_STOP, (_on_silence, _held), _SHOWN),
            Row(_OBEYS, _components, _NO_LAPSE, (_lapses,), (MODEL_CHECK,)),
        ),
        ("*operator killed", "operator halted*", "operator restarted", "ros *"),
        ("JML933",),
    ),
    Hazard(
        "sensor",
        "Loss of a sensor",
        "JML455 JML456 JML459 JML465",
        (
            Row("{} reports no old value", _reports, _unfresh, (_fresh,), (FAULT_RUNS,)),
            Row("readers of {} learn it", _published, _NO_DEADLINE, (_loss_told,), (FAULT_RUNS,)),
            Row("who asks by {} learns it", _asking, "no silenceTimeout", (_told,)),
        ),
        ("*vehicle killed", "*vehicle halted*", "ros killed", "ros halted*"),
    ),
    Hazard(
        "stale",
        "Stale data",
        "JML456 JML490 JML494",
        (
            Row("{} does not pass it as new", _aged, _NO_LIMIT, (_age,)),
            Row("{} does not report it as new", _reports, _unfresh, (_fresh, _age)),
        ),
    ),
    Hazard(
        "unit",
        "Wrong unit, sign or frame",
        "JML431 JML432 JML433 JML434 JML437 JML438 JML440 JML441 JML448 JML449 JML458 JML515 "
        "JML518",
        (Row("a rule or a test of {} shows it", _carriers, _meaningless, (_meaning,), _MAPPED),),
        checks="*",
    ),
    Hazard(
        "preemption",
        "Preemption",
        "JML353 JML364 JML368 JML427 JML516",
        (
            Row(_STOPS, _obeyed, _NO_STOP, (_on_end, _held), _SHOWN),
            Row("{} commands no longer", _given, "control false: it sends on", (_keeps_control,)),
        ),
        ("*taken over", "emergency*"),
        ("JML933", "JML934"),
    ),
    Hazard(
        "foreign",
        "Foreign command",
        "JML351 JML356 JML362 JML477 JML478 JML479",
        (
            Row("{} does not obey", _commandable, _NO_PEERS, (_known_peers, _known_hosts)),
            Row("{} does not obey", _components, _UNGUARDED, (_obeys_controller,), (MODEL_CHECK,)),
        ),
        properties=("JML934",),
    ),
    Hazard(
        "crash",
        "Crash of the bridge",
        "JML451 JML452 JML516",
        (
            Row(_STOPS, _obeyed, _NO_GUARDIAN, (_by_guardian, _held), _SHOWN),
            Row(_STOPS, _sent, _NO_GUARDIAN, (_by_guardian, _held), _SHOWN),
        ),
        ("*bridge killed", "bridge halted*", "bridge restarted", "kill -9", "halted for*"),
    ),
    Hazard(
        "overload",
        "Overload",
        "JML477 JML478 JML480 JML489 JML490 JML491 JML492 JML493",
        (
            Row("others beside {} go on", _taken, "neither rateCap nor maxRate", (_cap, _rate)),
            Row("peers of {} are heard", _bridges, _ANYBODY, (_known_hosts, _fixed_sources)),
        ),
    ),
)
