"""Text of a ros2jaus file: offsets of what its tree has, its comments, and changes of it."""

from __future__ import annotations

import codecs
import re
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.splices import FileText, Splice
from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.tree import comments_in

if TYPE_CHECKING:
    from jausml.language.model.documents import Document
    from jausml.language.text.tree import Span

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

    Attributes:
        text: The text with line feeds where lone carriage returns end lines.
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
            elif start == end:
                message = "something is to be added to what is removed; do one after the other"
                raise EditError(message)
        found: list[tuple[int, int, str]] = []
        # What is put in at an offset comes before what is taken away there.
        for start, end, new in sorted(changes, key=lambda each: each[:2]):
            if found and start < found[-1][1]:
                message = "two changes of the same text do not go together; do one after the other"
                raise EditError(message)
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
