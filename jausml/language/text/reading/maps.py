"""Reader of attribute maps: both ends, assignments, tables and test vectors become nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeGuard

from jausml.language.metamodel import ClassTable
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.conversions import CONVERSIONS, Argument, ArgumentKind
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.text import tree
from jausml.language.text.reading.elements import ElementReader, Special, decimal

MAP = "bridge.AttributeMap"
LIST = "bridge.ListAssignment"
_BOOLEANS = ("true", "false")


@dataclass(frozen=True, slots=True)
class WrittenEnd:
    """An end of a map as it is written, and the node of the map."""

    end: tree.End
    node: Node


class MapReader:
    """Maker of the nodes that only attribute maps have."""

    def __init__(self, elements: ElementReader) -> None:
        self._nodes = elements.nodes
        self._classes = self._nodes.metamodels.classes
        self._elements = elements
        self.ends: list[WrittenEnd] = []
        self.special: dict[str, Special] = {MAP: self._item, LIST: self._inner_item}
        """The readers of items that only maps and lists have, by qualified class."""

    def _item(self, node: Node, item: tree.Item) -> None:
        if isinstance(item, tree.End):
            self._end(node, item)
        elif isinstance(item, tree.Direction):
            feature = "toRos" if item.to_ros else "toJaus"
            self._undocumented(node, item, "assignments of a direction")
            for assignment in item.assignments:
                self._assignment(node, feature, assignment)
        elif isinstance(item, tree.Table):
            self._table(node, item)
        elif isinstance(item, tree.Vector):
            self._vector(node, item)
        else:
            self._elements.misplaced(item, node)

    def _inner_item(self, node: Node, item: tree.Item) -> None:
        if isinstance(item, tree.Assignment | tree.Ignored):
            self._assignment(node, "assignments", item)
        else:
            self._elements.misplaced(item, node)

    def _end(self, node: Node, end: tree.End) -> None:
        self.ends.append(WrittenEnd(end, node))
        # Members are looked at later, once the names of messages can be resolved.
        feature = "message" if end.is_jaus else "type"
        self._nodes.name(node, feature, end.type.text, end.type.span)

    def _assignment(self, node: Node, feature: str, item: tree.Assignment | tree.Ignored) -> None:
        if isinstance(item, tree.Ignored):
            child = self._new(node, feature, "Ignore", item)
            self._nodes.value(child, "target", item.target.text, item.target.span)
            return
        child = self._new(node, feature, _class_of(item), item)
        self._source(child, item)
        if item.targets:
            targets = ", ".join(target.text for target in item.targets)
            self._nodes.value(child, "target", targets, item.targets[0].span)
        for call in item.conversions:
            self._conversion(child, call)
        self._elements.items(child, item.items)

    def _source(self, node: Node, item: tree.Assignment) -> None:
        if not item.sources:
            return
        first = item.sources[0]
        odd = [
            source
            for source in item.sources
            if _is_constant(source) or isinstance(source, tree.Clock)
        ]
        if odd and len(item.sources) > 1:
            message = "a constant or the clock is the only source of an assignment"
            hint = "several sources are attributes; an expression may have numbers"
            self._nodes.fault("JML705", odd[0].span, message, hint, owner=node)
        elif isinstance(first, tree.Clock):
            pass
        # true and false are names to the grammar, and constants here.
        elif _is_constant(first):
            self._nodes.value(node, "value", first.text, first.span)
        else:
            texts = [source.text for source in item.sources if not isinstance(source, tree.Clock)]
            self._nodes.value(node, "source", ", ".join(texts), first.span)

    def _conversion(self, owner: Node, call: tree.Call) -> None:
        table = self._nodes.classes[owner]
        if "conversions" not in table.features:
            message = f"{table.name} takes no conversion"
            hint = "conversions stand behind attributes: a -> b : negate"
            self._nodes.fault("JML705", call.span, message, hint, owner=owner)
            return
        conversion = self._classes["bridge.Conversion"]
        node = self._nodes.element(owner, "conversions", conversion, call.span, call)
        self._nodes.value(node, "kind", call.name.text, call.name.span)
        for argument in call.arguments:
            if isinstance(argument, tree.Number):
                self._nodes.value(node, "arguments", decimal(argument.text), argument.span)
            elif isinstance(argument, tree.Text):
                self._text_argument(node, call, argument)
            else:
                self._name_argument(node, call, argument)

    def _text_argument(self, node: Node, call: tree.Call, argument: tree.Text) -> None:
        own = _own_argument(call)
        if own is not None and own.is_text:
            self._nodes.value(node, own.feature, argument.text, argument.span)
            return
        message = f"conversion '{call.name.text}' takes no text"
        known = [
            conversion.name
            for conversion in CONVERSIONS.values()
            if any(argument.is_text for argument in conversion.arguments)
        ]
        hint = f"{' and '.join(sorted(known))} do"
        self._nodes.fault("JML705", argument.span, message, hint, owner=node)

    def _name_argument(self, node: Node, call: tree.Call, argument: tree.Name) -> None:
        # The name is that of a method, a table or else a quantity: the conversion says which.
        own = _own_argument(call)
        if own is not None and own.kind is ArgumentKind.METHOD:
            self._nodes.value(node, own.feature, argument.text, argument.span)
            return
        is_table = own is not None and own.kind is ArgumentKind.TABLE
        feature = own.feature if own is not None and is_table else "quantity"
        self._nodes.name(node, feature, argument.text, argument.span)

    def _table(self, owner: Node, item: tree.Table) -> None:
        node = self._new(owner, "tables", "ValueTable", item)
        self._nodes.value(node, "name", item.name.text, item.name.span)
        for entry in item.entries:
            child = self._new(node, "entries", "TableEntry", entry)
            self._nodes.value(child, "jaus", entry.jaus.text, entry.jaus.span)
            self._nodes.value(child, "ros", entry.ros.text, entry.ros.span)

    def _vector(self, owner: Node, item: tree.Vector) -> None:
        node = self._new(owner, "vectors", "TestVector", item)
        self._nodes.value(node, "name", item.name.text, item.name.span)
        direction = TO_ROS if item.to_ros else TO_JAUS
        self._nodes.value(node, "direction", direction, item.span)
        for feature, entries in (("given", item.given), ("expected", item.expected)):
            self._vector_values(node, feature, entries)

    def _vector_values(
        self, owner: Node, feature: str, entries: Sequence[tree.VectorEntry]
    ) -> None:
        for entry in entries:
            node = self._new(owner, feature, "VectorValue", entry)
            self._nodes.value(node, "path", entry.path.text, entry.path.span)
            self._nodes.value(node, "value", entry.value.text, entry.value.span)
            if entry.tolerance is not None:
                text = decimal(entry.tolerance.text)
                self._nodes.value(node, "tolerance", text, entry.tolerance.span)

    def _new(self, owner: Node, feature: str, class_name: str, item: tree.Item) -> Node:
        table: ClassTable = self._classes[f"bridge.{class_name}"]
        node = self._nodes.element(owner, feature, table, item.span, item)
        self._elements.document(node, item)
        return node

    def _undocumented(self, node: Node, item: tree.Item, what: str) -> None:
        if item.documentation:
            message = f"{what} have no documentation: the comment before them is lost"
            self._nodes.fault("JML703", item.span, message, "", owner=node)


def _own_argument(call: tree.Call) -> Argument | None:
    conversion = CONVERSIONS.get(call.name.text)
    return conversion.own_argument if conversion is not None else None


def _class_of(item: tree.Assignment) -> str:
    if any(isinstance(part, tree.Assignment | tree.Ignored) for part in item.items) or _is_list(
        item.items
    ):
        return "ListAssignment"
    if any(isinstance(part, tree.Feature) and part.name.text == "map" for part in item.items):
        return "MessageAssignment"
    first = item.sources[0] if item.sources else None
    if isinstance(first, tree.Clock):
        return "ClockAssignment"
    return "ConstantAssignment" if _is_constant(first) else "FieldAssignment"


def _is_list(items: Sequence[tree.BlockItem]) -> bool:
    """Tells whether elements of a block are assignments in the uniform notation."""
    words = (item.keyword or item.name for item in items if isinstance(item, tree.Element))
    features = (item.name for item in items if isinstance(item, tree.Feature))
    endings = [word.text for word in words if word is not None]
    return any(ending.endswith("_assignment") or ending == "ignore" for ending in endings) or any(
        feature.text == "assignments" for feature in features
    )


def _is_constant(
    source: tree.Name | tree.Number | tree.Text | tree.Clock | None,
) -> TypeGuard[tree.Name | tree.Number | tree.Text]:
    if isinstance(source, tree.Name):
        return source.text in _BOOLEANS
    return isinstance(source, tree.Number | tree.Text)
