"""Which assignments rules can judge and which only a person can; members that are crossed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.frames import axis_of, passage
from jausml.language.semantics.assignments.ranges import sent_through, source_range
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.assignments.units import Measure, attribute_measure, result_measure
from jausml.language.semantics.conversions import NoValueError
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.names import joined, words
from jausml.language.semantics.paths.attributes import (
    BOOL,
    NUMBER,
    NUMBERS,
    Attribute,
    Part,
    compared,
    is_real,
)
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import (
    Placed,
    attribute_at,
    flattened,
    outer_scope,
    target_paths,
)
from jausml.language.semantics.paths.wholes import FoundPlace


def unknown_targets(map_: bridge.AttributeMap, *, to_ros: bool) -> Iterator[tuple[str, str]]:
    """Yields the targets of a map whose meaning no rule can judge and no test vector expects.

    A vector of one use of a table says what the table means for all.

    Yields:
        Paths of targets, each with what is not known of it.
    """
    vectors = [vector for vector in map_.vectors if is_to_ros(vector) == to_ros]
    expected = [_steps(value.path) for vector in vectors for value in vector.expected if value.path]
    placed = [
        (Placed(entry.assignment, entry.scope), target_paths(entry.assignment))
        for entry in flattened(
            map_.toRos if to_ros else map_.toJaus, outer_scope(map_, to_ros=to_ros)
        )
        if isinstance(entry.assignment, bridge.FieldAssignment)
    ]
    # The path of an element of a list begins with that of the list.
    shown = {
        target
        for assigned, targets in placed
        for target in targets
        for at in (expected_steps.find(_steps(target)) for expected_steps in expected)
        if at == 0 or (at > 0 and assigned.scope.is_nested)
    }
    tables = {
        table for assigned, targets in placed if shown & {*targets} for table in _tables(assigned)
    }
    for assigned, targets in placed:
        lack = lacking(assigned)
        if lack and not (by_table(assigned) and _tables(assigned) <= tables):
            yield from ((target, lack) for target in targets if target not in shown)


def _steps(path: str) -> str:
    return f".{path.strip().replace('[', '.[')}."


def lacking(placed: Placed[bridge.FieldAssignment]) -> str:
    """Returns the reason why rules cannot see a wrong unit, sign or name; empty where they can.

    A number without an axis has no direction where it cannot be negative.
    """
    sources, targets = placed.source_attributes, placed.target_attributes
    if not sources or not targets:
        return "ends that rules can read"
    if by_table(placed) and not _has_names(sources, targets):
        return "names at both ends of its table"
    numbers = [end for end in targets if end.kind in (NUMBER, NUMBERS) and not end.integral]
    known = [*map(attribute_measure, numbers), *([result_measure(placed)] if numbers else [])]
    if not all(isinstance(measured, Measure) for measured in known):
        return "a unit at both ends"
    if _has_axes(placed):
        return "" if _is_followed(placed) else "a sign that is followed"
    is_directed = any(map(_is_directed, numbers)) and all(map(_is_directed, sources))
    return "an axis at both ends" if is_directed or any(map(axis_of, (*sources, *targets))) else ""


def _has_axes(placed: Placed[bridge.FieldAssignment]) -> bool:
    return all(map(axis_of, (*placed.source_attributes, *placed.target_attributes)))


def _is_followed(placed: Placed[bridge.FieldAssignment]) -> bool:
    return passage(steps_of(placed), placed.source_attributes) is not None


_LEAST_ENTRIES = 2  # of fewer none can be exchanged


def by_table(placed: Placed[bridge.FieldAssignment]) -> bool:
    """Tells whether an assignment uses a table of several entries."""
    return any(len(table.entries) >= _LEAST_ENTRIES for table in _tables(placed))


def _tables(placed: Placed[bridge.FieldAssignment]) -> set[bridge.ValueTable]:
    return {step.table for step in placed.assignment.conversions if step.table is not None}


def _has_names(sources: list[Attribute], targets: list[Attribute]) -> bool:
    comparison = compared(sources[0], targets[0]) if len(sources) == len(targets) == 1 else None
    return comparison is not None and comparison.is_of_one_enumeration


_GEODETIC = frozenset({"latitude", "longitude", "altitude"})
"""Coordinates whose signs are north, east and up by their name (WGS 84; rule JML458)."""


def _is_geodetic(attribute: Attribute) -> bool:
    return not _GEODETIC.isdisjoint(word.casefold() for word in words(attribute.label))


def _is_directed(attribute: Attribute) -> bool:
    """Tells whether a number may be negative, with a direction as the meaning of its sign."""
    known, measured = source_range(attribute), attribute_measure(attribute)
    is_temperature = measured is not None and dict(measured.unit.dimension).keys() == {"K"}
    is_free = is_temperature or attribute.kind == BOOL or _is_geodetic(attribute)
    return not is_free and (known is None or known[0] < 0)


def turns_unseen(placed: Placed[bridge.FieldAssignment]) -> bool:
    """Tells whether an assignment changes the sign of a number without known axes."""
    sign = 1
    for step in steps_of(placed):
        if step.conversion.frames or step.sign is None:
            return False
        sign *= step.sign
    if sign > 0:
        return False
    ends = (*placed.source_attributes, *placed.target_attributes)
    is_seen = (_has_axes(placed) and _is_followed(placed)) or any(map(_is_geodetic, ends))
    return not is_seen


def crossed(placed: Placed[bridge.FieldAssignment]) -> tuple[str, str] | None:
    """Returns the namesakes that an assignment of one member to another passes by.

    Returns:
        The member of the target side that is called as the source is, and the one of the source
        side that is called as the target is; None unless there are both, of the same kind. Members
        with axes have rules of their own.
    """
    ends = placed.sources, placed.targets
    if any(len(end) != 1 for end in ends):
        return None
    ((path, source),), ((other, target),) = ends
    if not isinstance(source, Attribute) or not isinstance(target, Attribute):
        return None
    if axis_of(source) or axis_of(target) or _name(path) == _name(other):
        return None
    scope = placed.scope
    there = _namesake(scope.find_target(_owner(other)), _name(path), target)
    here = _namesake(scope.find_source(_owner(path)), _name(other), source)
    return (there, here) if there and here else None


def _owner(path: str) -> str:
    return path.rpartition(".")[0] or "."


def _name(path: str) -> str:
    return joined(path.rpartition(".")[2]).casefold()


def _namesake(owner: FoundPlace, name: str, like: Attribute) -> str:
    """Returns the name of a member that is called so and could stand in the place of another."""
    for member in _members(owner):
        if _name(str(member.name)) == name:
            attribute = attribute_at(_at(owner, str(member.name)))
            same = ("kind", "integral", "units")
            is_alike = isinstance(attribute, Attribute) and all(
                getattr(attribute, feature) == getattr(like, feature) for feature in same
            )
            return str(member.name) if is_alike else ""
    return ""


def _at(owner: FoundPlace, name: str) -> FoundPlace:
    return owner.follow(name) if isinstance(owner, JausPlace | RosPlace) else None


def _members(owner: FoundPlace) -> Iterable[Part]:
    if isinstance(owner, JausPlace):
        return owner.members() or ()
    return owner.type.fields if isinstance(owner, RosPlace) and owner.type is not None else ()


def outcome(
    placed: Placed[bridge.FieldAssignment],
    source_values: Mapping[str, str],
    expected: bridge.VectorValue,
) -> float | None:
    """Returns the result of an assignment for the values of a vector, if it is not as expected.

    Args:
        source_values: Values of the source by path, names of enumerated ones among them.

    Returns:
        None too where a value is no number, is left out, or is limited.
    """
    (source,), (target,) = placed.source_attributes, placed.target_attributes
    texts = source_values.get(str(placed.assignment.source).strip()), expected.value
    ends = [
        dict(end.constants).get(str(text), str(text))
        for end, text in zip((source, target), texts, strict=True)
    ]
    if not all(map(is_real, ends)) or (source.kind, target.kind) != (NUMBER, NUMBER):
        return None
    value, wanted = map(float, ends)
    step = source.step or 0.0
    try:
        # One step of the source to both sides: a vector may state what is rounded on the wire.
        result, *near = (sent_through(placed, value + part * step) for part in (0, -1, 1))
    except (NoValueError, OverflowError, ValueError):
        return None
    loose = (
        max(abs(beside - result) for beside in near)
        + (target.step or 0.0)
        + float(expected.tolerance)
    )
    return result if abs(result - wanted) > loose + _SINGLE * max(1.0, abs(wanted)) else None


_SINGLE = 2.0**-22  # part of a number by which two roundings to single precision may differ
