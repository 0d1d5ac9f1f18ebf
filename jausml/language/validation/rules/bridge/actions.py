"""Rules about action connections: list drivers of JAUS, and actions of ROS."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.connections.calls import (
    DriverMessages,
    driver_messages,
    knows_speed,
    member,
    takes,
)
from jausml.language.semantics.connections.limits import GREATEST_SPEED
from jausml.language.semantics.connections.topics import topic_fault
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import Provider, is_known, peers_of, services_of
from jausml.language.semantics.paths.attributes import PathFault
from jausml.language.semantics.paths.ros_paths import RosPlace, ros_name
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import provider_name
from jausml.language.validation.rule import Finding, Note, rule

_ENDS = ("name", "direction", "type", "driver", "element", "peers", "search")


def _is_sound(subject: Subject, connection: bridge.RosActionConnection) -> bool:
    map_ = connection.element
    if map_ is None or not subject.is_intact(connection.driver, connection.type):
        return False
    return subject.is_intact(map_.message, map_.type)


_of_lists = partial(rule, kinds=bridge.RosActionConnection, needs=_ENDS, condition=_is_sound)


@_of_lists("JML481", "no list driver for the elements")
def drives_lists(_: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The driver of an action connection executes lists with the message of its map.

    It inherits ListManager, takes ExecuteList and QueryActiveElement, and sends
    ReportActiveElement. A mission spooler executes its mission in the same way. A waypoint driver
    of the bridge executes its waypoint as a list of one; peers are given lists or missions.

    Bad: `driver="LocalVectorDriver"`, which is given a direction; or LocalWaypointListDriver with
    the map of SetGlobalWaypoint

    Good: `driver="LocalWaypointListDriver"` with the map of SetLocalWaypoint
    """
    messages = driver_messages(connection.driver)
    if messages is None:
        message = f"'{connection.driver.name}' executes no lists"
        hint = "name a service that inherits ListManager and takes ExecuteList"
        yield Finding(connection, message, "driver", hint)
    elif messages.is_single and not is_to_ros(connection):
        message = (
            f"goals become lists or missions of a peer, not waypoints of {connection.driver.name}"
        )
        yield Finding(connection, message, "driver", "name a list driver or MissionSpooler")
    elif not takes(connection.driver, connection.element.message):
        note = Note(connection.element, f"map '{connection.element.name}'")
        message = (
            f"the list of {connection.driver.name} does not hold {connection.element.message.name}"
        )
        yield Finding(connection, message, "element", related=(note,))


@_of_lists("JML482", "goal without the elements", needs=(*_ENDS, "goalMember"))
def goal_holds_elements(_: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The goal of an action has at goalMember a sequence of the ROS type of the map.

    A waypoint driver has one waypoint, so a single message will do there.

    Bad: `goalMember="pose"`; or gps_poses of FollowGPSWaypoints with a map to PoseStamped

    Good: `goalMember="poses"` of FollowWaypoints with a map to PoseStamped
    """
    path = connection.goalMember
    place = member(connection.type.goal, path) if path else None
    wanted = ros_name(connection.element.type)
    if isinstance(place, PathFault):
        yield Finding(connection, place.message, "goalMember", place.hint)
    elif place is not None and not _holds(place, connection):
        message = f"'{path}' is no sequence of {wanted}, which the map makes"
        yield Finding(connection, message, "goalMember")


@_of_lists(
    "JML483", "progress or reason that is none", needs=(*_ENDS, "progressMember", "reasonMember")
)
def members_fit(_: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The feedback has at progressMember a number, the result at reasonMember a string.

    The number is an integer. With `progress="distance"` it is a floating-point number, the elements
    are poses in metres, and the direction is jausToRos: a JAUS driver tells no distance.

    Bad: `progressMember="distance_remaining"`, which is a distance

    Good: `progressMember="number_of_poses_remaining" progress="remaining"`
    """
    is_distance = connection.progress.name == "distance"
    if is_distance and not (is_to_ros(connection) and _has_position(connection.element.type)):
        message = "no distance is known of these elements, or in this direction"
        yield Finding(
            connection, message, "progress", "say index or remaining, or no progressMember"
        )
    number = ("number of metres", ("float",)) if is_distance else ("integer", ("int", "uint"))
    parts = (
        ("progressMember", connection.progressMember, connection.type.feedback, *number),
        ("reasonMember", connection.reasonMember, connection.type.result, "string", ("string",)),
    )
    for feature, path, owner, noun, kinds in parts:
        place = member(owner, path) if path else None
        if isinstance(place, PathFault):
            yield Finding(connection, place.message, feature, place.hint)
        elif place is not None and not _is_of(place, kinds):
            yield Finding(connection, f"'{path}' is no {noun}", feature)


@_of_lists("JML484", "map of elements without assignments for the direction", is_decision=True)
def elements_translated(
    subject: Subject, connection: bridge.RosActionConnection
) -> Iterator[Finding]:
    """The map of an action connection has assignments for the direction of the connection.

    Without them every element of the list is empty.

    Bad: `direction="rosToJaus"` with a map that has `toRos` alone

    Good: the same map with `toJaus`
    """
    feature = "toRos" if is_to_ros(connection) else "toJaus"
    if not getattr(connection.element, feature) and subject.is_intact(connection.element):
        note = Note(connection.element, f"map '{connection.element.name}'")
        message = f"map '{connection.element.name}' has no {feature} assignments, which"
        message += f" {connection.direction.name} needs"
        yield Finding(connection, message, "element", related=(note,))


@_of_lists("JML485", "nobody provides the list driver")
def driver_provided(subject: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The component that executes the list of an action connection provides its driver.

    - JAUS to ROS: the bridge does.
    - ROS to JAUS: each peer does, and there is one, or a search for one.

    Bad: `direction="rosToJaus"` without peers

    Good: `direction="rosToJaus" peers="vehicle"`, where vehicle provides the driver
    """
    owner = connection.eContainer()
    providers = peers_of(connection)
    if is_to_ros(connection):
        providers = [] if owner is None else [owner]
    elif not providers:
        message = f"'{connection.name}' has no peer that executes its lists"
        yield Finding(connection, message, "peers", "name peers, or search for them")
    for provider in providers:
        if is_known(subject, provider) and not _provides(provider, connection.driver):
            message = f"{provider_name(provider)} does not provide {connection.driver.name}"
            yield Finding(connection, message, "driver")


@rule(
    "JML486",
    "figure of an action connection out of range",
    is_decision=True,
    kinds=bridge.RosActionConnection,
    needs=(*_ENDS, "speed", "timeout"),
)
def action_figures(subject: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The speed of lists is above 0 and what ExecuteList can say, and the timeout is above 0.

    A list that is executed at speed 0 stands still. Drivers of manipulators know no speed.

    Bad: `direction="rosToJaus"` without a speed

    Good: `direction="rosToJaus" speed="1.5" timeout="1"`
    """
    if not (math.isfinite(connection.timeout) and connection.timeout > 0):
        yield Finding(connection, f"timeout {connection.timeout:g} s is not above 0", "timeout")
    messages = driver_messages(connection.driver) if subject.is_intact(connection.driver) else None
    if messages is None or is_to_ros(connection) or not knows_speed(messages):
        return
    if not 0 < connection.speed <= GREATEST_SPEED:
        message = f"speed {connection.speed:g} m/s is not above 0 and up to {GREATEST_SPEED} m/s"
        hint = "state the speed at which peers execute lists"
        yield Finding(connection, message, "speed", hint)


@rule(
    "JML499",
    "mission whose end nobody has decided",
    is_decision=True,
    kinds=bridge.RosActionConnection,
    needs=(*_ENDS, "onEnd"),
)
def missions_end(subject: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """A mission that a ROS client gives to a JAUS peer has an `onEnd`, and nothing else has.

    The goal may end before the mission: the client cancels it, another goal comes, control is lost,
    or the bridge ends. The vehicle stands in any case. A mission that was aborted is gone; one that
    was paused stays, and goes on when somebody resumes it. Which of them is safe, a person says. A
    list leaves nothing behind, and a bridge that executes missions itself keeps them paused.

    Bad: `direction="rosToJaus" driver="MissionSpooler"` without `onEnd`

    Good: the same with `onEnd="abort"`
    """
    messages = driver_messages(connection.driver) if subject.is_intact(connection.driver) else None
    if messages is None:
        return
    is_open = connection.onEnd.name == "open"
    if not messages.spooler or is_to_ros(connection):
        if not is_open:
            yield Finding(connection, f"'{connection.name}' gives no mission to a peer", "onEnd")
    elif is_open:
        message = (
            f"nobody has decided what a goal of '{connection.name}' leaves that ends too early"
        )
        yield Finding(connection, message, "onEnd", "say onEnd abort, or pause")


@rule("JML487", "bad name of a ROS action", kinds=bridge.RosActionConnection, needs=("action",))
def action_names(_: Subject, connection: bridge.RosActionConnection) -> Iterator[Finding]:
    """The name of an action is one of ROS: letters, digits, `_` and `/`, no digit first.

    Bad: `action="follow waypoints"`

    Good: `action="follow_waypoints"`
    """
    fault = topic_fault(connection.action) if connection.action is not None else ""
    if fault:
        yield Finding(connection, f"action name {connection.action!r} {fault}", "action")


@rule(
    "JML488",
    "two lists of one kind in one bridge",
    kinds=bridge.Bridge,
    needs=("actionConnections",),
)
def one_driver_for_a_kind(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """The lists of one kind of elements go to one action, and a bridge has lists or missions.

    A bridge has one list, one mission or one waypoint; the content of its elements determines which
    action executes it. So a robot never follows two. For the same reason, no other connection takes
    the waypoint of an action, or tells it.

    Bad: two connections with `direction="jausToRos"` and the map of SetLocalWaypoint

    Good: one of them
    """
    first: dict[jaus.MessageDef, bridge.RosActionConnection] = {}
    kinds: dict[object, bridge.RosActionConnection] = {}
    for action_connection in owner.actionConnections:
        if not _is_sound(subject, action_connection) or not is_to_ros(action_connection):
            continue
        other = first.setdefault(action_connection.element.message, action_connection)
        if other is not action_connection:
            note = Note(other, f"'{other.name}' executes them")
            message = f"lists of {action_connection.element.message.name} are executed already"
            yield Finding(action_connection, message, "element", related=(note,))
            continue
        messages = driver_messages(action_connection.driver)
        if messages is None:
            continue
        kind = messages.execute if messages.is_single else bool(messages.spooler)
        kinds.setdefault(kind, action_connection)
        different = next((kinds[key] for key in kinds if key != kind), None)
        if different is not None:
            note = Note(different, f"'{different.name}' has the others")
            message = "a bridge executes lists, missions or one kind of waypoints"
            yield Finding(action_connection, message, "driver", related=(note,))
        if messages.is_single:
            yield from _taken_twice(owner, action_connection, messages)


def _taken_twice(
    owner: bridge.Bridge, action: bridge.RosActionConnection, messages: DriverMessages
) -> Iterator[Finding]:
    """Yields the connections that take the waypoint of an action, or tell it, too."""
    for bridge_connection in owner.bridgeConnections:
        message = bridge_connection.map.message if bridge_connection.map is not None else None
        if message is None or message not in (messages.execute, messages.report):
            continue
        if is_to_ros(bridge_connection) is (message is messages.execute):
            note = Note(action, f"'{action.name}' executes the waypoint, and tells it")
            text = f"'{bridge_connection.name}' has {message.name}, which is of an action here"
            yield Finding(bridge_connection, text, "map", related=(note,))


def _holds(place: RosPlace, connection: bridge.RosActionConnection) -> bool:
    messages = driver_messages(connection.driver)
    is_single = messages is not None and messages.is_single
    fits = is_single and not place.is_array and place.type is connection.element.type
    return fits or _is_sequence_of(place, connection.element.type)


def _is_sequence_of(place: RosPlace, element: ros.MessageType) -> bool:
    field = place.field
    inner = place.element()
    is_sequence = field is not None and field.arrayKind.name.endswith("Sequence")
    return place.is_array and is_sequence and inner is not None and inner.type is element


def _has_position(element: ros.MessageType) -> bool:
    paths = ("pose.position.x", "position.x")
    return any(isinstance(member(element, path), RosPlace) for path in paths)


def _is_of(place: RosPlace, kinds: tuple[str, ...]) -> bool:
    kind = getattr(place.field, "type", None)
    return not place.is_array and kind is not None and str(kind.name).startswith(kinds)


def _provides(provider: Provider, driver: jaus.Service) -> bool:
    urns = {str(service.urn) for service in services_of(provider)}
    return any(str(service.urn) in urns for service in lineage(driver)[:1])
