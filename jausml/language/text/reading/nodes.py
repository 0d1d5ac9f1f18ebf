"""Maker of the nodes that a text stands for, as the XMI parser would have made them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from jausml.language.model.notation import BY_NAME, Fault
from jausml.language.model.reading.classes import XSI
from jausml.language.model.xmi.parsing import Node

if TYPE_CHECKING:
    from jausml.language.metamodel import ClassTable, Metamodels
    from jausml.language.text.tree import Call, Item, Span

    Source: TypeAlias = Item | Call
    """What of a text may stand for an element."""

_TYPE = f"{XSI} type"


class NodeMaker:
    """Makes the nodes of one document, and keeps what is found on the way.

    Each value of a feature is a child node of its own, so that everything has its place.
    """

    def __init__(self, metamodels: Metamodels) -> None:
        self._prefixes = {each.name: each.ns_uri for each in metamodels.packages.values()}
        self.faults: list[Fault] = []
        self.classes: dict[Node, ClassTable] = {}
        """The class of each element."""
        self.spans: dict[Node, Span] = {}
        """Where each element is written."""
        self.sources: dict[Node, Source] = {}
        """What of the tree stands for an element by itself; elements that follow have none."""
        self.values: dict[Node, Span] = {}
        """Where each value and each reference is written."""

    def root(self, table: ClassTable, span: Span, source: Source | None = None) -> Node:
        """Returns the node of a root element."""
        node = self._node(f"{table.package.ns_uri} {table.name}", None, span)
        self.classes[node] = table
        return self._placed(node, span, source)

    def element(
        self,
        owner: Node,
        feature: str,
        table: ClassTable,
        span: Span,
        source: Source | None = None,
    ) -> Node:
        """Returns the node of an element that another one owns.

        Args:
            source: What of the tree stands for it, None for one that follows from something else.
        """
        node = self._node(feature, owner, span)
        node.attributes = [_TYPE, f"{table.package.name}:{table.name}"]
        self.classes[node] = table
        return self._placed(node, span, source)

    def around(self, span: Span) -> Node | None:
        """Returns the innermost element around the beginning of a span."""
        place = (span.line, span.column)
        found = [
            node
            for node, each in self.spans.items()
            if (each.line, each.column) <= place < (each.end_line, each.end_column)
        ]
        return max(found, key=lambda node: (node.line, node.column), default=None)

    def value(self, owner: Node, feature: str, text: str, span: Span) -> None:
        """Gives an element a value of an attribute."""
        self._value(owner, feature, span).text = text

    def null(self, owner: Node, feature: str, span: Span) -> None:
        """Gives an attribute of an element no value, although it has a default."""
        self._value(owner, feature, span).attributes = [f"{XSI} nil", "true"]

    def name(self, owner: Node, feature: str, name: str, span: Span) -> None:
        """Has an element refer to another one by name."""
        self._value(owner, feature, span).attributes = [BY_NAME, name]

    def href(self, owner: Node, feature: str, href: str, span: Span) -> None:
        """Has an element refer to another one by file and fragment."""
        self._value(owner, feature, span).attributes = ["href", href]

    def fault(
        self,
        rule: str,
        span: Span,
        message: str,
        hint: str = "",
        *,
        owner: Node | None = None,
        feature: str = "",
        hides: bool = False,
    ) -> None:
        """Notes a finding, as `Fault` says."""
        fault = Fault(rule, message, hint, span.line, span.column, owner, feature, hides)
        self.faults.append(fault)

    def _placed(self, node: Node, span: Span, source: Source | None) -> Node:
        self.spans[node] = span
        if source is not None:
            self.sources[node] = source
        return node

    def _value(self, owner: Node, feature: str, span: Span) -> Node:
        node = self._node(feature, owner, span)
        self.values[node] = span
        return node

    def _node(self, name: str, owner: Node | None, span: Span) -> Node:
        node = Node(name, [], self._prefixes, owner, (span.line, span.column, 0))
        if owner is not None:
            owner.children.append(node)
        return node
