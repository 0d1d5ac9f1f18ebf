"""Changes of what a text says of an element: name, documentation, and values that differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.splices import common_ends
from jausml.language.metamodel.filling import contents
from jausml.language.semantics.connections.exchanges import CONNECTION, FEATURES
from jausml.language.text.tree import (
    Assignment,
    Element,
    Feature,
    Ignored,
    Name,
    Table,
    Text,
    Value,
    Vector,
    snake_case,
)
from jausml.language.text.writing.layout import WIDTH, simple
from jausml.language.text.writing.spelling import documentation, is_comment, is_name, word

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.edited import EditedText, FeatureChange, InsertionPoints
    from jausml.authoring.editing.text.source import Part
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject

NAME, DOCUMENTATION = "name", "documentation"


class Values:
    """Sets attributes and references that stand in blocks as features."""

    def __init__(self, edited: EditedText, points: InsertionPoints) -> None:
        self._edited = edited
        self._points = points

    def set(self, change: FeatureChange) -> None:
        """Has a block say other values of a feature."""
        part, feature = change.part, change.feature
        items = self.items(part, feature.name)
        if not change.values:
            self.remove(part, feature.name)
        elif items:
            self._change(change, items)
        elif self._must_be_said(change.obj, feature, change.values):
            self.add(change.obj, part, self._edited.elements.feature(change.alone, feature))

    def add(self, obj: EObject, part: Part, item: Feature) -> None:
        """Adds a feature to the block of an element."""
        body = self._edited.outline.body(part)
        before = None
        if body is not None:
            before = self._points.for_value(obj, item.name.text, body)
        self._edited.add_item(part, before, item)

    def items(self, part: Part, name: str) -> list[Feature]:
        """Returns the items of a block that give values to a feature."""
        inner = part.items if isinstance(part, Element | Assignment) else []
        return [each for each in inner if isinstance(each, Feature) and each.name.text == name]

    def remove(self, part: Part, name: str) -> None:
        """Takes what gives values to a feature out of a block."""
        items = self.items(part, name)
        body = self._edited.outline.body(part)
        if body is None or not items:
            return
        closing = part.closing if isinstance(part, Assignment) else [""]
        if isinstance(part, Assignment) and len(items) == len(part.items) and not closing:
            # Without a block an assignment says the same.
            start = self._edited.source.before_space(body.start - 1, 0)
            self._edited.edits.delete(start, body.end + 1)
        else:
            self._edited.blocks.remove(body, items)

    def put(self, item: Feature, value: Value) -> None:
        """Puts one value in place of all that a feature has."""
        self._replace(item, [value], 0, len(item.values))

    def _must_be_said(self, obj: EObject, feature: FeatureTable, values: Sequence[Any]) -> bool:
        """Tells whether a feature that the text leaves open must be stated now."""
        if feature.name in FEATURES and self._edited.table(obj).qualified_name == CONNECTION:
            # What is left open follows from the rest, and that may change.
            return True
        return feature.unsettable or not _are_same(_values(obj, feature), values)

    def _change(self, change: FeatureChange, items: Sequence[Feature]) -> None:
        feature, values = change.feature, change.values
        old = _values(change.obj, feature)
        if _are_same(old, values):
            return
        rendered = self._edited.elements.feature(change.alone, feature).values
        if len(items) > 1 or len(old) != len(items[0].values):
            for each in items[1:]:
                body, _ = self._edited.outline.place(each)
                self._edited.blocks.remove(body, [each])
            self._replace(items[0], rendered, 0, len(items[0].values))
            return
        front, back = common_ends(old, values, _is_same)
        self._replace(items[0], rendered[front : len(values) - back], front, len(old) - back)

    def _replace(self, item: Feature, new: Sequence[Value], start: int, end: int) -> None:
        """Puts values in place of some of the values of a feature."""
        source, edits = self._edited.source, self._edited.edits
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
        source = self._edited.source
        indent = source.indent_of(self._edited.outline.start(item)) + source.unit
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


class Heads:
    """Sets names and documentation."""

    def __init__(self, edited: EditedText, values: Values) -> None:
        self._edited = edited
        self._values = values

    def set_name(self, obj: EObject, part: Part, name: str | None) -> None:
        """Gives an element another name, or takes it away."""
        if isinstance(part, Table | Vector):
            if name is None or not is_name(name):
                raise EditError(
                    f"a {self._edited.table(obj).name} cannot be named {name!r} in text"
                )
            self._replace(part.name, word(name))
        elif isinstance(part, Element):
            self._set_name(obj, part, name)
        else:
            raise EditError(f"a {self._edited.table(obj).name} has no name in text")

    def _set_name(self, obj: EObject, part: Element, name: str | None) -> None:
        items = self._values.items(part, NAME)
        is_sayable = name is not None and is_name(name)
        if items and name is not None:
            self._values.put(items[0], Text(name))
        elif items:
            self._values.remove(part, NAME)
        elif is_sayable and name is not None:
            self._name_head(obj, part, word(name))
        else:
            self._unname_head(obj, part)
            if name is not None:
                self._values.add(obj, part, Feature(Name(NAME), [Text(name)]))
            elif self._edited.outline.body(part) is None:
                self._edited.edits.insert(self._edited.outline.end(part), " {}")

    def _name_head(self, obj: EObject, part: Element, name: str) -> None:
        edits, outline = self._edited.edits, self._edited.outline
        if part.name is not None and self._edited.is_named_by(obj, part):
            self._replace(part.name, name)
        elif part.name is not None:
            # One word alone stands for the class.
            edits.insert(self._edited.source.range_of(part.name.span)[1], f" {name}")
        elif part.keyword is not None:
            edits.insert(self._edited.source.range_of(part.keyword.span)[1], f" {name}")
        else:
            keyword = snake_case(self._edited.table(obj).name)
            edits.insert(outline.start(part), f"new {keyword} {name} ")

    def _unname_head(self, obj: EObject, part: Element) -> None:
        if part.name is None or not self._edited.is_named_by(obj, part):
            return
        if part.keyword is None:
            self._replace(part.name, snake_case(self._edited.table(obj).name))
            return
        source, edits = self._edited.source, self._edited.edits
        edits.delete(source.range_of(part.keyword.span)[1], source.range_of(part.name.span)[1])

    def set_documentation(self, obj: EObject, part: Part, text: str | None) -> None:
        """Gives an element another documentation, or takes it away."""
        item = self._edited.outline.item_of(part)
        if isinstance(part, Element | Assignment):
            items = self._values.items(part, DOCUMENTATION)
            if items and text:
                self._values.put(items[0], Text(text))
                return
            self._values.remove(part, DOCUMENTATION)
        if isinstance(item, Feature) and len(item.values) > 1:
            raise EditError("values that share a feature have no documentation of their own")
        if text is None or is_comment(text):
            self._comment(item, text or "")
        elif isinstance(part, Element):
            self._comment(item, "")
            self._values.add(obj, part, Feature(Name(DOCUMENTATION), [Text(text)]))
        else:
            what = "an ignored attribute" if isinstance(part, Ignored) else "this element"
            raise EditError(f"no comment can say the documentation of {what} exactly")

    def _comment(self, item: Feature | Part, text: str) -> None:
        """Puts a documentation comment before an item, in place of the one that is there."""
        edited = self._edited
        item = edited.outline.item_of(item)
        source, start = edited.source, edited.outline.start(item)
        old = edited.outline.documentation(item)
        at = old.start if old is not None else start
        indent = source.indent_of(at)
        lines = documentation(text, WIDTH - len(indent.expandtabs(4))) if text else []
        comment = f"\n{indent}".join(lines)
        if old is not None and text:
            edited.edits.replace(old.start, old.end, comment)
        elif old is not None:
            self._take_comment(old.start, old.end)
        elif text and source.begins_line(start):
            edited.edits.insert(start, f"{comment}\n{indent}")
        elif text:
            body, _ = edited.outline.place(item)
            indent = edited.blocks.indent(body)
            comment = f"\n{indent}".join(lines)
            first = source.before_space(start, body.start)
            edited.edits.replace(first, start, f"\n{indent}{comment}\n{indent}")

    def _take_comment(self, start: int, end: int) -> None:
        source = self._edited.source
        line_end = source.line_end(end)
        if source.begins_line(start) and source.is_blank(end, line_end):
            self._edited.edits.delete(source.line_start(start), source.next_line(line_end))
        else:
            self._edited.edits.delete(start, source.behind_blanks(end))

    def _replace(self, name: Name, text: str) -> None:
        start, end = self._edited.source.range_of(name.span)
        self._edited.edits.replace(start, end, text)
