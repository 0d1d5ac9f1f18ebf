"""Filling: all assignments of a map that follow from what its two ends say of themselves.

Each is one that drawing from member to member would propose first and that the rules accept without
a word, also beside all others of the map. What is left is for the author.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from jausml.authoring.editing.commands import Add, Child
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.mapping.assigning import candidates
from jausml.authoring.proposals.mapping.assignments import OF_AUTHORS, innermost, statement, steps
from jausml.authoring.proposals.mapping.members import Member, corresponding, leaves
from jausml.authoring.proposals.mapping.trial import additions, judge, judge_together, tabled
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.names import name_of
from jausml.language.semantics.assignments.units import Measure, attribute_measure
from jausml.language.semantics.connections.exchanges import TO_ROS
from jausml.language.semantics.conversions.conversion import Conversion
from jausml.language.semantics.conversions.numbers import CovarianceToRms, Square
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.attributes import LIST, NUMBER, NUMBERS
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import outer_scope, parse_path, target_paths

_Steps = tuple[str, ...]

FEATURES = {True: "toRos", False: "toJaus"}
"""The assignments of a map, by whether they go to ROS."""

_DIAGONALS = {9: ((0, 4, 8),), 36: ((0, 7, 14), (21, 28, 35))}
"""The cells of variances along three axes, by the number of cells of a matrix."""

_COVARIANCE, _RMS = "covariance", "rms"


@dataclass(frozen=True, slots=True)
class Filling:
    """What fills a map.

    `left`: the members that nothing fills then, by `to_ros` and `to_jaus`. `refusal`: why there is
    nothing to do, empty where there is.
    """

    label: str
    commands: tuple[Add, ...]
    statements: tuple[str, ...]
    left: Mapping[str, tuple[str, ...]]
    refusal: str = ""


def fill_map(scope: Scope, used: bridge.AttributeMap) -> Filling:
    """Returns what fills the members of a map that nothing fills yet.

    Directions that no connection uses are left alone, unless none is used.
    """
    label = f"Fill map {name_of(used)}"
    if used.message is None or used.type is None:
        return Filling(label, (), (), {}, "the map has no message or no type yet")
    directions = _directions(scope, used)
    tables = tabled(used, found(scope, used, directions).assignments)
    good = tables.assignments
    known = [(name_of(table), scope.ref(table)) for table in used.tables]
    return Filling(
        label,
        tuple(additions(scope.ref(used), tables.tables, good, known, 0)),
        tuple(map(statement, good)),
        {"to_ros" if way else "to_jaus": _left(used, good, to_ros=way) for way in directions},
        "" if good else "no further members correspond by name, time, or unit and axis",
    )


@dataclass(frozen=True, slots=True)
class Found:
    """What was found for the members that nothing fills."""

    assignments: tuple[Child, ...]
    doubtful: tuple[tuple[tuple[Member, ...], Member], ...]


def found(scope: Scope, used: bridge.AttributeMap, directions: Iterable[bool]) -> Found:
    """Returns the assignments that follow from what the ends of a map say, for some directions.

    `directions`: true to ROS.
    """
    children: list[Child] = []
    doubtful: list[tuple[tuple[Member, ...], Member]] = []
    for to_ros in directions:
        sources, targets = leaves(used, is_jaus=to_ros), _unfilled(used, to_ros=to_ros)
        alike = corresponding(sources, targets)
        is_alone = len(sources) == len(targets) == len(leaves(used, is_jaus=not to_ros)) == 1
        # What a call does is said by its service, and its only field may be another thing.
        is_of_call = used.type is not None and isinstance(used.type.eContainer(), ros.ServiceType)
        only = ((sources[0], targets[0]),) if is_alone and not is_of_call else ()
        children += _assignments(scope, used, alike.pairs or only)
        children += variances(scope, used, sources, targets)
        doubtful += alike.doubtful
    judged = judge_together(scope.model.metamodels, used, children)
    good = tuple(candidate.assignment for candidate in judged if candidate.is_possible)
    return Found(good, tuple(doubtful))


def _directions(scope: Scope, used: bridge.AttributeMap) -> list[bool]:
    """Returns the directions in which a map is used, both where it is not yet."""
    connections = scope.model.instances(bridge.Connection, library=False)
    wanted = {
        connection.direction.name == TO_ROS for connection in connections if connection.map is used
    }
    return sorted(wanted or {True, False}, reverse=True)


def _unfilled(used: bridge.AttributeMap, *, to_ros: bool) -> list[Member]:
    """Returns the members of a direction that nothing fills."""
    filled = filled_paths(used, to_ros=to_ros)
    targets = leaves(used, is_jaus=not to_ros)
    return [target for target in targets if not is_filled(target.outer or target.path, filled)]


def _assignments(
    scope: Scope, used: bridge.AttributeMap, pairs: Iterable[tuple[Member, Member]]
) -> list[Child]:
    """Returns the assignments of pairs, those within one list together."""
    made: dict[object, Child] = {}
    for source, target in pairs:
        child = _proposed(scope, used, source, target)
        if child is None:
            continue
        key = (source.outer, target.outer) if source.outer else child.values["target"]
        before = made.get(key)
        made[key] = child if before is None or not source.outer else _joined(before, child)
    return list(made.values())


def _proposed(
    scope: Scope, used: bridge.AttributeMap, source: Member, target: Member
) -> Child | None:
    """Returns the first assignment of the most members that the rules accept without a word.

    Those with a number that only the author knows are left out.
    """
    children = [
        candidate.assignment for candidate in candidates(scope, used, source, target).candidates
    ]
    own = [child for child in children if not set(steps(child)) & set(OF_AUTHORS)]
    judged = judge(scope.model.metamodels, used, own)
    accepted = [candidate.assignment for candidate in judged if candidate.is_accepted]
    return max(accepted, key=_size, default=None)


def _size(child: Child) -> int:
    values = innermost(child).values
    return sum(len(values[name][0].split(", ")) for name in ("source", "target"))


def _joined(one: Child, other: Child) -> Child:
    """Returns an assignment of lists with what two of the same lists have."""
    return Child(one.feature, one.kind, one.values, (*one.children, *other.children))


def filled_paths(used: bridge.AttributeMap, *, to_ros: bool) -> list[_Steps]:
    """Returns the paths that something fills, or that are left out on purpose."""
    assignments = getattr(used, FEATURES[to_ros])
    return [parse_path(path) for assignment in assignments for path in target_paths(assignment)]


def targets_of(child: Child) -> Iterator[_Steps]:
    """Yields the paths that an assignment fills."""
    for path in map(parse_path, child.values["target"][0].split(", ")):
        inner = [assignment for assignment in child.children if assignment.feature == "assignments"]
        yield from ((*path, *own) for assignment in inner for own in targets_of(assignment))
        if not inner:
            yield path


def is_filled(path: str, filled: Iterable[_Steps]) -> bool:
    """Tells whether a member, something around it or something in it is filled."""
    own = parse_path(path)
    return any(
        filled_path[: len(own)] == own or own[: len(filled_path)] == filled_path
        for filled_path in filled
    )


def _left(used: bridge.AttributeMap, good: Sequence[Child], *, to_ros: bool) -> tuple[str, ...]:
    """Returns the members that nothing fills once assignments are added, wholes without parts."""
    filled = filled_paths(used, to_ros=to_ros)
    filled += [
        path for child in good if child.feature == FEATURES[to_ros] for path in targets_of(child)
    ]
    left: list[str] = []
    for leaf in leaves(used, is_jaus=not to_ros):
        is_part = bool(left) and leaf.path.startswith(f"{left[-1]}.")
        if leaf.attribute.kind != LIST and not is_part and not is_filled(leaf.path, filled):
            left.append(leaf.path)
    return tuple(left)


@dataclass(frozen=True)
class _Diagonal:
    """Variances along three axes."""

    paths: tuple[str, ...]
    measure: Measure

    def is_of(self, deviation: Member) -> bool:
        """Tells whether they are squares of a deviation, by their units."""
        own = attribute_measure(deviation.attribute)
        return own is not None and own.unit.squared().is_compatible(self.measure.unit)


def variances(
    scope: Scope, used: bridge.AttributeMap, sources: Iterable[Member], targets: Iterable[Member]
) -> list[Child]:
    """Returns assignments between root mean squares and diagonals, where units leave one each."""
    both = [*sources, *targets]
    deviations = [member for member in both if member.is_jaus and _is_deviation(member)]
    diagonals = [diagonal for one in both if not one.is_jaus for diagonal in _diagonals(used, one)]
    to_ros = any(source.is_jaus for source in sources)
    found: list[Child] = []
    for deviation in deviations:
        [*own] = (diagonal for diagonal in diagonals if diagonal.is_of(deviation))
        if len(own) == 1 and sum(own[0].is_of(member) for member in deviations) == 1:
            found += _diagonal_assignments(deviation, own[0].paths, to_ros=to_ros)
    return [
        candidate.assignment
        for candidate in judge(scope.model.metamodels, used, found)
        if candidate.is_accepted
    ]


def _is_deviation(one: Member) -> bool:
    last = [word.lower() for word in words(one.path.rpartition(".")[2])]
    return not one.outer and one.attribute.kind == NUMBER and last[-1:] == [_RMS]


def _diagonals(used: bridge.AttributeMap, one: Member) -> Iterator[_Diagonal]:
    """Yields the diagonals of a matrix of covariances; none of anything else."""
    is_matrix = one.attribute.kind == NUMBERS and one.path.endswith(_COVARIANCE)
    if one.outer or not is_matrix:
        return
    ends = outer_scope(used, to_ros=one.is_jaus)
    for cells in _DIAGONALS.get(one.attribute.count or 0, ()):
        paths = tuple(f"{one.path}[{cell}]" for cell in cells)
        place = ends.find_source(paths[0])
        measure = attribute_measure(place.attribute()) if isinstance(place, RosPlace) else None
        if measure is not None:
            yield _Diagonal(paths, measure)


def _diagonal_assignments(
    deviation: Member, cells: Sequence[str], *, to_ros: bool
) -> Iterator[Child]:
    kind = "bridge.FieldAssignment"
    if to_ros:
        absent = {"whenAbsent": ("leave",)} if deviation.attribute.optional else {}
        for cell in cells:
            values = {"target": (cell,), "source": (deviation.path,), **absent}
            yield Child("toRos", kind, values, (_conversion(Square),))
        return
    values = {"target": (deviation.path,), "source": (", ".join(cells),)}
    if deviation.attribute.optional:
        values["outOfRange"] = ("dropField",)
    yield Child("toJaus", kind, values, (_conversion(CovarianceToRms),))


def _conversion(known: type[Conversion]) -> Child:
    return Child("conversions", "bridge.Conversion", {"kind": (known.name,)})
