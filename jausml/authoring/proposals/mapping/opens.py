"""Open decisions of a map: members that nothing fills, stops, and what its author decides."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.mapping.assignments import UNKNOWN, innermost
from jausml.authoring.proposals.mapping.filling import assignments_feature, filled_paths, is_filled
from jausml.authoring.proposals.mapping.members import Member, leaves
from jausml.authoring.proposals.mapping.trial import judge
from jausml.authoring.proposals.named_elements import FRAME_IDS
from jausml.authoring.proposals.new_elements import OpenPoint, blocking, pending
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.names import name_of
from jausml.language.semantics.assignments.rates import fills_rates_alone
from jausml.language.semantics.conversions.conversion import FLU, UP
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import outer_scope, parse_path

_MOST = 8  # how many members a line names

_STAMP = "header.stamp"

_FRAME_ID, _CHILD_FRAME_ID = "header.frame_id", "child_frame_id"

_FRAMES = {UP: "odom", FLU: "base_link"}
"""Frames of REP 105 by what the axes of a ROS type are; the outer one comes first."""

STOPS = {True: "stopRos", False: "stopJaus"}
"""The stops of a map, by whether they go to ROS."""


def opens(
    map_: bridge.AttributeMap, assignments: Sequence[Child], directions: Collection[bool]
) -> Iterator[OpenPoint]:
    """Yields the decisions that are left to the author of a new map."""
    for to_ros in directions:
        feature = assignments_feature(to_ros=to_ros)
        own = [assignment for assignment in assignments if assignment.feature == feature]
        ends = [name_of(map_.message), ros_name(map_.type)]
        source, target = ends if to_ros else reversed(ends)
        yield from _unfilled(map_, own, source, target, to_ros=to_ros)
        yield from _untaken(map_, own, source, target, to_ros=to_ros)
        yield from _decisions(own)
    yield from _of_connections(map_, directions)


def _unfilled(
    map_: bridge.AttributeMap, own: Sequence[Child], source: str, target: str, *, to_ros: bool
) -> Iterator[OpenPoint]:
    if ignored := [child.values["target"][0] for child in own if child.kind == "bridge.Ignore"]:
        text = f"ignored: {_listed(ignored)} of {target}, since no member of {source} corresponds"
        # A field of JAUS is absent then, a member of ROS is 0.
        yield pending(text) if to_ros else OpenPoint(text)
    left = unfilled(map_, to_ros=to_ros)
    # Of a header without a frame a rule tells.
    paths = [field.path for field in left if not field.is_required and field.path != _FRAME_ID]
    if paths:
        text = f"nothing is assigned to {_listed(paths)} of {target}"
        yield blocking(text) if own else OpenPoint(text, _empty(map_))
    if missing := [field.path for field in left if field.is_required]:
        text = f"assign or ignore {_listed(missing)}: {target} always contains it"
        yield OpenPoint(text, "JML416" if own else _empty(map_))


def _empty(map_: bridge.AttributeMap) -> str:
    """Returns the rule that reports a connection by a map without assignments."""
    return "JML421" if _is_of_topics(map_) else "JML467"


def _untaken(
    map_: bridge.AttributeMap, own: Sequence[Child], source: str, target: str, *, to_ros: bool
) -> Iterator[OpenPoint]:
    read = [
        parse_path(path)
        for child in own
        for path in child.values.get("source", ("",))[0].split(", ")
        if path
    ]
    left: list[str] = []
    for leaf in leaves(map_, is_jaus=to_ros):
        path = leaf.outer or leaf.path
        is_part = bool(left) and path.startswith(f"{left[-1]}.")
        if path not in left and not is_part and not is_filled(path, read):
            left.append(path)
    if left:
        yield OpenPoint(f"no member of {target} takes {_listed(left)} of {source}")


def _decisions(own: Iterable[Child]) -> Iterator[OpenPoint]:
    """Yields the decisions that were made for the author, who may know better."""
    inner = [innermost(child) for child in own]
    frames = [
        f'"{child.values["value"][0]}"'
        for child in inner
        if child.kind == "bridge.ConstantAssignment"
        and child.values["target"][0].rpartition(".")[2] in FRAME_IDS
    ]
    if frames:
        yield pending(f"state the frames of your vehicle instead of {' and '.join(frames)}")
    if dropped := _stating(inner, "whenAbsent", "dropMessage", "source"):
        yield OpenPoint(f"if {dropped} is absent, the message is dropped (whenAbsent: dropMessage)")
    if clamped := _stating(inner, "outOfRange", "clamp", "target"):
        yield pending(f"values that {clamped} cannot carry become the nearest one")
    for child in inner:
        if any(step.values.get("arguments") == (UNKNOWN,) for step in child.children):
            target = child.values["target"][0]
            yield blocking(f"state the number of your vehicle instead of {UNKNOWN} for {target}")


def _stating(own: Iterable[Child], policy: str, value: str, end: str) -> str:
    """Lists one end of the assignments that state a policy."""
    return _listed([child.values[end][0] for child in own if child.values.get(policy) == (value,)])


def _of_connections(map_: bridge.AttributeMap, directions: Iterable[bool]) -> Iterator[OpenPoint]:
    """Yields the decisions that a connection of a topic by the map will ask for."""
    if not _is_of_topics(map_):
        return
    if is_command(map_.message) and map_.message.moves:
        if stops := [way for way in directions if getattr(map_, STOPS[way]) is None]:
            text = f"state what stops the command: {_named(stops)}"
            if zeros := [way for way in stops if fills_rates_alone(map_, to_ros=way)]:
                text += f"; all of its numbers are rates, so that {_named(zeros)} of zeros may be "
                text += "what stops it: write it if that is so for what you drive"
            yield OpenPoint(text, "JML451")
    elif False in directions:
        text = "state freshness, or whenStale: keep, for a topic that falls silent"
        yield OpenPoint(text, "JML455")


def _is_of_topics(map_: bridge.AttributeMap) -> bool:
    """Tells whether a map is of messages of topics, and not of parts of services or actions."""
    return isinstance(map_.type.eContainer(), ros.InterfacePackage)


def _named(directions: Iterable[bool]) -> str:
    return " and ".join(STOPS[way] for way in directions)


def _listed(names: Sequence[str]) -> str:
    more = len(names) - _MOST
    return ", ".join(names[:_MOST]) + (f" and {more} more" if more > 0 else "")


@dataclass(frozen=True)
class Unfilled:
    """A part of the target message that nothing fills, as large as can be."""

    path: str
    leaves: tuple[Member, ...]
    is_required: bool


def completed(
    scope: Scope, map_: bridge.AttributeMap, *, to_ros: bool, ignores: bool
) -> list[Child]:
    """Returns the assignments that complete a direction of a map."""
    feature = assignments_feature(to_ros=to_ros)
    header_assignments = list(_header(map_)) if to_ros else []
    named = {parse_path(child.values["target"][0]) for child in header_assignments}
    ignored = [
        Child(feature, "bridge.Ignore", {"target": (field.path,)})
        for field in unfilled(map_, named, to_ros=to_ros)
        if ignores and not field.is_required
    ]
    judged = judge(scope.model.metamodels, map_, [*header_assignments, *ignored])
    return [candidate.assignment for candidate in judged if candidate.is_possible]


def unfilled(
    map_: bridge.AttributeMap, filled: Iterable[tuple[str, ...]] = (), *, to_ros: bool
) -> list[Unfilled]:
    """Returns the members without an assignment in a direction, wholes without their parts.

    Options that are not chosen are left out.
    """
    taken = [*filled_paths(map_, to_ros=to_ros), *filled]
    members_by_path: dict[str, list[Member]] = {}
    for leaf in leaves(map_, is_jaus=not to_ros):
        if not is_filled(leaf.outer or leaf.path, taken):
            steps = parse_path(leaf.outer or leaf.path)
            members_by_path.setdefault(_widest(steps, taken), []).append(leaf)
    return list(_bare(map_, members_by_path.items(), to_ros=to_ros))


def _bare(
    map_: bridge.AttributeMap, path_groups: Iterable[tuple[str, Sequence[Member]]], *, to_ros: bool
) -> Iterator[Unfilled]:
    target = outer_scope(map_, to_ros=to_ros).target
    for path, inner in path_groups:
        place, before = target.follow(path), target.follow(path.rpartition(".")[0] or ".")
        around = before.field if isinstance(before, JausPlace) else None
        if isinstance(around, jaus.Variant | jaus.VariableField | jaus.VariableFormatField):
            continue
        is_required = isinstance(place, JausPlace) and not place.optional
        is_bit = isinstance(around, jaus.BitField)
        yield Unfilled(path, tuple(inner), is_required and not is_bit)


def _widest(steps: Sequence[str], taken: Sequence[tuple[str, ...]]) -> str:
    """Returns the shortest beginning of a path below which nothing is filled."""
    for length in range(1, len(steps) + 1):
        if not any(taken_path[:length] == tuple(steps[:length]) for taken_path in taken):
            return ".".join(steps[:length])
    return ".".join(steps)


def _header(map_: bridge.AttributeMap) -> Iterator[Child]:
    """Yields the time and the frames of a ROS message that have no assignment."""
    feature = assignments_feature(to_ros=True)
    filled = filled_paths(map_, to_ros=True)
    members = leaves(map_, is_jaus=False)
    known = {member.path for member in members if not is_filled(member.path, filled)}
    if _STAMP in known:
        yield Child(feature, "bridge.ClockAssignment", {"target": (_STAMP,)})
    frames = {member.attribute.frame for member in members}
    names = [name for frame, name in _FRAMES.items() if frame in frames]
    for path, name in zip((_FRAME_ID, _CHILD_FRAME_ID), names, strict=False):
        if path in known:
            values = {"target": (path,), "value": (name,)}
            yield Child(feature, "bridge.ConstantAssignment", values)


def stops_by_zeros(map_: bridge.AttributeMap, directions: Collection[bool]) -> list[bool]:
    """Returns the directions of a command in which zeros may be the stop.

    That they do is for a person to say: what receives them may be at rest by other numbers.
    """
    if not (is_command(map_.message) and map_.message.moves and _is_of_topics(map_)):
        return []
    return [way for way in directions if fills_rates_alone(map_, to_ros=way)]


def zeros(assignments: Sequence[Child], *, to_ros: bool) -> Child:
    """Returns a stop of zeros: a ROS message has them already, one of JAUS needs them stated."""
    values = () if to_ros else tuple(_zeros(assignments))
    return Child(STOPS[to_ros], "bridge.Stop", {}, values)


def _zeros(assignments: Sequence[Child]) -> Iterator[Child]:
    for child in map(innermost, assignments):
        if child.kind == "bridge.FieldAssignment":
            for target in child.values["target"][0].split(", "):
                values = {"target": (target,), "value": ("0",)}
                yield Child("values", "bridge.ConstantAssignment", values)
