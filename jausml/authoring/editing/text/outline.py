"""Outline of a text: in which list each item of its tree stands, and where lists and items end."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import (
    Assignment,
    Element,
    Feature,
    Item,
    Vector,
    is_documentation,
    lists_of,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.source import Comment, TextSource
    from jausml.language.text.tree import Call, SyntaxTree

    Part: TypeAlias = Item | Call

_SEMICOLON = re.compile(r"[ \t]*;")


@dataclass(frozen=True, eq=False)
class Body:
    """A list of items in brackets, or the whole text.

    Attributes:
        owner: What has the list, None for the text.
        start: Offset behind the opening bracket.
    """

    owner: Item | None
    items: Sequence[Item]
    start: int
    end: int


class Outline:
    """Where the items of a tree stand."""

    def __init__(self, tree: SyntaxTree, source: TextSource) -> None:
        self._source = source
        self._bodies: dict[int, list[Body]] = {}
        self._places: dict[int, tuple[Body, int]] = {}
        self._holders: dict[int, Feature | Assignment] = {}
        self.top = Body(None, tree.items, 0, len(source.text))
        pending = [self.top]
        while pending:
            body = pending.pop()
            for index, item in enumerate(body.items):
                self._places[id(item)] = (body, index)
                self._hold(item)
                found = self._bodies_of(item)
                self._bodies[id(item)] = found
                pending += found

    def place(self, item: Item) -> tuple[Body, int]:
        """Returns the list in which an item stands, and its position there."""
        return self._places[id(item)]

    def holder(self, part: Part) -> Feature | Assignment | None:
        """Returns the feature of which a block is a value, or the assignment of a conversion."""
        return self._holders.get(id(part))

    def item_of(self, part: Part) -> Item:
        """Returns what stands on lines of its own for an element: it, or what holds it."""
        holder = self.holder(part)
        if holder is not None:
            return holder
        assert isinstance(part, Item)  # noqa: S101 - all other parts are held
        return part

    def body(self, part: Part, number: int = 0) -> Body | None:
        """Returns a list of an item or of a block that is a value; None without brackets."""
        bodies = self._bodies.get(id(part), [])
        if isinstance(part, Vector):
            return bodies[number]
        return bodies[0] if bodies else None

    def start(self, part: Part) -> int:
        """Returns where an item begins, without its comments."""
        return self._source.offset(part.span.line, part.span.column)

    def end(self, part: Part) -> int:
        """Returns where an item ends, with a semicolon behind it."""
        end = self._source.offset(part.span.end_line, part.span.end_column)
        found = _SEMICOLON.match(self._source.text, end)
        return found.end() if found is not None else end

    def leading(self, item: Item) -> list[Comment]:
        """Returns the comments before an item that are not behind the one before it."""
        body, index = self.place(item)
        before = body.start
        if index:
            before = self.whole_end(body.items[index - 1])
        return self._source.comments_within(before, self.start(item))

    def documentation(self, item: Item) -> Comment | None:
        """Returns the comment that documents an item, None without one."""
        comments = reversed(self.leading(item))
        return next((each for each in comments if is_documentation(each.text)), None)

    def whole_start(self, item: Item) -> int:
        """Returns where an item begins with the comments that are its own.

        Those are the ones on the lines above it without an empty line between, and its
        documentation wherever it stands.
        """
        source = self._source
        documentation = self.documentation(item)
        start = self.start(item)
        for comment in reversed(self.leading(item)):
            is_near = source.text.count("\n", comment.end, start) <= 1
            is_near = is_near and (
                source.begins_line(comment.start) or "\n" not in source.text[comment.end : start]
            )
            must_go = documentation is not None and documentation.start <= comment.start
            if not is_near and not must_go:
                break
            start = comment.start
        return start

    def whole_end(self, item: Item) -> int:
        """Returns where an item ends with the comments behind it on its last line."""
        source = self._source
        end = self.end(item)
        for comment in source.comments_within(end, source.line_end(end)):
            if not comment.is_on_one_line or not source.is_blank(end, comment.start):
                break
            end = comment.end
        return end

    def _hold(self, item: Item) -> None:
        if isinstance(item, Feature):
            for value in item.values:
                if isinstance(value, Element):
                    self._holders[id(value)] = item
        if isinstance(item, Assignment):
            for call in item.conversions:
                self._holders[id(call)] = item

    def _bodies_of(self, item: Item) -> list[Body]:
        if isinstance(item, Feature):
            blocks = [each for each in item.values if isinstance(each, Element)]
            found = []
            for each in blocks:
                self._bodies[id(each)] = self._listed(each)
                found += self._bodies[id(each)]
            return found
        return self._listed(item)

    def _listed(self, item: Item) -> list[Body]:
        found = []
        for items, _ in lists_of(item):
            if isinstance(items, Items) and items.start is not None:
                start = self._source.offset(*items.start)
                width = 2 if self._source.text.startswith("=>", start) else 1
                found.append(Body(item, items, start + width, self._source.offset(*items.end)))
        return found
