"""Places of the elements of an XMI file, in characters of its text."""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

from jausml.language.model.xmi.parsing import element_ends

if TYPE_CHECKING:
    from jausml.language.model.documents import Document
    from jausml.language.model.xmi.parsing import Node


class XmlPlaces:
    """Where the elements of a document stand. `text`: the document, as it is stored."""

    def __init__(self, document: Document) -> None:
        self._data, self._encoding = document.data, document.encoding
        self.text = self._data.decode(self._encoding, "replace")

    def element(self, node: Node) -> tuple[int, int]:
        """Returns where an element begins, and where it ends with its end tag."""
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
