"""The meaning of ROS topics and parameters for a bridge: ready maps, the likeliest first."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from jausml.authoring.proposals.bridging import Offer, is_served, lacks_stop, offer_of
from jausml.authoring.proposals.named_elements import are_examples, are_named, frames_in, names_for
from jausml.authoring.proposals.topic_names import TopicName, is_bare
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.connections.calls import unanswered
from jausml.language.semantics.connections.exchanges import EVENT
from jausml.language.semantics.jaus.commands import is_command, is_emergency, told_by_command
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import used_maps

VEHICLE, OPERATOR = "vehicle", "operator"
SIDES = (VEHICLE, OPERATOR)
"""The ROS side of a bridge: a vehicle that JAUS commands, or an operator who commands one."""


@dataclass(frozen=True)
class TopicEnd:
    """A topic of ROS that a bridge shall carry.

    Attributes:
        type: Its type, such as `geometry_msgs/Twist`.
        to_ros: Whether nodes subscribe to it; False where they publish it, None where both or
            nobody knows.
        heard: Quality of service by which all of its publishers are heard, literals by feature;
            None for what is usual.
        published: Quality of service by which all that subscribe get it; None for what is usual.
        names: Names of the elements of its lists, such as joints, in the order that JAUS has.
        frames: Names of the robot's frames by those that ready maps have.
        own_frames: Frames that its messages name, by the path of the field.
    """

    name: str
    type: str
    to_ros: bool | None = None
    maps: tuple[str, ...] = ()
    heard: Mapping[str, str] | None = None
    published: Mapping[str, str] | None = None
    names: tuple[str, ...] = ()
    frames: Mapping[str, str] = field(default_factory=dict)
    own_frames: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Crossing:
    """A way in which a bridge can carry a topic.

    `hold_reason`: why the last command may stand when its source is lost, or what releases an
    emergency stop, as a person says it. Nothing else may fill it in: what is safe depends on what
    receives the command. `is_vehicle`: whether the nodes of ROS are those of a vehicle.
    """

    topic: TopicEnd
    map: bridge.AttributeMap
    offer: Offer = field(repr=False)
    hold_reason: str = ""
    is_vehicle: bool = True

    @property
    def has_no_stop(self) -> bool:
        """Whether it is a command without a stop in its map for a lost source."""
        return lacks_stop(self.offer, self.map)

    @property
    def is_own(self) -> bool:
        """Whether it sets or ends an emergency of the bridge itself, as nodes of a vehicle do."""
        return not self.offer.to_ros and self.is_vehicle and is_emergency(self.offer.message)

    @property
    def lacks_names(self) -> bool:
        """Whether its map knows elements by names, and the names of the robot are unknown."""
        return are_examples(self.map) and not self.names

    @property
    def names(self) -> tuple[str, ...]:
        """The names of elements in an own copy of its map; none for a map as it is."""
        return names_for(self.map, self.topic.names) if are_examples(self.map) else ()

    @property
    def frames(self) -> dict[str, str]:
        """The robot's frames by those that its map publishes."""
        if not self.offer.to_ros or library().document_of(self.map) is None:
            return {}
        known = self.topic.frames
        return {frame: known[frame] for frame in frames_in(self.map) if frame in known}

    @property
    def has_own_map(self) -> bool:
        """Whether it needs a copy of its map, with the names of the robot."""
        return bool(self.names or self.frames)

    @property
    def qos(self) -> dict[str, str]:
        """The quality of service of the topic: what its nodes ask for, else what is usual.

        The newest command counts, and none may be lost; a sensor is heard however it publishes.
        """
        known = self.topic.published if self.offer.to_ros else self.topic.heard
        is_sure = is_command(self.offer.message) or self.offer.to_ros
        usual = {"reliability": "reliable" if is_sure else "best_effort"}
        depth = "1" if is_command(self.offer.message) else "5"
        return {**(usual if known is None else known), "depth": depth}

    def says(self) -> str:
        """Returns the way of a topic in words, for people who choose."""
        message, service = name_of(self.offer.message), name_of(self.offer.service)
        if self.offer.to_ros:
            how = "asked for as a periodic event" if self.offer.exchange == EVENT else "taken"
            what = f"{message} of {service} is {how} and published"
        elif self.is_own:
            what = f"taken as {message} of the bridge itself"
        elif self.offer.exchange == EVENT:
            what = f"reported as {message} of {service} to whoever asks"
        else:
            what = f"sent as {message} to who provides {service}"
        return f"{name_of(self.map)}: {what}"


def crossings(topic: TopicEnd, maps: Sequence[bridge.AttributeMap], side: str) -> list[Crossing]:
    """Returns the ways of a topic, the likeliest first.

    What the name of the topic says decides; where it says nothing, reports come before commands,
    which move something. The type alone of a bare value, such as std_msgs/Bool, says nothing: there
    the name has to say what that of the map does, unless a person has named the map.
    """
    said = TopicName(topic.name)

    def rank(crossing: Crossing) -> tuple[bool, bool, bool, int, int, int]:
        moves = (
            crossing.offer.to_ros
            if is_emergency(crossing.offer.message)
            else is_command(crossing.offer.message)
        )
        is_named = are_named(crossing.map, topic.names)
        return moves is not said.commands, not is_named, *said.distance(crossing.map)

    ranked_crossings = sorted(_possible(topic, maps, is_vehicle=side == VEHICLE), key=rank)
    is_open = topic.maps or not is_bare(topic.type)
    return [crossing for crossing in ranked_crossings if is_open or said.names(crossing.map)]


def why_not(wanted: str, topic: TopicEnd, maps: Sequence[bridge.AttributeMap], side: str) -> str:
    """Returns why a topic cannot have a map, with the next step; empty for an unknown name."""
    named = [attribute_map for attribute_map in maps if name_of(attribute_map) == wanted]
    if not named:
        return ""
    if not (
        of_type := [attribute_map for attribute_map in named if _is_of(attribute_map, topic.type)]
    ):
        kinds = " or ".join(
            sorted(
                {
                    ros_name(attribute_map.type)
                    for attribute_map in named
                    if attribute_map.type is not None
                }
            )
        )
        return f"the map {wanted!r} is for {kinds or 'a type that is not known'}, not {topic.type}"
    other = SIDES[side == VEHICLE]
    if crossings(topic, of_type, other):
        return f"the map {wanted!r} is for the other side: add --side {other}"
    if not any(attribute_map.toRos or attribute_map.toJaus for attribute_map in of_type):
        return f"the map {wanted!r} assigns nothing yet: fill it in, and do this again"
    return f"the map {wanted!r} needs more than one topic and one message, or the other direction"


def _possible(
    topic: TopicEnd, maps: Sequence[bridge.AttributeMap], *, is_vehicle: bool
) -> Iterator[Crossing]:
    for map_ in maps:
        if not _is_of(map_, topic.type):
            continue
        for to_ros in (True, False):
            offer = offer_of(map_.message, to_ros=to_ros)
            if (
                offer is not None
                and topic.to_ros in (None, to_ros)
                and (offer.is_provided is not is_vehicle or is_emergency(offer.message))
                and (not is_served(offer.service) or name_of(map_) in topic.maps)
                and _can_carry(map_, to_ros=to_ros)
            ):
                yield Crossing(topic, map_, offer, is_vehicle=is_vehicle)


def _is_of(map_: bridge.AttributeMap, kind: str) -> bool:
    """Tells whether a map is of messages of a type, and not of parts of services or actions."""
    if map_.message is None or map_.type is None or ros_name(map_.type) != kind:
        return False
    return isinstance(map_.type.eContainer(), ros.InterfacePackage)


def _can_carry(map_: bridge.AttributeMap, *, to_ros: bool) -> bool:
    """Tells whether a map needs no more than one topic and one message."""
    if not (map_.toRos if to_ros else map_.toJaus) or (to_ros and map_.reportJoins):
        return False
    return len(list(used_maps(map_, to_ros=to_ros))) == 1


def robots_in(topics: Sequence[TopicEnd]) -> list[str]:
    """Returns the namespaces of topics that look like several robots; none of one robot.

    They have topics of the same names and types: one that nodes listen to, or at least two. Empty
    is the root.
    """
    spaces: dict[tuple[str, str], set[str]] = defaultdict(set)
    heard = set()
    for topic in topics:
        parts = topic.name.strip("/").split("/")
        for at in range(len(parts)):
            end = "/".join(parts[at:]), topic.type
            spaces[end].add("/".join(parts[:at]))
            if topic.to_ros:
                heard.add(end)
    shared = {end: namespaces for end, namespaces in spaces.items() if len(namespaces) > 1}
    are_several = len(shared) > 1 or not heard.isdisjoint(shared)
    return sorted(set().union(*shared.values())) if are_several else []


def within(topics: Sequence[TopicEnd], namespace: str) -> list[TopicEnd]:
    """Returns the topics of a namespace, with names relative to it; of the root, all but robots."""
    own = namespace.strip("/")
    if own:
        inner = [topic for topic in topics if topic.name.strip("/").startswith(f"{own}/")]
        return [replace(end, name=end.name.strip("/").removeprefix(f"{own}/")) for end in inner]
    others = [f"{robot}/" for robot in robots_in(topics) if robot]
    return [topic for topic in topics if not topic.name.strip("/").startswith(tuple(others))]


def clashes(chosen: Sequence[Crossing]) -> list[tuple[Crossing, Crossing]]:
    """Returns the ways that repeat one before them, each with that one, unless a person named it.

    Two topics that make one report are a value that jumps, and one command for two topics moves
    two things.
    """
    first: dict[tuple[int, bool], Crossing] = {}
    repetitions = []
    for crossing in chosen:
        before = first.setdefault((code(crossing.offer.message), crossing.offer.to_ros), crossing)
        is_same = before.topic is crossing.topic or crossing.map.message.moves is False
        if before is not crossing and not is_same and not crossing.topic.maps:
            repetitions.append((crossing, before))
    return repetitions


def joins_of(crossing: Crossing, topics: Sequence[TopicEnd], taken: set[str]) -> dict[str, str]:
    """Returns which topics the joins of a map are fed by, by the names of the joins.

    `taken`: the names of topics that joins have already; those that are found are added.
    """
    topics_by_join: dict[str, str] = {}
    if crossing.offer.to_ros:
        return topics_by_join
    for join in crossing.map.joins:
        free = [topic for topic in topics if topic.name not in taken | {crossing.topic.name}]
        fitting = [end for end in free if feeds(end, join)]
        # Of several of a type, one whose name says so.
        if best := next(
            (end for end in fitting if TopicName(end.name).feeds(join)), next(iter(fitting), None)
        ):
            topics_by_join[name_of(join)] = best.name
            taken.add(best.name)
    return topics_by_join


def feeds(topic: TopicEnd, join: bridge.Join) -> bool:
    """Tells whether a topic, which has a publisher, fits a join: by its type, and by its name.

    The name counts where the type is of a bare value.
    """
    if topic.to_ros or join.type is None or ros_name(join.type) != topic.type:
        return False
    return not is_bare(topic.type) or TopicName(topic.name).feeds(join)


def unanswered_queries(chosen: Sequence[Crossing]) -> dict[str, list[str]]:
    """Returns the queries of the services of a bridge that none of its ways answers.

    Returns the names of queries by the names of the services that the bridge provides.
    """
    sent = {code(crossing.offer.message) for crossing in chosen if not crossing.offer.to_ros}
    services = list(
        dict.fromkeys(
            crossing.offer.service for crossing in chosen if not crossing.offer.is_provided
        )
    )
    commands = [crossing.offer.message for crossing in chosen if crossing.offer.to_ros]
    codes = list(map(code, commands))
    answers = (
        told_by_command(command, services)
        for command in commands
        if codes.count(code(command)) == 1
    )
    sent.update(code(answer.report) for answer in answers if answer is not None)
    queries_by_service = {name_of(service): unanswered(service, sent) for service in services}
    return {
        service: [name_of(query) for query in queries]
        for service, queries in queries_by_service.items()
        if queries
    }


_ROLES = {
    "odom": ("odom_frame", "odom_frame_id"),
    "base_link": ("base_frame", "base_frame_id", "base_link_frame", "robot_base_frame"),
    "map": ("map_frame", "map_frame_id"),
}
"""Frames of REP 105, and how parameters are called that name those of a robot."""

_MEANINGS = (
    (r"use_sim_time", "the bridge needs use_sim_time: true too"),
    (r"(\w+_)?frame(_id)?", "the name of a frame"),
    (
        r"(\w*_)?(cmd_vel|command|cmd|watchdog)_timeout",
        "what takes commands stops by itself after that many seconds; silenceTimeout of the "
        "connection is yours to decide",
    ),
    (
        r"(max|min)_(vel|velocity|speed|accel|acceleration|steering|angular|linear)\w*"
        r"|\w*(vel|speed|acc)_(max|min)",
        "a limit of what it obeys; that of the vehicle is yours to state, as a quantity of the "
        "bridge where a map has one",
    ),
    (
        r"(publish|update|control|controller|odom)?_?(rate|frequency)",
        "messages a second; the rate of a connection is what JAUS is sent, as much by default",
    ),
    (
        r"wheel_(separation|radius|base|track)|wheelbase|track_width",
        "geometry, of which no message of the library tells",
    ),
)
"""Patterns of the last part of a name, and what a model makes of such a parameter."""

_DESCRIPTION = "robot_description"

_JOINT, _ATTRIBUTE = (
    re.compile(r"<joint\b([^<>]*)>"),
    re.compile(r"""(\w+)\s*=\s*["']([^"']*)["']"""),
)
_MOVABLE = frozenset({"revolute", "continuous", "prismatic"})


def is_worth_reading(name: str) -> bool:
    """Tells whether a parameter has a meaning for a model, by its name."""
    return name == _DESCRIPTION or bool(_meaning(name))


def says(name: str, value: Any) -> str:
    """Returns the meaning of a parameter for a model; empty where it has none as it is."""
    if name == _DESCRIPTION:
        joints = ",".join(described_joints(value))
        return f"movable joints {joints}; --joints TOPIC={joints} states them" if joints else ""
    if value in (False, "", None):
        return ""
    return _meaning(name)


def frame_role(name: str) -> str:
    """Returns which frame of REP 105 a parameter names; empty for none."""
    last = name.rpartition(".")[2]
    return next((role for role, names in _ROLES.items() if last in names), "")


def described_joints(description: Any) -> list[str]:
    """Returns the joints of a URDF that move, in its order."""
    joints = (dict(_ATTRIBUTE.findall(match)) for match in _JOINT.findall(str(description)))
    return [joint["name"] for joint in joints if joint.get("type") in _MOVABLE and "name" in joint]


def _meaning(name: str) -> str:
    last = name.rpartition(".")[2]
    return next((text for pattern, text in _MEANINGS if re.fullmatch(pattern, last)), "")
