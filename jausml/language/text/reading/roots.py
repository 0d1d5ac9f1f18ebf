"""Root elements of a text, with the implied ones that nobody writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.text.root_names import package_name, system_name
from jausml.language.text.tree import Element, Feature, Member, is_map

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, Metamodels
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.reading.elements import ElementReader
    from jausml.language.text.reading.nodes import NodeMaker
    from jausml.language.text.tree import Item, Span

_ROOTS = ("system.System", "bridge.MapLibrary", "jaus.ServiceSet", "ros.InterfacePackage")
_ROOT_FEATURE = "root"


class RootReader:
    """Makes the root elements of a document."""

    def __init__(
        self, metamodels: Metamodels, nodes: NodeMaker, elements: ElementReader, path: Path
    ) -> None:
        self._metamodels = metamodels
        self._nodes = nodes
        self._elements = elements
        self._path = path
        self._implicit: dict[str, Node] = {}
        self.roots: list[Node] = []
        self.types: dict[str, Member] = {}
        """The named types that members of messages may have, by name."""

    def add(self, item: Item) -> None:
        """Builds an item of the top level."""
        if isinstance(item, Element):
            self._element(item)
        elif isinstance(item, Feature):
            self._feature(item)
        elif isinstance(item, Member):
            self._type(item)
        else:
            self._elements.misplaced(item)

    def _element(self, block: Element) -> None:
        table = self._elements.class_of(block)
        if block.keyword is None and is_map(block.items):
            owner = self._owner("bridge.MapLibrary", block.span)
            self._elements.owned_map(owner, block)
        elif table is None:
            self._elements.report_unknown(block)
        elif table.qualified_name in _ROOTS:
            self._explicit(table, block)
        else:
            taking = next((each for each in _ROOTS if self._takes(each, table)), None)
            if taking is None:
                message = f"a {table.name} does not stand alone"
                hint = f"write it where it belongs, or root: new {block_words(block)} {{ ... }}"
                self._nodes.fault("JML702", block.span, message, hint)
            else:
                self._elements.element(self._owner(taking, block.span), block)

    def _explicit(self, table: ClassTable, block: Element, item: Item | None = None) -> None:
        node = self._nodes.root(table, block.span, block)
        self.roots.append(node)
        self._elements.fill(node, block, item)

    def _feature(self, item: Feature) -> None:
        """Takes `root: new component x { ... }`, which makes a root of any element."""
        blocks = [each for each in item.values if isinstance(each, Element)]
        if item.name.text != _ROOT_FEATURE or len(blocks) != len(item.values):
            message = f"feature '{item.name.text}' stands in no element"
            hint = "features stand in blocks: bridge front { address: 100.1.2 }"
            self._nodes.fault("JML702", item.span, message, hint)
            return
        for each in blocks:
            table = self._elements.class_of(each)
            if table is None:
                self._elements.report_unknown(each)
            else:
                self._explicit(table, each, item)

    def _type(self, member: Member) -> None:
        if member.name is None:
            message = "a struct without a name declares nothing"
            hint = "write a name behind it: struct [ ... ] pose"
            self._nodes.fault("JML706", member.span, message, hint)
        elif member.name.text in self.types:
            message = f"type '{member.name.text}' is declared twice"
            self._nodes.fault("JML707", member.span, message)
        else:
            self.types[member.name.text] = member

    def _takes(self, root: str, table: ClassTable) -> bool:
        features = self._metamodels.classes[root].features.values()
        kind = FeatureKind.CONTAINMENT
        return any(each.kind is kind and each.target in table.supertypes for each in features)

    def _owner(self, qualified_class: str, span: Span) -> Node:
        """Returns the implicit root of a class, made at the first call."""
        node = self._implicit.get(qualified_class)
        if node is None:
            node = self._nodes.root(self._metamodels.classes[qualified_class], span)
            is_package = qualified_class == "ros.InterfacePackage"
            name = package_name(self._path) if is_package else system_name(self._path)
            self._nodes.value(node, "name", name, span)
            self._implicit[qualified_class] = node
            self.roots.append(node)
        return node


def block_words(block: Element) -> str:
    """Returns the words before a block."""
    return " ".join(each.text for each in (block.keyword, block.name) if each is not None)
