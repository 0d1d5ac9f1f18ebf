"""Rules about what a connection states without effect, or with an effect that nobody wants."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.flows import flow_of
from jausml.language.semantics.connections.stops import has_stop, is_command
from jausml.language.semantics.connections.topics import resolve_topic, topic_fault
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.connections.flows import Flow
    from jausml.language.semantics.subject import Subject

_TIMED = ("periodicEvent", "query")
_FLOW = ("name", "map", "direction", "exchange", "peers", "search", "topics")


def _is_guarded(owner: bridge.Bridge) -> bool:
    """Tells whether a bridge commands what a guardian could stop."""
    connections = [each for each in owner.bridgeConnections if each.map and each.map.message]
    goals = [each for each in owner.actionConnections if each.direction.name == "jausToRos"]
    return bool(goals) or any(is_command(each) and has_stop(each) for each in connections)


@rule("JML463", Severity.WARNING, "feature without effect")
def features_used(subject: Subject) -> Iterator[Finding]:
    """What is stated has an effect: rate, priority and acknowledgement, and a bridge's guardian.

    The rate is that at which a bridge asks: of a periodic event or of queries, from JAUS to ROS. A
    report that the bridge serves comes as often as subscribers ask, and a single message whenever
    its source sends it. Priority and acknowledgement are for messages that the bridge sends on its
    own. A bridge that commands nothing with a stop, and sends no goals, has no guardian anyway.

    Bad: `exchange="message" rate="5.0"`

    Good: `exchange="periodicEvent" rate="5.0"`
    """
    for owner in subject.instances(bridge.Bridge):
        if not owner.guardian and not _is_guarded(owner):
            message = f"guardian has no effect: '{owner.name}' commands nothing that has a stop"
            yield Finding(owner, message, "guardian")
    for connection in subject.instances(bridge.Connection):
        to_ros = connection.direction.name == "jausToRos"
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


@rule("JML464", Severity.WARNING, "message published twice")
def published_once(subject: Subject) -> Iterator[Finding]:
    """A message of a peer reaches a topic once.

    Topics are compared by their full names: `velocity` and `/velocity` are one in a bridge without
    a namespace. Connections are compared by message, peers and topics.

    Bad: two connections of ReportVelocityState of one peer with `<topics name="odom"/>`

    Good: one of them
    """
    for owner in subject.instances(bridge.Bridge):
        flows: dict[str, list[Flow]] = defaultdict(list)
        for connection in owner.bridgeConnections:
            if not subject.is_read(connection, _FLOW) or connection.map is None:
                continue
            if not subject.is_intact(connection.map.message, connection.map.type):
                continue
            yield from _topics_twice(connection, owner)
            flow = flow_of(connection, owner)
            others = (each for topic in sorted(flow.topics) for each in flows[topic])
            same = next((each for each in others if _repeats(flow, each)), None)
            if same is not None:
                topic = min(flow.topics & same.topics)
                first = same.connection
                message = f"'{connection.name}' publishes to {topic} what '{first.name}' does"
                note = Note(first, f"'{first.name}'")
                yield Finding(connection, message, "topics", related=(note,))
            for topic in flow.topics:
                flows[topic].append(flow)


def _repeats(flow: Flow, other: Flow) -> bool:
    if not (flow.to_ros and other.to_ros):
        return False
    is_same = flow.code == other.code and flow.connection.map is other.connection.map
    return is_same and bool(flow.peers & other.peers or (flow.is_open and other.is_open))


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


@rule("JML465", Severity.WARNING, "deadline shorter than the period")
def deadlines_met(subject: Subject) -> Iterator[Finding]:
    """The deadline of a topic is not shorter than the time between the messages of its connection.

    With a shorter one each message is late (ROS 2, requested deadline missed).

    Bad: `rate="10"` with `<qos deadline="0.01"/>`

    Good: the same with `deadline="0.2"`
    """
    for connection in subject.instances(bridge.Connection):
        owner = connection.eContainer()
        is_timed = connection.exchange.name in _TIMED and connection.direction.name == "jausToRos"
        rate = connection.rate or (owner.frequency if isinstance(owner, bridge.Bridge) else 0.0)
        if not is_timed or rate <= 0:
            continue
        for qos in (each.qos for each in connection.topics if each.qos is not None):
            if 0 < qos.deadline < 1 / rate:
                message = f"deadline {qos.deadline:g} s, but '{connection.name}' publishes each"
                yield Finding(qos, f"{message} {1 / rate:g} s", "deadline")
