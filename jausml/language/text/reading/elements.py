"""Reader of blocks: classes, owning features, values and references become nodes of elements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable, Metamodels, ValueKind
from jausml.language.model.notation import BY_NAME, Fault
from jausml.language.model.reading.classes import target_class
from jausml.language.model.values import nearest, show, suggest_or_list
from jausml.language.model.xmi.parsing import MAX_DEPTH, Node
from jausml.language.model.xmi.printing import XSI
from jausml.language.text.keywords import KEYWORDS, classes_by_keyword, keyword_of, owning_features
from jausml.language.text.tree import (
    Call,
    Element,
    Feature,
    Href,
    Item,
    Name,
    Number,
    Span,
    Text,
    Value,
    is_bare,
    is_map,
)

Source: TypeAlias = "Item | Call"
"""A part of a text that may stand for an element."""
Special: TypeAlias = "Callable[[Node, Item], None]"

_TYPE = f"{XSI} type"


class NodeMaker:
    """Maker of the nodes of one document, with the faults on the way.

    Each value of a feature is a child node of its own, so that everything has its place.
    """

    def __init__(self, metamodels: Metamodels) -> None:
        self.metamodels = metamodels
        self._prefixes = {package.name: package.ns_uri for package in metamodels.packages.values()}
        self.faults: list[Fault] = []
        self.classes: dict[Node, ClassTable] = {}
        """The class of each element."""
        self.spans: dict[Node, Span] = {}
        """Where each element is written."""
        self.sources: dict[Node, Source] = {}
        """The parts of the tree that stand for elements; elements that follow have none."""
        self.values: dict[Node, Span] = {}
        """Where each value and each reference is written."""

    def root(self, table: ClassTable, span: Span, source: Source | None = None) -> Node:
        """Returns the node of a root element."""
        node = self._node(f"{table.package.ns_uri} {table.name}", None, span)
        self.classes[node] = table
        return self._placed(node, span, source)

    def element(
        self, owner: Node, feature: str, table: ClassTable, span: Span, source: Source | None = None
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
        nodes = [
            node
            for node, extent in self.spans.items()
            if (extent.line, extent.column) <= place < (extent.end_line, extent.end_column)
        ]
        return max(nodes, key=lambda node: (node.line, node.column), default=None)

    def value(self, owner: Node, feature: str, text: str, span: Span) -> None:
        """Gives an element a value of an attribute."""
        self._value(owner, feature, span).text = text

    def null(self, owner: Node, feature: str, span: Span) -> None:
        """Sets an attribute to no value, although it has a default."""
        self._value(owner, feature, span).attributes = [f"{XSI} nil", "true"]

    def name(self, owner: Node, feature: str, name: str, span: Span) -> None:
        """Adds a reference by name."""
        self._value(owner, feature, span).attributes = [BY_NAME, name]

    def href(self, owner: Node, feature: str, href: str, span: Span) -> None:
        """Adds a reference by file and fragment."""
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
        # Offsets in bytes are for XML alone, whose attributes are looked up by them.
        node = Node(name, [], self._prefixes, owner, (span.line, span.column, 0))
        if owner is not None:
            owner.children.append(node)
        return node


_LOST = "jausml format keeps it, but no model has it"
_MOST_DIGITS = 100
DOCUMENTATION = "documentation"


class ElementReader:
    """Makes the nodes of elements from their blocks."""

    def __init__(self, nodes: NodeMaker) -> None:
        self.nodes = nodes
        self._keywords = classes_by_keyword(nodes.metamodels)
        self._depth = 0
        self.special: dict[str, Special] = {}
        """The readers of items that the blocks of a class alone have, by qualified class."""

    def class_of(self, block: Element) -> ClassTable | None:
        """Returns the class that the words before a block name, None for a map without keyword."""
        if block.keyword is not None:
            return self._keywords.get(block.keyword.text)
        return self._keywords.get(block.name.text) if block.name is not None else None

    def report_unknown(self, block: Element, owner: Node | None = None) -> None:
        """Reports words before a block that name no class."""
        word = block.keyword or block.name
        if word is None:
            message = "a block without a keyword says nothing of its class"
            self.nodes.fault("JML702", block.span, message, "write a keyword before it")
            return
        same = sorted(keyword for keyword in self._keywords if keyword.endswith(f".{word.text}"))
        keywords = [keyword for keyword in self._keywords if "." not in keyword]
        near = nearest(word.text, [*keywords, *(KEYWORDS if is_bare(block) else ())])
        hint = f"did you mean '{near}'?" if near else ""
        if same:
            hint = f"several classes share it: write {' or '.join(same)}"
        elif block.keyword is None and not near:
            hint = "a map has JAUS and ROS in its block; other elements a keyword before their name"
        elif is_bare(block) and not near:
            hint = "commas stand between values, and the keyword of its class before an element"
        message = f"unknown keyword {show(word.text)}"
        self.nodes.fault("JML702", word.span, message, hint, owner=owner, hides=True)

    def fill(self, node: Node, block: Element, item: Item | None = None) -> None:
        """Sets the name, documentation and contents of an element by its block.

        Args:
            item: What the documentation stands before, None for the block itself.
        """
        table = self.nodes.classes[node]
        if block.name is not None and block.keyword is not None:
            if "name" in table.features:
                self.nodes.value(node, "name", block.name.text, block.name.span)
            else:
                message = f"{table.name} has no name"
                hint = f"write '{block.keyword.text} {{'"
                self.nodes.fault("JML702", block.name.span, message, hint, owner=node)
        self.document(node, item or block)
        self.items(node, block.items)

    def document(self, node: Node, item: Item, table: ClassTable | None = None) -> None:
        """Gives an element the documentation that stands before an item."""
        if not item.documentation:
            return
        table = table or self.nodes.classes[node]
        if DOCUMENTATION in table.features:
            self.nodes.value(node, DOCUMENTATION, item.documentation, item.span)
        else:
            message = f"{table.name} has no documentation: the comment before it is lost"
            self.nodes.fault("JML703", item.span, message, _LOST)

    def items(self, node: Node, items: Sequence[Item]) -> None:
        """Adds the items of a block to an element."""
        if self._depth >= MAX_DEPTH // 2:
            span = items[0].span if items else Span(node.line, node.column)
            self.nodes.fault("JML008", span, f"blocks are nested more than {MAX_DEPTH // 2} deep")
            return
        self._depth += 1
        special = self.special.get(self.nodes.classes[node].qualified_name)
        for item in items:
            if isinstance(item, Feature):
                self.feature(node, item)
            elif isinstance(item, Element):
                self.element(node, item)
            elif special is not None:
                special(node, item)
            else:
                self.misplaced(item, node)
        self._depth -= 1

    def misplaced(self, item: Item, owner: Node | None = None) -> None:
        """Reports an item that has no meaning where it stands."""
        where = f"in {self.nodes.classes[owner].name}" if owner is not None else "on top level"
        words = {"End": "JAUS and ROS stand", "Direction": "assignments stand"}
        kind = type(item).__name__
        what = words.get(kind, f"this {kind.lower()} stands")
        message = f"{what} in a map, and not {where}"
        hint = "write a map around it: name { JAUS ... ROS ... }"
        self.nodes.fault("JML702", item.span, message, hint, owner=owner)

    def element(self, owner: Node, block: Element) -> None:
        """Adds a part to an element."""
        table = self.class_of(block)
        features = self.nodes.classes[owner].features
        is_plain_map = block.keyword is None and is_map(block.items)
        # A word that is no keyword is rather the name of a map, if one may stand here.
        if is_plain_map or (table is None and self._may_be_map(owner, block)):
            self.owned_map(owner, block)
            return
        if table is None:
            written = block.keyword or block.name
            if written is not None and written.text in features:
                is_value = block.name is not None and is_bare(block)
                value = block.name.text if is_value and block.name is not None else "{ ... }"
                hint = f"write '{written.text}: {value}'"
                message = f"'{written.text}' is a feature: a colon stands before its value"
                self.nodes.fault("JML702", written.span, message, hint, owner=owner)
                return
            self.report_unknown(block, owner)
            return
        owning = self._owning(owner, table)
        if len(owning) == 1:
            self.fill(self.nodes.element(owner, owning[0], table, block.span, block), block)
            return
        self._report_owner(owner, block, table, owning)

    def owned_map(self, owner: Node, block: Element) -> None:
        """Gives an element an attribute map, which needs no keyword."""
        table = self.nodes.metamodels.classes["bridge.AttributeMap"]
        owning = self._owning(owner, table)
        if len(owning) != 1:
            self._report_owner(owner, block, table, owning)
            return
        node = self.nodes.element(owner, owning[0], table, block.span, block)
        self.fill_map(node, block)

    def fill_map(self, node: Node, block: Element) -> None:
        """Sets the name of a map, which may be the only word before its block, and its contents."""
        if block.keyword is None and block.name is not None:
            self.nodes.value(node, "name", block.name.text, block.name.span)
        self.fill(node, block)

    def feature(self, node: Node, item: Feature) -> None:
        """Gives an element the values of a feature."""
        table = self.nodes.classes[node]
        feature = table.features.get(item.name.text)
        if feature is None:
            near = suggest_or_list(item.name.text, table.features)
            what = f"unknown feature {show(item.name.text)} of {table.name}"
            meant = nearest(item.name.text, table.features)
            self.nodes.fault("JML103", item.name.span, what, near, owner=node, feature=meant)
            return
        blocks = [block for block in item.values if isinstance(block, Element)]
        # A comment documents a block; with several values it is open which one.
        if item.documentation and not (len(item.values) == len(blocks) == 1):
            message = f"the comment before feature '{feature.name}' documents nothing"
            self.nodes.fault("JML703", item.span, message, _LOST)
        for value in item.values:
            self._value(node, feature, value, item)

    def _value(self, node: Node, feature: FeatureTable, value: Value, item: Feature) -> None:
        if isinstance(value, Href):
            self._href(node, feature, value)
        elif isinstance(value, Element):
            if feature.kind is FeatureKind.CONTAINMENT:
                self._block_value(node, feature, value, item)
            else:
                what = "refers to elements" if feature.is_reference else "has a value"
                self._wrong(node, feature, value.span, f"{what}, it owns none")
        elif feature.kind is FeatureKind.ATTRIBUTE:
            self.nodes.value(node, feature.name, literal(value, feature), value.span)
        elif feature.kind is FeatureKind.CONTAINMENT:
            hint = f"write {feature.name}: {{ ... }}"
            self._wrong(node, feature, value.span, "owns its elements", hint)
        elif isinstance(value, Number):
            self._wrong(node, feature, value.span, "takes a name, no number")
        else:
            self.nodes.name(node, feature.name, value.text, value.span)

    def _href(self, node: Node, feature: FeatureTable, value: Href) -> None:
        if feature.kind is not FeatureKind.ATTRIBUTE:
            self.nodes.href(node, feature.name, value.text, value.span)
        elif value.text:
            self._wrong(node, feature, value.span, "has a value, no reference")
        else:
            self.nodes.null(node, feature.name, value.span)

    def _block_value(
        self, node: Node, feature: FeatureTable, block: Element, item: Feature
    ) -> None:
        wanted = target_class(feature)
        table = wanted if block.keyword is None and block.name is None else self.class_of(block)
        if table is None:
            self.report_unknown(block, node)
        elif table not in wanted.subtypes or table.abstract:
            is_too_wide = table in wanted.subtypes
            what = "needs a class" if is_too_wide else f"is {keyword_of(table.name)}"
            legal = sorted(keyword_of(kind.name) for kind in wanted.subtypes if not kind.abstract)
            hint = f"write 'new' and one of: {' or '.join(legal)}"
            self._wrong(node, feature, block.span, f"takes {wanted.name}; this {what}", hint)
        else:
            child = self.nodes.element(node, feature.name, table, block.span, block)
            self.fill(child, block, item if len(item.values) == 1 else None)

    def _wrong(
        self, node: Node, feature: FeatureTable, span: Span, what: str, hint: str = ""
    ) -> None:
        message = f"feature '{feature.name}' of {self.nodes.classes[node].name} {what}"
        self.nodes.fault("JML705", span, message, hint, owner=node, feature=feature.name)

    def _may_be_map(self, owner: Node, block: Element) -> bool:
        """Tells whether a word that names no class is rather the name of a map."""
        table = self.nodes.metamodels.classes["bridge.AttributeMap"]
        is_alone = block.keyword is None and block.name is not None
        near = nearest(block.name.text, self._keywords) if block.name is not None else ""
        return is_alone and not near and bool(self._owning(owner, table)) and not block.items

    def _owning(self, owner: Node, table: ClassTable) -> Sequence[str]:
        """Returns the features of an element that may own an element of a class."""
        return owning_features(self.nodes.classes[owner], table)

    def _report_owner(
        self, owner: Node, block: Element, table: ClassTable, owning: Sequence[str]
    ) -> None:
        what = f"{self.nodes.classes[owner].name} owns no {table.name}"
        hint = ""
        if owning:
            what = f"{table.name} may stand in {' or '.join(owning)}"
            hint = f"write {owning[0]}: new {keyword_of(table.name)} ..."
        self.nodes.fault("JML702", block.span, what, hint, owner=owner)


def literal(value: Name | Number | Text, feature: FeatureTable) -> str:
    """Returns the text of a value as XMI writes it: whole numbers have their decimal digits."""
    kind = feature.data_type.kind if feature.data_type is not None else ValueKind.STRING
    if isinstance(value, Number) and kind in (ValueKind.INTEGER, ValueKind.REAL):
        return decimal(value.text)
    return value.text


def decimal(number: str) -> str:
    """Returns a number without hexadecimal digits; one beyond all types stays as it is."""
    sign, digits = ("-", number[1:]) if number.startswith("-") else ("", number.lstrip("+"))
    # int() of a very long number takes long, and no type of the metamodels holds one.
    if digits[:2] in ("0x", "0X") and len(digits) <= _MOST_DIGITS:
        return f"{sign}{int(digits, 16)}"
    return sign + digits
