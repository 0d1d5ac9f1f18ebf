"""Checks of one connection: by examples, what is absent, its stop, vectors, lists as wholes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.generation.errors import GenerationError
from jausml.generation.literals import python_literal
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.stops import stop_assignments, stop_text
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import target_paths
from jausml_generators.bridge.checks.check import Chain, Check, equals, holds, store, tidy
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.filling import (
    PRESENT,
    SINGLE,
    Code,
    JausMessage,
    Message,
    Place,
    Scalar,
    ValueTextError,
    has_place,
    has_value,
    is_absent,
    short_name,
)
from jausml_generators.bridge.checks.samples import Sample
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.services_and_actions import ActionView
from jausml_generators.bridge.translation.expressions import TIME
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.python.names import snake_case
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
        compared = [line for path in untouched for line in _as_made(ends, path)]
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


def _as_made(ends: Ends, path: str) -> list[str]:
    """Returns the assertions that a target has its initial value at a path."""
    place = ends.target.place(path)
    return [*has_place(place), equals(place.code, ends.default(path))]


def _is_alternative(message: Message, path: str) -> bool:
    """Tells whether a path is one of several alternatives of a field."""
    return isinstance(message, JausMessage) and message.field(path).index is not None


def _is_array(ends: Ends, path: str) -> bool:
    """Whether a path leads to a whole array, whose comparison is not one truth value."""
    return ends.to_ros and ends.target.place(path).kind.startswith(("array", "octets"))


def absences(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks of the absent policies of a connection."""
    for path, values in _without(ends, sample):
        chains = ends.lacking(values) or ends.reading(path)
        if any(_policy(chain) == "dropMessage" for chain in chains):
            yield _refused(ends, values, path)
            continue
        for chain in chains:
            if path in chain.sources:
                yield from _kept(ends, sample, values, path, chain)


def _without(ends: Ends, sample: Sample) -> Iterator[tuple[str, dict[str, Scalar]]]:
    """Yields the paths at which a source may have no value, and a message that has none there."""
    source = ends.source
    if isinstance(source, JausMessage):
        for path in sample.values:
            if source.field(path).is_optional:
                yield path, sample.without(path)
        return
    for path in dict.fromkeys(
        source_path for chain in ends.chains for source_path in chain.sources
    ):
        for marker in source.markers(path)[:1]:
            replacements = marker.settled(sample.values)
            if replacements is None:
                continue
            values = {**sample.values, **replacements}
            changed = [chain for source_path in replacements for chain in ends.reading(source_path)]
            lacking = ends.lacking(values)
            if all(chain in lacking for chain in changed):
                yield path, values


def _policy(chain: Chain) -> str:
    return str(chain.assignment.whenAbsent.name)


def _refused(ends: Ends, values: dict[str, Scalar], path: str) -> Check:
    lines = [*ends.source.fill(values), *ends.refused("AbsentFieldError")]
    about = f"A message without {path} is refused."
    return Check(f"{ends.name}_needs_{short_name(path)}", about, tuple(lines))


def _kept(
    ends: Ends, sample: Sample, values: dict[str, Scalar], path: str, chain: Chain
) -> Iterator[Check]:
    policy = _policy(chain)
    target = chain.targets[0]
    if not all(map(ends.is_alone, chain.targets)):
        return
    place = ends.target.place(target)
    absent = [*ends.source.fill(values), *ends.translated()]
    if policy in {"unstated", "leave"}:
        outcome = ends.defaults(chain.targets)
        for target_path in chain.targets:
            said = ends.target.unknown(target_path) if policy == "unstated" else ""
            known = ends.target.place(target_path)
            outcome += has_value(known, known.parse(said)) if said else _as_made(ends, target_path)
        about = f"Without {path} {target} is as it is made, or says that it has no value."
    elif policy == "receptionTime":
        changed = holds(f"{place.code} != {ends.default(target)}")
        outcome = [*ends.defaults([target]), changed]
        about = f"Without {path} {target} is the time of reception."
    elif policy == "useDefault" and len(chain.sources) == 1 and len(chain.targets) == 1:
        try:
            value = place.parse(str(chain.assignment.defaultValue or ""))
        except ValueTextError:
            return
        outcome = has_value(place, value)
        about = f"Without {path} {target} takes its default."
    elif policy == "lastValue" and target in sample.expected:
        outcome = has_value(place, sample.expected[target])
        absent = [*ends.source.fill(sample.values), *ends.translated(), *absent]
        about = f"Without {path} {target} keeps its last value."
    else:
        return
    name = f"{ends.name}_{short_name(target)}_without_{short_name(path)}"
    lines = (*absent, *outcome)
    yield Check(name, about, tidy(lines))


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
