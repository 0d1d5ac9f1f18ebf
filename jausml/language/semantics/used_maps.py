"""The maps that a translation uses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge

if TYPE_CHECKING:
    from collections.abc import Iterator


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
