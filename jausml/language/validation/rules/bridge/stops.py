"""Rules about stops and about what commands set in motion."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.hold_reasons import is_reason
from jausml.language.semantics.connections.topics import Flow, flow_of, resolve_topic, topic_fault
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import is_emergency
from jausml.language.semantics.paths.scopes import is_sound
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule
from jausml.language.validation.rules.bridge.sources import is_same_source


@rule(
    "JML426",
    "safe value that is never sent",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def safe_value_used(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A safe value that is not for a command takes effect only with a silence timeout.

    The safe value of a command is always sent: when control is lost, in an emergency, and at the
    end.

    Bad: a report with `safeValue` and without `silenceTimeout`

    Good: `safeValue` with `silenceTimeout="0.5"`
    """
    is_watched = stops.carries_commands(connection) or stops.silence_timeout(connection) > 0
    if connection.safeValue and not is_watched:
        message = f"'{connection.name}' has a safe value, but no silenceTimeout"
        yield Finding(connection, message, "safeValue")


@rule(
    "JML451",
    "command that nothing stops",
    is_decision=True,
    kinds=bridge.Connection,
    condition=is_sound,
)
def commands_stop(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection with commands says what happens when their source is lost.

    Otherwise the last command would stay in effect indefinitely: a vehicle drives on although its
    operator has released it, or has died. Either the connection has a `safeValue`, or its map a
    stop for the direction, or the last command stays in effect for a stated reason: `onSilence`
    hold and `holdReason`. A message whose definition says `moves` false needs no stop.

    Bad: the map of SetLocalWaypoint, which has no stop, without a word in the connection

    Good: `onSilence="hold" holdReason="SetTravelSpeed stops the vehicle on its way"`
    """
    if not stops.carries_commands(connection):
        return
    if stops.has_stop(connection) or stops.keeps_last_command(connection):
        return
    map_, to_ros = connection.map, is_to_ros(connection)
    note = Note(map_, f"map '{map_.name}'")
    message = f"nothing stops what {map_.message.name} of '{connection.name}' sets in motion"
    hint = f"give it a safeValue, or the map a {'stopRos' if to_ros else 'stopJaus'}, "
    hint += "or say onSilence hold with a holdReason"
    if not subject.model.is_library(map_.message):
        hint += f", or moves false of {map_.message.name} if it sets nothing in motion"
    yield Finding(connection, message, "map", hint, (note,))


@rule(
    "JML452",
    "hold that is not explained",
    is_decision=True,
    kinds=bridge.Connection,
    condition=is_sound,
)
def holds_explained(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A command that outlasts its source does so for a stated reason, and sends no stop.

    The reason is something that a person knows about the receiver. The words that former versions
    of jausml proposed are none, nor are words much like them.

    Bad: `onSilence="hold"` without `holdReason`, or with a `safeValue`

    Good: `onSilence="hold" holdReason="the planner of the vehicle drives to the goal by itself"`
    """
    if connection.onSilence.name != "hold" or is_emergency(connection.map.message):
        return
    if not stops.carries_commands(connection):
        message = f"'{connection.name}' carries no command, so nothing is held"
        yield Finding(connection, message, "onSilence")
    elif connection.safeValue:
        message = f"'{connection.name}' holds, so its safe value is never sent"
        yield Finding(connection, message, "onSilence", "take one of them")
    elif not (reason := stops.hold_reason(connection).strip()):
        message = f"'{connection.name}' holds, but says no reason"
        yield Finding(connection, message, "onSilence", "say in holdReason why that is safe")
    elif not is_reason(reason):
        message = f"'{connection.name}' holds, but '{reason}' is no reason that a person gave"
        hint = "say in holdReason what you know about the receiver"
        yield Finding(connection, message, "holdReason", hint)


@rule(
    "JML516",
    "stop that drives",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def stops_stand(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A stop sends zeros in what moves a vehicle: speeds, turning rates, accelerations, efforts.

    A number that a stop states is sent when the source of a command is lost, and a default that a
    ROS type gives a member is sent where a stop says nothing of it. Where a vehicle stops by
    something else than 0, such as a propeller that has to turn back, whoever knows it says so in an
    `@allow` with the reason. Brakes may be on.

    Bad: `stopRos: { values: { target: linear.x  value: 3 } }`

    Good: `stopRos: {}`, or `@allow JML516 until 2030-01-31: it hovers by this thrust`
    """
    if not stops.carries_commands(connection) or not stops.has_stop(connection):
        return
    if values := stops.moving_values(connection):
        text = ", ".join(f"{path} {value}" for path, value in values)
        stop = stops.stop_of_map(connection)
        place = connection if connection.safeValue or stop is None else stop
        feature = "safeValue" if connection.safeValue else None
        message = f"the stop of '{connection.name}' sends {text}"
        hint = "a stop of 0, or an @allow with the reason why this stops the vehicle"
        note = Note(connection, f"'{connection.name}'")
        yield Finding(place, message, feature, hint, (note,))


@rule(
    "JML453",
    "stop that silence does not send",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def silence_stops(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A command with a stop sends it when its source falls silent.

    With a `silenceTimeout` of 0 the last command stands while control lasts: a ROS node that has
    died, or a program that hangs and keeps control, is not noticed. A `holdReason` says why that is
    right; without `silenceTimeout` the stop of the map decides, or 1 second.

    Bad: `silenceTimeout="0"` for SetVelocityCommand

    Good: `silenceTimeout="0.5"`
    """
    if connection.silenceTimeout != 0 or connection.holdReason:
        return
    if stops.carries_commands(connection) and stops.has_stop(connection):
        message = f"the silence of its source does not stop '{connection.name}'"
        hint = "leave silenceTimeout out, or say the reason in holdReason"
        yield Finding(connection, message, "silenceTimeout", hint)


@rule(
    "JML454",
    "silence time-out within the period",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
    condition=is_sound,
)
def timeouts_outlast_periods(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A silence timeout is longer than the period of the rate that the connection declares.

    Otherwise a source that keeps its rate counts as silent between any two messages.

    Bad: `rate="1" silenceTimeout="0.5"`

    Good: `rate="10" silenceTimeout="0.5"`
    """
    rate, seconds = _declared_rate(connection), stops.silence_timeout(connection)
    if not (math.isfinite(rate) and rate > 0 and 0 < seconds <= 1 / rate):
        return
    message = f"'{connection.name}' counts as silent after {seconds:g} s"
    message += f", but its messages come every {1 / rate:g} s"
    yield Finding(connection, message, "silenceTimeout")


@rule("JML497", "topic that several commands stop", severity=Severity.WARNING)
def one_command_of_a_topic(subject: Subject) -> Iterator[Finding]:
    """One connection with a stop commands a topic.

    Of two, the one whose source falls silent or loses control sends its stop into what the other
    one commands: the robot halts, or jerks. Topics are compared by their full names, in all bridges
    of a system.

    Bad: connections of SetVelocityCommand and of SetTravelSpeed with `<topics name="cmd_vel"/>`

    Good: `teleop_vel` and `planner_vel`, and a multiplexer that knows who drives (twist_mux)
    """
    for group in subject.systems(("name", "namespace")):
        commanding: dict[str, bridge.Connection] = {}
        for owner in group:
            if not isinstance(owner, bridge.Bridge):
                continue
            for connection, topics in subject.once(_stopped_topics, owner):
                for topic in topics:
                    first = commanding.setdefault(topic, connection)
                    if first is not connection:
                        message = (
                            f"'{connection.name}' and '{first.name}' command {topic}, and the stop"
                        )
                        message += " of the one ends what the other commands"
                        hint = "give each a topic, and let a multiplexer decide who drives"
                        note = Note(first, f"'{first.name}'", "topics")
                        yield Finding(connection, message, "topics", hint, (note,))


def _stopped_topics(
    subject: Subject, owner: bridge.Bridge
) -> list[tuple[bridge.Connection, list[str]]]:
    return [
        (bridge_connection, sorted(flow_of(bridge_connection, owner).topics))
        for bridge_connection in owner.bridgeConnections
        if _stops_a_topic(subject, bridge_connection)
    ]


def _stops_a_topic(subject: Subject, connection: bridge.Connection) -> bool:
    needs = ("name", "map", "direction", "topics", "safeValue", "onSilence")
    if not subject.is_read(connection, needs) or connection.map is None:
        return False
    is_sound = subject.is_intact(connection.map.message, connection.map.type)
    to_ros = is_to_ros(connection)
    return is_sound and to_ros and stops.carries_commands(connection) and stops.has_stop(connection)


def _declared_rate(connection: bridge.Connection) -> float:
    if connection.rate:
        return float(connection.rate)
    owner = connection.eContainer()
    asks = connection.exchange.name == "query" and is_to_ros(connection)
    is_timed = connection.exchange.name == "periodicEvent" or asks
    return float(owner.frequency) if is_timed and owner is not None else 0.0


_TIMED = ("periodicEvent", "query")
_FLOW = ("name", "map", "direction", "exchange", "peers", "search", "topics")


@rule("JML463", "feature without effect", severity=Severity.WARNING, kinds=bridge.Bridge)
def features_used(_: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """What is stated has an effect: rate, priority and acknowledgement, and a bridge's guardian.

    The rate is that at which a bridge asks: of a periodic event or of queries, from JAUS to ROS. A
    report that the bridge serves comes as often as subscribers ask, and a single message whenever
    its source sends it. Priority and acknowledgement are for messages that the bridge sends on its
    own. A bridge that commands nothing with a stop, and sends no goals, has no guardian anyway.

    Bad: `exchange="message" rate="5.0"`

    Good: `exchange="periodicEvent" rate="5.0"`
    """
    if not owner.guardian and not stops.has_stops(owner):
        message = f"guardian has no effect: '{owner.name}' commands nothing that has a stop"
        yield Finding(owner, message, "guardian")


@features_used.also(bridge.Connection)
def _features_used_connection(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    to_ros = is_to_ros(connection)
    exchange = connection.exchange.name
    if connection.rate and exchange not in _TIMED:
        message = f"rate of '{connection.name}' has no effect with exchange {exchange}"
        yield Finding(connection, message, "rate")
    elif connection.rate and not to_ros:
        message = f"rate has no effect: '{connection.name}' serves a report"
        hint = "leave it out: each subscriber asks for its own rate"
        yield Finding(connection, message, "rate", hint)
    if to_ros or exchange != "message":
        what = "publishes" if to_ros else "serves a report"
        if connection.priority.name != "standard":
            message = f"priority has no effect: '{connection.name}' {what}"
            yield Finding(connection, message, "priority")
        if connection.acknowledge:
            message = f"acknowledge has no effect: '{connection.name}' {what}"
            yield Finding(connection, message, "acknowledge")


@rule("JML464", "message published twice", severity=Severity.WARNING, kinds=bridge.Bridge)
def published_once(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """A message of a peer reaches a topic once.

    Topics are compared by their full names: `velocity` and `/velocity` are one in a bridge without
    a namespace. Connections are compared by message, peers and topics.

    Bad: two connections of ReportVelocityState of one peer with `<topics name="odom"/>`

    Good: one of them
    """
    flows: dict[str, list[Flow]] = defaultdict(list)
    for connection in owner.bridgeConnections:
        if not subject.is_read(connection, _FLOW) or connection.map is None:
            continue
        if not subject.is_intact(connection.map.message, connection.map.type):
            continue
        yield from _topics_twice(connection, owner)
        flow = flow_of(connection, owner)
        others = (other_flow for topic in sorted(flow.topics) for other_flow in flows[topic])
        same = next((other for other in others if _repeats(flow, other)), None)
        if same is not None:
            topic = min(flow.topics & same.topics)
            first = same.connection
            message = f"'{connection.name}' publishes to {topic} what '{first.name}' does"
            note = Note(first, f"'{first.name}'")
            yield Finding(connection, message, "topics", related=(note,))
        for topic in flow.topics:
            flows[topic].append(flow)


def _repeats(flow: Flow, other: Flow) -> bool:
    return flow.to_ros and other.to_ros and is_same_source(flow, other)


def _topics_twice(connection: bridge.Connection, owner: bridge.Bridge) -> Iterator[Finding]:
    seen: dict[tuple[str, str], bridge.Topic] = {}
    for topic in connection.topics:
        if not topic.name or topic_fault(topic.name):
            continue
        full = resolve_topic(topic.name, owner.namespace or "", owner.name or "")
        first = seen.setdefault((full, topic.join.name if topic.join is not None else ""), topic)
        if first is not topic:
            message = f"topic {full} is named twice in '{connection.name}'"
            yield Finding(topic, message, "name", related=(Note(first, f"'{first.name}'", "name"),))


@rule(
    "JML465", "deadline shorter than the period", severity=Severity.WARNING, kinds=bridge.Connection
)
def deadlines_met(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """The deadline of a topic is not shorter than the time between the messages of its connection.

    A decimation or a maxRate makes that time longer. With a shorter deadline, each message is late
    (ROS 2, requested deadline missed).

    Bad: `rate="10"` with `<qos deadline="0.01"/>`

    Good: the same with `deadline="0.2"`
    """
    owner = connection.eContainer()
    is_timed = connection.exchange.name in _TIMED and is_to_ros(connection)
    rate = connection.rate or (owner.frequency if isinstance(owner, bridge.Bridge) else 0.0)
    if not is_timed or rate <= 0:
        return
    # Reports of several peers may come at once.
    period = max(1.0, connection.decimation / max(len(connection.peers), 1)) / rate
    period = max(period, 1 / connection.maxRate if connection.maxRate > 0 else 0.0)
    for qos in (topic.qos for topic in connection.topics if topic.qos is not None):
        if 0 < qos.deadline < period:
            message = f"deadline {qos.deadline:g} s, but '{connection.name}' publishes each"
            yield Finding(qos, f"{message} {period:g} s", "deadline")
