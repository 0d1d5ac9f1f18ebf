"""Desk: what the planner of a text has before it while it plans."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.text.blocks import Blocks
from jausml.authoring.editing.text.naming import Naming
from jausml.authoring.editing.text.outline import Outline
from jausml.authoring.editing.text.source import Edits, TextSource
from jausml.language.model.names import name_of
from jausml.language.text.tree import Element, Import, Item
from jausml.language.text.writing.elements import ElementWriter
from jausml.language.text.writing.layout import lines_of
from jausml.language.text.writing.maps import MAP, MapWriter

if TYPE_CHECKING:
    from jausml.authoring.editing.planning import Context
    from jausml.authoring.editing.text.outline import Body, Part
    from jausml.language.metamodel import ClassTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.reading.document import TextDocument


class Desk:
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

    def table(self, obj: EObject) -> ClassTable:
        """Returns the class of an element."""
        return self.metamodels.class_of(obj)

    def node(self, obj: EObject) -> Node:
        """Returns the light node of an element of the text."""
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
            raise EditError(message)
        return part

    def find_part(self, obj: EObject) -> Part | None:
        """Returns what stands for an element in the tree, None if nothing does."""
        node = self.model.node_of(obj)
        return None if node is None else self.written.source_of(node)

    def body(self, obj: EObject) -> Body | None:
        """Returns the list of what an element owns, None for one without a block."""
        part = self.find_part(obj)
        return self.outline.top if part is None else self.outline.body(part)

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
