"""Places of the elements of a file, in characters of its text, and as browsers count them."""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property
from itertools import accumulate

from jausml.language.model.documents import Document
from jausml.language.model.xmi.parsing import Node, element_ends
from jausml.language.text.reading.document import TextDocument

_LINE_END = re.compile(r"\r\n?|\n")


def flat(text: str) -> str:
    """Returns a text in which an end of a line is one character, as pages have it."""
    return _LINE_END.sub("\n", text)


def units(text: str) -> int:
    """Returns the units of UTF-16 of a text, in which an end of a line is one."""
    return len(flat(text).encode("utf-16-le", "surrogatepass")) // 2


def character(text: str, offset: int) -> int:
    """Returns the character of a text at an offset as pages count."""
    before = flat(text).encode("utf-16-le", "surrogatepass")[: 2 * offset]
    *lines, last = before.decode("utf-16-le", "replace").split("\n")
    return _line_starts(text)[len(lines)] + len(last)


def _line_starts(text: str) -> list[int]:
    return [0, *(match.end() for match in _LINE_END.finditer(text))]


class TextPlaces:
    """Where the elements of a document in the text notation stand."""

    def __init__(self, document: Document, written: TextDocument) -> None:
        self.text = document.data.decode("utf-8-sig", "replace")
        self._written, self._starts = written, _line_starts(self.text)

    def element(self, node: Node) -> tuple[int, int] | None:
        """Returns the start and end of an element, None for an implied one."""
        source = self._written.source_of(node)
        if source is None:
            return None
        span = source.span
        start = self._starts[span.line - 1] + span.column - 1
        return start, self._starts[span.end_line - 1] + span.end_column - 1


class XmlPlaces:
    """Where the elements of a document stand. `text`: the document, as it is stored."""

    def __init__(self, document: Document) -> None:
        self._data, self._encoding = document.data, document.encoding
        self.text = self._data.decode(self._encoding, "replace")

    def element(self, node: Node) -> tuple[int, int]:
        """Returns the start of an element, and its end behind the end tag."""
        start, end = (self._character(offset) for offset in (node.offset, self._ends[node.offset]))
        return start, self.text.index(">", end) + 1 if self.text.startswith("</", end) else end

    @cached_property
    def _ends(self) -> dict[int, int]:
        return element_ends(self._data)

    @cached_property
    def _line_starts(self) -> tuple[list[int], list[int]]:
        """Where lines start, in bytes and in characters."""
        lines = self.text.splitlines(keepends=True)
        sizes = (len(line.encode(self._encoding)) for line in lines)
        return list(accumulate(sizes, initial=0)), list(accumulate(map(len, lines), initial=0))

    def _character(self, offset: int) -> int:
        """Returns the offset in characters for one in bytes."""
        in_bytes, in_characters = self._line_starts
        line = bisect_right(in_bytes, offset) - 1
        part = self._data[in_bytes[line] : offset]
        return in_characters[line] + len(part.decode(self._encoding, "replace"))
