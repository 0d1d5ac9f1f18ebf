"""Stops of new maps: zeros, where a person says that they stop what all numbers of a map drive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.mapping.statements import innermost
from jausml.language.semantics.commands import is_command
from jausml.language.semantics.rates import fills_rates_alone

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from jausml.language.metamodel.classes import bridge

STOPS = {True: "stopRos", False: "stopJaus"}
"""The stops of a map, by whether they go to ROS."""


def stops_by_zeros(used: bridge.AttributeMap, ways: Collection[bool]) -> list[bool]:
    """Returns the directions of a command in which zeros may be what stops it.

    That they do is for a person to say: what receives them may be at rest by other numbers.
    """
    if not (is_command(used.message) and used.message.moves):
        return []
    return [way for way in ways if fills_rates_alone(used, to_ros=way)]


def zeros(assignments: Sequence[Child], *, to_ros: bool) -> Child:
    """Returns a stop of zeros. A ROS message has them by itself, one of JAUS is given them."""
    values = () if to_ros else tuple(_zeros(assignments))
    return Child(STOPS[to_ros], "bridge.Stop", {}, values)


def _zeros(assignments: Sequence[Child]) -> Iterator[Child]:
    for each in map(innermost, assignments):
        if each.kind == "bridge.FieldAssignment":
            for target in each.values["target"][0].split(", "):
                values = {"target": (target,), "value": ("0",)}
                yield Child("values", "bridge.ConstantAssignment", values)
