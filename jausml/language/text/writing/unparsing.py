"""Writer of models as ros2jaus text: the syntax tree of a model, maps in their own notation."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from jausml.language.metamodel import FeatureTable, Metamodels
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.model import Model
from jausml.language.model.names import name_of
from jausml.language.model.xmi.printing import UnwritableError
from jausml.language.model.xmi.writer import is_written
from jausml.language.semantics.conversions import conversion_of
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.names import system_name
from jausml.language.semantics.paths.scopes import has_source
from jausml.language.semantics.subject import remembering
from jausml.language.text.tree import (
    DEEPEST,
    LONGEST,
    Assignment,
    BlockItem,
    Call,
    Clock,
    Direction,
    Element,
    End,
    Entry,
    Feature,
    Ignored,
    Import,
    Item,
    Name,
    Number,
    SyntaxTree,
    Table,
    Text,
    Vector,
    VectorEntry,
    lists_of,
)
from jausml.language.text.writing import layout
from jausml.language.text.writing.layout import space_document
from jausml.language.text.writing.references import DocumentNames, ElementWriter, ReferenceNames
from jausml.language.text.writing.spelling import (
    IN_THE_HEAD,
    constant,
    documented,
    is_comment,
    is_name,
    number,
    word_or_constant,
)

Documented: TypeAlias = "bridge.NamedElement | bridge.Assignment | bridge.TableEntry"

MAP = "bridge.AttributeMap"
_BY_ARROW = frozenset({"target", "source", "value", "conversions", "assignments", "documentation"})


class MapWriter:
    """Writes the maps of one document."""

    def __init__(
        self, elements: ElementWriter, names: DocumentNames, metamodels: Metamodels
    ) -> None:
        self._elements = elements
        self._names = names
        self._metamodels = metamodels

    def items(self, obj: bridge.AttributeMap) -> Iterator[BlockItem]:
        """Yields the items in the block of an attribute map."""
        ends = {"message": self._end(obj, "message", obj.message)}
        ends["type"] = self._end(obj, "type", obj.type)
        said = {name for name, end in ends.items() if end is not None}
        yield from (end for end in ends.values() if end is not None)
        yield from self._elements.values(obj, without=IN_THE_HEAD | said)
        yield from self._elements.children(obj, ("openDecisions",))
        yield from (self.table(table) for table in obj.tables)
        yield from map(self._elements.element, obj.quantities)
        yield from map(self._elements.element, obj.joins)
        yield from map(self._elements.element, obj.reportJoins)
        for name, stop in (("stopRos", obj.stopRos), ("stopJaus", obj.stopJaus)):
            if stop is not None:
                yield self._elements.value_item(stop, self._feature(obj, name))
        yield from self._directions(obj.toRos, self._feature(obj, "toRos"))
        yield from self._directions(obj.toJaus, self._feature(obj, "toJaus"))
        yield from (self.vector(vector) for vector in obj.vectors)

    def _end(self, obj: bridge.AttributeMap, name: str, target: EObject | None) -> End | None:
        """Returns the clause of one end, None when it has no name."""
        if target is None:
            return None
        reference = self._names.name(obj, target, self._feature(obj, name))
        return End(name == "message", reference, None) if isinstance(reference, Name) else None

    def _feature(self, obj: EObject, name: str) -> FeatureTable:
        return self._metamodels.class_of(obj).features[name]

    def table(self, obj: bridge.ValueTable) -> Table | Element:
        """Returns a table, as a uniform block where its own notation does not suffice."""
        entries = [table_entry(entry) for entry in obj.entries]
        pairs = [entry for entry in entries if entry is not None]
        if not is_name(obj.name) or not _can_be_documented(obj) or len(pairs) < len(entries):
            return self._elements.element(obj)
        return documented(Table(Name(obj.name), pairs), obj)

    def vector(self, obj: bridge.TestVector) -> Vector | Element:
        """Returns a test vector, as a uniform block where its own notation does not suffice."""
        inputs = [vector_entry(vector_value) for vector_value in obj.given]
        expected = [vector_entry(vector_value) for vector_value in obj.expected]
        entries = [entry for entry in [*inputs, *expected] if entry is not None]
        if len(entries) < len(inputs) + len(expected) or not is_name(obj.name):
            return self._elements.element(obj)
        if not _can_be_documented(obj):
            return self._elements.element(obj)
        to_ros = is_to_ros(obj)
        vector = Vector(Name(obj.name), to_ros, entries[: len(inputs)], entries[len(inputs) :])
        return documented(vector, obj)

    def _directions(
        self, assignments: Sequence[bridge.Assignment], feature: FeatureTable
    ) -> Iterator[Direction | Feature]:
        """Yields the assignments of one direction in order, as blocks where arrows do not do."""
        direction: Direction | None = None
        for assignment in assignments:
            arrow = self.arrow(assignment)
            if arrow is None:
                if direction is not None:
                    yield direction
                direction = None
                yield self._elements.value_item(assignment, feature)
                continue
            if direction is None:
                direction = Direction(feature.name == "toRos")
            direction.assignments.append(arrow)
        if direction is not None:
            yield direction

    def arrow(self, obj: bridge.Assignment) -> Assignment | Ignored | None:
        """Returns an assignment as an arrow, None when no arrow says exactly this."""
        targets = _paths(obj.target)
        if targets is None:
            return None
        if isinstance(obj, bridge.Ignore):
            is_sayable = len(targets) == 1 and _can_be_documented(obj)
            return documented(Ignored(targets[0]), obj) if is_sayable else None
        sources = self._sources(obj)
        if not sources:
            return None
        arrow = Assignment(sources, targets)
        # The arrow says the rest; these are in its block.
        arrow.items += self._elements.values(obj, without=_BY_ARROW)
        if isinstance(obj, (bridge.FieldAssignment, bridge.ListAssignment)):
            self._convert(arrow, obj)
        if isinstance(obj, bridge.ListAssignment):
            arrow.items += self._nested(obj)
            if not any(isinstance(item, Assignment | Ignored) for item in arrow.items):
                return None
        return documented(arrow, obj)

    def _sources(self, obj: bridge.Assignment) -> list[Name | Number | Text | Clock] | None:
        if isinstance(obj, bridge.ClockAssignment):
            return [Clock()]
        if isinstance(obj, bridge.ConstantAssignment):
            return [constant(obj.value)] if obj.value is not None else None
        if not has_source(obj) or (isinstance(obj, bridge.MessageAssignment) and obj.map is None):
            return None
        paths = _paths(obj.source)
        # As a source these are constants, so a path of such a name needs the uniform notation.
        if paths is None or obj.source in ("true", "false"):
            return None
        return list(paths)

    def _convert(
        self, arrow: Assignment, obj: bridge.FieldAssignment | bridge.ListAssignment
    ) -> None:
        calls = [self.call(conversion) for conversion in obj.conversions]
        sayable = [call for call in calls if call is not None]
        # All or none: half of a chain behind the arrow would change its order.
        if len(sayable) == len(calls):
            arrow.conversions = sayable
        else:
            arrow.items += [self._elements.element(conversion) for conversion in obj.conversions]

    def call(self, obj: bridge.Conversion) -> Call | None:
        """Returns a conversion as a call, None when it has features that its call does not take."""
        table = self._metamodels.class_of(obj)
        feature_names = [
            name
            for name, feature in table.features.items()
            if name != "kind" and is_written(obj, feature)
        ]
        kind = obj.kind.name
        if not feature_names:
            return Call(Name(kind))
        own = conversion_of(obj).own_argument
        holder = "quantity" if "quantity" in feature_names else "arguments"
        holder = holder if own is None else own.feature
        # A call has one kind of argument; with more only a block can say all of them.
        if feature_names != [holder]:
            return None
        value = getattr(obj, holder)
        arguments: list[Any]
        if holder == "arguments":
            arguments = [number(argument) for argument in value]
            return Call(Name(kind), tuple(arguments)) if _are(Number, arguments) else None
        if table.features[holder].is_reference:
            arguments = [self._names.name(obj, value, table.features[holder])]
            return Call(Name(kind), tuple(arguments)) if _are(Name, arguments) else None
        if own is not None and not own.is_text:
            return Call(Name(kind), (Name(value),)) if is_name(value) else None
        return Call(Name(kind), (Text(value),))

    def _nested(self, obj: bridge.ListAssignment) -> Iterator[BlockItem]:
        feature = self._feature(obj, "assignments")
        for assignment in obj.assignments:
            yield self.arrow(assignment) or self._elements.value_item(assignment, feature)


def _are(kind: type, values: list[Any]) -> bool:
    return all(isinstance(value, kind) for value in values)


def _paths(text: str | None) -> list[Name] | None:
    """Returns the paths of a source or target, None when commas stand otherwise than usual."""
    # Commas are written in one way, and other ways would not come back.
    paths = (text or "").split(", ")
    return [Name(path) for path in paths] if all(map(_is_path, paths)) else None


def _is_path(text: str) -> bool:
    return text == "." or ("," not in text and is_name(text.removeprefix("/")))


def table_entry(obj: bridge.TableEntry) -> Entry | None:
    """Returns a pair of a table, None when a pair cannot say it."""
    if None in (obj.jaus, obj.ros) or not _can_be_documented(obj):
        return None
    return documented(Entry(word_or_constant(obj.jaus), word_or_constant(obj.ros)), obj)


def vector_entry(obj: bridge.VectorValue) -> VectorEntry | None:
    """Returns a value of a test vector, None when its notation does not suffice."""
    tolerance = number(obj.tolerance)
    if not _is_path(obj.path or "") or obj.value is None or not isinstance(tolerance, Number):
        return None
    is_stated = tolerance.text != "0"
    return VectorEntry(
        Name(obj.path), word_or_constant(obj.value), tolerance if is_stated else None
    )


def _can_be_documented(*elements: Documented) -> bool:
    texts = [element.documentation for element in elements]
    return all(text is None or is_comment(text) for text in texts)


IMPLIED_PARTS = {
    "system.System": ("components", "nodes", "bridges", "hosts", "placements"),
    "bridge.MapLibrary": ("maps",),
}
"""Root elements that need not be written when the file gives them their name, with the parts that
may then stand by themselves."""


def to_text(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> str:
    """Returns root elements with all that they own as ros2jaus text in its canonical layout.

    Args:
        path: The file that the text is meant for. Imports are relative to it, and a system or map
            library of its name is left to be implied.

    Raises:
        UnwritableError: A reference leads to an element that neither the roots nor a document of
            the model own, or the text would be longer or deeper than texts may be.
    """
    with remembering():
        document = to_tree(roots, model, path)
    return _laid_out(document)


def to_clip(elements: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> str:
    """Returns elements with all their parts as text, each as it may stand in its owner.

    The arguments and errors are those of `to_text`.
    """
    with remembering():
        writer, imports = _writer(elements, model, Path(path))
        writer.says_all = True
        document = SyntaxTree([*imports, *map(writer.alone, elements)])
        space_document(document.items)
    return _laid_out(document)


def _laid_out(document: SyntaxTree) -> str:
    if _depth(document.items) > DEEPEST:
        raise UnwritableError(f"its elements are nested more than {DEEPEST} deep")
    text = layout.lay_out(document)
    if len(text) > LONGEST:
        raise UnwritableError(f"the text would have more than {LONGEST:,} characters")
    return text


def to_tree(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> SyntaxTree:
    """Returns root elements with all that they own as a syntax tree."""
    elements, imports = _writer(roots, model, Path(path))
    document = SyntaxTree([*imports])
    implied: set[str] = set()
    for root in roots:
        qualified_class = model.metamodels.class_of(root).qualified_name
        parts = [] if qualified_class in implied else _parts(root, elements, model, Path(path))
        if parts:
            implied.add(qualified_class)
        document.items += parts or [elements.root(root)]
    space_document(document.items)
    return document


def _writer(
    roots: Sequence[EObject], model: Model, path: Path
) -> tuple[ElementWriter, Sequence[Import]]:
    """Returns the writer of elements of a model into a file, and the imports of that file."""
    names = ReferenceNames(roots, model, path)
    elements = ElementWriter(model.metamodels, names)
    elements.special[MAP] = MapWriter(elements, names, model.metamodels).items
    return elements, [Import(target) for target in names.imports]


def _parts(root: EObject, elements: ElementWriter, model: Model, path: Path) -> list[BlockItem]:
    """Returns the items of a root that the file implies; none for other roots."""
    table = model.metamodels.class_of(root)
    names = IMPLIED_PARTS.get(table.qualified_name)
    if names is None or name_of(root) != system_name(path):
        return []
    others = (feature for name, feature in table.features.items() if name not in ("name", *names))
    if any(is_written(root, other) for other in others):
        return []
    # A part that needs the word of its feature cannot stand without its root.
    parts = elements.children(root, names)
    return parts if all(isinstance(part, Element) for part in parts) else []


def _depth(items: Iterable[Item]) -> int:
    """Returns how deep the brackets of items are nested, of arrows as if all had some."""
    inner = (_depth(nested_list) for item in items for nested_list, _ in lists_of(item))
    return max((1 + depth for depth in inner), default=0)
