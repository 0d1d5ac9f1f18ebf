"""Connections of ROS actions as commands: lists of JAUS that become goals, and the other way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from jausml.authoring.editing.commands import NEW, Add, Command, Set
from jausml.authoring.proposals.calls import member_named, members_of, own_copy, peers_of
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.named_elements import are_examples
from jausml.authoring.proposals.new_elements import OpenPoint, open_decisions, pending
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.connections.calls import (
    ELEMENTS,
    PATH_SEGMENTS,
    WAYPOINTS,
    driver_messages,
    knows_speed,
    takes,
)
from jausml.language.semantics.directions import TO_JAUS
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.ros_paths import ros_name

_REASON = ("error_msg", "error_message", "message", "reason", "status_message")
_DEEPEST = 2  # how many messages a list of a goal may lie in, as that of a nav_msgs/Path does

_LEFT, _DONE = frozenset({"remaining", "left"}), frozenset({"current", "index", "active"})


@dataclass(frozen=True)
class ListWay:
    """A way in which a list of JAUS and the goal of an action can be one another.

    `member`: the member of the goal that has the elements.
    """

    driver: jaus.Service
    map: bridge.AttributeMap
    member: str

    @property
    def is_usual(self) -> bool:
        """Whether it need not be named: waypoints of vehicles, whose lists have a speed."""
        messages = driver_messages(self.driver)
        is_segment = code(self.map.message) in PATH_SEGMENTS
        if messages is None or is_segment:
            return False
        return messages.is_single or knows_speed(messages)

    def says(self) -> str:
        """Returns the way in words, for people who choose."""
        message = name_of(self.map.message)
        return f"{name_of(self.map)}: {message} of {name_of(self.driver)} is {self.member}"


def lists_in(kind: ros.ActionType) -> Iterator[tuple[str, ros.MessageType]]:
    """Yields the members of a goal that are sequences of messages, with the types of these."""
    return _lists(kind.goal, "", _DEEPEST)


def _lists(
    owner: ros.MessageType, before: str, depth: int
) -> Iterator[tuple[str, ros.MessageType]]:
    for field in owner.fields:
        if not isinstance(field, ros.MessageField):
            continue
        path = f"{before}{field.name}"
        if field.arrayKind.name.endswith("Sequence"):
            yield path, field.messageType
        elif field.arrayKind.name == "single" and depth:
            yield from _lists(field.messageType, f"{path}.", depth - 1)


def singles_in(kind: ros.ActionType) -> Iterator[tuple[str, ros.MessageType]]:
    """Yields the members of a goal that are one message, with the types of these."""
    for field in kind.goal.fields:
        if isinstance(field, ros.MessageField) and field.arrayKind.name == "single":
            yield str(field.name), field.messageType


def list_ways(
    maps: Iterable[bridge.AttributeMap],
    drivers: Iterable[jaus.Service],
    kind: ros.ActionType,
    *,
    to_ros: bool,
) -> list[ListWay]:
    """Returns the ways for an action, by maps of one element of a list that its goal has.

    A goal without lists may have a single message, as that of NavigateToPose: it goes to a
    waypoint.
    """
    ends = list(lists_in(kind))
    singles = [] if ends or not to_ros else list(singles_in(kind))
    known = [
        service
        for service in drivers
        if (messages := driver_messages(service)) is not None
        and messages.is_single is bool(singles)
    ]
    candidates_by_key: dict[tuple[str, str, str], ListWay] = {}
    for member, element in ends or singles:
        for map_ in maps:
            if map_.message is None or map_.type is None or are_examples(map_):
                continue
            if ros_name(map_.type) != ros_name(element):
                continue
            if not (map_.toRos if to_ros else map_.toJaus):
                continue
            for driver in known:
                if _has_elements(driver, map_.message):
                    key = (member, name_of(map_), str(driver.urn))
                    candidates_by_key.setdefault(key, ListWay(driver, map_, member))
    return list(candidates_by_key.values())


def _has_elements(driver: jaus.Service, message: jaus.MessageDef) -> bool:
    """Tells whether a message is an element of a driver: of the standard, or of its own service."""
    is_of_standard = str(driver.urn) in ELEMENTS | WAYPOINTS
    is_own = str(message.eContainer().urn) == str(driver.urn)  # type: ignore[union-attr]
    return takes(driver, message) and (is_of_standard or is_own)


def ways_for(scope: Scope, kind: ros.ActionType, *, to_ros: bool) -> list[ListWay]:
    """Returns the ways for an action with all maps and services, the usual ones first."""
    candidates = list_ways(
        scope.instances(bridge.AttributeMap), scope.instances(jaus.Service), kind, to_ros=to_ros
    )
    return sorted(candidates, key=lambda way: not way.is_usual)


def progress_of(kind: ros.ActionType) -> tuple[str, str]:
    """Returns the member of the feedback with the progress, and its meaning; empty for none.

    A number whose name tells neither is none: a wrong one would name wrong elements.
    """
    for name in members_of(kind.feedback, ("int", "uint")):
        said = {word.lower() for word in words(name)}
        if said & _LEFT:
            return name, "remaining"
        if said & _DONE:
            return name, "index"
    return "", ""


def action_commands(
    scope: Scope,
    owner: bridge.Bridge,
    action: str,
    kind: ros.ActionType,
    way: ListWay,
    *,
    to_ros: bool,
    name: str,
    speed: float | None = None,
) -> list[Command]:
    """Returns the commands that make the connection of an action, with its driver and its map."""
    place = scope.ref(owner)
    commands: list[Command] = []
    feature = "provides" if to_ros else "uses"
    known = list(getattr(owner, feature))
    if str(way.driver.urn) not in {str(service.urn) for service in with_inherited(known)}:
        refs = tuple(map(scope.ref, (*known, way.driver)))
        commands.append(Set(place, feature, refs))
    copy = own_copy(scope, owner, way.map)
    commands += copy or ()
    values: dict[str, tuple[str, ...]] = {"name": (name,)}
    if not to_ros:
        values["direction"] = (TO_JAUS,)
    values |= {
        "action": (action,),
        "type": (scope.ref(kind),),
        "driver": (scope.ref(way.driver),),
        "element": (scope.ref(way.map) if copy is None else f"{NEW}0",),
        "goalMember": (way.member,),
    }
    progress, says = progress_of(kind)
    if progress:
        values["progressMember"] = (progress,)
        values |= {} if says == "index" else {"progress": (says,)}
    if reason := member_named(kind.result, _REASON, "string"):
        values["reasonMember"] = (reason,)
    inner = open_decisions(opens_of(kind, way, name, to_ros=to_ros, speed=speed))
    if not to_ros:
        peers, search = peers_of(scope, driver_messages(way.driver).execute, way.driver)  # type: ignore[union-attr]
        inner += search
        values |= peers | ({"speed": (f"{speed:g}",)} if speed else {})
    return [*commands, Add(place, "actionConnections", "bridge.RosActionConnection", values, inner)]


def why_none(kind: ros.ActionType, *, to_ros: bool) -> str:
    """Returns why no list driver can have the goals of an action, with what helps."""
    lists = [f"{member}, each {ros_name(element)}" for member, element in lists_in(kind)]
    if not lists:
        reason = f"the goal of {ros_name(kind)} has no list of messages, which list drivers have"
        return "; ".join((reason, *_as_topics(kind)))
    [element, *_] = (ros_name(message_type) for _, message_type in lists_in(kind))
    direction = "to-ros" if to_ros else "to-jaus"
    return (
        f"no map carries an element of its goal ({'; '.join(lists)}) for a list driver; "
        f"begin one: jausml new map NAME SetLocalWaypoint {element} --direction {direction}"
    )


def _as_topics(kind: ros.ActionType) -> Iterator[str]:
    """Yields the topics that take a goal of one message, as planners take it too."""
    known = {
        ros_name(attribute_map.type)
        for attribute_map in library().instances(bridge.AttributeMap)
        if attribute_map.type
    }
    for field in kind.goal.fields:
        if isinstance(field, ros.MessageField) and ros_name(field.messageType) in known:
            word = f"goal_{field.name}:{ros_name(field.messageType)}"
            yield (
                f"a single {field.name} goes to a topic, if its planner takes one: jausml new "
                f"connection {word} (no feedback, and what stops it you state)"
            )


def opens_of(
    kind: ros.ActionType, way: ListWay, name: str, *, to_ros: bool, speed: float | None
) -> list[OpenPoint]:
    """Returns the decisions about a connection of an action that are left to a person."""
    open_points = []
    messages = driver_messages(way.driver)
    if not to_ros and not speed and messages is not None and knows_speed(messages):
        text = "state the speed at which peers execute lists: speed, or --speed"
        open_points.append(OpenPoint(text, "JML486"))
    is_list = messages is not None and not messages.is_single
    if is_list and not progress_of(kind)[0]:
        numbers = members_of(kind.feedback, ("int", "uint"))
        text = "nothing tells which element is active: "
        if numbers:
            open_points.append(pending(f"{text}progressMember ({', '.join(numbers)})"))
        else:
            open_points.append(OpenPoint(f"{text}its feedback has no number"))
    others = [
        str(field.name) for field in kind.goal.fields if field.name != way.member.partition(".")[0]
    ]
    if to_ros and others:
        text = f"defaults are sent in {', '.join(others)} of the goal, unless goal_{name} of the "
        open_points.append(pending(f"{text}skeleton sets them"))
    return open_points
