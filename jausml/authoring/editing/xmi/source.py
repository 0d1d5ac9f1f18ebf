"""Text of an XMI file: where its elements and attributes begin and end, and changes of it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.splices import FileText
from jausml.language.model.xmi.parsing import element_ends
from jausml.language.model.xmi.writer import attribute_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.splices import Splice
    from jausml.language.model.documents import Document
    from jausml.language.model.xmi.parsing import Node

_NAME = re.compile(r"<[^\s/>]+")
_ATTRIBUTE = re.compile(r"""(\s+)([^\s=/>]+)\s*=\s*("[^"]*"|'[^']*')""")
_END = re.compile(r"\s*/?>")


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute as it is written; all places are offsets in characters.

    `end`: where the value ends; the attribute ends one behind it.
    """

    name: str
    before: str
    start: int
    value: int
    end: int


@dataclass(frozen=True, slots=True)
class Element:
    """An element as it is written; all places are offsets in characters.

    `inner_end`: where its end tag starts; `tag_end` when it has none.
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

    `EditError`: its encoding cannot be written again as it was.
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


Line = tuple["int | None", str]
"""A line of an element that is put in: how deep it stands, and its text; None as it is."""

_UNIT = "  "

_COMMENTS = re.compile(r"[ \t]*(?:<!--[^\r\n]*?-->[ \t]*)*(?=[\r\n]|\Z)")
_LINE_END = re.compile(r"[ \t]*(?:\r\n|\n|\r)")


@dataclass(frozen=True, slots=True)
class Edit:
    """New text in place of characters, from an offset to one behind them."""

    start: int
    end: int
    text: str


class Edits:
    """The edits of one file."""

    def __init__(self, source: Source, root: Node) -> None:
        self.source = source
        self._root = root
        self._edits: list[Edit] = []
        self._removed: set[Node] = set()
        self._filled: set[Node] = set()

    def splices(self) -> list[Splice]:
        """Returns what was gathered."""
        for owner in dict.fromkeys(each.parent for each in self._removed):
            if owner is not None:
                self._collapse(owner)
        for node in self._removed:
            self._edits.append(Edit(*self._whole(node), ""))
        return [self.source.splice(each.start, each.end, each.text) for each in self._edits]

    def put(self, start: int, end: int, text: str) -> None:
        """Puts a text in place of characters."""
        self._edits.append(Edit(start, end, text))

    def set_value(self, attribute: Attribute, text: str) -> None:
        """Gives an attribute another value; its quotation marks stay."""
        escaped = attribute_text(text)
        if self.source.text[attribute.end] == "'":
            escaped = escaped.replace("&quot;", '"').replace("'", "&apos;")
        self.put(attribute.value, attribute.end, escaped)

    def remove_attribute(self, attribute: Attribute) -> None:
        """Takes an attribute away, with the whitespace before it."""
        self.put(attribute.start, attribute.end + 1, "")

    def add_attribute(
        self, element: Element, name: str, text: str, later: Sequence[str] | set[str]
    ) -> None:
        """Gives an element an attribute which it has not.

        `later`: the names of the attributes that it stands before.
        """
        before = [each for each in element.attributes if each.name not in later]
        last = before[-1] if before else None
        at = last.end + 1 if last is not None else element.start + 1 + len(element.name)
        # Where each attribute has a line of its own, so has the new one.
        is_apart = last is not None and last is not element.attributes[0] and "\n" in last.before
        gap = last.before.replace("\r\n", "\n") if last is not None and is_apart else " "
        self.put(at, at, f'{gap}{name}="{attribute_text(text)}"')

    def remove(self, node: Node) -> None:
        """Takes an element away, with its lines if it has them to itself."""
        self._removed.add(node)

    def is_removed(self, node: Node) -> bool:
        """Tells whether an element goes."""
        return node in self._removed

    def replace(self, node: Node, text: str) -> None:
        """Puts a text in place of an element."""
        element = self.source.element(node)
        self.put(element.start, element.end, text)

    def indent(self, node: Node) -> str | None:
        """Returns the whitespace before an element; None when other text stands on its line."""
        start = self.source.element(node).start
        before = self.source.text[self._line_start(start) : start]
        return before if not before.strip(" \t\ufeff") else None

    @cached_property
    def unit(self) -> str:
        """By how much the file indents what an element owns."""
        for node in self._root.children[:1]:
            inner, outer = self.indent(node), self.indent(self._root) or ""
            if inner is not None and inner.startswith(outer) and inner != outer:
                return inner.removeprefix(outer)
        return _UNIT

    def insert(
        self, owner: Node, after: Node | None, before: Node | None, lines: list[Line]
    ) -> None:
        """Adds child elements.

        `after`: the child behind which they go, None without one that stays. `lines`: their lines;
        the children themselves stand 0 deep.
        """
        self._filled.add(owner)
        if after is not None:
            self._insert_after(after, lines)
        elif before is not None:
            self._insert_before(before, lines)
        else:
            self._insert_into(owner, lines)

    def moved(self, node: Node) -> list[Line]:
        """Returns the lines of an element with its edits so far, as `insert` takes them.

        These edits are no longer made where it stands.
        """
        element = self.source.element(node)
        inner = [e for e in self._edits if element.start <= e.start and e.end <= element.end]
        self._edits = [each for each in self._edits if each not in inner]
        text = self.source.text[element.start : element.end]
        for each in sorted(inner, key=lambda edit: edit.start, reverse=True):
            start, end = each.start - element.start, each.end - element.start
            text = text[:start] + each.text + text[end:]
        margin = self.indent(node) or ""
        first, *others = re.split(r"\r\n|\n|\r", text)
        return [(0, first), *(self._measured(each, margin) for each in others)]

    def _measured(self, line: str, margin: str) -> Line:
        if not line.startswith(margin):
            return (None, line)
        rest = line.removeprefix(margin)
        depth = 0
        while rest.startswith(self.unit):
            rest = rest.removeprefix(self.unit)
            depth += 1
        return (depth, rest)

    def _insert_after(self, node: Node, lines: list[Line]) -> None:
        end = self.source.element(node).end
        margin = self.indent(node)
        if margin is None:
            self.put(end, end, _in_one(lines))
            return
        comments = _COMMENTS.match(self.source.text, end)
        at = comments.end() if comments is not None else end
        self.put(at, at, "\n" + self._indented(lines, margin))

    def _insert_before(self, node: Node, lines: list[Line]) -> None:
        start = self.source.element(node).start
        margin = self.indent(node)
        if margin is None:
            self.put(start, start, _in_one(lines))
            return
        at = self._line_start(start)
        self.put(at, at, self._indented(lines, margin) + "\n")

    def _insert_into(self, owner: Node, lines: list[Line]) -> None:
        element = self.source.element(owner)
        margin = self.indent(owner) or ""
        text = f"\n{self._indented(lines, margin + self.unit)}\n{margin}"
        if element.is_empty:
            self.put(element.attributes_end, element.end, f">{text}</{element.name}>")
        elif any(each in self._removed for each in owner.children):
            self.put(element.tag_end, element.tag_end, text.rstrip())
        else:
            inner = self.source.text[element.tag_end : element.inner_end].rstrip()
            self.put(element.tag_end + len(inner), element.inner_end, text)

    def _indented(self, lines: list[Line], margin: str) -> str:
        """Returns lines at a margin."""
        return "\n".join(
            text if depth is None else margin + self.unit * depth + text for depth, text in lines
        )

    def _whole(self, node: Node) -> tuple[int, int]:
        """Returns where an element starts and ends, with its lines if it has them to itself."""
        element = self.source.element(node)
        text = self.source.text
        line_end = _LINE_END.match(text, element.end)
        if self.indent(node) is not None and line_end is not None:
            return self._line_start(element.start), line_end.end()
        return element.start, element.end

    def _collapse(self, owner: Node) -> None:
        """Closes an element by its one tag if nothing is left in it."""
        is_left = any(each not in self._removed for each in owner.children)
        if is_left or owner in self._filled or owner in self._removed:
            return
        element = self.source.element(owner)
        rest = self.source.text[element.tag_end : element.inner_end]
        at = element.tag_end
        for child in owner.children:
            inner = self.source.element(child)
            if self.source.text[at : inner.start].strip():
                return
            at = inner.end
        if not self.source.text[at : element.inner_end].strip() and rest:
            for child in owner.children:
                self._removed.discard(child)
            self.put(element.attributes_end, element.end, "/>")

    def _line_start(self, at: int) -> int:
        text = self.source.text
        return max(text.rfind("\n", 0, at), text.rfind("\r", 0, at)) + 1


def _in_one(lines: list[Line]) -> str:
    return "".join(text for _, text in lines)
