"""Changes of what stands before blocks: the name of an element, and its documentation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.language.text.keywords import snake_case
from jausml.language.text.tree import (
    Assignment,
    Element,
    Feature,
    Ignored,
    Name,
    Table,
    Text,
    Vector,
)
from jausml.language.text.writing.heads import is_comment
from jausml.language.text.writing.layout import WIDTH
from jausml.language.text.writing.literals import is_name
from jausml.language.text.writing.spelling import documentation, word

if TYPE_CHECKING:
    from jausml.authoring.editing.text.desk import Desk
    from jausml.authoring.editing.text.outline import Part
    from jausml.authoring.editing.text.values import Values
    from jausml.language.metamodel.classes.ecore import EObject

NAME, DOCUMENTATION = "name", "documentation"


class Heads:
    """Sets names and documentation."""

    def __init__(self, desk: Desk, values: Values) -> None:
        self._desk = desk
        self._values = values

    def set_name(self, obj: EObject, part: Part, name: str | None) -> None:
        """Gives an element another name, or takes it away."""
        if isinstance(part, Table | Vector):
            if name is None or not is_name(name):
                raise EditError(f"a {self._desk.table(obj).name} cannot be named {name!r} in text")
            self._replace(part.name, word(name))
        elif isinstance(part, Element):
            self._set_name(obj, part, name)
        else:
            raise EditError(f"a {self._desk.table(obj).name} has no name in text")

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
            elif self._desk.outline.body(part) is None:
                self._desk.edits.insert(self._desk.outline.end(part), " {}")

    def _name_head(self, obj: EObject, part: Element, name: str) -> None:
        edits, outline = self._desk.edits, self._desk.outline
        if part.name is not None and self._desk.is_named_by(obj, part):
            self._replace(part.name, name)
        elif part.name is not None:
            # One word alone stands for the class.
            edits.insert(self._desk.source.range_of(part.name.span)[1], f" {name}")
        elif part.keyword is not None:
            edits.insert(self._desk.source.range_of(part.keyword.span)[1], f" {name}")
        else:
            keyword = snake_case(self._desk.table(obj).name)
            edits.insert(outline.start(part), f"new {keyword} {name} ")

    def _unname_head(self, obj: EObject, part: Element) -> None:
        if part.name is None or not self._desk.is_named_by(obj, part):
            return
        if part.keyword is None:
            self._replace(part.name, snake_case(self._desk.table(obj).name))
            return
        source, edits = self._desk.source, self._desk.edits
        edits.delete(source.range_of(part.keyword.span)[1], source.range_of(part.name.span)[1])

    def set_documentation(self, obj: EObject, part: Part, text: str | None) -> None:
        """Gives an element another documentation, or takes it away."""
        item = self._desk.outline.item_of(part)
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
        desk = self._desk
        item = desk.outline.item_of(item)
        source, start = desk.source, desk.outline.start(item)
        old = desk.outline.documentation(item)
        at = old.start if old is not None else start
        indent = source.indent_of(at)
        lines = documentation(text, WIDTH - len(indent.expandtabs(4))) if text else []
        comment = f"\n{indent}".join(lines)
        if old is not None and text:
            desk.edits.replace(old.start, old.end, comment)
        elif old is not None:
            self._take_comment(old.start, old.end)
        elif text and source.begins_line(start):
            desk.edits.insert(start, f"{comment}\n{indent}")
        elif text:
            body, _ = desk.outline.place(item)
            indent = desk.blocks.indent(body)
            comment = f"\n{indent}".join(lines)
            first = source.before_space(start, body.start)
            desk.edits.replace(first, start, f"\n{indent}{comment}\n{indent}")

    def _take_comment(self, start: int, end: int) -> None:
        source = self._desk.source
        line_end = source.line_end(end)
        if source.begins_line(start) and source.is_blank(end, line_end):
            self._desk.edits.delete(source.line_start(start), source.next_line(line_end))
        else:
            self._desk.edits.delete(start, source.behind_blanks(end))

    def _replace(self, name: Name, text: str) -> None:
        start, end = self._desk.source.range_of(name.span)
        self._desk.edits.replace(start, end, text)
