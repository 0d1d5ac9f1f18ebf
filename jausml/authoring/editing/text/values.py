"""Changes of the values of features in blocks: the values that differ, and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.filling import contents
from jausml.language.semantics.ways import CONNECTION, FEATURES
from jausml.language.text.tree import Assignment, Element, Feature, Value
from jausml.language.text.writing.layout import WIDTH, simple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.desk import Desk
    from jausml.authoring.editing.text.outline import Part
    from jausml.authoring.editing.text.places import Places
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject


class Values:
    """Sets attributes and references that stand in blocks as features."""

    def __init__(self, desk: Desk, places: Places) -> None:
        self._desk = desk
        self._places = places

    def set(
        self,
        obj: EObject,
        part: Part,
        sketch: EObject,
        feature: FeatureTable,
        values: Sequence[Any],
    ) -> None:
        """Has a block say other values of a feature.

        Args:
            values: Its new values; without any, nothing is said of it.
        """
        items = self.items(part, feature.name)
        if not values:
            self.remove(part, feature.name)
        elif items:
            self._change(obj, sketch, feature, values, items)
        elif self._must_be_said(obj, feature, values):
            self.add(obj, part, self._desk.elements.feature(sketch, feature))

    def add(self, obj: EObject, part: Part, item: Feature) -> None:
        """Adds a feature to the block of an element."""
        body = self._desk.outline.body(part)
        before = None
        if body is not None:
            before = self._places.for_value(obj, item.name.text, body)
        self._desk.add_item(part, before, item)

    def items(self, part: Part, name: str) -> list[Feature]:
        """Returns the items of a block that give values to a feature."""
        inner = part.items if isinstance(part, Element | Assignment) else []
        return [each for each in inner if isinstance(each, Feature) and each.name.text == name]

    def remove(self, part: Part, name: str) -> None:
        """Takes what gives values to a feature out of a block."""
        items = self.items(part, name)
        body = self._desk.outline.body(part)
        if body is None or not items:
            return
        closing = part.closing if isinstance(part, Assignment) else [""]
        if isinstance(part, Assignment) and len(items) == len(part.items) and not closing:
            # Without a block an assignment says the same.
            start = self._desk.source.before_space(body.start - 1, 0)
            self._desk.edits.delete(start, body.end + 1)
        else:
            self._desk.blocks.remove(body, items)

    def put(self, item: Feature, value: Value) -> None:
        """Puts one value in place of all that a feature has."""
        self._replace(item, [value], 0, len(item.values))

    def _must_be_said(self, obj: EObject, feature: FeatureTable, values: Sequence[Any]) -> bool:
        """Tells whether a feature that the text leaves open must be stated now."""
        if feature.name in FEATURES and self._desk.table(obj).qualified_name == CONNECTION:
            # What is left open follows from the rest, and that may change.
            return True
        return feature.unsettable or not _are_same(_values(obj, feature), values)

    def _change(
        self,
        obj: EObject,
        sketch: EObject,
        feature: FeatureTable,
        values: Sequence[Any],
        items: Sequence[Feature],
    ) -> None:
        old = _values(obj, feature)
        if _are_same(old, values):
            return
        rendered = self._desk.elements.feature(sketch, feature).values
        if len(items) > 1 or len(old) != len(items[0].values):
            for each in items[1:]:
                body, _ = self._desk.outline.place(each)
                self._desk.blocks.remove(body, [each])
            self._replace(items[0], rendered, 0, len(items[0].values))
            return
        most = min(len(old), len(values))
        front = 0
        while front < most and _is_same(old[front], values[front]):
            front += 1
        back = 0
        while back < most - front and _is_same(old[-1 - back], values[-1 - back]):
            back += 1
        self._replace(items[0], rendered[front : len(values) - back], front, len(old) - back)

    def _replace(self, item: Feature, new: Sequence[Value], start: int, end: int) -> None:
        """Puts values in place of some of the values of a feature."""
        source, edits = self._desk.source, self._desk.edits
        spans = [source.range_of(each.span) for each in item.values]
        if start < end and new:
            edits.replace(spans[start][0], spans[end - 1][1], self._joined(item, new, ""))
        elif new and start:
            at = spans[start - 1][1]
            edits.insert(at, self._joined(item, new, ", ", source.line_start(at)))
        elif new:
            edits.insert(spans[0][0], self._joined(item, new, "") + ", ")
        elif start:
            edits.delete(spans[start - 1][1], spans[end - 1][1])
        elif end < len(spans):
            edits.delete(spans[0][0], spans[end][0])

    def _joined(
        self, item: Feature, values: Sequence[Value], lead: str, line: int | None = None
    ) -> str:
        """Returns values with commas; behind others, those that do not fit begin a line."""
        source = self._desk.source
        indent = source.indent_of(self._desk.outline.start(item)) + source.unit
        texts = [simple(each) for each in values if not isinstance(each, Element)]
        if line is None:
            return lead + ", ".join(texts)
        end = source.line_end(line)
        width = end - line
        found = ""
        for text in texts:
            if width + len(text) + len(", ") > WIDTH:
                found += f",\n{indent}{text}"
                width = len(indent) + len(text)
            else:
                found += f", {text}"
                width += len(text) + len(", ")
        return found


def _values(obj: EObject, feature: FeatureTable) -> list[Any]:
    return list(contents(obj, feature)) if feature.many else [getattr(obj, feature.name)]


def _are_same(ones: Sequence[Any], others: Sequence[Any]) -> bool:
    return len(ones) == len(others) and all(map(_is_same, ones, others))


def _is_same(one: Any, other: Any) -> bool:
    return one is other or (not hasattr(one, "eClass") and bool(one == other))
