"""Text documents: parsed texts on their way to elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.language.model.notation import Fault, ImportedDocument
from jausml.language.text.reading import imports
from jausml.language.text.reading.bridge_of_maps import add_bridge
from jausml.language.text.reading.declarations.declarer import Declarer
from jausml.language.text.reading.elements import ElementReader
from jausml.language.text.reading.exchanges import infer_exchanges
from jausml.language.text.reading.imports import explain
from jausml.language.text.reading.maps import MapReader
from jausml.language.text.reading.members import MemberCheck
from jausml.language.text.reading.nodes import NodeMaker
from jausml.language.text.reading.roots import RootReader
from jausml.language.text.tree import Element, End, Import, Span, lists_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from jausml.language.metamodel import Metamodels
    from jausml.language.model.notation import Explanation, Known
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.bridge_options import BridgeOfMaps
    from jausml.language.text.reading.nodes import Source
    from jausml.language.text.tree import Item, SyntaxTree

SERVICE = "service"
"""The keyword of services, one of which may take the messages that a text declares."""


class TextDocument:
    """The nodes of a text, and what is declared and checked once its surroundings are known."""

    def __init__(
        self,
        document: SyntaxTree,
        faults: Sequence[Fault],
        path: Path,
        metamodels: Metamodels,
        bridge: BridgeOfMaps | None = None,
    ) -> None:
        self.tree = document
        self._metamodels = metamodels
        self._bridge = bridge
        self._nodes = NodeMaker(metamodels)
        elements = ElementReader(metamodels, self._nodes)
        self._maps = MapReader(metamodels, self._nodes, elements)
        elements.special |= self._maps.special
        self._roots = RootReader(metamodels, self._nodes, elements, path)
        self._declarer = Declarer(metamodels, self._nodes, elements, path, self._roots.types)
        self.imports: list[ImportedDocument] = []
        self._declarer.service.written = _own_service(document)
        self._declarer.service.asks_for_all = bridge is not None
        for item in document.items:
            if isinstance(item, Import):
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
        """What is wrong with the text."""
        return self._nodes.faults

    def source_of(self, node: Node) -> Source | None:
        """Returns what of the tree stands for an element; None where it follows from the rest."""
        return self._nodes.sources.get(node)

    def value_span(self, node: Node) -> Span | None:
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
        return add_bridge(bridge, ends, self._declarer, known, self._nodes, self._metamodels)

    def check(self) -> Sequence[Fault]:
        """Settles what connections leave open; returns what is unclear about them and members."""
        ends = [each for each in self._maps.ends if not self._declarer.declares(each.end)]
        check = MemberCheck(self._declarer.types)
        unclear = [*check.run(ends), *self._unused()]
        return [*unclear, *infer_exchanges(self._nodes.classes.items())]

    def _placed(self, fault: Fault) -> Fault:
        """Returns a syntax error with the element of which it may hide anything."""
        around = self._nodes.around(Span(fault.line, fault.column))
        return replace(fault, owner=around, hides=True)

    def explain(self, qualified_class: str, name: str) -> Explanation:
        """Returns why the text may know no element of a name: what is not imported or declared."""
        return explain(qualified_class, name, self._declarer.service)

    def _unused(self) -> Iterator[Fault]:
        types = self._declarer.types
        for name, member in types.named.items():
            if name not in types.used and member.name is not None:
                span = member.name.span
                message = f"no member is of type '{name}'"
                yield Fault("JML706", message, line=span.line, column=span.column)

    def _import(self, item: Import) -> None:
        found = imports.resolve(item)
        if isinstance(found, Fault):
            self._nodes.faults.append(found)
        else:
            self.imports.append(found)


def _own_service(document: SyntaxTree) -> Element | None:
    """Returns the one service that a text writes, if its maps may declare messages for it."""
    found = [
        item
        for item in document.items
        if isinstance(item, Element) and item.keyword is not None and item.keyword.text == SERVICE
    ]
    return found[0] if len(found) == 1 and _lists_members(document.items) else None


def _lists_members(items: Sequence[Item]) -> bool:
    pending = list(items)
    for item in pending:
        if isinstance(item, End) and item.is_jaus and item.members is not None:
            return True
        pending += [each for inner, _ in lists_of(item) for each in inner]
    return False
