"""Names in a text: those that declare an element, and those that refer to one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

from jausml.authoring.editor.context import class_of, class_of_value, feature_named, table
from jausml.authoring.editor.places import Place, is_within
from jausml.language.metamodel import ClassTable
from jausml.language.semantics.conversions import CONVERSIONS, Argument
from jausml.language.text import tree

# Keyword and class of what source paths may begin with, by whether they lead to ROS.
_JOINS = {True: ("report_join", "bridge.ReportJoin"), False: ("join", "bridge.Join")}


@dataclass(frozen=True, slots=True)
class Declaration:
    """A name that a text gives to an element.

    Attributes:
        item: What has the name.
        owners: The items around it, the outermost first.
    """

    name: tree.Name
    table: ClassTable
    item: tree.Item
    owners: tuple[tree.Item, ...]

    @property
    def path(self) -> list[str]:
        """The names of the owners and its own."""
        names = [getattr(owner, "name", None) for owner in self.owners]
        return [*(name.text for name in names if isinstance(name, tree.Name)), self.name.text]


@dataclass(frozen=True, slots=True)
class Reference:
    """A name that refers to an element.

    Attributes:
        wanted: The class of the element.
        owners: The items around it, the outermost first.
        is_first_step: Whether it is a path of which the first step is the name.
    """

    name: tree.Name
    wanted: ClassTable
    owners: tuple[tree.Item, ...]
    is_first_step: bool = False

    @property
    def text(self) -> str:
        """The name that is looked for."""
        return self.name.text.partition(".")[0] if self.is_first_step else self.name.text


@dataclass(slots=True)
class Names:
    """All names of a document, in order: those that declare an element, and those that refer."""

    declarations: list[Declaration] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)

    def declared(self, wanted: ClassTable) -> Iterator[Declaration]:
        """Returns the declarations of the elements of a class."""
        return (
            declaration for declaration in self.declarations if declaration.table in wanted.subtypes
        )

    def declared_at(self, place: Place) -> Declaration | None:
        """Returns the declaration whose name is at a place."""
        for declaration in self.declarations:
            if is_within(declaration.name.span, place):
                return declaration
        return None

    def reference_at(self, place: Place) -> Reference | None:
        """Returns the reference at a place."""
        for reference in self.references:
            if is_within(reference.name.span, place):
                return reference
        return None


def names_of(document: tree.SyntaxTree) -> Names:
    """Returns the names of a document."""
    collector = _Collector()
    collector.items(document.items, None, ())
    return collector.names


def find(reference: Reference, names: Names) -> Declaration | None:
    """Returns the declaration that a reference means: that with most owners in common."""
    steps = reference.text.replace("/", ".").split(".")
    fitting = [
        declaration
        for declaration in names.declared(reference.wanted)
        if declaration.name.text.endswith(steps[-1])
        and [step for name in declaration.path for step in name.split(".")][-len(steps) :] == steps
    ]
    return max(
        fitting, key=lambda declaration: _shared(declaration.owners, reference.owners), default=None
    )


def _shared(first: Sequence[tree.Item], second: Sequence[tree.Item]) -> int:
    """Returns how many owners two sequences have in common, from the outermost on."""
    pairs = zip(first, second, strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] is pair[1], pairs))


class _Collector:
    """Walks through a tree."""

    def __init__(self) -> None:
        self.names = Names()
        # The names of the joins of the map that is walked through, by keyword.
        self._joins_of_map: dict[str, set[str]] = {}

    def items(
        self, items: Iterable[tree.Item], own: ClassTable | None, owners: tuple[tree.Item, ...]
    ) -> None:
        """Collects the names in some items.

        Args:
            own: The class of the element that has them; None for others, and for what is unknown.
            owners: What is around them, the outermost first.
        """
        for item in items:
            if isinstance(item, tree.Element):
                self._element(item, class_of(item, own), owners)
            elif isinstance(item, tree.Feature):
                self._feature(item, own, owners)
            elif isinstance(item, tree.End):
                wanted = table("jaus.MessageDef" if item.is_jaus else "ros.MessageType")
                self._refer(item.type, wanted, owners)
            elif isinstance(item, tree.Table):
                self._declare(item.name, table("bridge.ValueTable"), item, owners)
            elif isinstance(item, tree.Vector):
                self._declare(item.name, table("bridge.TestVector"), item, owners)
                self._joins([entry.path for entry in item.given], owners, to_ros=item.to_ros)
            elif isinstance(item, tree.Direction):
                self.items(item.assignments, None, (*owners, item))
            elif isinstance(item, tree.Assignment):
                self._assignment(item, owners)

    def _element(
        self, element: tree.Element, own: ClassTable | None, owners: tuple[tree.Item, ...]
    ) -> None:
        if element.name is not None and own is not None:
            self._declare(element.name, own, element, owners)
        around = self._joins_of_map
        if own is table("bridge.AttributeMap"):
            self._joins_of_map = _joins_in(element)
        self.items(element.items, own, (*owners, element))
        self._joins_of_map = around

    def _feature(
        self, feature: tree.Feature, own: ClassTable | None, owners: tuple[tree.Item, ...]
    ) -> None:
        known = feature_named(feature, owners[-1] if owners else None, own)
        for value in feature.values:
            if isinstance(value, tree.Element):
                self._element(value, class_of_value(value, known), owners)
            elif isinstance(value, tree.Name) and known is not None and known.target is not None:
                self._refer(value, known.target, owners)

    def _assignment(self, assignment: tree.Assignment, owners: tuple[tree.Item, ...]) -> None:
        direction = next((owner for owner in owners if isinstance(owner, tree.Direction)), None)
        if direction is not None:
            paths = [source for source in assignment.sources if isinstance(source, tree.Name)]
            self._joins(paths, owners, to_ros=direction.to_ros)
        for call in assignment.conversions:
            self._call(call, owners)
        self.items(assignment.items, None, (*owners, assignment))

    def _call(self, call: tree.Call, owners: tuple[tree.Item, ...]) -> None:
        conversion = CONVERSIONS.get(call.name.text)
        own = conversion.own_argument if conversion is not None else None
        wanted = Argument("").refers_to if own is None else own.refers_to
        for argument in call.arguments:
            if wanted and isinstance(argument, tree.Name):
                self._refer(argument, table(wanted), owners)

    def _joins(
        self, paths: Iterable[tree.Name], owners: tuple[tree.Item, ...], *, to_ros: bool
    ) -> None:
        """Notes paths that may begin with the name of a join of their map."""
        keyword, wanted = _JOINS[to_ros]
        joins = self._joins_of_map.get(keyword, ())
        for path in paths:
            if path.text.partition(".")[0] in joins:
                reference = Reference(path, table(wanted), owners, is_first_step=True)
                self.names.references.append(reference)

    def _declare(
        self, name: tree.Name, own: ClassTable, item: tree.Item, owners: tuple[tree.Item, ...]
    ) -> None:
        self.names.declarations.append(Declaration(name, own, item, owners))

    def _refer(self, name: tree.Name, wanted: ClassTable, owners: tuple[tree.Item, ...]) -> None:
        self.names.references.append(Reference(name, wanted, owners))


def _joins_in(element: tree.Element) -> dict[str, set[str]]:
    """Returns the names of the joins in a map, by keyword."""
    names_by_keyword: dict[str, set[str]] = {keyword: set() for keyword, _ in _JOINS.values()}
    for item in element.items:
        if isinstance(item, tree.Element) and item.keyword is not None and item.name is not None:
            names_by_keyword.get(item.keyword.text, set()).add(item.name.text)
    return names_by_keyword
