"""Directions of attribute maps: all assignments that rules look at, with their places."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar, overload

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.paths.scopes import (
    Followed,
    Placed,
    flattened,
    has_source,
    outer_scope,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.semantics.subject import Subject


FirstT = TypeVar("FirstT", bound="bridge.Assignment")
SecondT = TypeVar("SecondT", bound="bridge.Assignment")


def sound_connections(subject: Subject) -> list[bridge.Connection]:
    """Returns the connections that were read well, with message and type of their maps."""
    return [
        each
        for each in subject.instances(bridge.Connection)
        if each.map is not None and subject.is_intact(each.map.message, each.map.type)
    ]


@dataclass(frozen=True)
class Direction:
    """One direction of a map, a stop or a safe value: what is filled from what.

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
        """Returns the assignments of some classes.

        Args:
            kinds: The classes, such as `bridge.FieldAssignment`.
        """
        if not self.assignments:
            return ()
        found = self._by_kind.get(kinds)
        if found is None:
            found = tuple(each for each in self.assignments if isinstance(each.assignment, kinds))
            self._by_kind[kinds] = found
        return found


def directions(subject: Subject) -> tuple[Direction, ...]:
    """Returns all directions of all maps, stops and safe values, as far as both ends were read."""
    return subject.once(_directions)


def direction_of(
    subject: Subject, attribute_map: bridge.AttributeMap, *, to_ros: bool
) -> Direction | None:
    """Returns one direction of a map, which may be one of the library.

    Returns:
        None when an end of the map was not read.
    """
    if not subject.is_intact(attribute_map.message, attribute_map.type):
        return None
    assignments = attribute_map.toRos if to_ros else attribute_map.toJaus
    return _direction(subject, attribute_map, attribute_map, assignments, to_ros=to_ros)


def _directions(subject: Subject) -> tuple[Direction, ...]:
    found = []
    for each in subject.instances(bridge.AttributeMap):
        ways = (direction_of(subject, each, to_ros=to_ros) for to_ros in (True, False))
        found += [way for way in ways if way is not None]
        if subject.is_intact(each.message, each.type):
            for stop, to_ros in ((each.stopRos, True), (each.stopJaus, False)):
                if stop is not None:
                    found.append(_direction(subject, each, stop, stop.values, to_ros=to_ros))
    for connection in subject.instances(bridge.Connection):
        used = connection.map
        if used is not None and subject.is_intact(used.message, used.type):
            to_ros = connection.direction.name == "jausToRos"
            values = connection.safeValue
            found.append(_direction(subject, used, connection, values, to_ros=to_ros))
    return tuple(found)


def _direction(
    subject: Subject,
    attribute_map: bridge.AttributeMap,
    owner: bridge.AttributeMap | bridge.Stop | bridge.Connection,
    assignments: Iterable[bridge.Assignment],
    *,
    to_ros: bool,
) -> Direction:
    sound = [each for each in assignments if subject.is_intact(each) and _is_complete(each)]
    followed = subject.once(_followed)
    scope = outer_scope(attribute_map, to_ros=to_ros, followed=followed)
    placed = tuple(each for each in flattened(sound, scope) if _is_complete(each.assignment))
    return Direction(attribute_map, owner, to_ros, placed)


def _followed(_: Subject) -> Followed:
    return Followed()


def _is_complete(assignment: bridge.Assignment) -> bool:
    if has_source(assignment) and assignment.source is None:
        return False
    return assignment.target is not None


def used_maps(attribute_map: bridge.AttributeMap, *, to_ros: bool) -> Iterator[bridge.AttributeMap]:
    """Yields a map and those that its messages inside messages use, each once."""
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
            if isinstance(assignment, bridge.MessageAssignment):
                waiting.append(assignment.map)
