"""Checks by example: what a source message becomes, and what stays as it is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml_generators.bridge.checks.assertions import has_value
from jausml_generators.bridge.checks.check import Check, equals, holds, tidy
from jausml_generators.bridge.translation.ros_fields import PathError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.filling import Place
    from jausml_generators.bridge.checks.samples import Sample


def examples(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks by example of a connection."""
    view = ends.view
    begin = [*ends.source.fill(sample.values), *ends.translated()]
    lines = list(begin)
    for path, value in sample.expected.items():
        lines += has_value(ends.target.place(path), value)
    for path in sample.changed:
        lines.append(holds(f"{ends.target.place(path).code} != {ends.default(path)}"))
    if not ends.to_ros:
        lines += [
            f"decoded = {view.target_name}.decode(target.encode())",
            f"assert isinstance(decoded, {view.target_name})",
        ]
    about = f"{view.source_name} becomes {view.target_name}."
    yield Check(ends.name, about, tidy(lines))
    untouched = list(_untouched(ends))
    if untouched:
        yield Check(
            f"{ends.name}_leaves_ignored_members_alone",
            f"What the map ignores in {view.target_name} stays as it is made.",
            tidy([*begin, *untouched]),
        )


def _untouched(ends: Ends) -> Iterator[str]:
    for assignment in ends.assignments:
        path = assignment.target.strip()
        if not isinstance(assignment, bridge.Ignore):
            continue
        if ends.written.overlapping(path):
            continue
        try:
            place = ends.target.place(path)
        except PathError:
            continue
        if _is_there(place) and not _is_array(ends, path):
            yield equals(place.code, ends.default(path))


def _is_there(place: Place) -> bool:
    """Whether a message as it is made has an attribute, and not only its optional container."""
    own = f"{place.code} is not None"
    return all(condition == own for condition in place.conditions)


def _is_array(ends: Ends, path: str) -> bool:
    """Whether a path leads to a whole array, whose comparison is not one truth value."""
    return ends.to_ros and ends.target.place(path).kind.startswith(("array", "octets"))
