"""Text documents: parsed texts on their way to elements.

What nobody writes is added: implied root elements, and the direction and exchange of connections
that leave them open.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from jausml.language.metamodel import ClassTable, DataTypeTable, Metamodels
from jausml.language.metamodel.filling import set_value
from jausml.language.model.notation import Explanation, Fault, ImportedDocument, Known
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.connections.exchanges import CONNECTION, FEATURES, Inferred, infer
from jausml.language.semantics.names import package_name, system_name
from jausml.language.semantics.subject import remembered, remembering
from jausml.language.text import tree
from jausml.language.text.reading import imports
from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps, add_bridge
from jausml.language.text.reading.declarer import Declarer
from jausml.language.text.reading.elements import ElementReader, NodeMaker, Source
from jausml.language.text.reading.imports import explain
from jausml.language.text.reading.maps import MapReader
from jausml.language.text.reading.members import MemberCheck

SERVICE = "service"
"""The keyword of services, one of which may take the messages that a text declares."""


class TextDocument:
    """The nodes of a text, with the declarations and checks that need its surroundings."""

    def __init__(
        self,
        document: tree.SyntaxTree,
        faults: Sequence[Fault],
        path: Path,
        metamodels: Metamodels,
        bridge: BridgeOfMaps | None = None,
    ) -> None:
        self.tree = document
        self._bridge = bridge
        self._nodes = NodeMaker(metamodels)
        elements = ElementReader(self._nodes)
        self._maps = MapReader(elements)
        elements.special |= self._maps.special
        self._roots = RootReader(elements, path)
        self._declarer = Declarer(elements, path, self._roots.types)
        self.imports: list[ImportedDocument] = []
        # Set apart, since messages that maps declare go into it once all maps are read.
        self._declarer.service.written = _own_service(document)
        self._declarer.service.asks_for_all = bridge is not None
        for item in document.items:
            if isinstance(item, tree.Import):
                self._import(item)
            elif item is not self._declarer.service.written:
                self._roots.add(item)
        self._nodes.faults += map(self._placed, faults)

    @property
    def roots(self) -> Sequence[Node]:
        """The nodes of the root elements."""
        return self._roots.roots

    @property
    def faults(self) -> Sequence[Fault]:
        """The faults of the text."""
        return self._nodes.faults

    def source_of(self, node: Node) -> Source | None:
        """Returns the part of the tree that is an element; None where it follows from the rest."""
        return self._nodes.sources.get(node)

    def value_span(self, node: Node) -> tree.Span | None:
        """Returns where the value or the reference of a node is written, None for an element."""
        return self._nodes.values.get(node)

    def declare(self, known: Known) -> tuple[Sequence[Node], Sequence[Fault]]:
        """Returns the messages and types that maps use and nobody knows, and the asked bridge."""
        before = len(self._nodes.faults)
        self._declarer.run(self._maps.ends, known)
        roots = list(self._declarer.roots)
        if self._bridge is not None:
            roots += self._system_of_maps(self._bridge, known)
        return roots, self._nodes.faults[before:]

    def _system_of_maps(self, bridge: BridgeOfMaps, known: Known) -> Sequence[Node]:
        for root in self._roots.roots:
            if self._nodes.classes[root].qualified_name == "system.System":
                message = "the file has a system, and a bridge of all its maps makes one"
                hint = "give its own bridge the address, or leave --bridge-address out"
                self._nodes.fault("JML716", self._nodes.spans[root], message, hint, owner=root)
                return []
        ends = self._maps.ends
        return add_bridge(bridge, ends, self._declarer, known, self._nodes)

    def check(self) -> Sequence[Fault]:
        """Completes the open features of connections; returns their faults and those of members."""
        # An end that declares its message agrees with it, and needs no check.
        ends = [end for end in self._maps.ends if not self._declarer.declares(end.end)]
        check = MemberCheck(self._declarer.types)
        unclear = [*check.run(ends), *self._unused()]
        return [*unclear, *infer_exchanges(self._nodes.classes.items())]

    def explain(self, qualified_class: str, name: str) -> Explanation:
        """Returns why the text may know no element of a name: what is not imported or declared."""
        return explain(qualified_class, name, self._declarer.service)

    def _placed(self, fault: Fault) -> Fault:
        """Returns a syntax error with the element of which it may hide a part."""
        around = self._nodes.around(tree.Span(fault.line, fault.column))
        return replace(fault, owner=around, hides=True)

    def _unused(self) -> Iterator[Fault]:
        types = self._declarer.types
        for name, member in types.named.items():
            if name not in types.used and member.name is not None:
                span = member.name.span
                message = f"no member is of type '{name}'"
                yield Fault("JML706", message, line=span.line, column=span.column)

    def _import(self, item: tree.Import) -> None:
        target = imports.resolve(item)
        if isinstance(target, Fault):
            self._nodes.faults.append(target)
        else:
            self.imports.append(target)


def _own_service(document: tree.SyntaxTree) -> tree.Element | None:
    """Returns the only service of a text, if its maps may declare messages for it."""
    services = [
        item
        for item in document.items
        if isinstance(item, tree.Element)
        and item.keyword is not None
        and item.keyword.text == SERVICE
    ]
    return services[0] if len(services) == 1 and _lists_members(document.items) else None


def _lists_members(items: Sequence[tree.Item]) -> bool:
    """Tells whether an end of JAUS among items, or inside them, declares its members."""
    pending = list(items)
    for item in pending:
        if isinstance(item, tree.End) and item.is_jaus and item.members is not None:
            return True
        pending += [nested_item for inner, _ in tree.lists_of(item) for nested_item in inner]
    return False


_SERVICES, _PEERS = ("provides", "uses"), ("map", "peers", "query")


def infer_exchanges(classes: Iterable[tuple[Node, ClassTable]]) -> list[Fault]:
    """Sets the inferred features of connections; returns the ambiguous ones as faults."""
    wanted = [
        (node, table)
        for node, table in classes
        if table.qualified_name == CONNECTION and node.obj is not None
    ]
    # What services have does not change while exchanges are inferred.
    with remembering():
        return [fault for node, table in wanted for fault in _settle(node, table)]


def _settle(node: Node, table: ClassTable) -> Iterator[Fault]:
    connection: Any = node.obj
    written = {child.tag for child in node.children}
    unstated = [name for name in FEATURES if name not in written]
    if not unstated or connection.map is None:
        return
    stated = {
        name: getattr(getattr(connection, name), "name", None)
        for name in FEATURES
        if name in written
    }
    # With a reference unresolved, what follows from the rest may be wrong: nothing is reported.
    is_known = _is_read(node, _PEERS) and (node.parent is None or _knows_services(node.parent))
    inferred = infer(connection, **stated, is_known=is_known)
    for name in unstated:
        feature = table.features[name]
        literals = cast("DataTypeTable", feature.data_type).literals
        set_value(connection, feature, literals[getattr(inferred, name)])
    if len(inferred.options) > 1:
        yield _ambiguous(node, inferred)


@remembered
def _knows_services(bridge: Node) -> bool:
    """Returns whether the services of a bridge were read, once for all its connections."""
    return _is_read(bridge, _SERVICES)


def _is_read(node: Node, features: Iterable[str]) -> bool:
    """Tells whether all references that a text has of some features were resolved."""
    for name in features:
        written = sum(child.tag == name for child in node.children)
        value = getattr(node.obj, name)
        read = len(value) if hasattr(value, "__len__") else int(value is not None)
        if read < written:
            return False
    return True


def _ambiguous(node: Node, inferred: Inferred) -> Fault:
    connection: Any = node.obj
    message = f"'{connection.name}' may carry {connection.map.message.name} in several ways"
    telling = [
        name for name in FEATURES if len({getattr(option, name) for option in inferred.options}) > 1
    ]
    variants = [
        f"{'  '.join(f'{name}: {getattr(option, name)}' for name in telling)} ({option.meaning})"
        for option in inferred.options
    ]
    hint = f"write {', or '.join(variants)}"
    return Fault("JML715", message, hint, node.line, node.column, node)


_ROOTS = ("system.System", "bridge.MapLibrary", "jaus.ServiceSet", "ros.InterfacePackage")
_ROOT_FEATURE = "root"


class RootReader:
    """Makes the root elements of a document."""

    def __init__(self, elements: ElementReader, path: Path) -> None:
        self._nodes = elements.nodes
        self._metamodels = self._nodes.metamodels
        self._elements = elements
        self._path = path
        self._implicit: dict[str, Node] = {}
        self.roots: list[Node] = []
        self.types: dict[str, tree.Member] = {}
        """The named types that members of messages may have, by name."""

    def add(self, item: tree.Item) -> None:
        """Builds an item of the top level."""
        if isinstance(item, tree.Element):
            self._element(item)
        elif isinstance(item, tree.Feature):
            self._feature(item)
        elif isinstance(item, tree.Member):
            self._type(item)
        else:
            self._elements.misplaced(item)

    def _element(self, block: tree.Element) -> None:
        table = self._elements.class_of(block)
        if block.keyword is None and tree.is_map(block.items):
            owner = self._owner("bridge.MapLibrary", block.span)
            # A map needs no keyword: it is known by its ends.
            self._elements.owned_map(owner, block)
        elif table is None:
            self._elements.report_unknown(block)
        elif table.qualified_name in _ROOTS:
            self._explicit(table, block)
        else:
            taking = next((root for root in _ROOTS if self._takes(root, table)), None)
            if taking is None:
                message = f"a {table.name} does not stand alone"
                words = " ".join(name.text for name in (block.keyword, block.name) if name)
                hint = f"write it where it belongs, or root: new {words} {{ ... }}"
                self._nodes.fault("JML702", block.span, message, hint)
            else:
                self._elements.element(self._owner(taking, block.span), block)

    def _explicit(
        self, table: ClassTable, block: tree.Element, item: tree.Item | None = None
    ) -> None:
        node = self._nodes.root(table, block.span, block)
        self.roots.append(node)
        self._elements.fill(node, block, item)

    def _feature(self, item: tree.Feature) -> None:
        """Takes `root: new component x { ... }`, which makes a root of any element."""
        blocks = [value for value in item.values if isinstance(value, tree.Element)]
        if item.name.text != _ROOT_FEATURE or len(blocks) != len(item.values):
            message = f"feature '{item.name.text}' stands in no element"
            hint = "features stand in blocks: bridge front { address: 100.1.2 }"
            self._nodes.fault("JML702", item.span, message, hint)
            return
        for block in blocks:
            table = self._elements.class_of(block)
            if table is None:
                self._elements.report_unknown(block)
            else:
                self._explicit(table, block, item)

    def _type(self, member: tree.Member) -> None:
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
        contained = self._metamodels.classes[root].contained
        return any(feature.target in table.supertypes for feature in contained)

    def _owner(self, qualified_class: str, span: tree.Span) -> Node:
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
