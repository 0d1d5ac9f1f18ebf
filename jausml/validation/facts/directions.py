"""The directions of attribute maps: all assignments that rules look at, with their places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.metamodel.classes import bridge
from jausml.validation.facts.layouts import class_name
from jausml.validation.facts.paths import Placed, flattened, outer_scope

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.validation.subject import Subject

_WITH_SOURCE = frozenset({"FieldAssignment", "ListAssignment", "MessageAssignment"})


@dataclass(frozen=True, slots=True)
class Direction:
    """One direction of a map, or the safe value of a connection: what is filled from what.

    Attributes:
        map: The `bridge.AttributeMap`.
        owner: The map, or the connection that has the safe value.
        to_ros: Whether the assignments fill the ROS type.
        assignments: The assignments that were read well, those nested in lists included.
    """

    map: Any
    owner: Any
    to_ros: bool
    assignments: tuple[Placed, ...]

    def of_kind(self, *names: str) -> Iterator[Placed]:
        """Yields the assignments of some classes.

        Args:
            names: Names of classes, such as `FieldAssignment`.
        """
        return (each for each in self.assignments if each.kind in names)


def directions(subject: Subject) -> tuple[Direction, ...]:
    """Returns all directions of all maps, and safe values, as far as both ends were read."""
    return subject.once(_directions)


def direction_of(subject: Subject, attribute_map: Any, *, to_ros: bool) -> Direction | None:
    """Returns one direction of a map, which may be one of the library.

    Args:
        subject: The model.
        attribute_map: The map.
        to_ros: Which direction.

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
    for connection in subject.instances(bridge.Connection):
        used = connection.map
        if used is not None and subject.is_intact(used.message, used.type):
            to_ros = connection.direction.name == "jausToRos"
            values = connection.safeValue
            found.append(_direction(subject, used, connection, values, to_ros=to_ros))
    return tuple(found)


def _direction(
    subject: Subject, attribute_map: Any, owner: Any, assignments: Iterable[Any], *, to_ros: bool
) -> Direction:
    sound = [each for each in assignments if subject.is_intact(each) and _is_complete(each)]
    scope = outer_scope(attribute_map, to_ros=to_ros)
    placed = tuple(each for each in flattened(sound, scope) if _is_complete(each.assignment))
    return Direction(attribute_map, owner, to_ros, placed)


def _is_complete(assignment: Any) -> bool:
    has_source = class_name(assignment) not in _WITH_SOURCE or assignment.source is not None
    return assignment.target is not None and has_source
