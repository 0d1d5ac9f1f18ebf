"""Attribute paths of assignments in both directions: where each starts, and where it leads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeGuard, TypeVar, overload

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.attributes import COUNT, NUMBER, Attribute, Found, PathFault
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.wholes import FoundPlace, PathPlace, ShapeError, parts_of
from jausml.language.semantics.subject import Subject, remembered

if TYPE_CHECKING:
    from typing_extensions import TypeIs

WithSource: TypeAlias = "bridge.FieldAssignment | bridge.ListAssignment | bridge.MessageAssignment"
Carrier: TypeAlias = "bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection"


COUNTERS = ("index", COUNT)


@remembered
def _followed(way: tuple[PathPlace, str]) -> FoundPlace:
    """Returns the place that a path leads to: those of one type are the same in each map."""
    start, path = way
    return start.follow(path)


@remembered
def _type_place(type_: ros.MessageType | None) -> RosPlace:
    return RosPlace(type=type_)


@remembered
def _attribute(place: PathPlace) -> Attribute:
    return place.attribute()


def attribute_at(location: FoundPlace) -> Found:
    """Returns the attribute of a place."""
    return _attribute(location) if isinstance(location, JausPlace | RosPlace) else location


@dataclass(frozen=True, slots=True)
class PathScope:
    """The start of the paths of some assignments.

    Attributes:
        is_nested: Whether the assignments fill elements of a list.
    """

    map: bridge.AttributeMap
    to_ros: bool
    source: PathPlace
    target: PathPlace
    is_nested: bool = False

    def find_source(self, path: str) -> FoundPlace:
        """Returns the place that a source path leads to; joins and `/` are known."""
        if path.startswith("/"):
            outer = outer_scope(self.map, to_ros=self.to_ros)
            return outer.find_source(path[1:])
        first, _, rest = path.partition(".")
        # Paths within a list start at its element, where no join is known.
        join = None if self.is_nested else self._join(first)
        if join is None:
            return _followed((self.source, path))
        if isinstance(join, bridge.ReportJoin):
            return message_place(join.message).follow(rest or ".") if join.message else None
        return RosPlace(type=join.type).follow(rest or ".") if join.type else None

    def _join(self, name: str) -> bridge.Join | bridge.ReportJoin | None:
        joins = self.map.reportJoins if self.to_ros else self.map.joins
        return next((join for join in joins if join.name == name), None)

    def find_target(self, path: str) -> FoundPlace:
        """Returns the place that a target path leads to."""
        if path.startswith("/") and self.is_nested:
            return PathFault("the target of an element lies within the element")
        location = _followed((self.target, path))
        if isinstance(location, JausPlace | RosPlace) and location.is_count:
            return PathFault(f"'{path}' follows from the elements")
        return location

    def inner(self, assignment: bridge.ListAssignment) -> PathScope | None:
        """Returns the scope of nested assignments; None when the ends are no lists."""
        source = self.find_source(source_paths(assignment)[0])
        target = self.find_target(assignment.target.strip())
        if not (is_many(source) and is_many(target)):
            return None
        from_element, to_element = source.element(), target.element()
        if from_element is None or to_element is None:
            return None
        return replace(self, source=from_element, target=to_element, is_nested=True)


AssignmentT = TypeVar("AssignmentT", bound="bridge.Assignment")
AssignmentT_co = TypeVar("AssignmentT_co", bound="bridge.Assignment", covariant=True)


@dataclass(frozen=True, eq=False)
class Placed(Generic[AssignmentT_co]):
    """An assignment with the places where its paths start."""

    assignment: AssignmentT_co
    scope: PathScope

    @cached_property
    def targets(self) -> list[tuple[str, Found]]:
        """The target paths and what they lead to."""
        paths = target_paths(self.assignment)
        return [(path, attribute_at(self.scope.find_target(path))) for path in paths]

    @cached_property
    def sources(self) -> list[tuple[str, Found]]:
        """The source paths and what they lead to; none for constants and the like."""
        return [(path, _source(self.scope, path)) for path in source_paths(self.assignment)]

    @cached_property
    def target_attributes(self) -> list[Attribute]:
        """The attributes of the targets, empty unless all of them were found."""
        return _all_found(self.targets)

    @cached_property
    def source_attributes(self) -> list[Attribute]:
        """The attributes of the sources, empty unless all of them were found."""
        return _all_found(self.sources)


def _source(scope: PathScope, path: str) -> Found:
    location = scope.find_source(path)
    if isinstance(location, PathFault) and scope.is_nested and path in COUNTERS:
        return Attribute(NUMBER, "a number", integral=True, lower=0, step=1, label=path)
    return attribute_at(location)


def outer_scope(attribute_map: bridge.AttributeMap, *, to_ros: bool) -> PathScope:
    """Returns the scope of the assignments of a map."""
    ends = message_place(attribute_map.message), _type_place(attribute_map.type)
    source, target = ends if to_ros else reversed(ends)
    return PathScope(attribute_map, to_ros, source, target)


def place(
    attribute_map: bridge.AttributeMap, assignment: AssignmentT, *, to_ros: bool
) -> Placed[AssignmentT] | None:
    """Returns an assignment with the places where its paths start.

    Returns:
        None when the list that it belongs to is not there.
    """
    scope = _scope(attribute_map, assignment.eContainer(), to_ros=to_ros)
    return Placed(assignment, scope) if scope is not None else None


def flattened(
    assignments: Iterable[bridge.Assignment], scope: PathScope
) -> Iterator[Placed[bridge.Assignment]]:
    """Yields assignments, nested ones behind their owner.

    In the place of one of a whole are those of its members, if source and target correspond.
    """
    for assignment in expanded(assignments, scope):
        yield Placed(assignment, scope)
        if (
            isinstance(assignment, bridge.ListAssignment)
            and assignment.source
            and assignment.target
        ):
            inner = scope.inner(assignment)
            if inner is not None:
                yield from flattened(assignment.assignments, inner)


def expanded(
    assignments: Iterable[bridge.Assignment], scope: PathScope
) -> Iterator[bridge.Assignment]:
    """Yields assignments; one of wholes is replaced by those of the members."""
    for assignment in assignments:
        parts = None
        with suppress(ShapeError):  # which a rule tells
            parts = parts_in(assignment, scope)
        if parts is None:
            yield assignment
        else:
            yield from expanded(parts, scope)


def spelled_out(map_: bridge.AttributeMap, *, to_ros: bool) -> list[bridge.Assignment]:
    """Returns the assignments of a direction of a map, of wholes those of their members."""
    written = map_.toRos if to_ros else map_.toJaus
    return list(expanded(written, outer_scope(map_, to_ros=to_ros)))


def parts_in(assignment: bridge.Assignment, scope: PathScope) -> list[bridge.Assignment] | None:
    """Returns the result of `parts_of` for an assignment in a scope."""
    if not isinstance(assignment, bridge.FieldAssignment):
        return None
    sources, targets = source_paths(assignment), target_paths(assignment)
    if len(sources) != 1 or len(targets) != 1:
        return None
    source, target = scope.find_source(sources[0]), scope.find_target(targets[0])
    return parts_of(assignment, source, target)


def is_many(location: FoundPlace) -> TypeGuard[PathPlace]:
    """Tells whether a place is a list or an array as a whole."""
    if isinstance(location, RosPlace):
        return location.is_array
    if not isinstance(location, JausPlace) or location.is_count:
        return False
    return isinstance(location.field, (jaus.List, jaus.Array))


def has_source(assignment: bridge.Assignment) -> TypeIs[WithSource]:
    """Tells whether an assignment takes its value from the other side."""
    kinds = (bridge.FieldAssignment, bridge.ListAssignment, bridge.MessageAssignment)
    return isinstance(assignment, kinds)


def source_paths(assignment: bridge.Assignment) -> list[str]:
    """Returns the source paths of an assignment."""
    return _split(assignment.source) if has_source(assignment) else []


def target_paths(assignment: bridge.Assignment) -> list[str]:
    """Returns the target paths of an assignment."""
    return _split(assignment.target)


@lru_cache(maxsize=4096)
def parse_path(path: str) -> tuple[str, ...]:
    """Returns the steps of a path, indices as steps of their own, to compare paths."""
    if path == ".":
        return ()
    return tuple(part for step in path.split(".") for part in re.split(r"(?=\[)", step) if part)


def _scope(
    attribute_map: bridge.AttributeMap, owner: EObject | None, *, to_ros: bool
) -> PathScope | None:
    if not isinstance(owner, bridge.ListAssignment):
        return outer_scope(attribute_map, to_ros=to_ros)
    around = _scope(attribute_map, owner.eContainer(), to_ros=to_ros)
    return around.inner(owner) if around is not None else None


def _all_found(ends: list[tuple[str, Found]]) -> list[Attribute]:
    known = [result for _, result in ends if isinstance(result, Attribute)]
    return known if len(known) == len(ends) else []


def _split(text: str | None) -> list[str]:
    return [path.strip() for path in text.split(",")] if text is not None else []


FirstT = TypeVar("FirstT", bound="bridge.Assignment")
SecondT = TypeVar("SecondT", bound="bridge.Assignment")


def is_sound(subject: Subject, connection: bridge.Connection) -> bool:
    """Tells whether message and type of the map of a connection were read well."""
    map_ = connection.map
    return map_ is not None and subject.is_intact(map_.message, map_.type)


def sound_connections(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections that were read well, with message and type of their maps."""
    return [
        connection
        for connection in subject.instances(bridge.Connection)
        if is_sound(subject, connection)
    ]


@dataclass(frozen=True)
class Direction:
    """One direction of a map, a stop or a safe value, with its assignments.

    Attributes:
        owner: The map, its stop, or the connection that has the safe value.
        assignments: The assignments that were read well, those nested in lists included.
    """

    map: bridge.AttributeMap
    owner: bridge.AttributeMap | bridge.Stop | bridge.Connection
    to_ros: bool
    assignments: tuple[Placed[bridge.Assignment], ...]
    _by_kind: dict[tuple[type[bridge.Assignment], ...], tuple[Placed[Any], ...]] = field(
        default_factory=dict, compare=False, repr=False
    )

    @overload
    def of_kind(self, kind: type[FirstT], /) -> tuple[Placed[FirstT], ...]: ...

    @overload
    def of_kind(
        self, kind: type[FirstT], other: type[SecondT], /
    ) -> tuple[Placed[FirstT | SecondT], ...]: ...

    def of_kind(self, *kinds: type[bridge.Assignment]) -> tuple[Placed[Any], ...]:
        """Returns the assignments of some classes."""
        if not self.assignments:
            return ()
        assignments = self._by_kind.get(kinds)
        if assignments is None:
            assignments = tuple(
                assignment
                for assignment in self.assignments
                if isinstance(assignment.assignment, kinds)
            )
            self._by_kind[kinds] = assignments
        return assignments


Directed = bridge.AttributeMap | bridge.Connection
"""Elements with directions: a map its own and those of its stops, a connection of a safe value."""

DIRECTED = (bridge.AttributeMap, bridge.Connection)
"""The same for rules."""


def directed(subject: Subject) -> list[Directed]:
    """Returns all that have directions, maps first."""
    return [*subject.instances(bridge.AttributeMap), *subject.instances(bridge.Connection)]


def directions_of(subject: Subject, owner: Directed) -> tuple[Direction, ...]:
    """Returns the directions of a map or a connection that say something.

    Returns:
        None of them where an end of the map was not read.
    """
    return subject.once(_directions, owner)


def direction_of(
    subject: Subject, attribute_map: bridge.AttributeMap, *, to_ros: bool
) -> Direction | None:
    """Returns one direction of a map, also of the library.

    Returns:
        None when an end of the map was not read.
    """
    if not subject.is_intact(attribute_map.message, attribute_map.type):
        return None
    assignments = attribute_map.toRos if to_ros else attribute_map.toJaus
    return _direction(subject, attribute_map, attribute_map, assignments, to_ros=to_ros)


def _directions(subject: Subject, owner: Directed) -> tuple[Direction, ...]:
    map_ = owner.map if isinstance(owner, bridge.Connection) else owner
    if map_ is None or not subject.is_intact(map_.message, map_.type):
        return ()
    written: list[tuple[Directed | bridge.Stop, Sequence[bridge.Assignment], bool]]
    if isinstance(owner, bridge.Connection):
        written = [(owner, owner.safeValue, is_to_ros(owner))]
    else:
        stops = ((map_.stopRos, True), (map_.stopJaus, False))
        written = [(map_, map_.toRos, True), (map_, map_.toJaus, False)]
        written += ((stop, stop.values, to_ros) for stop, to_ros in stops if stop is not None)
    return tuple(
        _direction(subject, map_, place, assignments, to_ros=to_ros)
        for place, assignments, to_ros in written
        if assignments
    )


def _direction(
    subject: Subject,
    attribute_map: bridge.AttributeMap,
    owner: Directed | bridge.Stop,
    assignments: Iterable[bridge.Assignment],
    *,
    to_ros: bool,
) -> Direction:
    sound = [
        assignment
        for assignment in assignments
        if subject.is_intact(assignment) and _is_complete(assignment)
    ]
    scope = outer_scope(attribute_map, to_ros=to_ros)
    placed = tuple(
        placement for placement in flattened(sound, scope) if _is_complete(placement.assignment)
    )
    return Direction(attribute_map, owner, to_ros, placed)


def _is_complete(assignment: bridge.Assignment) -> bool:
    if has_source(assignment) and assignment.source is None:
        return False
    return assignment.target is not None


def used_maps(attribute_map: bridge.AttributeMap, *, to_ros: bool) -> Iterator[bridge.AttributeMap]:
    """Yields a map and those for its messages inside messages, each once."""
    seen: list[bridge.AttributeMap] = []
    waiting = [attribute_map]
    while waiting:
        current = waiting.pop(0)
        if current in seen:
            continue
        seen.append(current)
        yield current
        assignments = list(current.toRos if to_ros else current.toJaus)
        while assignments:
            assignment = assignments.pop(0)
            if isinstance(assignment, bridge.ListAssignment):
                assignments = [*assignment.assignments, *assignments]
            if isinstance(assignment, bridge.MessageAssignment) and assignment.map is not None:
                waiting.append(assignment.map)


def carriers_of(owner: bridge.Bridge) -> tuple[Carrier, ...]:
    """Returns all connections of a bridge: of topics, of ROS services and of ROS actions."""
    return (*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections)


def maps_of(carrier: Carrier) -> tuple[bridge.AttributeMap, ...]:
    """Returns the maps that a connection uses, in either direction, each once."""
    maps: list[bridge.AttributeMap | None]
    if isinstance(carrier, bridge.Connection):
        maps = [carrier.map]
    elif isinstance(carrier, bridge.RosServiceConnection):
        maps = [carrier.request, carrier.response]
    else:
        maps = [carrier.element]
    inner = (
        inner_map
        for own_map in maps
        if own_map is not None
        for to_ros in (True, False)
        for inner_map in used_maps(own_map, to_ros=to_ros)
    )
    return tuple(dict.fromkeys(inner))
