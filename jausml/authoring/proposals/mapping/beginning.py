"""New maps: what corresponds, what the author says besides, and what is open then.

Where a choice is the author's, it is a doubt: whoever asks answers it in the words of
`jausml.authoring.proposals.mapping.beginning`, and begins the map once more.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from jausml.authoring.editing.commands import NEW, Add, Child
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.mapping.assigning import Candidates, candidates
from jausml.authoring.proposals.mapping.assignments import innermost, statement
from jausml.authoring.proposals.mapping.filling import assignments_feature, propose_assignments
from jausml.authoring.proposals.mapping.members import Member, member
from jausml.authoring.proposals.mapping.opens import (
    completed,
    opens,
    stops_by_zeros,
    unfilled,
    zeros,
)
from jausml.authoring.proposals.mapping.trial import (
    additions,
    findings,
    fresh_map,
    judge,
    table_of,
    tabled,
    with_assignments,
)
from jausml.authoring.proposals.new_elements import OpenPoint, blocking, open_decisions
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.values import suggest
from jausml.language.semantics.conversions import CONVERSIONS

_MOST = 6  # how many choices a line names

Words = tuple[tuple[str, str], ...]
"""Targets, each with what fills it."""

_FIELD = "bridge.FieldAssignment"

_SOURCELESS = {"clock": "bridge.ClockAssignment", "ignore": "bridge.Ignore"}

_CONSTANT = re.compile(r'"(?P<text>.*)"|(?P<plain>[-+]?\.?\d[^\s,:]*|true|false)', re.DOTALL)

_CALL = re.compile(r"(?P<name>\w+)\s*(?:\((?P<arguments>[^()]*)\))?\s*")


@dataclass(frozen=True)
class Wish:
    """The wanted map.

    `ways`: the directions: True to ROS. One of which nothing is known stays empty. `taken`: what
    was taken for the author without being asked for, in words.
    """

    name: str
    message: jaus.MessageDef
    type: ros.MessageType
    to_ros: Words = ()
    to_jaus: Words = ()
    ways: tuple[bool, ...] = (True, False)
    taken: tuple[str, ...] = ()
    zeros_stop: bool = False

    def said(self, *, to_ros: bool) -> Words:
        """Returns the author's assignments of a direction."""
        return self.to_ros if to_ros else self.to_jaus

    def with_answer(self, doubt: Doubt, words: str) -> Wish:
        """Returns the wish with the answer to a doubt, in the place of what was said before."""
        kept = tuple(pair for pair in self.said(to_ros=doubt.to_ros) if pair[0] != doubt.target)
        said = (*kept, (doubt.target, words))
        return replace(self, to_ros=said) if doubt.to_ros else replace(self, to_jaus=said)

    def with_first(self, doubt: Doubt) -> Wish:
        """Returns the wish with the first choice of a doubt, of which the map then tells."""
        first, count = doubt.choices[0], len(doubt.choices)
        choice = f"{doubt.target} takes {shown(first)}, the first of {count} that fit"
        return replace(self.with_answer(doubt, first), taken=(*self.taken, choice))


@dataclass(frozen=True)
class Doubt:
    """A target for which more than one thing fits.

    `choices`: what fits, in words, the likeliest first.
    """

    to_ros: bool
    target: str
    choices: tuple[str, ...]


@dataclass(frozen=True)
class Begun:
    """A new map.

    Attributes:
        statements: Its assignments in the text notation, by direction: True to ROS.
        doubts: Where more than one thing fits; nothing fills these targets yet, or the first.
        stops_by_zeros: The directions in which zeros may be what stops it: True to ROS.
    """

    add: Add
    tables: tuple[Add, ...]
    statements: Mapping[bool, tuple[str, ...]]
    opens: tuple[OpenPoint, ...]
    doubts: tuple[Doubt, ...]
    findings: tuple[str, ...]
    stops_by_zeros: tuple[bool, ...]


def begin_map(scope: Scope, owner: bridge.Bridge, wish: Wish) -> Begun:
    """Returns a new map with the assignments that follow from its ends and the author's wish.

    `AnswerError`: what the author says is forbidden by a rule, or names nothing.
    """
    metamodels = scope.model.metamodels
    new_map = fresh_map(metamodels, wish.name, wish.message, wish.type)
    tables: list[Child] = []
    children: list[Child] = []
    doubts: list[Doubt] = []

    def take(more: Iterable[Child]) -> None:
        tabled_children = tabled(new_map, more)
        tables.extend(tabled_children.tables)
        children.extend(tabled_children.assignments)
        with_assignments(
            metamodels, new_map, (*tabled_children.tables, *tabled_children.assignments)
        )

    for way in wish.ways:
        take(_said(scope, new_map, wish, doubts, to_ros=way))
    proposals = propose_assignments(scope, new_map, wish.ways)
    take(proposals.assignments)
    found_of = [way for way in wish.ways if _directed(children, to_ros=way)]
    begun = found_of or list(wish.ways)
    for way in begun:
        take(completed(scope, new_map, to_ros=way, ignores=way in found_of))
    doubts += _alike(proposals.doubtful, begun)
    doubts += _of_values(new_map, found_of)
    by_zeros = stops_by_zeros(new_map, found_of)
    for way in by_zeros if wish.zeros_stop else ():
        take([zeros(_directed(children, to_ros=way), to_ros=way)])
    left = (
        *opens(new_map, children, begun),
        *map(blocking, wish.taken),
        *_as_opens(new_map, doubts),
    )
    by_tables = [child for child in children if any(map(table_of, child.children))]
    plain = [child for child in children if child not in by_tables]
    values = {
        "name": (wish.name,),
        "message": (scope.ref(wish.message),),
        "type": (scope.ref(wish.type),),
    }
    return Begun(
        Add(
            scope.ref(owner), "maps", "bridge.AttributeMap", values, (*open_decisions(left), *plain)
        ),
        tuple(additions(f"{NEW}0", tables, by_tables, (), 1)),
        {
            way: tuple(map(statement, own))
            for way in begun
            if (own := _directed(children, to_ros=way))
        },
        left,
        tuple(doubts),
        tuple(f"{rule.id} {finding.message}" for rule, finding in findings(metamodels, new_map)),
        tuple(by_zeros),
    )


def _directed(children: Iterable[Child], *, to_ros: bool) -> list[Child]:
    """Returns the assignments of a direction."""
    feature = assignments_feature(to_ros=to_ros)
    return [child for child in children if child.feature == feature]


def _as_opens(map_: bridge.AttributeMap, doubts: Collection[Doubt]) -> Iterator[OpenPoint]:
    """Yields the decisions of doubts; a rule reports those of required fields by itself."""
    left = unfilled(map_, to_ros=False) if doubts else ()
    required = {field.path for field in left if field.is_required}
    for doubt in doubts:
        text = f"{doubt.target} may come from {' or '.join(map(shown, doubt.choices[:_MOST]))}"
        is_reported = not doubt.to_ros and doubt.target in required
        yield OpenPoint(text, "JML416") if is_reported else blocking(text)


def _said(
    scope: Scope, map_: bridge.AttributeMap, wish: Wish, doubts: list[Doubt], *, to_ros: bool
) -> Iterator[Child]:
    """Yields the author's assignments of a direction; another possible meaning becomes a doubt."""
    for target, source in wish.said(to_ros=to_ros):
        assignments = assignments_of(scope, map_, target, source, to_ros=to_ros)
        if len(assignments) > 1:
            doubts.append(Doubt(to_ros, target, tuple(map(words_of, assignments))))
        yield assignments[0]


def _alike(
    doubtful: Iterable[tuple[tuple[Member, ...], Member]], directions: Collection[bool]
) -> Iterator[Doubt]:
    """Yields the targets to which several sources are equally alike, and none that is in a list."""
    for sources, target in doubtful:
        if not target.outer and (not target.is_jaus) in directions:
            yield Doubt(not target.is_jaus, target.path, tuple(source.path for source in sources))


def _of_values(map_: bridge.AttributeMap, directions: Collection[bool]) -> Iterator[Doubt]:
    """Yields the unfilled fields that the message always has and whose values have names."""
    for field in unfilled(map_, to_ros=False) if False in directions else ():
        names = field.leaves[0].attribute.constants if field.leaves[0].path == field.path else ()
        if field.is_required and names:
            yield Doubt(
                to_ros=False, target=field.path, choices=tuple(f'"{name}"' for name, _ in names)
            )


def assignments_of(
    scope: Scope, map_: bridge.AttributeMap, target: str, source: str, *, to_ros: bool
) -> list[Child]:
    """Returns the ways to fill a target as words say, the likeliest first."""
    feature = "toRos" if to_ros else "toJaus"
    path, colon, chain = (part.strip() for part in source.partition(":"))
    if not colon and (plain := _sourceless(feature, target, source)) is not None:
        return [_allowed(scope, map_, plain)]
    proposals = _directions(scope, map_, target, path.partition(",")[0], to_ros=to_ros)
    known = (
        [] if proposals is None else [candidate.assignment for candidate in proposals.candidates]
    )
    if not colon and "," not in path:
        if proposals is not None and not known:
            raise AnswerError(f"{source} -> {target}: {proposals.refusal}")
        if known:
            return known
    values = {"target": (target,), "source": (path,)}
    child = Child(feature, _FIELD, values, _conversions(chain))
    alike = (candidate for candidate in known if words_of(candidate) == words_of(child))
    return [next(alike, None) or _allowed(scope, map_, child)]


def words_of(child: Child) -> str:
    """Returns the words by which `assignments_of` gives an assignment of a field again."""
    inner = innermost(child)
    calls = []
    for step in inner.children:
        name, arguments = step.values["kind"][0], step.values.get("arguments", ())
        calls.append(f"{name}({', '.join(arguments)})" if arguments else name)
    return f"{inner.values['source'][0]} : {', '.join(calls)}".rstrip()


def _sourceless(feature: str, target: str, source: str) -> Child | None:
    """Returns an assignment without a source, None where the words name one."""
    values: dict[str, tuple[str, ...]] = {"target": (target,)}
    if source in _SOURCELESS:
        return Child(feature, _SOURCELESS[source], values)
    if constant := _CONSTANT.fullmatch(source):
        text = constant["plain"] if constant["text"] is None else constant["text"]
        return Child(feature, "bridge.ConstantAssignment", {**values, "value": (text,)})
    return None


def _directions(
    scope: Scope, map_: bridge.AttributeMap, target: str, source: str, *, to_ros: bool
) -> Candidates | None:
    """Returns the ways from member to member; None for paths with an index."""
    try:
        start = member(map_, source, is_jaus=to_ros)
        end = member(map_, target.partition(",")[0], is_jaus=not to_ros)
    except AnswerError:
        return None
    return candidates(scope, map_, start, end)


def _conversions(text: str) -> tuple[Child, ...]:
    conversions: list[Child] = []
    rest = text.strip()
    while rest:
        call = _CALL.match(rest)
        if call is None or call["name"] not in CONVERSIONS:
            name = call["name"] if call else rest
            hint = suggest(name, CONVERSIONS)
            raise AnswerError(f"there is no conversion {name!r}{f'; {hint}' if hint else ''}")
        values: dict[str, tuple[str, ...]] = {"kind": (call["name"],)}
        if arguments := tuple(word.strip() for word in (call["arguments"] or "").split(",")):
            values |= {"arguments": arguments} if any(arguments) else {}
        conversions.append(Child("conversions", "bridge.Conversion", values))
        rest = rest[call.end() :].lstrip(", ")
    return tuple(conversions)


def _allowed(scope: Scope, map_: bridge.AttributeMap, child: Child) -> Child:
    [judged] = judge(scope.model.metamodels, map_, [child])
    if not judged.is_possible:
        raise AnswerError(judged.said)
    return child


def shown(words: str) -> str:
    """Returns words as people read them where they choose."""
    return f"{words.removesuffix(' :')} as it is" if words.endswith(":") else words
