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


def with_newlines(text: str) -> str:
    """Returns a text in which each end of a line is a newline, as in a text area of a browser."""
    return _LINE_END.sub("\n", text)


def utf16_length(text: str) -> int:
    """Returns how many units of UTF-16 a browser counts in a text, an end of a line as one."""
    return len(with_newlines(text).encode("utf-16-le", "surrogatepass")) // 2


def index_of_utf16(text: str, offset: int) -> int:
    """Returns the index in a text of what a browser finds at an offset in units of UTF-16."""
    before = with_newlines(text).encode("utf-16-le", "surrogatepass")[: 2 * offset]
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
    """Where the elements of an XMI document stand.

    The document must be readable: bytes are counted by encoding its text again.

    Attributes:
        text: The text of the document, as it is stored.
    """

    def __init__(self, document: Document) -> None:
        self._data, self._encoding = document.data, document.encoding
        self.text = self._data.decode(self._encoding, "replace")

    def element(self, node: Node) -> tuple[int, int]:
        """Returns the start of an element, and its end: behind the end tag, if it has one."""
        start = self._character(node.offset)
        end = self._character(self._ends[node.offset])
        # The end of an element with an end tag is known by the start of that tag.
        if self.text.startswith("</", end):
            end = self.text.index(">", end) + 1
        return start, end

    @cached_property
    def _ends(self) -> dict[int, int]:
        return element_ends(self._data)

    @cached_property
    def _line_offsets(self) -> tuple[list[int], list[int]]:
        """Where lines start, in bytes and in characters."""
        lines = self.text.splitlines(keepends=True)
        sizes = (len(line.encode(self._encoding)) for line in lines)
        return list(accumulate(sizes, initial=0)), list(accumulate(map(len, lines), initial=0))

    def _character(self, offset: int) -> int:
        """Returns the offset in characters for one in bytes."""
        in_bytes, in_characters = self._line_offsets
        line = bisect_right(in_bytes, offset) - 1
        part = self._data[in_bytes[line] : offset]
        return in_characters[line] + len(part.decode(self._encoding, "replace"))
