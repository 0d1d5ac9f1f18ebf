"""Where the messages of a connection stand in a recording, and what translates them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.language.semantics.jaus.commands import named
from jausml.language.semantics.jaus.services import lineage
from jausml.live.recording.recorder import ACTION_TOPICS, CALLS, GOALS, RESULTS
from jausml.live.recording.seeking import JAUS_TOPICS
from jausml.live.systems.inspection import placed, reporters_of, topic_of
from jausml.live.systems.recorded_calls import (
    ANSWERED,
    GOT,
    RECEIVED,
    REQUEST_AT,
    RESPONSE_AT,
    SENT,
    CallEnd,
    has_contents,
)
from jausml.live.systems.state import TopicName, node_of
from jausml.runtime.bridge.ends.ros_side import Outcome
from jausml.runtime.messages import SetElement

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.metamodel.classes import jaus
    from jausml.language.model import Model
    from jausml.live.systems.playback import RecordedSystem
    from jausml.live.systems.state import ConnectionState
    from jausml.live.workers.worker import Element


_SUCCEEDED = 4
"""Status of a goal that succeeded (action_msgs/msg/GoalStatus)."""

_REFUSING = frozenset(
    {"absent_field", "empty_goal", "filtered", "inactive", "no_counterpart", "no_peer", "no_speed"}
    | {"not_encodable", "not_ready", "out_of_range", "too_long", "translation_failed"}
)
"""How a bridge that serves an action counts goals that it does not accept."""


@dataclass(frozen=True)
class Ways:
    """Where the messages of a connection stand.

    Attributes:
        carried: What messages of the source go through; None where no model says so, or where they
            are in no recording.
        like: The connection of the model, whose policies and quantities count.
        missing: Why both sides cannot be compared; empty if they can.
        holder: What the source gives, where it holds the messages that are translated.
        event: On the side of ROS, which events of calls are meant; None where it has messages.
        answers: Topics of what answers the target, where it asks.
        calls: The ends of calls that the recording has.
    """

    source: tuple[str, ...]
    target: tuple[str, ...]
    is_to_ros: bool
    carried: bridge.Connection | None = None
    like: Element | None = None
    missing: str = ""
    holder: jaus.MessageDef | None = None
    event: int | None = None
    answers: tuple[str, ...] = ()
    calls: tuple[CallEnd, ...] = ()

    @property
    def offset(self) -> int:
        """Where messages of ROS stand in the bytes of events; 0 for messages by themselves."""
        if self.event is None:
            return 0
        return REQUEST_AT if self.event in (SENT, RECEIVED) else RESPONSE_AT

    @property
    def events_of_source(self) -> int | None:
        """Which events are meant on the side that is taken from."""
        return None if self.is_to_ros else self.event

    @property
    def events_of_target(self) -> int | None:
        """Which events are meant on the other side."""
        return self.event if self.is_to_ros else None


def ways_of(system: RecordedSystem, model: Model, connection: ConnectionState) -> tuple[Ways, ...]:
    """Returns the topics of both sides of a connection, none where the model has none such.

    Calls go two ways: that of requests comes first.
    """
    declaration = connection.declaration
    found = _modelled(model, declaration.key) if declaration is not None else None
    if declaration is None or found is None:
        return ()
    if isinstance(found, bridge.RosServiceConnection):
        return _ways_of_calls(system, connection, found)
    if isinstance(found, bridge.RosActionConnection):
        return (_ways_of_lists(system, connection, found),)
    ros = (topic_of(connection, declaration).name,) if declaration.topics else ()
    jaus = _jaus_topics(system, reporters_of(connection, declaration), declaration.message)
    is_to_ros = declaration.direction == "to ROS"
    source, target = (jaus, ros) if is_to_ros else (ros, jaus)
    return (Ways(source, target, is_to_ros, found, found),)


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
) -> tuple[Ways, ...]:
    serves, peers = calls.serves(call), [str(each.address) for each in call.peers]
    askers, answerers = ((connection.jaus_id,), peers) if serves else (peers, (connection.jaus_id,))
    answers = [calls.answering(call), *call.rejections]
    name = dict(connection.values).get("service") or str(call.service)
    ros = _ros_names(connection, call, name, (CALLS,))
    requests_of = f"the requests and responses of the ROS service {name} as they came"
    missing = f"the recording does not have {requests_of}"
    asked, answered = (
        tuple(topic for each in messages for topic in _topics_from(system, senders, each))
        for senders, messages in ((askers, [calls.asking(call)]), (answerers, answers))
    )
    halves = {each.kind: calls.as_connection(call, each) for each in calls.halves(call)}
    is_recorded = has_contents(system, ros[0])
    success = "" if calls.maps_success(call) else call.successMember or ""
    end = CallEnd(ros[0], serves, call.timeout, success, call.reasonMember or "")
    requests = Ways(
        *((ros, asked) if serves else (asked, ros)),
        is_to_ros=not serves,
        carried=halves.get(calls.REQUEST),
        like=call,
        missing="" if is_recorded else missing,
        event=RECEIVED if serves else SENT,
        answers=answered,
        calls=(end,) if is_recorded else (),
    )
    usual = _topics_from(system, answerers, answers[0])
    source, target = (usual, ros) if serves else (ros, usual)
    event, carried = (ANSWERED if serves else GOT), halves.get(calls.RESPONSE)
    responses = replace(
        requests, source=source, target=target, is_to_ros=serves, event=event, carried=carried
    )
    return requests, responses


def _ways_of_lists(
    system: RecordedSystem, connection: ConnectionState, action: bridge.RosActionConnection
) -> Ways:
    missing = f"the recording does not have the goals of the ROS action {action.action}"
    ros = _ros_names(connection, action, str(action.action), ACTION_TOPICS)
    messages = calls.driver_messages(action.driver)
    is_mission = messages is not None and messages.spooler
    name = calls.SPOOLER[0] if is_mission else SetElement.NAME
    inputs = (each for service in lineage(action.driver) for each in service.inputs)
    holder = named(name, inputs)
    if messages is not None and messages.is_single:
        name, holder = str(messages.execute.name), None
    serves = action.direction.name != "jausToRos"
    ends = tuple(
        CallEnd(each, serves, action.timeout, *told)
        for each in ros
        for ending, told in _tellers(action, serves=serves).items()
        if each.endswith(ending) and has_contents(system, each)
    )
    if ends:
        missing = "a list is not compared with its goal"
    if serves:
        given = _jaus_topics(system, (connection.jaus_id,), name)
        return Ways(ros, given, is_to_ros=False, like=action, missing=missing, calls=ends)
    peers = [str(each.address) for each in action.peers]
    taken = _jaus_topics(system, peers, name)
    carried = calls.of_elements(action)
    return Ways(
        taken,
        ros,
        is_to_ros=True,
        carried=carried,
        like=action,
        missing=missing,
        holder=holder,
        calls=ends,
    )


def _tellers(
    action: bridge.RosActionConnection, *, serves: bool
) -> dict[str, tuple[str, str, object, frozenset[str]]]:
    """Returns where it is told of goals that came to nothing: before they begin, and at the end.

    Each with the paths of success and reason, what says success, and how bridges count the others.
    """
    ended = frozenset({Outcome.ABORTED.value, Outcome.CANCELED.value})
    refused = _REFUSING if serves else frozenset({Outcome.REFUSED.value})
    reason = f"result.{action.reasonMember}" if action.reasonMember else ""
    return {
        GOALS: ("accepted", "", True, refused),
        RESULTS: ("status", reason, _SUCCEEDED, ended),
    }


def _topics_from(
    system: RecordedSystem, senders: Iterable[str], message: jaus.MessageDef | None
) -> tuple[str, ...]:
    return () if message is None else _jaus_topics(system, senders, str(message.name))


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
