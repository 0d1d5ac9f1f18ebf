"""Where the messages of a connection stand in a recording, and what translates them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.live.recording.recorder import ACTION_TOPICS, CALLS
from jausml.live.recording.seeking import JAUS_TOPICS
from jausml.live.systems.inspection import placed, reporters_of, topic_of
from jausml.live.systems.state import TopicName, node_of
from jausml.runtime.messages import SetElement

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.metamodel.classes import jaus
    from jausml.language.model import Model
    from jausml.live.systems.playback import RecordedSystem
    from jausml.live.systems.state import ConnectionState
    from jausml.live.workers.worker import Element


@dataclass(frozen=True)
class Ways:
    """Where the messages of a connection stand.

    Attributes:
        carried: What messages of the source go through; None where no model says so, or where they
            are in no recording.
        like: The connection of the model, whose policies and quantities count.
        missing: What recordings do not have, so that both sides cannot be compared; empty if they
            can.
        has_elements: Whether the source gives lists, of which each element is a message.
    """

    source: tuple[str, ...]
    target: tuple[str, ...]
    is_to_ros: bool
    carried: bridge.Connection | None = None
    like: Element | None = None
    missing: str = ""
    has_elements: bool = False


def ways_of(system: RecordedSystem, model: Model, connection: ConnectionState) -> Ways | None:
    """Returns the topics of both sides of a connection, None where the model has none such."""
    declaration = connection.declaration
    found = _modelled(model, declaration.key) if declaration is not None else None
    if declaration is None or found is None:
        return None
    if isinstance(found, bridge.RosServiceConnection):
        return _ways_of_calls(system, connection, found)
    if isinstance(found, bridge.RosActionConnection):
        return _ways_of_lists(system, connection, found)
    ros = (topic_of(connection, declaration).name,) if declaration.topics else ()
    jaus = _jaus_topics(system, reporters_of(connection, declaration), declaration.message)
    is_to_ros = declaration.direction == "to ROS"
    source, target = (jaus, ros) if is_to_ros else (ros, jaus)
    return Ways(source, target, is_to_ros, found, found)


def _modelled(model: Model, key: tuple[str, str]) -> Element | None:
    for owner in model.instances(bridge.Bridge, library=False):
        if node_of(owner) == key[0]:
            elements: tuple[Element, ...] = (
                *owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections,
            )  # fmt: skip
            return next((each for each in elements if each.name == key[1]), None)
    return None


def _jaus_topics(system: RecordedSystem, senders: Iterable[str], message: str) -> tuple[str, ...]:
    """Returns the topics of a message from some components; without any from whoever sends it."""
    named = tuple(f"{JAUS_TOPICS}{each}/{message}" for each in senders)
    return named or tuple(each for each in system.recording.topics if each.endswith(f"/{message}"))


def _ways_of_calls(
    system: RecordedSystem, connection: ConnectionState, call: bridge.RosServiceConnection
) -> Ways:
    """Returns those of the half that comes from JAUS: requests of ROS are not recorded as such."""
    half = next((each for each in calls.halves(call) if each.to_ros), None)
    taken = calls.answering(call) if calls.serves(call) else calls.asking(call)
    return Ways(
        _taken_from(system, call.peers, taken),
        _ros_names(connection, call, str(call.service), (CALLS,)),
        is_to_ros=True,
        carried=None if half is None else calls.as_connection(call, half),
        like=call,
        missing=f"the requests and responses of the ROS service {call.service} as they came",
    )


def _ways_of_lists(
    system: RecordedSystem, connection: ConnectionState, action: bridge.RosActionConnection
) -> Ways:
    missing = f"the goals of the ROS action {action.action}"
    ros = _ros_names(connection, action, str(action.action), ACTION_TOPICS)
    if action.direction.name != "jausToRos":
        given = _jaus_topics(system, (connection.jaus_id,), SetElement.NAME)
        return Ways(ros, given, is_to_ros=False, like=action, missing=missing)
    peers = [str(each.address) for each in action.peers]
    taken = _jaus_topics(system, peers, SetElement.NAME)
    carried = calls.of_elements(action)
    return Ways(
        taken,
        ros,
        is_to_ros=True,
        carried=carried,
        like=action,
        missing=missing,
        has_elements=True,
    )


def _taken_from(
    system: RecordedSystem, peers: Iterable[jaus.Component], message: jaus.MessageDef | None
) -> tuple[str, ...]:
    if message is None:
        return ()
    return _jaus_topics(system, [str(each.address) for each in peers], str(message.name))


def _ros_names(
    connection: ConnectionState,
    element: bridge.RosServiceConnection | bridge.RosActionConnection,
    name: str,
    endings: Iterable[str],
) -> tuple[str, ...]:
    """Returns the topics on which others see what a service or action does."""
    owner = element.eContainer()
    if owner is None:
        return ()
    full = resolve_topic(name, owner.namespace or "", owner.name or "")
    topic = placed(connection, node_of(owner), TopicName(full, "", is_absolute=full == name))
    return tuple(topic.name + each for each in endings)


def topics_of_joins(
    system: RecordedSystem, connection: ConnectionState, modelled: bridge.Connection
) -> Iterator[tuple[str, str]]:
    """Yields the topics of joins, with the names of these."""
    owner = modelled.eContainer()  # of what was made for half a call there is none
    for end in endpoints([owner]) if owner is not None else ():
        join = getattr(end.element, "join", None)
        if join is not None and owner is not None and end.element.eContainer() is modelled:
            is_absolute = end.topic == getattr(end.element, end.feature)
            topic = TopicName(end.topic, "", is_absolute)
            yield placed(connection, node_of(owner), topic).name, str(join.name)
    for report in joined_reports(modelled):
        named = [str(each.address) for each in report.source.peers] if report.source else []
        for name in system.recording.topics:
            sender, _, message = name.removeprefix(JAUS_TOPICS).partition("/")
            if message == report.join.message.name and (not named or sender in named):
                yield name, str(report.join.name)
