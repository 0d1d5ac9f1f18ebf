"""EditedText: what the planner of a text has before it while it plans.

Detached elements are as a command leaves them, to be written and named like any element. They refer
to elements of the model and have an owner there, or one that is detached itself; the model knows
nothing of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.text.blocks import Blocks
from jausml.authoring.editing.text.naming import Naming
from jausml.authoring.editing.text.source import Edits, Outline, TextSource
from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.filling import hang, link, new_object, point, set_value, set_values
from jausml.language.model.names import name_of
from jausml.language.model.values import convert
from jausml.language.semantics.connections.exchanges import FEATURES, infer
from jausml.language.semantics.names import snake_case
from jausml.language.text.tree import Direction, Element, End, Feature, Import, Item, Table, Vector
from jausml.language.text.writing.layout import lines_of
from jausml.language.text.writing.references import ElementWriter
from jausml.language.text.writing.unparsing import MAP, MapWriter

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml.authoring.editing.drafts import Context
    from jausml.authoring.editing.text.source import Body, Part
    from jausml.authoring.editing.working_copy import ElementCopy
    from jausml.language.metamodel import ClassTable, DataTypeTable, FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.refs import Ref
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.reading.document import TextDocument


_MAP_ORDER = (
    *("openDecisions", "tables", "quantities", "joins", "reportJoins", "stopRos", "stopJaus"),
    *("toRos", "toJaus", "vectors"),
)
"""The features of maps that own elements, in the order in which they are written."""


@dataclass(frozen=True)
class FeatureChange:
    """Other values of a feature of an element.

    Attributes:
        part: What stands for the element in the tree.
        values: The new values; without any, nothing is said of the feature.
    """

    edited: EditedText
    obj: EObject
    part: Part
    feature: FeatureTable
    values: Sequence[Any]

    @cached_property
    def made(self) -> EObject:
        """The element as it will be, detached."""
        return self.edited.detached(self.edited.copy(self.obj))

    @cached_property
    def alone(self) -> EObject:
        """The element as it will be, detached, without the many that it may own."""
        return self.edited.detached(self.edited.copy(self.obj), is_whole=False)

    @property
    def value(self) -> Any:
        """The new value of a feature that takes one, None without it."""
        return self.values[0] if self.values else None


class EditedText:
    """The text, its tree, its model, and those who write what is new."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.model = context.model
        self.metamodels = context.model.metamodels
        self.written = cast("TextDocument", context.document.written)
        self.source = TextSource(context.document, context.file)
        self.outline = Outline(self.written.tree, self.source)
        self.edits = Edits(self.source)
        self.blocks = Blocks(self.outline, self.edits)
        self.names = Naming(context)
        self.elements = ElementWriter(self.metamodels, self.names)
        self.maps = MapWriter(self.elements, self.names, self.metamodels)
        self.elements.special[MAP] = self.maps.items

    def copy(self, obj: EObject) -> ElementCopy:
        """Returns an element as it will be."""
        return self.context.working_copy.copies[obj]

    def detached(self, copy: ElementCopy, *, is_whole: bool = True) -> EObject:
        """Returns a detached element as it will be; its owner is an element of the model."""
        made = detached(copy, self._find, is_whole=is_whole)
        if copy.owner is not None:
            hang(made, self._find(copy.owner), copy.owner.table.features[copy.feature])
        if copy.obj is None:
            settle_new(made, copy)
        return made

    def _find(self, target: ElementCopy | Ref) -> EObject:
        if isinstance(target, str):
            return self.names.find(target)
        if target.obj is not None and target.file == self.context.file:
            return target.obj
        return self.names.find(self.context.ref(target))

    def table(self, obj: EObject) -> ClassTable:
        """Returns the class of an element."""
        return self.metamodels.class_of(obj)

    def node(self, obj: EObject) -> Node:
        """Returns the node of an element of the text."""
        node = self.model.node_of(obj)
        assert node is not None  # noqa: S101 - every element of the file was read
        return node

    def part(self, obj: EObject) -> Part:
        """Returns what stands for an element in the tree."""
        part = self.written.source_of(self.node(obj))
        if part is None:
            kind, name = self.table(obj).name, name_of(obj)
            what = f"{kind} '{name}'" if name else f"this {kind}"
            message = f"{what} follows from the rest of {self.context.file}: edit the text"
            if obj.eContainer() is None:
                keyword = snake_case(kind)
                message += f", and put {keyword} {name or 'NAME'} {{ ... }} around what it has"
            raise EditError(message)
        return part

    def find_part(self, obj: EObject) -> Part | None:
        """Returns what stands for an element in the tree, None if nothing does."""
        node = self.model.node_of(obj)
        return None if node is None else self.written.source_of(node)

    def body(self, part: Part, feature: str) -> Body | None:
        """Returns the list of what an element owns by a feature, None for one without a block."""
        return self.outline.body(part, 1 if feature == "expected" else 0)

    def owned_by(self, item: Element) -> str:
        """Returns the feature that owns the element of an item, empty where it is not known."""
        obj = self.object_of(item)
        feature = obj.eContainmentFeature() if obj is not None else None
        return str(feature.name) if feature is not None else ""

    def object_of(self, part: Part) -> EObject | None:
        """Returns the element for which a part of the tree stands, None if it is for none."""
        return self._objects.get(id(part))

    @cached_property
    def _objects(self) -> dict[int, EObject]:
        found = {}
        for obj in self.model.elements_of(self.context.document):
            part = self.find_part(obj)
            if part is not None:
                found[id(part)] = obj
        return found

    def add_item(self, part: Part, before: Item | None, item: Item) -> None:
        """Puts an item into the block of an element, which it gets if it has none."""
        body = self.outline.body(part)
        if body is not None:
            self.blocks.insert(body, before, item)
            return
        start, end = self.source.range_of(part.span)
        self.blocks.append_block(end, item, indent=self.source.indent_of(start))

    def put(self, item: Item, new: Item) -> None:
        """Puts an item in place of another one; comments before it stay."""
        start, end = self.source.range_of(item.span)
        new.documentation = ""
        indent = self.source.indent_of(start)
        lines = self.blocks.lines(new, indent)
        self.edits.replace(start, end, "\n".join(lines).lstrip())

    def add_imports(self) -> None:
        """Adds the imports that new names need."""
        if not self.names.imports:
            return
        items = self.outline.top.items
        lines = [line for each in self.names.imports for line in lines_of(Import(each), 100)]
        last = [each for each in items if isinstance(each, Import)]
        if last:
            self.blocks.insert_lines(self.outline.top, last[-1], lines, is_spaced=False)
        else:
            self.blocks.insert_lines(self.outline.top, None, lines, is_spaced=True)

    def is_named_by(self, obj: EObject, part: Element) -> bool:
        """Tells whether the last word before a block is the name of the element."""
        if part.name is None:
            return False
        node = self.node(obj)
        spans = (self.written.value_span(each) for each in node.children if each.tag == "name")
        return any(each is part.name.span for each in spans)


class InsertionPoints:
    """Finds places in the blocks of elements."""

    def __init__(self, edited: EditedText) -> None:
        self._edited = edited

    def for_value(self, obj: EObject, feature: str, body: Body) -> Item | None:
        """Returns the item behind which a new value of an attribute or a reference goes."""
        return self._last_before(obj, feature, body)

    def for_owned(self, copy: ElementCopy, body: Body) -> Item | None:
        """Returns the item behind which an element goes, None for the first place."""
        earlier, later = (
            [each for each in self.items(some) if self._edited.outline.place(each)[0] is body]
            for some in copy.siblings
        )
        if earlier:
            return earlier[-1]
        owner = copy.owner.obj if copy.owner is not None else None
        if not later:
            return self._last_before(cast("EObject", owner), copy.feature, body)
        index = self._edited.outline.place(later[0])[1]
        moved = self.items([copy])
        before = [each for each in body.items[:index] if each not in moved]
        return before[-1] if before else None

    def items(self, copies: Iterable[ElementCopy]) -> list[Item]:
        """Returns what stands in the text for elements, each once."""
        found: dict[int, Item] = {}
        for each in copies:
            part = self._edited.find_part(each.obj) if each.obj is not None else None
            if part is not None:
                item = self._edited.outline.item_of(part)
                found[id(item)] = item
        return list(found.values())

    def _last_before(self, obj: EObject, feature: str, body: Body) -> Item | None:
        table = self._edited.table(obj)
        if body.owner is None:
            return body.items[-1] if body.items else None
        wanted = _rank(table, feature)
        found = [each for each in body.items if self._rank(table, each) <= wanted]
        return found[-1] if found else None

    def _rank(self, table: ClassTable, item: Item) -> int:
        """Returns where in its block the writer would put an item."""
        if isinstance(item, Import):
            return -3
        if isinstance(item, End):
            return -2 if item.is_jaus else -1
        if isinstance(item, Direction):
            return _rank(table, "toRos" if item.to_ros else "toJaus")
        if isinstance(item, Table | Vector):
            return _rank(table, "tables" if isinstance(item, Table) else "vectors")
        if isinstance(item, Feature):
            return _rank(table, item.name.text)
        if isinstance(item, Element):
            return self._rank_of_element(table, item)
        return _rank(table, "assignments")

    def _rank_of_element(self, table: ClassTable, item: Element) -> int:
        owned = self._edited.owned_by(item)
        return _rank(table, owned) if owned else 0


def _rank(table: ClassTable, name: str) -> int:
    feature = table.features.get(name)
    if feature is None:
        return 0
    features = list(table.features)
    if feature.kind is not FeatureKind.CONTAINMENT:
        return features.index(name)
    if table.qualified_name == MAP and name in _MAP_ORDER:
        return len(features) + _MAP_ORDER.index(name)
    return len(features) + features.index(name)


def detached(
    copy: ElementCopy, find: Callable[[ElementCopy | Ref], EObject], *, is_whole: bool = True
) -> EObject:
    """Returns an element of a working copy without an owner.

    `find`: returns the element of the model that a reference means. `is_whole`: with all that it
    owns.
    """
    made: Any = new_object(copy.table)
    features = copy.table.features
    for name, texts in copy.values.items():
        feature = features[name]
        data_type = cast("DataTypeTable", feature.data_type)
        values = [None if text is None else convert(text, data_type)[0] for text in texts]
        if not feature.settable:
            continue
        if feature.many:
            set_values(made, feature, values)
        elif values:
            set_value(made, feature, values[0])
    for name, targets in copy.references.items():
        if features[name].settable:
            for each in targets:
                point(made, features[name], find(each))
    for name, owned in copy.owned.items() if is_whole else ():
        for each in owned:
            link(made, features[name], detached(each, find))
    return made  # type: ignore[no-any-return]


def settle_new(made: EObject, copy: ElementCopy) -> None:
    """Gives new connections the way that follows from all else, where a command leaves it open.

    So the text leaves it open too.
    """
    if isinstance(made, bridge.Connection) and copy.open:
        stated = [None if each in copy.open else getattr(made, each).name for each in FEATURES]
        inferred = infer(made, *stated)
        for name in FEATURES:
            feature = copy.table.features[name]
            literals = cast("DataTypeTable", feature.data_type).literals
            set_value(made, feature, literals[getattr(inferred, name)])
    for name, owned in copy.owned.items():
        elements = getattr(made, name)
        for each, inner in zip(
            elements if copy.table.features[name].many else [elements], owned, strict=True
        ):
            settle_new(each, inner)
