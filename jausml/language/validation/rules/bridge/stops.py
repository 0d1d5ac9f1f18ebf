"""Rules about what happens when the source of a connection is lost."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.flows import flow_of
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject


@rule("JML426", Severity.WARNING, "safe value that is never sent")
def safe_value_used(subject: Subject) -> Iterator[Finding]:
    """A safe value that is not for a command takes effect only with a silence timeout.

    The safe value of a command is always sent: when control is lost, in an emergency, and at the
    end.

    Bad: a report with `safeValue` and without `silenceTimeout`

    Good: `safeValue` with `silenceTimeout="0.5"`
    """
    for connection in _sound_connections(subject):
        is_watched = stops.is_command(connection) or stops.silence_timeout(connection) > 0
        if connection.safeValue and not is_watched:
            message = f"'{connection.name}' has a safe value, but no silenceTimeout"
            yield Finding(connection, message, "safeValue")


@rule("JML451", Severity.ERROR, "command that nothing stops")
def commands_stop(subject: Subject) -> Iterator[Finding]:
    """A connection with commands says what happens when their source is lost.

    Otherwise the last command would stay in effect indefinitely: a vehicle drives on although its
    operator has released it, or has died. Either the connection has a `safeValue`, or its map a
    stop for the direction, or the last command stays in effect for a stated reason: `onSilence`
    hold and `holdReason`. A message whose definition says `moves` false needs no stop.

    Bad: the map of SetLocalWaypoint, which has no stop, without a word in the connection

    Good: `onSilence="hold" holdReason="SetTravelSpeed stops the vehicle on its way"`
    """
    for connection in _sound_connections(subject):
        if not stops.is_command(connection):
            continue
        if stops.has_stop(connection) or stops.holds(connection):
            continue
        used, to_ros = connection.map, connection.direction.name == "jausToRos"
        note = Note(used, f"map '{used.name}'")
        message = f"nothing stops what {used.message.name} of '{connection.name}' sets in motion"
        hint = f"give it a safeValue, or the map a {'stopRos' if to_ros else 'stopJaus'}, "
        hint += "or say onSilence hold with a holdReason"
        if not subject.model.is_library(used.message):
            hint += f", or moves false of {used.message.name} if it sets nothing in motion"
        yield Finding(connection, message, "map", hint, (note,))


@rule("JML452", Severity.ERROR, "hold that is not explained")
def holds_explained(subject: Subject) -> Iterator[Finding]:
    """A command that outlasts its source does so for a stated reason, and sends no stop.

    The reason is something that a person knows about the receiver. The words that former versions
    of jausml proposed are none, nor are words much like them.

    Bad: `onSilence="hold"` without `holdReason`, or with a `safeValue`

    Good: `onSilence="hold" holdReason="the planner of the vehicle drives to the goal by itself"`
    """
    for connection in _sound_connections(subject):
        if connection.onSilence.name != "hold":
            continue
        if not stops.is_command(connection):
            message = f"'{connection.name}' carries no command, so nothing is held"
            yield Finding(connection, message, "onSilence")
        elif connection.safeValue:
            message = f"'{connection.name}' holds, so its safe value is never sent"
            yield Finding(connection, message, "onSilence", "take one of them")
        elif not (reason := stops.hold_reason(connection).strip()):
            message = f"'{connection.name}' holds, but says no reason"
            yield Finding(connection, message, "onSilence", "say in holdReason why that is safe")
        elif not stops.is_reason(reason):
            message = f"'{connection.name}' holds, but '{reason}' is no reason that a person gave"
            hint = "say in holdReason what you know about the receiver"
            yield Finding(connection, message, "holdReason", hint)


@rule("JML453", Severity.WARNING, "stop that silence does not send")
def silence_stops(subject: Subject) -> Iterator[Finding]:
    """A command with a stop sends it when its source falls silent.

    With a `silenceTimeout` of 0 the last command stands while control lasts: a ROS node that has
    died, or a program that hangs and keeps control, is not noticed. A `holdReason` says why that is
    right; without `silenceTimeout` the stop of the map decides, or 1 second.

    Bad: `silenceTimeout="0"` for SetVelocityCommand

    Good: `silenceTimeout="0.5"`
    """
    for connection in _sound_connections(subject):
        if connection.silenceTimeout != 0 or connection.holdReason:
            continue
        if stops.is_command(connection) and stops.has_stop(connection):
            message = f"the silence of its source does not stop '{connection.name}'"
            hint = "leave silenceTimeout out, or say the reason in holdReason"
            yield Finding(connection, message, "silenceTimeout", hint)


@rule("JML454", Severity.WARNING, "silence time-out within the period")
def timeouts_outlast_periods(subject: Subject) -> Iterator[Finding]:
    """A silence timeout is longer than the period of the rate that the connection declares.

    Otherwise a source that keeps its rate counts as silent between any two messages.

    Bad: `rate="1" silenceTimeout="0.5"`

    Good: `rate="10" silenceTimeout="0.5"`
    """
    for connection in _sound_connections(subject):
        rate, seconds = _declared_rate(connection), stops.silence_timeout(connection)
        if not (math.isfinite(rate) and rate > 0 and 0 < seconds <= 1 / rate):
            continue
        message = f"'{connection.name}' counts as silent after {seconds:g} s"
        message += f", but its messages come every {1 / rate:g} s"
        yield Finding(connection, message, "silenceTimeout")


@rule("JML497", Severity.WARNING, "topic that several commands stop")
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
            for each in owner.bridgeConnections:
                if not _stops_a_topic(subject, each):
                    continue
                for topic in sorted(flow_of(each, owner).topics):
                    first = commanding.setdefault(topic, each)
                    if first is not each:
                        message = f"'{each.name}' and '{first.name}' command {topic}, and the stop"
                        message += " of the one ends what the other commands"
                        hint = "give each a topic, and let a multiplexer decide who drives"
                        note = Note(first, f"'{first.name}'", "topics")
                        yield Finding(each, message, "topics", hint, (note,))


def _stops_a_topic(subject: Subject, connection: bridge.Connection) -> bool:
    needs = ("name", "map", "direction", "topics", "safeValue", "onSilence")
    if not subject.is_read(connection, needs) or connection.map is None:
        return False
    is_sound = subject.is_intact(connection.map.message, connection.map.type)
    to_ros = connection.direction.name == "jausToRos"
    return is_sound and to_ros and stops.is_command(connection) and stops.has_stop(connection)


def _declared_rate(connection: bridge.Connection) -> float:
    if connection.rate:
        return float(connection.rate)
    owner = connection.eContainer()
    asks = connection.exchange.name == "query" and connection.direction.name == "jausToRos"
    is_timed = connection.exchange.name == "periodicEvent" or asks
    return float(owner.frequency) if is_timed and owner is not None else 0.0


def _sound_connections(subject: Subject) -> list[bridge.Connection]:
    return [
        each
        for each in subject.instances(bridge.Connection)
        if each.map is not None and subject.is_intact(each.map.message, each.map.type)
    ]
