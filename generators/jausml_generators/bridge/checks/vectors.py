"""Checks by the test vectors of maps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.generation.errors import GenerationError
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.directions import is_to_ros
from jausml_generators.bridge.checks.check import Check, tidy
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.filling import (
    SINGLE,
    Message,
    Scalar,
    ValueTextError,
    has_value,
    is_absent,
)
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.python.names import snake_case

ABSENT, WHOLE = "absent", "."
# Rounding of the sums that turn integers of the wire into values.
_SLACK = 1.0 + 1e-9


def vectors(ends: Ends) -> Iterator[Check]:
    """Yields the test vectors of the map of a connection, for its direction.

    Raises:
        GenerationError: A value of a vector does not fit its attribute.
    """
    for vector in ends.map.vectors:
        if is_to_ros(vector) != ends.to_ros:
            continue
        try:
            yield _check(ends, vector)
        except (PathError, ValueTextError) as error:
            raise GenerationError(
                f"test vector '{vector.name}' of map '{ends.map.name}': {error}"
            ) from error


def _check(ends: Ends, vector: bridge.TestVector) -> Check:
    lines, joined = _joined_inputs(ends, vector)
    lines += [f"bridge.{name} = {value!r}" for name, value in ends.overridden.items()]
    if [vector_value.path for vector_value in vector.expected] == [WHOLE]:
        lines += ends.refused("JausError", join_names=joined)
        return _vector(ends, vector, lines)
    lines += ends.translated(joined)
    if not ends.to_ros:
        lines.append(f"target = {ends.view.target_name}.decode(target.encode())")
    for expected in vector.expected:
        place = ends.target.place(expected.path.strip())
        if expected.value == ABSENT:
            lines += is_absent(place)
            continue
        value = place.parse(str(expected.value))
        lines += has_value(place, value, _tolerance(ends, expected, value))
    return _vector(ends, vector, lines)


def _vector(ends: Ends, vector: bridge.TestVector, lines: Iterable[str]) -> Check:
    about = vector.documentation or f"The test vector {vector.name} of the map {ends.map.name}."
    name = f"{ends.name}_vector_{snake_case(vector.name)}"
    return Check(name, str(about), tidy(lines))


def _joined_inputs(ends: Ends, vector: bridge.TestVector) -> tuple[list[str], list[str]]:
    """The statements that make the source and joined messages, and the names of the latter."""
    values: dict[str, dict[str, Scalar]] = {"": {}}
    messages: dict[str, Message] = {"": ends.source}
    for vector_value in vector.given:
        path = vector_value.path.strip()
        join = ends.join_of(path)
        name = "" if join is None else join.name
        if join is not None:
            path = path.partition(".")[2]
            messages.setdefault(name, ends.joined_message(join))
        if vector_value.value != ABSENT:
            place = messages[name].place(path)
            values.setdefault(name, {})[path] = place.parse(str(vector_value.value))
    lines = [line for name, message in messages.items() for line in message.fill(values[name])]
    return lines, [name for name in messages if name]


def _tolerance(ends: Ends, expected: bridge.VectorValue, value: Scalar) -> float:
    """Returns the stated tolerance, but at least the rounding on the wire."""
    if isinstance(value, str | bytes):
        return 0.0
    place = ends.target.place(expected.path.strip())
    half_step = 0.0 if place.kind == "integer" else place.step / 2 * _SLACK
    if expected.tolerance > 0:
        return max(float(expected.tolerance), half_step)
    on_the_way = [half_step, SINGLE * abs(float(value))]
    for chain in ends.chains:
        if expected.path.strip() in chain.targets:
            steps = [ends.source.place(path).step for path in chain.sources]
            on_the_way.append(max(steps) / 2 * _SLACK)
    return max(on_the_way)
