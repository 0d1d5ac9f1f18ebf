"""Assigning: how a member of one side of a map becomes one of the other, as the rules accept it.

The conversions are found by trying: each conversion of the catalogue that takes what the source is
and yields what the target is, with those that may stand before or behind it, is judged by the rules
themselves, so that what is proposed is what `jausml validate` accepts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import AnswerError, Option, Options, Scope
from jausml.authoring.proposals.mapping.assignments import (
    OF_AUTHORS,
    UNKNOWN,
    filling,
    innermost,
    statement,
    steps,
)
from jausml.authoring.proposals.mapping.members import Member, leaves, member
from jausml.authoring.proposals.mapping.trial import Judged, judge, tabled
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.frames import axis_of
from jausml.language.semantics.assignments.units import attribute_measure
from jausml.language.semantics.conversions import (
    CONVERSIONS,
    NEGATION,
    Conversion,
    UnitEffect,
    conversions_between,
)
from jausml.language.semantics.paths.attributes import (
    LIST,
    NUMBER,
    NUMBERS,
    TIME,
    TIME_STAMP,
    compared,
)
from jausml.language.semantics.paths.scopes import is_many, outer_scope

_MOST = 8
_POLICIES: tuple[Mapping[str, str], ...] = (
    {},
    {"whenAbsent": "dropMessage"},
    {"outOfRange": "clamp"},
    {"whenAbsent": "dropMessage", "outOfRange": "clamp"},
)
_OF_INSTANTS: tuple[Mapping[str, str], ...] = ({}, {"whenAbsent": "receptionTime"})
_OF_VARIANCES: tuple[Mapping[str, str], ...] = ({}, {"whenAbsent": "leave"})
_LEVEL: Mapping[str, str] = {"whenAbsent": "useDefault", "defaultValue": "0"}
"""The policy for optional angles that a message leaves out: a heading alone is an orientation."""

_WITHOUT = {
    "useDefault": "an angle that is absent is 0",
    "receptionTime": "without '{}' it is the time of reception",
    "leave": "without '{}' it stays as it is made",
    "dropMessage": "without '{}' the message is dropped",
}
"""Words for the policies of a target without its source."""

_MANY = (LIST, NUMBERS)
_SIMPLE = [conversion for conversion in CONVERSIONS.values() if not conversion.arguments]
_TO_ROS, _TO_JAUS = "toRos", "toJaus"


@dataclass(frozen=True)
class _Draft:
    """An assignment that is to be."""

    sources: tuple[str, ...]
    targets: tuple[str, ...]
    conversions: tuple[str, ...] = ()
    policy: tuple[tuple[str, str], ...] = ()

    def child(self, feature: str) -> Child:
        """Returns the assignment as a part that can be added."""
        values = {
            "target": (", ".join(self.targets),),
            "source": (", ".join(self.sources),),
            **{name: (value,) for name, value in self.policy},
        }
        chain = tuple(map(_conversion, self.conversions))
        return Child(feature, "bridge.FieldAssignment", values, chain)


def assign(scope: Scope, map_: bridge.AttributeMap, source: Member, target: Member) -> Options:
    """Returns the ways to assign a member to one of the other side, the best first."""
    proposals = candidates(scope, map_, source, target)
    if not proposals.candidates:
        return Options(refusal=proposals.refusal)
    options = []
    for index, candidate in enumerate(proposals.candidates):
        table = tabled(map_, [candidate.assignment])
        [assignment] = table.assignments
        ends = proposals.source, proposals.target
        option = Option(
            label=_label(assignment),
            why=_why(candidate, assignment, proposals.plain, *ends),
            preview=statement(assignment),
            commands=filling(scope, map_, assignment, *ends, assignment.feature, table.tables),
            is_best=index == 0 and not set(steps(assignment)) & set(OF_AUTHORS),
        )
        options.append(option)
    return Options(tuple(options))


@dataclass(frozen=True)
class Candidates:
    """The ways to assign a member to one of the other side, or why there is none.

    `candidates`: what can be done, the best first.
    """

    source: Member
    target: Member
    plain: Judged | None = None
    candidates: tuple[Judged, ...] = ()
    refusal: str = ""


def candidates(
    scope: Scope, map_: bridge.AttributeMap, source: Member, target: Member
) -> Candidates:
    """Returns the ways to assign a member to one of the other side, before any table."""
    if source.is_jaus is target.is_jaus:
        refusal = "both are of one side; draw to a member of the other side"
        return Candidates(source, target, refusal=refusal)
    source, target = _in_elements(map_, source, target), _in_elements(map_, target, source)
    if bool(source.outer) is not bool(target.outer):
        inside, outside = (source, target) if source.outer else (target, source)
        refusal = (
            f"'{inside.path}' is of each element of '{inside.outer}', '{outside.path}' is"
            " there once; draw between members of elements, or name one element by its index"
        )
        return Candidates(source, target, refusal=refusal)
    judgements = _best_conversion(scope, map_, source, target)
    refusal = judgements.plain.said or "no conversion leads from one to the other"
    return Candidates(
        source, target, judgements.plain, tuple(_distinct(judgements.good)[:_MOST]), refusal
    )


@dataclass(frozen=True)
class _Found:
    """The candidates for an assignment.

    `good`: what the rules accept; where they accept nothing without a word, what is possible.
    """

    plain: Judged
    good: list[Judged]


def _best_conversion(
    scope: Scope, map_: bridge.AttributeMap, source: Member, target: Member
) -> _Found:
    own = (source.inner,), (target.inner,)
    direct = [_Draft(*own, (), tuple(policy.items())) for policy in _policies(target)]
    judged = _judged(scope, map_, source, target, direct)
    plain, accepted = judged[0], [candidate for candidate in judged if candidate.is_accepted]
    if accepted:
        if source.attribute.kind == NUMBER and _may_be_turned(source, target):
            turned = [_Draft(*own, (NEGATION.name,), tuple(policy.items())) for policy in _POLICIES]
            accepted += _judged(scope, map_, source, target, turned)
        return _Found(plain, [candidate for candidate in accepted if candidate.is_accepted])
    judged += _judged(scope, map_, source, target, list(_drafts(map_, source, target)))
    good = [candidate for candidate in judged if candidate.is_accepted]
    return _Found(plain, good or [candidate for candidate in judged if candidate.is_possible])


def _policies(target: Member) -> tuple[Mapping[str, str], ...]:
    """Returns the policies for values that are absent or do not fit, the least first."""
    if target.attribute.kind in (TIME, TIME_STAMP):
        return _OF_INSTANTS
    return _OF_VARIANCES if "covariance" in target.attribute.label.lower() else _POLICIES


def _may_be_turned(source: Member, target: Member) -> bool:
    """Tells whether a number may have the other sign at its target: the axes are unknown."""
    are_named = compared(source.attribute, target.attribute) is not None
    are_known = axis_of(source.attribute) is not None and axis_of(target.attribute) is not None
    return not (are_named or are_known)


def _in_elements(map_: bridge.AttributeMap, one: Member, other: Member) -> Member:
    """Returns the elements of a list or array, where the other end is a list or lies in one."""
    if one.attribute.kind not in _MANY or one.outer:
        return one
    if not other.outer and other.attribute.kind not in _MANY:
        return one
    place = outer_scope(map_, to_ros=one.is_jaus).find_source(one.path)
    element = place.element() if is_many(place) else None
    if element is None:
        return one
    return replace(one, outer=one.path, inner=".", attribute=element.attribute())


def _judged(
    scope: Scope,
    map_: bridge.AttributeMap,
    source: Member,
    target: Member,
    drafts: Sequence[_Draft],
) -> list[Judged]:
    """Judges drafts in their places, within a list if their members are in one."""
    feature = _TO_ROS if source.is_jaus else _TO_JAUS
    children = [
        _in_list(draft, source, target, feature) if source.outer else draft.child(feature)
        for draft in drafts
    ]
    return judge(scope.model.metamodels, map_, children)


def _in_list(draft: _Draft, source: Member, target: Member, feature: str) -> Child:
    values = {"target": (target.outer,), "source": (source.outer,)}
    return Child(feature, "bridge.ListAssignment", values, (draft.child("assignments"),))


def _drafts(map_: bridge.AttributeMap, source: Member, target: Member) -> Iterator[_Draft]:
    """Yields the assignments that may be right with conversions, the simplest first."""
    own = (source.inner,), (target.inner,)
    for chain, policy in product(_chains(source, target), _policies(target)):
        yield _Draft(*own, tuple(step.name for step in chain), tuple(policy.items()))
    for conversion in _SIMPLE:
        for sources, targets in _with_siblings(map_, source, target, conversion):
            is_angle = bool(conversion.takes_axes) and source.attribute.optional
            for policy in (_LEVEL, *_POLICIES) if is_angle else _POLICIES:
                yield _Draft(sources, targets, (conversion.name,), tuple(policy.items()))


def _chains(source: Member, target: Member) -> Iterator[tuple[Conversion, ...]]:
    """Yields the chains of conversions from the kind of the source to one value.

    What is known of the unit of both ends shall not be lost on the way.
    """
    own, other = (attribute_measure(end.attribute) for end in (source, target))
    of_authors = [CONVERSIONS[author] for author in OF_AUTHORS]
    is_of_ratios = any(measure is None or not measure.unit.dimension for measure in (own, other))
    chains: list[tuple[Conversion, ...]] = [(conversion,) for conversion in _SIMPLE]
    chains += [pair for pair in product(_SIMPLE, _SIMPLE) if _may_follow(*pair)]
    for chain in chains:
        forgets = any(conversion.units is UnitEffect.ANY for conversion in chain)
        fitting = chain[0].takes([source.attribute.kind]) and len(chain[-1].outputs) == 1
        if fitting and not (forgets and own is not None and other is not None):
            yield chain
    if source.attribute.kind == target.attribute.kind == NUMBER and is_of_ratios:
        yield from ((author,) for author in of_authors)
        yield from ((NEGATION, author) for author in of_authors)


def _may_follow(first: Conversion, second: Conversion) -> bool:
    """Tells whether two conversions in a row may have a meaning: a sign, and another one."""
    if (first is NEGATION) is (second is NEGATION):
        return False
    fitting = second.takes(list(first.outputs))
    return fitting and not (_is_last_choice(first) or _is_last_choice(second))


def _is_last_choice(conversion: Conversion) -> bool:
    """Tells whether a conversion changes a quantity or order that would fit without it."""
    units = conversion.units
    if units in (UnitEffect.SQUARE, UnitEffect.ROOT):
        return True
    is_same = units is UnitEffect.SAME or (isinstance(units, tuple) and units[0] == units[1])
    return is_same and not conversion.frames and conversion is not NEGATION


def _with_siblings(
    map_: bridge.AttributeMap, source: Member, target: Member, conversion: Conversion
) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Yields ends of a conversion of several values, such as three angles to an orientation."""
    several = len(conversion.inputs) > 1, len(conversion.outputs) > 1
    if not any(several) or source.outer:
        return
    sources = _along(map_, source, conversion.takes_axes) if several[0] else (source.inner,)
    targets = _along(map_, target, conversion.gives_axes) if several[1] else (target.inner,)
    if len(sources) == len(conversion.inputs) and len(targets) == len(conversion.outputs):
        yield sources, targets


def _along(map_: bridge.AttributeMap, one: Member, axes: Sequence[str]) -> tuple[str, ...]:
    """Returns the angles about some axes beside a member; none if one is missing."""
    before, dot, _ = one.inner.rpartition(".")
    place = outer_scope(map_, to_ros=one.is_jaus).find_source(before or ".")
    names = [
        str(sibling.name) for sibling in getattr(place, "members", list)() or () if sibling.name
    ]
    paths_by_axis: dict[str, str] = {}
    for name in names:
        path = f"{before}{dot}{name}"
        try:
            axis = axis_of(member(map_, path, is_jaus=one.is_jaus).attribute)
        except AnswerError:
            continue
        if axis is not None and axis.is_angle and axis.name:
            paths_by_axis.setdefault(axis.name, path)
    paths = tuple(paths_by_axis[axis_name] for axis_name in axes if axis_name in paths_by_axis)
    return paths if len(paths) == len(axes) and one.inner in paths else ()


def _distinct(judgements: Iterable[Judged]) -> list[Judged]:
    """Returns one candidate with one policy for each chain of conversions, plain ones first."""
    kept: dict[tuple[object, ...], Judged] = {}
    for candidate in judgements:
        kept.setdefault(
            (steps(candidate.assignment), statement(candidate.assignment).count(",")), candidate
        )
    return sorted(kept.values(), key=_effort)


def _effort(judged: Judged) -> tuple[int, int]:
    own = steps(judged.assignment)
    odd = sum(_is_last_choice(CONVERSIONS[step]) for step in own)
    return odd + 2 * sum(step in OF_AUTHORS for step in own), len(own)


def _label(assignment: Child) -> str:
    return ", then ".join(steps(assignment)) or "as it is"


def _why(
    judged: Judged, assignment: Child, plain: Judged | None, source: Member, target: Member
) -> str:
    """Returns why an assignment is as it is."""
    names = steps(assignment)
    is_other = plain is not None and plain.said and judged is not plain
    reasons = [plain.said.partition("; ")[0]] if plain is not None and is_other else []
    if names != steps(judged.assignment):
        reasons.append(f"'{source.path}' and '{target.path}' number what they name alike otherwise")
    reasons += [f"{name}: {CONVERSIONS[name].documentation}" for name in names]
    own, other = (attribute_measure(end.attribute) for end in (source, target))
    if not names and own is not None and other is not None:
        if own.unit != other.unit:
            reasons.append(f"{own.text} becomes {other.text} without being asked")
        else:
            reasons.append(f"both are in {other.text}, along the same axis")
    if any(name in OF_AUTHORS for name in names):
        reasons.append(f"write the number of your vehicle in the place of {UNKNOWN}")
    inner = innermost(judged.assignment)
    [absent] = inner.values.get("whenAbsent", ("",))
    if absent:
        reasons.append(_WITHOUT[absent].format(source.path))
    if "outOfRange" in inner.values:
        reasons.append(f"what '{target.path}' cannot carry is moved to the end of its range")
    if not judged.is_accepted:
        reasons.append(judged.said)
    return "; ".join(dict.fromkeys(reasons)) or "both are alike"


def _conversion(name: str) -> Child:
    values: dict[str, tuple[str, ...]] = {"kind": (name,)}
    if name in OF_AUTHORS:
        values["arguments"] = (UNKNOWN,)
    return Child("conversions", "bridge.Conversion", values)


def partners(scope: Scope, map_: bridge.AttributeMap, source: Member) -> list[tuple[Member, str]]:
    """Returns the members of the other side to which a member may be assigned, with how."""
    others = [
        leaf
        for leaf in leaves(map_, is_jaus=not source.is_jaus)
        if bool(leaf.outer) is bool(source.outer)
    ]
    own, feature = source.inner, _TO_ROS if source.is_jaus else _TO_JAUS
    plain = [
        _in_list(draft, source, other, feature) if source.outer else draft.child(feature)
        for other in others
        for draft in [_Draft((own,), (other.inner,))]
    ]
    pairs = []
    for partner, judged in zip(others, judge(scope.model.metamodels, map_, plain), strict=True):
        if judged.is_possible:
            pairs.append((partner, "as it is"))
        elif conversions_between([source.attribute.kind], partner.attribute.kind) and _may_become(
            source, partner
        ):
            pairs.append((partner, "by a conversion"))
    return sorted(pairs, key=lambda pair: pair[1])


def _may_become(source: Member, target: Member) -> bool:
    """Tells whether the units of two members allow an assignment."""
    own, other = (attribute_measure(end.attribute) for end in (source, target))
    return own is None or other is None or own.unit.is_compatible(other.unit)
