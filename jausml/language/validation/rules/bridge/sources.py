"""Rules about values of one source, emergencies, and messages that the runtime takes care of."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.hold_reasons import is_reason
from jausml.language.semantics.connections.reports import is_report
from jausml.language.semantics.connections.topics import Flow, flow_of
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import is_command, is_emergency
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.services import (
    code,
    find_input,
    find_output,
    find_query,
    is_known,
)
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import is_sound
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_ENDS = ("name", "map", "direction", "exchange", "peers", "search", "query", "topics")
_OF_MANY = (
    *("diagnostic_msgs/", "rcl_interfaces/", "tf2_msgs/", "visualization_msgs/"),
    *("sensor_msgs/JointState", "std_msgs/String"),
)
"""Types whose messages say what they are of, so that many publish on one topic."""

_LEFT_TO_CONNECTIONS = {"urn:jausml:MachineStates", "urn:jaus:jss:iop:DigitalResourceDiscovery"}
"""Services of which the runtime answers what no connection answers."""


@rule("JML429", "report of several sources", kinds=bridge.Bridge)
def reports_have_one_source(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """One topic makes a report of a bridge.

    JAUS asks a component for a report, and does not say of which topic. With two topics, each
    message replaces that of the other: whoever asks sees the value jump. A service connection that
    answers the same query is a second source too.

    Bad: two connections with the map local_pose, of the topics odom_left and odom_right

    Good: one of them; or a bridge, which has an address of its own, for each robot
    """
    sources: dict[int, tuple[str, bridge.Connection | bridge.RosServiceConnection]] = {}
    for query, what, connection, element in _sources(subject, owner):
        of, first = sources.setdefault(query, (what, connection))
        if of != what or first is not connection:
            message = f"{what} of '{connection.name}' is a second source of what {of} tells"
            hint = "leave out one of them, or give one a bridge of its own"
            note = Note(first, f"'{first.name}'")
            yield Finding(element, message, None, f"{hint}: the value would jump", (note,))


def _sources(
    subject: Subject, owner: bridge.Bridge
) -> Iterator[
    tuple[
        int,
        str,
        bridge.Connection | bridge.RosServiceConnection,
        bridge.Connection | bridge.RosServiceConnection | bridge.Topic,
    ]
]:
    """Yields the answers to queries: code, source in words, and the elements that state it."""
    for connection in owner.bridgeConnections:
        if not (
            subject.is_read(connection, _ENDS)
            and is_sound(subject, connection)
            and is_report(connection)
        ):
            continue
        query = find_query(connection, owner)
        main = [topic for topic in connection.topics if topic.join is None and topic.name]
        if query is not None:
            yield from ((code(query), f"topic {topic.name}", connection, topic) for topic in main)
    for call in owner.serviceConnections:
        asking = calls.asking(call) if subject.is_intact(call) else None
        if asking is not None and subject.is_intact(asking) and not calls.serves(call):
            yield code(asking), f"service {call.service}", call, call


@rule("JML450", "topic of several sources")
def topics_have_one_source(subject: Subject) -> Iterator[Finding]:
    """One report is published on a topic.

    Where the reports of two components, or two reports of one, reach the same topic, its value
    jumps between them. Topics are compared by their full names, in all bridges of a system. Types
    whose messages name what they are of may come from many, such as JointState.

    Bad: ReportLocalPose of two robots in two connections with `<topics name="odom"/>`

    Good: `robot1/odom` and `robot2/odom`
    """
    for group in subject.systems(("name", "namespace")):
        published: dict[str, list[Flow]] = defaultdict(list)
        for owner in group:
            if not isinstance(owner, bridge.Bridge):
                continue
            for flow in subject.once(_published, owner):
                for topic in sorted(flow.topics):
                    yield from _second(flow, topic, published[topic])
                    published[topic].append(flow)


def _second(flow: Flow, topic: str, others: list[Flow]) -> Iterator[Finding]:
    map_ = flow.connection.map
    first = next((other for other in others if not is_same_source(flow, other)), None)
    if first is not None and not ros_name(map_.type).startswith(_OF_MANY):
        name = first.connection.name
        message = f"'{flow.connection.name}' publishes {map_.message.name} on {topic}, where"
        message += f" '{name}' publishes {first.connection.map.message.name}"
        hint = "give each a topic of its own: the value would jump"
        note = Note(first.connection, f"'{name}'", "topics")
        yield Finding(flow.connection, message, "topics", hint, (note,))


def is_same_source(flow: Flow, other: Flow) -> bool:
    """Tells whether two connections to ROS carry the same message of a common peer alike.

    A copy of a bridge has copies of its maps, which have the same names.
    """
    is_same = flow.code == other.code and flow.connection.map.name == other.connection.map.name
    return is_same and bool(flow.peers & other.peers or (flow.is_open and other.is_open))


def _published(subject: Subject, owner: bridge.Bridge) -> list[Flow]:
    return [
        flow_of(bridge_connection, owner)
        for bridge_connection in owner.bridgeConnections
        if subject.is_read(bridge_connection, _ENDS)
        and is_sound(subject, bridge_connection)
        and is_to_ros(bridge_connection)
        and not flow_of(bridge_connection, owner).is_message
    ]


@rule(
    "JML462",
    "message that the runtime itself takes",
    kinds=bridge.Connection,
    needs=_ENDS,
    condition=is_sound,
)
def core_messages_left(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """No connection takes a command of a core service from the bridge, or makes a report of one.

    The runtime obeys and answers these itself: life cycle, control, time, discovery, events, lists.
    What can cross are SetEmergency and ClearEmergency, which it tells when an emergency of the
    bridge begins and ends, whoever has set it: such a connection to ROS has no peers. The status of
    other components can be asked for.

    Bad: a connection of Standby to a topic; one of ReportStatus from a topic

    Good: a connection of SetEmergency to a topic; one of ReportStatus of a peer
    """
    message, owner = connection.map.message, connection.eContainer()
    service = message.eContainer()
    urn = str(getattr(service, "urn", ""))
    if owner is None or not is_known(subject, owner):
        return
    if urn not in SERVED_BY_RUNTIME - _LEFT_TO_CONNECTIONS:
        return
    to_ros, by_message = (
        is_to_ros(connection),
        connection.exchange.name == "message",
    )
    if is_emergency(message):
        if to_ros and (connection.peers or connection.search is not None):
            text = f"an emergency of '{owner.name}' counts whoever has set it"
            yield Finding(connection, text, "peers", "leave out the peers")
    elif to_ros and by_message and is_command(message) and find_input(message, owner) is not None:
        hint = _hook(message)
        text = f"the runtime itself takes {message.name} of '{connection.name}'"
        yield Finding(connection, text, "map", hint)
    elif not to_ros and not by_message and find_output(message, owner) is not None:
        text = f"the runtime itself tells {message.name} of '{owner.name}'"
        yield Finding(connection, text, "map", "leave the connection out")


def _hook(message: jaus.MessageDef) -> str:
    if message.name in ("SetElement", "DeleteElement"):
        return "name the map as the element of a connection with an action, which executes lists"
    return "leave the connection out; hooks of the component tell its state and its controller"


@rule(
    "JML500",
    "emergency stop that nobody explains",
    is_decision=True,
    kinds=bridge.Connection,
    needs=(*_ENDS, "holdReason"),
    condition=is_sound,
)
def emergencies_explained(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection of an emergency says what releases the stop, as a person has decided it.

    SetEmergency presses a stop, and nothing but a ClearEmergency releases it: a connection that
    carries one makes that possible, and without one it stays pressed. The `holdReason` says who may
    release it, and how, where it is pressed, and why that is safe, where it is released; of a
    service that is called, the documentation of the connection says it.

    Bad: SetEmergency to the topic e_stop/set without a word

    Good: `holdReason="the key at the robot releases it"`
    """
    message = connection.map.message
    if is_emergency(message) and not is_reason(connection.holdReason or ""):
        does = "presses" if message.name == "SetEmergency" else "releases"
        text = f"'{connection.name}' {does} an emergency stop, and nobody says what may release it"
        yield Finding(connection, text, "holdReason", "say it in holdReason, as the robot is built")


@emergencies_explained.also(bridge.RosServiceConnection)
def _calls_explained(subject: Subject, call: bridge.RosServiceConnection) -> Iterator[Finding]:
    asking = calls.asking(call) if subject.is_intact(call) else None
    if asking is None or calls.serves(call) or not subject.is_intact(asking):
        return
    if is_emergency(asking) and not is_reason(call.documentation or ""):
        text = f"'{call.name}' calls an emergency stop, and nobody says what may release it"
        hint = "say it in the documentation of the connection, as the robot is built"
        yield Finding(call, text, "documentation", hint)
