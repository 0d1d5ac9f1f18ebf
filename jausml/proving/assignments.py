"""Which assignment of a map gives a number its value."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.proving.layout import JAUS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.proving.round_trips import RoundTrip


def assignment_of(trip: RoundTrip, side: str, path: str) -> bridge.FieldAssignment | None:
    """Returns the assignment that gives a number of a side its value when it comes back."""
    assignments = trip.to_jaus.toJaus if side == JAUS else trip.to_ros.toRos
    for each in field_assignments(assignments):
        targets = (one.strip() for one in str(each.target).split(","))
        if any(_is_at(path, target) for target in targets):
            return each
    return None


def is_alone(assignment: bridge.FieldAssignment | None, path: str) -> bool:
    """Whether an assignment gives one number the value of one source.

    What shares an assignment, as the parts of an orientation do, may rightly be lost in it.
    """
    if assignment is None or "," in assignment.source:
        return False
    return f".{path}".endswith(f".{str(assignment.target).strip()}")


def field_assignments(assignments: Iterable[bridge.Assignment]) -> Iterator[bridge.FieldAssignment]:
    """Yields those of fields, in lists too."""
    for each in assignments:
        if isinstance(each, bridge.FieldAssignment):
            yield each
        elif isinstance(each, bridge.ListAssignment):
            yield from field_assignments(each.assignments)


def _is_at(path: str, target: str) -> bool:
    """Whether the path of a number is that of a target, or of something in it."""
    if path == target or path.startswith(f"{target}."):
        return True
    plain = re.sub(r"\[\d+\]", "", path)
    return "[" in path and "[" not in target and plain.endswith(f".{target.lstrip('/')}")
