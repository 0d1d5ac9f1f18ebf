"""Text of an XMI file, and where its elements and attributes begin and end."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.splices import FileText
from jausml.language.model.xmi.parsing import element_ends

if TYPE_CHECKING:
    from jausml.language.model.documents import Document
    from jausml.language.model.xmi.parsing import Node

_NAME = re.compile(r"<[^\s/>]+")
_ATTRIBUTE = re.compile(r"""(\s+)([^\s=/>]+)\s*=\s*("[^"]*"|'[^']*')""")
_END = re.compile(r"\s*/?>")


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute as it is written; all places are offsets in characters.

    Attributes:
        end: Where the value ends; the attribute ends one behind it.
    """

    name: str
    before: str
    start: int
    value: int
    end: int


@dataclass(frozen=True, slots=True)
class Element:
    """An element as it is written; all places are offsets in characters.

    Attributes:
        inner_end: Where its end tag starts; `tag_end` when it has none.
    """

    name: str
    start: int
    attributes: tuple[Attribute, ...]
    tag_end: int
    inner_end: int
    end: int

    @property
    def is_empty(self) -> bool:
        """Whether it is one tag, closed by `/>`."""
        return self.inner_end == self.end

    @property
    def attributes_end(self) -> int:
        """Where the last attribute ends, or the name of an element that has none."""
        if self.attributes:
            return self.attributes[-1].end + 1
        return self.start + 1 + len(self.name)

    def attribute(self, name: str) -> Attribute | None:
        """Returns the attribute of a name with its prefix, None without one."""
        return next((each for each in self.attributes if each.name == name), None)


class Source(FileText):
    """The text of a document.

    Raises:
        EditError: Its encoding cannot be written again as it was.
    """

    errors = "xmlcharrefreplace"

    def __init__(self, document: Document, file: str) -> None:
        try:
            super().__init__(file, document.data, document.encoding)
            is_same = self.stored.encode(document.encoding) == document.data
        except (LookupError, ValueError):
            is_same = False
        if not is_same:
            message = f"the encoding {document.encoding} of {file} cannot be kept: save it as UTF-8"
            raise EditError(message)
        self.text = self.stored
        self._elements: dict[int, Element] = {}

    def element(self, node: Node) -> Element:
        """Returns where an element and its attributes stand."""
        found = self._elements.get(node.offset)
        if found is None:
            found = self._elements[node.offset] = self._scanned(node.offset)
        return found

    def _scanned(self, offset: int) -> Element:
        text = self.text
        start = self._character(offset)
        name = _NAME.match(text, start)
        if name is None:
            raise EditError(f"{self.file} was not read as it is stored")
        attributes = []
        at = name.end()
        while match := _ATTRIBUTE.match(text, at):
            at = match.end()
            attributes.append(
                Attribute(match[2], match[1], match.start(), match.start(3) + 1, at - 1)
            )
        end = _END.match(text, at)
        tag_end = end.end() if end is not None else at
        inner_end = whole_end = tag_end
        if text[tag_end - 2] != "/":
            inner_end = self._character(self._ends[offset])
            whole_end = text.index(">", inner_end) + 1
        return Element(name.group()[1:], start, tuple(attributes), tag_end, inner_end, whole_end)

    @cached_property
    def _ends(self) -> dict[int, int]:
        return element_ends(self._data)
