"""Names in a text: those that declare an element, and those that refer to one."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeVar
from weakref import WeakKeyDictionary

from jausml.authoring.editor.context import class_of, class_of_value, feature_named, table
from jausml.authoring.editor.places import is_within
from jausml.language.semantics.conversions import CONVERSIONS, Argument
from jausml.language.text.reading.joining import Joined, Part, moved
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    End,
    Feature,
    Item,
    Name,
    Span,
    SyntaxTree,
    Table,
    Vector,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from jausml.authoring.editor.places import Place
    from jausml.language.metamodel import ClassTable

_JOINS = {True: ("report_join", "bridge.ReportJoin"), False: ("join", "bridge.Join")}
"""Keyword and class of what source paths may begin with, by whether they lead to ROS."""


class Owner(NamedTuple):
    """An item around a name, and by how many lines it is moved."""

    item: Item
    by: int = 0

    def is_same(self, other: Owner) -> bool:
        """Tells whether both are one item of a text."""
        return self.item is other.item and self.by == other.by

    def is_at(self, place: Place) -> bool:
        """Tells whether the item begins at a place of the text."""
        return (self.item.span.line + self.by, self.item.span.column) == (place.line, place.column)


@dataclass(frozen=True, slots=True)
class Declaration:
    """A name that a text gives to an element.

    Attributes:
        what: What has the name.
        owners: The items around it, the outermost first.
    """

    name: Name
    table: ClassTable
    what: Owner
    owners: tuple[Owner, ...]

    @property
    def item(self) -> Item:
        """The item that has the name, perhaps on other lines."""
        return self.what.item

    @property
    def span(self) -> Span:
        """Where the item stands."""
        span: Span = moved(self.item.span, self.what.by)
        return span

    @property
    def path(self) -> list[str]:
        """The names of the owners and its own."""
        names = [getattr(each.item, "name", None) for each in self.owners]
        return [*(each.text for each in names if isinstance(each, Name)), self.name.text]

    def moved(self, by: int, around: tuple[Owner, ...]) -> Declaration:
        """Returns the same on other lines, within other items."""
        name = moved(self.name, by)
        return Declaration(name, self.table, Owner(self.item, by), _within(self, by, around))


@dataclass(frozen=True, slots=True)
class Reference:
    """A name that refers to an element."""

    name: Name
    wanted: ClassTable
    owners: tuple[Owner, ...]
    is_first_step: bool = False

    @property
    def text(self) -> str:
        """The name that is looked for."""
        return self.name.text.partition(".")[0] if self.is_first_step else self.name.text

    def moved(self, by: int, around: tuple[Owner, ...]) -> Reference:
        """Returns the same on other lines, within other items."""
        name = moved(self.name, by)
        return Reference(name, self.wanted, _within(self, by, around), self.is_first_step)


def _within(name: Declaration | Reference, by: int, around: tuple[Owner, ...]) -> tuple[Owner, ...]:
    return (*around, *(Owner(item, at + by) for item, at in name.owners))


@dataclass(frozen=True, slots=True)
class _Inner:
    """The names of a list that was read by parts, without the items around it.

    `owner`: the class of what the list belongs to.
    """

    items: Joined
    owner: ClassTable | None
    owners: tuple[Owner, ...]


@dataclass(slots=True)
class Names:
    """All names of a document, in order."""

    entries: list[Declaration | Reference | _Inner] = field(default_factory=list)

    @property
    def declarations(self) -> Iterator[Declaration]:
        """The names that declare an element."""
        return _chosen(self, Declaration)

    @property
    def references(self) -> Iterator[Reference]:
        """The names that refer to an element."""
        return _chosen(self, Reference)

    def declared(self, wanted: ClassTable) -> Iterator[Declaration]:
        """Returns the declarations of the elements of a class."""
        return _chosen(self, Declaration, lambda each: each.table in wanted.subtypes)

    def declared_at(self, place: Place) -> Declaration | None:
        """Returns the declaration whose name is at a place."""
        found = _chosen(self, Declaration, line=place.line)
        return next((each for each in found if is_within(each.name.span, place)), None)

    def reference_at(self, place: Place) -> Reference | None:
        """Returns the reference at a place."""
        found = _chosen(self, Reference, line=place.line)
        return next((each for each in found if is_within(each.name.span, place)), None)


_NameT = TypeVar("_NameT", Declaration, Reference)


def _chosen(
    names: Names,
    kind: type[_NameT],
    is_wanted: Callable[[_NameT], bool] = lambda each: True,  # noqa: ARG005 - all
    line: int | None = None,
    by: int = 0,
    around: tuple[Owner, ...] = (),
) -> Iterator[_NameT]:
    """Yields names of a kind.

    `line`: the only line that is looked for. `by`, `around`: by how many lines they are moved, and
    the items around all of them.
    """
    each: Declaration | Reference | _Inner
    for each in names.entries:
        if isinstance(each, _Inner):
            owners = (*around, *(Owner(item, at + by) for item, at in each.owners))
            parts = each.items.parts() if line is None else [each.items.part_at(line - by)]
            for part, at in parts:
                inner = _names_of_part(part, each.owner)
                yield from _chosen(inner, kind, is_wanted, line, by + at, owners)
        elif isinstance(each, kind) and is_wanted(each):
            yield each.moved(by, around)


def names_of(document: SyntaxTree) -> Names:
    """Returns the names of a document; those of parts that were looked at before are kept."""
    collector = _Collector()
    collector.items(document.items, None, None, ())
    return collector.names


_Known = WeakKeyDictionary[Part, dict["ClassTable | None", Names]]


@lru_cache(maxsize=1)
def _known() -> _Known:
    return WeakKeyDictionary()


def _names_of_part(part: Part, owner: ClassTable | None) -> Names:
    """Returns the names of a part where it was read; `owner`: the class of what it belongs to."""
    known = _known().setdefault(part, {})
    if owner not in known:
        collector = _Collector()
        collector.items(part.items(0), None, owner, ())
        known[owner] = collector.names
    return known[owner]


def find(reference: Reference, names: Names) -> Declaration | None:
    """Returns the declaration that a reference means: the one that shares most owners with it."""
    steps = reference.text.replace("/", ".").split(".")
    fitting = [
        each
        for each in names.declared(reference.wanted)
        if each.name.text.endswith(steps[-1])
        and [step for name in each.path for step in name.split(".")][-len(steps) :] == steps
    ]
    return max(fitting, key=lambda each: _shared(each.owners, reference.owners), default=None)


def _shared(first: Sequence[Owner], second: Sequence[Owner]) -> int:
    shared = 0
    for one, other in zip(first, second, strict=False):
        if not one.is_same(other):
            break
        shared += 1
    return shared


class _Collector:
    """Walks through a tree."""

    def __init__(self) -> None:
        self.names = Names()

    def items(
        self,
        items: Iterable[Item],
        container: Item | None,
        owner: ClassTable | None,
        owners: tuple[Item, ...],
    ) -> None:
        # In a map, names mean what stands elsewhere in it.
        if isinstance(items, Joined) and owner is not table("bridge.AttributeMap"):
            self.names.entries.append(_Inner(items, owner, tuple(map(Owner, owners))))
            return
        for item in items:
            if isinstance(item, Element):
                self._element(item, class_of(item, owner), owners)
            elif isinstance(item, Feature):
                self._feature(item, container, owner, owners)
            elif isinstance(item, End):
                wanted = table("jaus.MessageDef" if item.is_jaus else "ros.MessageType")
                self._refer(item.type, wanted, owners)
            elif isinstance(item, Table):
                self._declare(item.name, table("bridge.ValueTable"), item, owners)
            elif isinstance(item, Vector):
                self._declare(item.name, table("bridge.TestVector"), item, owners)
                self._joins([each.path for each in item.given], owners, to_ros=item.to_ros)
            elif isinstance(item, Direction):
                self.items(item.assignments, item, None, (*owners, item))
            elif isinstance(item, Assignment):
                self._assignment(item, owners)

    def _element(self, element: Element, own: ClassTable | None, owners: tuple[Item, ...]) -> None:
        if element.name is not None and own is not None:
            self._declare(element.name, own, element, owners)
        self.items(element.items, element, own, (*owners, element))

    def _feature(
        self,
        feature: Feature,
        container: Item | None,
        owner: ClassTable | None,
        owners: tuple[Item, ...],
    ) -> None:
        known = feature_named(feature, container, owner)
        for value in feature.values:
            if isinstance(value, Element):
                self._element(value, class_of_value(value, known), owners)
            elif isinstance(value, Name) and known is not None and known.target is not None:
                self._refer(value, known.target, owners)

    def _assignment(self, assignment: Assignment, owners: tuple[Item, ...]) -> None:
        direction = next((each for each in owners if isinstance(each, Direction)), None)
        if direction is not None:
            paths = [each for each in assignment.sources if isinstance(each, Name)]
            self._joins(paths, owners, to_ros=direction.to_ros)
        for call in assignment.conversions:
            self._call(call, owners)
        self.items(assignment.items, assignment, None, (*owners, assignment))

    def _call(self, call: Call, owners: tuple[Item, ...]) -> None:
        conversion = CONVERSIONS.get(call.name.text)
        own = conversion.own_argument if conversion is not None else None
        wanted = Argument("").refers_to if own is None else own.refers_to
        for argument in call.arguments:
            if wanted and isinstance(argument, Name):
                self._refer(argument, table(wanted), owners)

    def _joins(self, paths: Iterable[Name], owners: tuple[Item, ...], *, to_ros: bool) -> None:
        """Notes paths that may begin with the name of a join of their map."""
        keyword, wanted = _JOINS[to_ros]
        joins = {
            each.name.text
            for owner in owners
            if isinstance(owner, Element)
            for each in owner.items
            if isinstance(each, Element)
            and each.keyword is not None
            and each.keyword.text == keyword
            and each.name is not None
        }
        for path in paths:
            if path.text.partition(".")[0] in joins:
                reference = Reference(
                    path, table(wanted), tuple(map(Owner, owners)), is_first_step=True
                )
                self.names.entries.append(reference)

    def _declare(self, name: Name, own: ClassTable, item: Item, owners: tuple[Item, ...]) -> None:
        self.names.entries.append(Declaration(name, own, Owner(item), tuple(map(Owner, owners))))

    def _refer(self, name: Name, wanted: ClassTable, owners: tuple[Item, ...]) -> None:
        self.names.entries.append(Reference(name, wanted, tuple(map(Owner, owners))))
