"""New maps: what corresponds, what the author says besides, and what is open then.

Where a choice is the author's, it is a doubt: whoever asks answers it in the words of
`jausml.authoring.proposals.mapping.words`, and begins the map once more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import NEW, Add, Child
from jausml.authoring.proposals.mapping.completing import bare, completed
from jausml.authoring.proposals.mapping.filling import FEATURES, found
from jausml.authoring.proposals.mapping.opens import opens
from jausml.authoring.proposals.mapping.statements import statement
from jausml.authoring.proposals.mapping.stopping import stops_by_zeros, zeros
from jausml.authoring.proposals.mapping.tabling import additions, table_of, tabled
from jausml.authoring.proposals.mapping.trial import findings, fresh_map, with_assignments
from jausml.authoring.proposals.mapping.words import assignments_of, shown, words_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member
    from jausml.language.metamodel.classes import bridge, jaus, ros

_MOST = 6
"""How many choices a line names."""

Words = tuple[tuple[str, str], ...]
"""Targets, each with what fills it."""


@dataclass(frozen=True)
class Wish:
    """What a new map shall be.

    Attributes:
        ways: The directions: True to ROS. One of which nothing is known stays empty.
        taken: What was taken for the author without being asked for, in words.
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
        """Returns what the author says of a direction."""
        return self.to_ros if to_ros else self.to_jaus

    def with_answer(self, doubt: Doubt, words: str) -> Wish:
        """Returns the wish with the answer to a doubt, in the place of what was said before."""
        kept = tuple(each for each in self.said(to_ros=doubt.to_ros) if each[0] != doubt.target)
        said = (*kept, (doubt.target, words))
        return replace(self, to_ros=said) if doubt.to_ros else replace(self, to_jaus=said)

    def with_first(self, doubt: Doubt) -> Wish:
        """Returns the wish with the first choice of a doubt, of which the map then tells."""
        first, count = doubt.choices[0], len(doubt.choices)
        told = f"{doubt.target} takes {shown(first)}, the first of {count} that fit"
        return replace(self.with_answer(doubt, first), taken=(*self.taken, told))


@dataclass(frozen=True)
class Doubt:
    """A target for which more than one thing fits.

    Attributes:
        choices: What fits, in words, the likeliest first.
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
    opens: tuple[str, ...]
    doubts: tuple[Doubt, ...]
    findings: tuple[str, ...]
    stops_by_zeros: tuple[bool, ...]


def begin_map(scope: Scope, owner: bridge.Bridge, wish: Wish) -> Begun:
    """Returns a new map with all that follows from its ends and from what the author says.

    Raises:
        AnswerError: What the author says is forbidden by a rule, or names nothing.
    """
    metamodels = scope.model.metamodels
    made = fresh_map(metamodels, wish.name, wish.message, wish.type)
    tables: list[Child] = []
    children: list[Child] = []
    doubts: list[Doubt] = []

    def take(more: Iterable[Child]) -> None:
        found = tabled(made, more)
        tables.extend(found.tables)
        children.extend(found.assignments)
        with_assignments(metamodels, made, (*found.tables, *found.assignments))

    for way in wish.ways:
        take(_said(scope, made, wish, doubts, to_ros=way))
    filled = found(scope, made, wish.ways)
    take(filled.assignments)
    found_of = [way for way in wish.ways if any(each.feature == FEATURES[way] for each in children)]
    begun = found_of or list(wish.ways)
    for way in begun:
        take(completed(scope, made, to_ros=way, ignores=way in found_of))
    doubts += _alike(filled.doubtful, begun)
    doubts += _of_values(made, found_of)
    by_zeros = stops_by_zeros(made, found_of)
    for way in by_zeros if wish.zeros_stop else ():
        take([zeros([each for each in children if each.feature == FEATURES[way]], to_ros=way)])
    told = (*opens(made, children, begun), *wish.taken, *map(_told, doubts))
    by_tables = [each for each in children if any(map(table_of, each.children))]
    plain = [each for each in children if each not in by_tables]
    values = {
        "name": (wish.name,),
        "message": (scope.ref(wish.message),),
        "type": (scope.ref(wish.type),),
    }
    if told:
        values["documentation"] = ("\n\n".join(f"Open: {each}." for each in told),)
    return Begun(
        Add(scope.ref(owner), "maps", "bridge.AttributeMap", values, tuple(plain)),
        tuple(additions(f"{NEW}0", tables, by_tables, (), 1)),
        {
            way: tuple(statement(each) for each in children if each.feature == FEATURES[way])
            for way in begun
            if any(each.feature == FEATURES[way] for each in children)
        },
        told,
        tuple(doubts),
        tuple(f"{rule.id} {each.message}" for rule, each in findings(metamodels, made)),
        tuple(by_zeros),
    )


def _told(doubt: Doubt) -> str:
    return f"{doubt.target} may come from {' or '.join(map(shown, doubt.choices[:_MOST]))}"


def _said(
    scope: Scope, used: bridge.AttributeMap, wish: Wish, doubts: list[Doubt], *, to_ros: bool
) -> Iterator[Child]:
    """Yields what the author says of a direction; how it may be meant else becomes a doubt."""
    for target, source in wish.said(to_ros=to_ros):
        ways = assignments_of(scope, used, target, source, to_ros=to_ros)
        if len(ways) > 1:
            doubts.append(Doubt(to_ros, target, tuple(map(words_of, ways))))
        yield ways[0]


def _alike(
    doubtful: Iterable[tuple[tuple[Member, ...], Member]], ways: Collection[bool]
) -> Iterator[Doubt]:
    """Yields the targets to which several sources are equally alike, and none that is in a list."""
    for sources, target in doubtful:
        if not target.outer and (not target.is_jaus) in ways:
            yield Doubt(not target.is_jaus, target.path, tuple(each.path for each in sources))


def _of_values(used: bridge.AttributeMap, ways: Collection[bool]) -> Iterator[Doubt]:
    """Yields the unfilled fields that the message always has and whose values have names."""
    for each in bare(used, to_ros=False) if False in ways else ():
        names = each.leaves[0].attribute.constants if each.leaves[0].path == each.path else ()
        if each.is_required and names:
            yield Doubt(
                to_ros=False, target=each.path, choices=tuple(f'"{name}"' for name, _ in names)
            )
