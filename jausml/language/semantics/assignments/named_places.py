"""Names of elements that a map takes by their places, such as the two joints of a pan-tilt unit."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge

_PLACE = re.compile(r"(\w+)\[(\d+)\]")
_KEYS = ("name", "joint_names")
"""Fields of ROS messages that name the elements of the arrays beside them."""


@dataclass(frozen=True)
class NamedPlaces:
    """The names that a map gives to elements in ROS.

    Attributes:
        keys: The ROS sequence that holds them, such as `name` of sensor_msgs/JointState.
        names: The names, in the order of the places.
        arrays: The arrays beside it of which the map reads elements, such as `position`.
    """

    keys: str
    names: tuple[str, ...]
    arrays: tuple[str, ...]


def named_by(path: str | None) -> int | None:
    """Returns the place of the element that a path such as `name[0]` names; None for others."""
    return next((place for array, place in _places(path) if array in _KEYS), None)


def named_places(map_: bridge.AttributeMap) -> NamedPlaces | None:
    """Returns the names of the elements that a map takes by place; None without names.

    What it writes with names, it reads by them: the elements of a message may stand in any order.
    """
    names: dict[int, str] = {}
    keys = ""
    for assignment in map_.toRos:
        place = named_by(assignment.target)
        if place is not None and isinstance(assignment, bridge.ConstantAssignment):
            keys = str(assignment.target).partition("[")[0].strip()
            names[place] = str(assignment.value)
    # With a gap in the places an element would have no name.
    if not names or [*sorted(names)] != [*range(len(names))]:
        return None
    read = (
        array
        for assignment in map_.toJaus
        for array, _ in _places(getattr(assignment, "source", ""))
    )
    arrays = tuple(dict.fromkeys(read))
    return NamedPlaces(keys, tuple(names[place] for place in sorted(names)), arrays)


def _places(path: str | None) -> Iterator[tuple[str, int]]:
    """Yields the array and the place of a path such as `position[0]`; nothing for others."""
    match = _PLACE.fullmatch((path or "").strip())
    if match is not None:
        yield match[1], int(match[2])
