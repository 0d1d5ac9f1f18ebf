"""Text of a ros2jaus file: offsets, comments, the outline of its lists, and changes of it."""

from __future__ import annotations

import codecs
import re
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.splices import FileText, Splice
from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import (
    Assignment,
    Element,
    Feature,
    Item,
    Vector,
    comments_in,
    is_documentation,
    lists_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.model.documents import Document
    from jausml.language.text.tree import Call, Span, SyntaxTree

    Part: TypeAlias = Item | Call

_BLANKS = " \t"


class Comment(NamedTuple):
    """A comment with its marks, and the offsets of its characters."""

    start: int
    end: int
    text: str

    @property
    def is_on_one_line(self) -> bool:
        """Whether it has no line break."""
        return "\n" not in self.text


class TextSource(FileText):
    """The text of a document. All places are offsets in characters.

    `text`: the text with line feeds where lone carriage returns end lines.
    """

    def __init__(self, document: Document, file: str) -> None:
        mark = len(codecs.BOM_UTF8) if document.data.startswith(codecs.BOM_UTF8) else 0
        super().__init__(file, document.data, "utf-8", mark)
        self.text = with_line_feeds(self.stored)

    @cached_property
    def unit(self) -> str:
        """What lines within a block are indented by."""
        return "\t" if "\n\t" in self.text else "    "

    @cached_property
    def comments(self) -> list[Comment]:
        """The comments in order."""
        found = comments_in(self.text)
        return [Comment(each.start(), each.end(), each.group()) for each in found]

    def comments_within(self, start: int, end: int) -> list[Comment]:
        """Returns the comments that begin in a stretch."""
        starts = self._comment_starts
        return self.comments[bisect_left(starts, start) : bisect_left(starts, end)]

    def range_of(self, span: Span) -> tuple[int, int]:
        """Returns where a span begins and ends."""
        return self.offset(span.line, span.column), self.offset(span.end_line, span.end_column)

    def offset(self, line: int, column: int) -> int:
        """Returns the offset of a line and a column, counted from 1."""
        return self._lines[line - 1] + column - 1

    def line_start(self, at: int) -> int:
        """Returns where the line of an offset begins."""
        return self._lines[bisect_right(self._lines, at) - 1]

    def line_end(self, at: int) -> int:
        """Returns where the line of an offset ends, before its line end."""
        found = self.text.find("\n", at)
        if found < 0:
            return len(self.text)
        return found - 1 if found > at and self.text[found - 1] == "\r" else found

    def next_line(self, at: int) -> int:
        """Returns where the line behind that of an offset begins, or the end of the text."""
        found = self.text.find("\n", at)
        return len(self.text) if found < 0 else found + 1

    def indent_of(self, at: int) -> str:
        """Returns the blanks that the line of an offset begins with."""
        start = self.line_start(at)
        line = self.text[start : self.line_end(start)]
        return line[: len(line) - len(line.lstrip(_BLANKS))]

    def begins_line(self, at: int) -> bool:
        """Tells whether only blanks stand before an offset on its line."""
        return not self.text[self.line_start(at) : at].strip()

    def is_blank(self, start: int, end: int) -> bool:
        """Tells whether only whitespace stands in a stretch."""
        return not self.text[start:end].strip()

    def behind_blanks(self, at: int) -> int:
        """Returns the offset of what comes behind blanks on the same line."""
        while at < len(self.text) and self.text[at] in _BLANKS:
            at += 1
        return at

    def before_space(self, at: int, least: int) -> int:
        """Returns where the whitespace before an offset begins, not before a least offset."""
        while at > least and self.text[at - 1].isspace():
            at -= 1
        return at

    @cached_property
    def _lines(self) -> list[int]:
        return [0, *(each.end() for each in re.finditer("\n", self.text))]

    @cached_property
    def _comment_starts(self) -> list[int]:
        return [each.start for each in self.comments]


_CONFLICT = "two changes of the same text do not go together; do one after the other"


@dataclass
class Edits:
    """Changes of a text that are planned together."""

    source: TextSource
    _deleted: list[tuple[int, int]] = field(default_factory=list)
    _replaced: list[tuple[int, int, str]] = field(default_factory=list)

    def replace(self, start: int, end: int, new: str) -> None:
        """Puts a text in place of a stretch, which may be empty."""
        if new or start < end:
            self._replaced.append((start, end, new))

    def insert(self, at: int, new: str) -> None:
        """Puts a text at an offset, behind what is put there already."""
        self.replace(at, at, new)

    def delete(self, start: int, end: int) -> None:
        """Takes a stretch away, whatever else changes in it."""
        if start < end:
            self._deleted.append((start, end))

    def splices(self) -> list[Splice]:
        """Returns the splices, in order and none over another."""
        deleted = _united(self._deleted)
        changes = [(start, end, "") for start, end in deleted]
        for start, end, new in self._replaced:
            if not any(first < end and start < last for first, last in deleted):
                changes.append((start, end, new))
            elif not any(first <= start and end <= last for first, last in deleted):
                raise EditError(_CONFLICT)
            elif start == end:
                message = "something is to be added to what is removed; do one after the other"
                raise EditError(message)
        found: list[tuple[int, int, str]] = []
        # What is put in at an offset comes before what is taken away there.
        for start, end, new in sorted(changes, key=lambda each: each[:2]):
            if found and start < found[-1][1]:
                raise EditError(_CONFLICT)
            if found and start == found[-1][1]:
                first, _, before = found.pop()
                found.append((first, end, before + new))
            else:
                found.append((start, end, new))
        splices = (self.source.splice(*each) for each in found)
        return [each for each in splices if each.old != each.new]


def _united(ranges: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Returns stretches in order, those that touch or overlap as one."""
    found: list[tuple[int, int]] = []
    for start, end in sorted(ranges):
        if found and start <= found[-1][1]:
            found[-1] = (found[-1][0], max(end, found[-1][1]))
        else:
            found.append((start, end))
    return found


_SEMICOLON = re.compile(r"[ \t]*;")


@dataclass(frozen=True, eq=False)
class Body:
    """A list of items in brackets, or the whole text.

    `owner`: what has the list, None for the text. `start`: offset behind the opening bracket.
    """

    owner: Item | None
    items: Sequence[Item]
    start: int
    end: int


class Outline:
    """Where the items of a tree stand; it looks at no others than it is asked of."""

    def __init__(self, tree: SyntaxTree, source: TextSource) -> None:
        self._source = source
        self._bodies: dict[int, list[Body]] = {}
        self.top = Body(None, tree.items, 0, len(source.text))

    def place(self, item: Item) -> tuple[Body, int]:
        """Returns the list in which an item stands, and its position there."""
        return next(each for each in self._around(item) if each[0].items[each[1]] is item)

    def holder(self, part: Part) -> Feature | Assignment | None:
        """Returns the feature of which a block is a value, or the assignment of a conversion."""
        for body, index in self._around(part):
            item = body.items[index]
            if item is part:
                return None
            if isinstance(item, Feature | Assignment) and any(e is part for e in _held(item)):
                return item
        return None

    def _around(self, part: Part) -> Iterator[tuple[Body, int]]:
        """Yields the lists in which a part stands, and positions there, the outermost first."""
        body: Body | None = self.top
        start = (part.span.line, part.span.column)
        offset = self._source.offset(*start)
        while body is not None:
            index = bisect_right(body.items, start, key=_start_of) - 1
            if index < 0:
                return
            yield body, index
            inner = self._bodies_of(body.items[index])
            body = next((each for each in inner if each.start <= offset < each.end), None)

    def item_of(self, part: Part) -> Item:
        """Returns what stands on lines of its own for an element: it, or what holds it."""
        holder = self.holder(part)
        if holder is not None:
            return holder
        assert isinstance(part, Item)  # noqa: S101 - all other parts are held
        return part

    def body(self, part: Part, number: int = 0) -> Body | None:
        """Returns a list of an item or of a block that is a value; None without brackets."""
        bodies = self._bodies_of(part)
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

    def _bodies_of(self, part: Part) -> list[Body]:
        found = self._bodies.get(id(part))
        if found is None:
            if isinstance(part, Feature):
                found = [body for each in _held(part) for body in self._bodies_of(each)]
            else:
                found = self._listed(part) if isinstance(part, Item) else []
            self._bodies[id(part)] = found
        return found

    def _listed(self, item: Item) -> list[Body]:
        found = []
        for items, _ in lists_of(item):
            if isinstance(items, Items) and items.start is not None:
                start = self._source.offset(*items.start)
                width = 2 if self._source.text.startswith("=>", start) else 1
                found.append(Body(item, items, start + width, self._source.offset(*items.end)))
        return found


def _held(item: Feature | Assignment) -> list[Part]:
    """Returns the blocks of a feature, or the conversions of an assignment."""
    if isinstance(item, Feature):
        return [each for each in item.values if isinstance(each, Element)]
    return list(item.conversions)


def _start_of(item: Item) -> tuple[int, int]:
    return item.span.line, item.span.column
