"""Assignments of wholes: a record onto a message, an array onto an array, member by member.

Whoever walks over assignments sees those of the members in the place of such a one. They are no
part of the model: their owner does not know of them, and they know which assignment was written.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind, load_metamodels
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.filling import hang, new_object, point, set_value
from jausml.language.semantics.names import snake_case
from jausml.language.semantics.paths.attributes import PathFault
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace, ros_name

if TYPE_CHECKING:
    from typing_extensions import TypeIs

    from jausml.language.metamodel.classes.ecore import EObject

PathPlace = JausPlace | RosPlace
FoundPlace = PathPlace | PathFault | None
"""Where a path leads."""

_WRITTEN = "written_assignment"

Pair = tuple[str, str]
"""Paths of a source and a target that belong together."""


class ShapeError(ValueError):
    """Two wholes do not correspond; the message says why."""


def parts_of(
    assignment: bridge.FieldAssignment, source: FoundPlace, target: FoundPlace
) -> list[bridge.Assignment] | None:
    """Returns the assignments of the members for one of wholes; None for one of a value.

    Args:
        source: The place of its only source.
        target: The place of its only target.

    Raises:
        ShapeError: Both are wholes that do not correspond: members by their names, elements by
            their positions.
    """
    if assignment.conversions or not (_is_place(source) and _is_place(target)):
        return None
    paths = str(assignment.source).strip(), str(assignment.target).strip()
    if _is_many(source) and _is_many(target):
        _hold_counts(source, target)
        whole = _copy(assignment, bridge.ListAssignment, paths)
        elements = source.element(), target.element()
        # A list of records of one value corresponds to an array of such values.
        ends = _value_in(elements[0], elements[1]), _value_in(elements[1], elements[0])
        inner = _copy(assignment, bridge.FieldAssignment, ends, whole)
        # Not linked: elements of the model must not learn of what only stands for others.
        point(whole, load_metamodels().class_of(whole).features["assignments"], inner)
        return [whole]
    members = _members(source), _members(target)
    if members[0] is None or members[1] is None:
        return None
    return [
        _copy(assignment, bridge.FieldAssignment, (_below(paths[0], one), _below(paths[1], other)))
        for one, other in _pairs(members[0], members[1], (_name(source), _name(target)))
    ]


def written(element: EObject) -> EObject:
    """Returns the written assignment of one of a member; else the element itself."""
    assignment: EObject = element.__dict__.get(_WRITTEN, element)
    return assignment


def _is_place(place: FoundPlace) -> TypeIs[PathPlace]:
    return isinstance(place, JausPlace | RosPlace)


def _is_many(place: PathPlace) -> bool:
    if isinstance(place, RosPlace):
        return place.is_array
    return isinstance(place.field, jaus.List | jaus.Array)


def _value_in(element: PathPlace | None, other: PathPlace | None) -> str:
    """Returns the path of the value in an element: lists of JAUS hold records, if only of one."""
    members: dict[str, str] = (_members(element) if element is not None else None) or {}
    is_value = other is not None and _members(other) is None
    return next(iter(members.values())) if is_value and len(members) == 1 else "."


def _hold_counts(source: PathPlace, target: PathPlace) -> None:
    fixed = [_fixed_count(place) for place in (source, target)]
    if fixed[0] != fixed[1]:
        counts = ["any number of" if count is None else count for count in fixed]
        message = f"{_name(source)} has {counts[0]} elements, {_name(target)} has {counts[1]}"
        raise ShapeError(message)


def _fixed_count(place: PathPlace) -> int | None:
    """Returns how many elements there always are; None where their number varies."""
    if isinstance(place.field, jaus.List):
        least, most = place.field.minimumCount, place.field.maximumCount
        return most if most and least == most else None
    return place.attribute().count


def _members(place: PathPlace) -> dict[str, str] | None:
    """Returns the names of members by what they are called on both sides; None without any."""
    if isinstance(place, RosPlace):
        if place.type is None:
            return None
        return {snake_case(str(field.name)): str(field.name) for field in place.type.fields}
    if isinstance(place.field, jaus.Record | jaus.Sequence) or place.message is not None:
        return {snake_case(str(member.name)): str(member.name) for member in place.members() or ()}
    return None


def _pairs(
    source: dict[str, str], target: dict[str, str], names: tuple[str, str]
) -> Iterator[Pair]:
    lacking = [(name, *names) for key, name in source.items() if key not in target]
    lacking += [(name, *names[::-1]) for key, name in target.items() if key not in source]
    for name, here, there in lacking:
        raise ShapeError(f"'{name}' of {here} has no counterpart in {there}")
    for key, name in target.items():
        yield source[key], name


def _below(path: str, name: str) -> str:
    return name if path == "." else f"/{name}" if path == "/" else f"{path}.{name}"


def _name(place: PathPlace) -> str:
    if isinstance(place, RosPlace) and place.type is not None:
        return ros_name(place.type)
    return place.attribute().name if not place.label else f"'{place.label}'"


def _copy(
    assignment: bridge.FieldAssignment,
    kind: type[bridge.FieldAssignment | bridge.ListAssignment],
    paths: Pair,
    owner: bridge.Assignment | None = None,
) -> bridge.Assignment:
    """Returns an assignment of other paths, with the policies and the owner of one."""
    tables = load_metamodels()
    table, own = tables.class_of(kind), tables.class_of(assignment)
    copy: bridge.Assignment = new_object(table)
    for name, feature in own.features.items():
        is_policy = feature.kind is FeatureKind.ATTRIBUTE and not feature.many
        if is_policy and name in table.features and name in assignment.__dict__:
            set_value(copy, table.features[name], getattr(assignment, name))
    for name, path in zip(("source", "target"), paths, strict=True):
        set_value(copy, table.features[name], path)
    # Beside the features, where no writer and no comparison sees it.
    copy.__dict__[_WRITTEN] = written(assignment)
    around = assignment.eContainer() if owner is None else owner
    if around is not None:
        holder = "assignments" if owner is not None else assignment.eContainmentFeature().name
        hang(around, tables.class_of(around).features[holder], copy)
    return copy
