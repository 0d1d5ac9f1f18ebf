"""Members of the two sides of a map: what assignments can name, and which mean the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.authoring.proposals.elements import AnswerError
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.frames import Axis, axis_of, direction
from jausml.language.semantics.assignments.units import Measure, attribute_measure
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.attributes import LIST, TIME, TIME_STAMP, Attribute
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import is_many, outer_scope
from jausml.language.semantics.paths.wholes import PathPlace

_DEEPEST = 8


@dataclass(frozen=True)
class Member:
    """A member of one side of a map.

    `outer`: path of the list or array that it lies in; empty for none. `inner`: its path from an
    element of that; the whole path without one.
    """

    is_jaus: bool
    path: str
    outer: str
    inner: str
    attribute: Attribute


def member(map_: bridge.AttributeMap, path: str, *, is_jaus: bool) -> Member:
    """Returns a member of a map.

    `path`: its path as the map view has it: names, without indices.
    """
    if map_.message is None or map_.type is None:
        raise AnswerError("the map has no message or no type yet")
    scope = outer_scope(map_, to_ros=is_jaus)
    place = scope.find_source(path)
    if isinstance(place, JausPlace | RosPlace):
        return Member(is_jaus, path, "", path, place.attribute())
    steps = path.split(".")
    for count in range(1, len(steps) + 1):
        outer = ".".join(steps[:count])
        around = scope.find_source(outer)
        if is_many(around):
            inner = ".".join(steps[count:]) or "."
            leaf = _within(around, inner)
            if leaf is not None:
                return Member(is_jaus, path, outer, inner, leaf.attribute())
            break
    raise AnswerError(f"there is no member {path!r} that can be assigned by itself")


def _within(around: PathPlace, path: str) -> PathPlace | None:
    element = around.element()
    place = element.follow(path) if element is not None else None
    return place if isinstance(place, JausPlace | RosPlace) else None


def leaves(map_: bridge.AttributeMap, *, is_jaus: bool) -> list[Member]:
    """Returns the members of a side that hold values: numbers, texts, times, orientations."""
    if map_.message is None or map_.type is None:
        return []
    scope = outer_scope(map_, to_ros=is_jaus)
    members = []
    for path in _paths(scope.source, "", 0):
        try:
            leaf = member(map_, path, is_jaus=is_jaus)
        except AnswerError:
            continue
        if leaf.attribute.kind:
            members.append(leaf)
    return members


def _paths(place: PathPlace, before: str, depth: int) -> Iterator[str]:
    """Yields the paths of what a place holds, elements of lists included."""
    inner = place.element() if is_many(place) else place
    if inner is None or depth > _DEEPEST:
        return
    if isinstance(inner, JausPlace):
        names = [
            str(inner_member.name) for inner_member in inner.members() or () if inner_member.name
        ]
    else:
        names = [str(field.name) for field in inner.type.fields] if inner.type is not None else []
    for name in names:
        inner_place = inner.step(name)
        if isinstance(inner_place, JausPlace | RosPlace):
            path = f"{before}.{name}" if before else name
            yield path
            yield from _paths(inner_place, path, depth + 1)


_ALIKE = 1.0  # how much a likeness counts; what the paths have in common counts less

_HEADER, _STAMP, _EARLIER = "header", "header.stamp", 0.5
"""The time of a message, and what it counts more than other times in it."""

_TIMES = {TIME_STAMP, TIME}

_PLAIN = frozenset(
    {
        *("x", "y", "z", "roll", "pitch", "yaw", "heading"),
        *("position", "linear", "angular", "rotational", "velocity", "rate", "acceleration"),
        "component",
    }
)
"""Words of a name that unit and axis tell too; others, as in MapCenterX, tell something more."""


@dataclass(frozen=True)
class _Known:
    """The known facts of a member.

    `measure`: its unit, None without a known one.
    """

    member: Member
    name: tuple[str, ...]
    path: frozenset[str]
    axis: Axis | None
    measure: Measure | None

    @property
    def kind(self) -> str:
        """The kind of value that it holds."""
        return self.member.attribute.kind


@dataclass(frozen=True)
class Correspondence:
    """The members of both sides that correspond.

    `pairs`: members that mean the same, in the order of the targets.
    """

    pairs: list[tuple[Member, Member]]
    doubtful: list[tuple[tuple[Member, ...], Member]]


def corresponding(sources: Iterable[Member], targets: Iterable[Member]) -> Correspondence:
    """Returns the members that mean the same.

    An orientation stands in a pair with the angle about z, whose siblings are found from there. A
    member for which several are equally alike stands in none.
    """
    starts, ends = ([_known(side_member) for side_member in side] for side in (sources, targets))
    likeness = [[_likeness(start, end) for start in starts] for end in ends]
    best = [_best(row) for row in likeness]
    back = [_best([row[at] for row in likeness]) for at in range(len(starts))]
    singled = (*_orientation(starts, ends), *_lone(starts, ends))
    meant = {end.member.path: start.member for start, end in singled}
    correspondence = Correspondence([], [])
    for index, end in enumerate(ends):
        at = best[index]
        if end.member.path in meant:
            correspondence.pairs.append((meant[end.member.path], end.member))
        elif at is not None and back[at] == index:
            correspondence.pairs.append((starts[at].member, end.member))
        elif top := max(likeness[index], default=0.0):
            known = zip(starts, likeness[index], strict=True)
            alike = tuple(start.member for start, much in known if much == top)
            correspondence.doubtful.append((alike, end.member))
    return correspondence


def _known(one: Member) -> _Known:
    steps = [tuple(word.lower() for word in words(step)) for step in one.path.split(".")]
    path = frozenset(word for step in steps for word in step)
    return _Known(one, steps[-1], path, axis_of(one.attribute), attribute_measure(one.attribute))


def _best(row: Sequence[float]) -> int | None:
    """Returns where the largest number is, None where it is 0 or stands there twice."""
    top = max(row, default=0.0)
    return row.index(top) if top and row.count(top) == 1 else None


def _likeness(one: _Known, other: _Known) -> float:
    """Returns how much two members are alike, 0 for those that do not mean the same."""
    if bool(one.member.outer) is not bool(other.member.outer) or not _is_same(one, other):
        return 0.0
    is_first = _STAMP in (one.member.path, other.member.path)
    common = len(one.path & other.path) / len(one.path | other.path)
    return _ALIKE + common + (_EARLIER if is_first else 0.0)


def _is_same(one: _Known, other: _Known) -> bool:
    kinds = {one.kind, other.kind}
    if kinds & _TIMES:
        return kinds == _TIMES
    if LIST in kinds or not _is_measured_alike(one, other):
        return False
    if one.axis is not None and other.axis is not None:
        is_known = one.measure is not None and other.measure is not None
        is_plain = _is_plain(one, other) and _is_plain(other, one)
        return is_known and is_plain and _towards(one.axis) == _towards(other.axis)
    return one.name == other.name and len("".join(one.name)) > 1


def _is_plain(one: _Known, other: _Known) -> bool:
    """Tells whether a name adds no word to the unit, axis and path of the other."""
    return _PLAIN.issuperset(set(one.name) - other.path)


def _is_measured_alike(one: _Known, other: _Known) -> bool:
    if one.measure is None or other.measure is None:
        return True
    return one.measure.unit.is_compatible(other.measure.unit)


def _towards(axis: Axis) -> tuple[str, bool]:
    """Returns the direction of an axis, whatever its sign, and whether it is of an angle."""
    return direction(axis)[0], axis.is_angle


def _orientation(
    starts: Sequence[_Known], ends: Sequence[_Known]
) -> Iterator[tuple[_Known, _Known]]:
    """Yields the only orientation and the only angle about z at the other end, in their order."""
    for is_given, wholes, angles in ((True, starts, ends), (False, ends, starts)):
        groups = [list(_turns(wholes, "")), list(_turns(angles, "z"))]
        if [len(group) for group in groups] == [1, 1]:
            [whole], [angle] = groups
            yield (whole, angle) if is_given else (angle, whole)
            return


def _lone(starts: Sequence[_Known], ends: Sequence[_Known]) -> Iterator[tuple[_Known, _Known]]:
    """Yields the only values of both ends besides headers, where they are of one kind."""
    alone = [
        [known_member for known_member in side if not _is_header(known_member)]
        for side in (starts, ends)
    ]
    if [len(group) for group in alone] == [1, 1]:
        [start], [end] = alone
        is_outside = not start.member.outer and not end.member.outer
        is_whole = [known_member.member.attribute.integral for known_member in (start, end)]
        is_like = start.kind == end.kind != LIST and is_whole[0] is is_whole[1]
        if is_outside and is_like and _is_measured_alike(start, end):
            yield start, end


def _is_header(known: _Known) -> bool:
    return known.member.path.partition(".")[0] == _HEADER


def _turns(known: Iterable[_Known], name: str) -> Iterator[_Known]:
    """Yields the angles about an axis, or the orientations without a name; none of lists."""
    for candidate in known:
        axis = None if candidate.member.outer else candidate.axis
        if axis is not None and axis.is_angle and axis.name == name:
            yield candidate
