"""Connections in the system view: rows of the bridge, their words, and edges to both sides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import target_paths
from jausml.views.diagrams.graph import IDLE, JAUS_COLUMN, ROS_COLUMN, Edge, End, Node, Port
from jausml.views.diagrams.views.context import Builder, details, name_of, number

PROVIDES, USES = "provides", "uses"
"""Relations of boxes to services of which no message is carried."""

_EXCHANGES = {
    "message": "message",
    "periodicEvent": "event",
    "everyChangeEvent": "event on change",
    "query": "query",
    "periodic": "event",
    "everyChange": "event on change",
    "oneTime": "query once",
}


def topic(name: str | None, owner: ros.Node | bridge.Bridge) -> str:
    """Returns the full name of a topic, service or action of a node or bridge."""
    return resolve_topic(name or "?", owner.namespace or "", owner.name or "")


def exchange(style: str, rate: float, usual: float = 0) -> str:
    """Returns how messages are exchanged, in words.

    Args:
        style: Literal of `bridge.Exchange` or `jaus.EventType`.
        rate: Hertz that the connection asks for, 0 for the usual ones.
        usual: Hertz of the bridge.
    """
    hertz = (rate or usual) if style in ("periodicEvent", "periodic", "query") else 0
    words = _EXCHANGES.get(style, style)
    return f"{words}, {number(hertz)} Hz" if hertz else words


def add_service_connection(
    builder: Builder, owner: jaus.Component, connection: jaus.ServiceConnection
) -> None:
    """Adds the edge of a connection by which a component asks another."""
    context = builder.context
    message, usual = connection.message, getattr(owner, "frequency", 0)
    label = exchange(connection.exchange.name, connection.rate, usual)
    message_name = name_of(message)
    row = context.row(
        connection, name_of(connection), message_name, message=message_name, exchange=label
    )
    end = builder.put(context.id_of(owner), row)
    provider = connection.provider
    providers = [provider] if provider is not None else []
    for start in _jaus_ends(builder, owner, providers, connection.search, message, "sends"):
        builder.edges.append(
            Edge(f"{row.id}!{start.node}", start, end, "message", name_of(message), (label,),
                 details=row.details, findings=row.findings, element=row.element)
        )  # fmt: skip


def add_idle_services(builder: Builder, owner: jaus.Component) -> None:
    """Adds a row for each service of which no connection carries anything.

    The runtime takes care of core services by itself.
    """
    context, own = builder.context, builder.context.id_of(owner)
    carried = [
        element if isinstance(element, jaus.Service) else element.eContainer()
        for element in builder.carried.get(own, ())
    ]
    for way, services in ((PROVIDES, owner.provides), (USES, owner.uses)):
        for service in services:
            if service.urn in SERVED_BY_RUNTIME or any(
                ancestor in carried for ancestor in lineage(service)
            ):
                continue
            builder.put(
                own,
                Port(
                    f"{own}!{way}!{name_of(service)} {service.version}",
                    name_of(service),
                    way,
                    IDLE,
                    details=details(service, version=service.version),
                    element=context.reference(service),
                ),
            )


def add_bridge(builder: Builder, owner: bridge.Bridge) -> None:
    """Adds the connections of a bridge: messages, ROS services and ROS actions."""
    for connection in owner.bridgeConnections:
        _add_connection(builder, owner, connection)
    for service in owner.serviceConnections:
        asked = calls.asking(service)
        messages = [message for message in (asked, calls.answering(service)) if message is not None]
        note = " / ".join(name_of(message) for message in messages) or "?"
        _add_call(builder, owner, service, "service", service.service, note, asked)
    for action in owner.actionConnections:
        note = f"list of {name_of(action.driver)}"
        _add_call(builder, owner, action, "action", action.action, note, action.driver)


def _add_connection(builder: Builder, owner: bridge.Bridge, connection: bridge.Connection) -> None:
    context, map_ = builder.context, connection.map
    message = map_.message if map_ is not None else None
    kind = map_.type if map_ is not None else None
    to_ros = is_to_ros(connection)
    style = connection.exchange.name
    is_command = style == "message" and message is not None and message.isCommand
    label = exchange("command" if is_command else style, connection.rate, owner.frequency)
    arrow = "\N{RIGHTWARDS ARROW}" if to_ros else "\N{LEFTWARDS ARROW}"
    row = context.row(
        connection,
        name_of(connection),
        f"{name_of(message)} {arrow} {_short(kind)}",
        map=name_of(map_),
        message=name_of(message),
        type=_type(kind),
        exchange=label,
        limits=limits(connection),
        QoS=topics_qos(connection),
        **{"when lost": when_lost(connection)},
    )
    here = builder.put(context.id_of(owner), row)
    way = "sends" if to_ros else "takes"
    peers = _jaus_ends(builder, owner, connection.peers, connection.search, message, way)
    for source in connection.sources:
        joined = source.join.message if source.join is not None else None
        peers += _jaus_ends(builder, owner, source.peers, None, joined, "sends")
    for peer in peers:
        _join(builder, row, peer, here, label, name_of(message), forwards=to_ros)
    for ros_topic in connection.topics:
        name = topic(ros_topic.name, owner)
        wanted = "subscribes" if to_ros else "publishes"
        its = kind if ros_topic.join is None else ros_topic.join.type
        for end in _ros_ends(builder, owner, name, wanted, _type(its)):
            _join(builder, row, here, end, "", name, forwards=to_ros)


def _add_call(
    builder: Builder,
    owner: bridge.Bridge,
    connection: bridge.RosServiceConnection | bridge.RosActionConnection,
    words: str,
    name: str,
    note: str,
    asked: jaus.MessageDef | jaus.Service | None,
) -> None:
    """Adds the connection with a ROS service or action.

    `words`: which of both. `name`: its name. `note`: what JAUS has for it, `asked` that which is
    asked for.
    """
    context, kind = builder.context, connection.type
    to_ros = is_to_ros(connection)
    arrow = "\N{RIGHTWARDS ARROW}" if to_ros else "\N{LEFTWARDS ARROW}"
    more = {words: name, "type": _type(kind), "JAUS": note}
    note = f"{note} {arrow} {_short(kind)}"
    row = context.row(connection, name_of(connection), note, words, **more)
    here = builder.put(context.id_of(owner), row)
    way = "asks" if to_ros else "answers"
    for peer in _jaus_ends(builder, owner, connection.peers, connection.search, asked, way):
        _join(builder, row, peer, here, words, note, forwards=to_ros, kind="call")
    full = topic(name, owner)
    wanted = "serves" if to_ros else "calls"
    for end in _ros_ends(builder, owner, full, wanted, _type(kind)):
        _join(builder, row, here, end, words, full, forwards=to_ros, kind="call")


def _join(
    builder: Builder,
    row: Port,
    left: End,
    right: End,
    label: str,
    title: str,
    *,
    forwards: bool,
    kind: str = "",
) -> None:
    """Adds an edge of a connection, from the left to the right or back."""
    ends = (left, right) if forwards else (right, left)
    is_jaus = right.port == row.id
    other = left if is_jaus else right
    builder.edges.append(
        Edge(
            f"{row.id}!{other.node}!{other.port}",
            *ends,
            kind or ("message" if is_jaus else "topic"),
            title,
            (label,) if label else (),
            details=row.details,
            findings=row.findings,
            element=row.element,
        )
    )


def _jaus_ends(
    builder: Builder,
    owner: jaus.Component,
    peers: Sequence[jaus.Component],
    search: jaus.PeerSearch | None,
    message: jaus.MessageDef | jaus.Service | None,
    way: str,
) -> list[End]:
    """Returns the ends at the JAUS side: rows of the peers for the message."""
    context = builder.context
    boxes = [context.id_of(peer) for peer in peers]
    boxes = [box_id for box_id in boxes if box_id in builder.boxes]
    if not boxes:
        words = "any component"
        if search is not None:
            words = "found: " + ", ".join(name_of(service) for service in search.services)
        box = Node(
            f"{context.id_of(owner)}!{words}", "others", words, "not named", column=JAUS_COLUMN
        )
        boxes = [builder.add(box)]
    name = name_of(message)
    for box_id in (context.id_of(owner), *boxes):
        builder.carry(box_id, message)
    return [builder.put(box_id, Port(f"{box_id}!{way}!{name}", name, way)) for box_id in boxes]


def _ros_ends(builder: Builder, owner: bridge.Bridge, name: str, way: str, kind: str) -> list[End]:
    """Returns the ends at the ROS side; a name that no node has is one of other nodes."""
    ends = [end for other, its, end in builder.endpoints if (other, its) == (name, way)]
    if ends:
        return ends
    own = builder.context.id_of(owner)
    box = builder.add(
        Node(f"{own}!ros", "others", "other ROS nodes", "not in the model", column=ROS_COLUMN)
    )
    return [builder.put(box, Port(f"{box}!{way}!{name}", name, kind))]


def _type(kind: ros.MessageType | ros.ServiceType | ros.ActionType | None) -> str:
    return ros_name(kind) if kind is not None else "?"


def _short(kind: ros.MessageType | ros.ServiceType | ros.ActionType | None) -> str:
    return _type(kind).rpartition("/")[2]


def qos(profile: ros.QoSProfile | None) -> str:
    """Returns a quality of service in words, empty for the default."""
    if profile is None:
        return ""
    depth = f" {profile.depth}" if profile.history.name == "keep_last" else ""
    words = [_words(profile.reliability.name), _words(profile.durability.name)]
    words.append(_words(profile.history.name) + depth)
    for name, seconds in (("deadline", profile.deadline), ("lifespan", profile.lifespan)):
        words += [f"{name} {number(seconds)} s"] if seconds else []
    if profile.leaseDuration:
        words.append(
            f"alive {_words(profile.liveliness.name)} in {number(profile.leaseDuration)} s"
        )
    return ", ".join(words)


def topics_qos(connection: bridge.Connection) -> str:
    """Returns the quality of service of the topics of a connection, of those that state one."""
    pairs = ((str(ros_topic.name or "?"), qos(ros_topic.qos)) for ros_topic in connection.topics)
    return "; ".join(f"{name}: {words}" for name, words in pairs if words)


def limits(connection: bridge.Connection) -> str:
    """Returns the limits on the messages of a connection, in words."""
    return ", ".join(_limits(connection))


def _limits(connection: bridge.Connection) -> Iterator[str]:
    if connection.rateCap:
        yield f"at most {number(connection.rateCap)} Hz are taken of one source"
    if connection.decimation > 1:
        yield f"one of {connection.decimation} passes"
    if connection.maxRate:
        yield f"at most {number(connection.maxRate)} Hz pass"
    if connection.ageLimit:
        yield f"none older than {number(connection.ageLimit)} s"


def when_lost(connection: bridge.Connection) -> str:
    """Returns the action of a connection when its source is lost, in words; empty for none."""
    map_ = connection.map
    if map_ is None or map_.message is None:
        return ""
    if not stops.has_stop(connection):
        if not stops.carries_commands(connection) or not stops.keeps_last_command(connection):
            return ""
        return ": ".join(filter(None, ("the last command stands", stops.hold_reason(connection))))
    seconds = stops.silence_timeout(connection)
    values = ", ".join(
        _value(stop_assignment) for stop_assignment in stops.stop_assignments(connection)
    )
    when = f"after {number(seconds)} s of silence" if seconds else "when control of it is lost"
    return f"{when}: {values or 'the defaults'}"


def _value(assignment: bridge.Assignment) -> str:
    what = assignment.value if isinstance(assignment, bridge.ConstantAssignment) else "clock"
    return f"{', '.join(target_paths(assignment))} = {what}"


def _words(literal: str) -> str:
    return literal.replace("_", " ")
