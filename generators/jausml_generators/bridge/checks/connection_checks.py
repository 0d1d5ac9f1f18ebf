"""Checks of one connection that need no more than a sample of its messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.generation.literals import python_literal
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.stops import stop_assignments, stop_text
from jausml.language.semantics.paths.scopes import target_paths
from jausml_generators.bridge.checks.check import Check, equals, holds, store, tidy
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.filling import (
    PRESENT,
    Code,
    JausMessage,
    Message,
    Place,
    Scalar,
    ValueTextError,
    has_value,
)
from jausml_generators.bridge.checks.samples import Sample
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.services_and_actions import ActionView
from jausml_generators.bridge.translation.expressions import TIME
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.python.statements import call


def examples(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks by example of a connection."""
    view = ends.view
    begin = [*ends.source.fill(sample.values), *ends.translated()]
    lines = list(begin)
    for path, value in sample.expected.items():
        lines += has_value(ends.target.place(path), value)
    for path in sample.changed:
        place = ends.target.place(path)
        lines.append(holds(f"{place.code} != {ends.default(path)}"))
        # A TimeStamp as it is made is a whole second, which the time of reception is not.
        if place.kind == TIME and PRESENT in sample.values.values():
            lines.append(holds(f"{place.code}.nanosec == 0"))
    if not ends.to_ros:
        lines += [
            f"decoded = {view.target_name}.decode(target.encode())",
            f"assert isinstance(decoded, {view.target_name})",
        ]
    about = f"{view.source_name} becomes {view.target_name}."
    yield Check(ends.name, about, tidy(lines))
    untouched = list(_untouched(ends))
    if untouched:
        compared = [line for path in untouched for line in ends.as_made(path)]
        yield Check(
            f"{ends.name}_leaves_ignored_members_alone",
            f"What the map ignores in {view.target_name} stays as it is made.",
            tidy([*begin, *ends.defaults(untouched), *compared]),
        )


def _untouched(ends: Ends) -> Iterator[str]:
    """The ignored paths at which something stands that can be compared."""
    for assignment in ends.assignments:
        path = assignment.target.strip()
        if not isinstance(assignment, bridge.Ignore):
            continue
        if ends.written.overlapping(path) or ends.target.is_told_unset(path):
            continue
        try:
            is_there = ends.is_made(path) and not _is_alternative(ends.target, path)
        except PathError:
            continue
        if is_there and not _is_array(ends, path):
            yield path


def _is_alternative(message: Message, path: str) -> bool:
    """Tells whether a path is one of several alternatives of a field."""
    return isinstance(message, JausMessage) and message.field(path).index is not None


def _is_array(ends: Ends, path: str) -> bool:
    """Whether a path leads to a whole array, whose comparison is not one truth value."""
    return ends.to_ros and ends.target.place(path).kind.startswith(("array", "octets"))


def safe_values(ends: Ends) -> Iterator[Check]:
    """Yields the check of the value that a connection sends when its source is lost.

    The whole message is compared: what the model leaves out stays as it is made.
    """
    view = ends.view
    if not view.has_safe_value:
        return
    expected = ends.message("expected", is_ros=ends.to_ros)
    whole = "" if ends.to_ros else ".encode()"
    text = stop_text(view.connection)
    yield Check(
        f"{ends.name}_safe_value",
        f"What is sent when the source is lost is what the model says: {text}.",
        (
            store("target", f"bridge.safe_{ends.name}()"),
            f"assert isinstance(target, {view.target_name})",
            *expected.fill(_values(ends)),
            equals(f"target{whole}", f"expected{whole}"),
        ),
    )


def _values(ends: Ends) -> dict[str, Scalar]:
    return {
        path: _value(assignment, ends.target.place(path))
        for assignment in stop_assignments(ends.view.connection)
        for path in target_paths(assignment)
    }


def _value(assignment: bridge.Assignment, place: Place) -> Scalar:
    """Returns the constant; for the clock or a value without text, the actual value."""
    taken = Code(place.code)
    if not isinstance(assignment, bridge.ConstantAssignment):
        return taken
    try:
        return place.parse(str(assignment.value))
    except ValueTextError:
        return taken


def forms(ends: Ends, sample: Sample | None) -> Check:
    """Returns the check of a connection, for a message as it is made and for a sample.

    Args:
        sample: A source message that passes, if one is known.
    """
    compared = equals(
        call(
            "differing_forms",
            "bridge",
            f"bridge.translate_{ends.name}",
            f"bridge.{ends.name}",
            "source",
            *ends.join_arguments(),
        ),
        "[]",
    )
    lines = [*ends.joined(), *ends.source.fill({}), compared]
    if sample is not None and sample.values:
        lines += [*ends.source.fill(sample.values), compared]
    about = "Python, element by element and as a whole, compiled code and rclpy agree."
    return Check(f"{ends.name}_has_the_same_bytes_in_each_form", about, tuple(lines))


def times(views: Iterable[ConnectionView]) -> Iterator[Check]:
    """Yields the check of how often connections ask, and how long they wait, where they do."""
    lines = []
    for view in views:
        if isinstance(view, ActionView):
            continue
        if view.rate is not None:
            lines.append(equals(f"bridge.{view.name}.rate", python_literal(view.rate)))
        if view.longest_silence > 0:
            seconds = python_literal(view.longest_silence)
            lines.append(equals(f"bridge.{view.name}.silence_timeout", seconds))
    if lines:
        yield Check("times", "Rates and times of silence are those of the model.", tuple(lines))
