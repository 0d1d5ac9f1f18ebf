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
from jausml.authoring.proposals.mapping.variances import variance_assignments
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.names import name_of
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.attributes import LIST
from jausml.language.semantics.paths.scopes import parse_path, target_paths

_Path = tuple[str, ...]
"""The steps of a path."""


def assignments_feature(*, to_ros: bool) -> str:
    """Returns the feature of a map that holds its assignments in a direction."""
    return "toRos" if to_ros else "toJaus"


@dataclass(frozen=True, slots=True)
class Filling:
    """The assignments that fill a map.

    `left`: the members that nothing fills then, by `to_ros` and `to_jaus`. `refusal`: why there is
    nothing to do, empty where there is.
    """

    label: str
    commands: tuple[Add, ...]
    statements: tuple[str, ...]
    left: Mapping[str, tuple[str, ...]]
    refusal: str = ""


def fill_map(scope: Scope, map_: bridge.AttributeMap) -> Filling:
    """Returns the assignments for the members of a map that have none yet.

    Directions that no connection uses are left alone, unless none is used.
    """
    label = f"Fill map {name_of(map_)}"
    if map_.message is None or map_.type is None:
        return Filling(label, (), (), {}, "the map has no message or no type yet")
    directions = _directions(scope, map_)
    proposals = propose_assignments(scope, map_, directions)
    with_tables = tabled(map_, proposals.assignments)
    assignments = with_tables.assignments
    known_tables = [(name_of(table), scope.ref(table)) for table in map_.tables]
    new_tables = with_tables.tables
    refusal = "no further members correspond by name, time, or unit and axis"
    return Filling(
        label,
        tuple(additions(scope.ref(map_), new_tables, assignments, known_tables, first=0)),
        tuple(map(statement, assignments)),
        {
            "to_ros" if to_ros else "to_jaus": _left(map_, assignments, to_ros=to_ros)
            for to_ros in directions
        },
        "" if assignments else refusal,
    )


@dataclass(frozen=True, slots=True)
class Proposals:
    """Assignments of the members that nothing fills.

    `doubtful`: targets that several sources are equally alike to, each behind these sources; none
    of them is assigned.
    """

    assignments: tuple[Child, ...]
    doubtful: tuple[tuple[tuple[Member, ...], Member], ...]


def propose_assignments(
    scope: Scope, map_: bridge.AttributeMap, directions: Iterable[bool]
) -> Proposals:
    """Returns the assignments that follow from what the ends of a map say, for some directions.

    `directions`: true to ROS.
    """
    children: list[Child] = []
    doubtful: list[tuple[tuple[Member, ...], Member]] = []
    for to_ros in directions:
        sources, targets = leaves(map_, is_jaus=to_ros), _unfilled(map_, to_ros=to_ros)
        alike = corresponding(sources, targets)
        pairs = alike.pairs or _only_pair(map_, sources, targets, to_ros=to_ros)
        children += _assignments(scope, map_, pairs)
        children += variance_assignments(scope, map_, sources, targets)
        doubtful += alike.doubtful
    judged = judge_together(scope.model.metamodels, map_, children)
    possible = tuple(candidate.assignment for candidate in judged if candidate.is_possible)
    return Proposals(possible, tuple(doubtful))


def _only_pair(
    map_: bridge.AttributeMap, sources: Sequence[Member], targets: Sequence[Member], *, to_ros: bool
) -> list[tuple[Member, Member]]:
    """Returns the members of ends that have one each, both without an assignment."""
    # What a call does is said by its service, and its only field may be another thing.
    if map_.type is not None and isinstance(map_.type.eContainer(), ros.ServiceType):
        return []
    is_alone = len(sources) == len(targets) == len(leaves(map_, is_jaus=not to_ros)) == 1
    return [(sources[0], targets[0])] if is_alone else []


def _directions(scope: Scope, map_: bridge.AttributeMap) -> list[bool]:
    """Returns the directions in which a map is used, both where it is not yet."""
    connections = scope.model.instances(bridge.Connection, library=False)
    directions = {is_to_ros(connection) for connection in connections if connection.map is map_}
    return sorted(directions or {True, False}, reverse=True)


def _unfilled(map_: bridge.AttributeMap, *, to_ros: bool) -> list[Member]:
    """Returns the members of a direction that nothing fills."""
    filled = filled_paths(map_, to_ros=to_ros)
    targets = leaves(map_, is_jaus=not to_ros)
    return [target for target in targets if not is_filled(target.outer or target.path, filled)]


def _assignments(
    scope: Scope, map_: bridge.AttributeMap, pairs: Iterable[tuple[Member, Member]]
) -> list[Child]:
    """Returns the assignments of pairs, those within one list together."""
    assignments: dict[object, Child] = {}
    for source, target in pairs:
        child = _proposed(scope, map_, source, target)
        if child is None:
            continue
        if not source.outer:
            # A later pair whose assignment has the same targets takes the place of an earlier one.
            assignments[child.values["target"]] = child
            continue
        lists = (source.outer, target.outer)
        if lists in assignments:
            child = _joined(assignments[lists], child)
        assignments[lists] = child
    return list(assignments.values())


def _proposed(
    scope: Scope, map_: bridge.AttributeMap, source: Member, target: Member
) -> Child | None:
    """Returns the assignment of a pair that the rules accept without a word; None without any.

    Of several it is the one of the most members, and the first one of these. Those with a number
    that only the author knows are left out.
    """
    children = [
        candidate.assignment for candidate in candidates(scope, map_, source, target).candidates
    ]
    own = [child for child in children if not set(steps(child)) & set(OF_AUTHORS)]
    judged = judge(scope.model.metamodels, map_, own)
    accepted = [candidate.assignment for candidate in judged if candidate.is_accepted]
    return max(accepted, key=_size, default=None)


def _size(child: Child) -> int:
    values = innermost(child).values
    return sum(len(values[name][0].split(", ")) for name in ("source", "target"))


def _joined(first: Child, second: Child) -> Child:
    """Returns an assignment of lists with what two of the same lists have."""
    return Child(first.feature, first.kind, first.values, (*first.children, *second.children))


def filled_paths(map_: bridge.AttributeMap, *, to_ros: bool) -> list[_Path]:
    """Returns the paths that something fills, or that are left out on purpose."""
    assignments = getattr(map_, assignments_feature(to_ros=to_ros))
    return [parse_path(path) for assignment in assignments for path in target_paths(assignment)]


def targets_of(child: Child) -> Iterator[_Path]:
    """Yields the paths that an assignment fills."""
    for path in map(parse_path, child.values["target"][0].split(", ")):
        inner = [assignment for assignment in child.children if assignment.feature == "assignments"]
        yield from ((*path, *own) for assignment in inner for own in targets_of(assignment))
        if not inner:
            yield path


def is_filled(path: str, filled: Iterable[_Path]) -> bool:
    """Tells whether a member, one around it or one in it is filled."""
    member_path = parse_path(path)
    return any(
        filled_path[: len(member_path)] == member_path
        or member_path[: len(filled_path)] == filled_path
        for filled_path in filled
    )


def _left(
    map_: bridge.AttributeMap, assignments: Sequence[Child], *, to_ros: bool
) -> tuple[str, ...]:
    """Returns the members that nothing fills once assignments are added, wholes without parts."""
    feature = assignments_feature(to_ros=to_ros)
    filled = filled_paths(map_, to_ros=to_ros)
    for child in assignments:
        if child.feature == feature:
            filled += targets_of(child)
    left: list[str] = []
    # A whole stands right before its parts.
    for leaf in leaves(map_, is_jaus=not to_ros):
        is_part = bool(left) and leaf.path.startswith(f"{left[-1]}.")
        if leaf.attribute.kind != LIST and not is_part and not is_filled(leaf.path, filled):
            left.append(leaf.path)
    return tuple(left)
