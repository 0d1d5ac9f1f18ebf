"""Parser of XML text: light nodes with positions, by expat.

The parse refuses what could read other files or exhaust memory (DOCTYPE, depth) and knows the
usual accidents: merge conflict markers and Git LFS pointers in place of a model. The positions of
attributes are found in the text of a start tag when somebody asks.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any
from xml.parsers import expat

from jausml.language.model import conflicts
from jausml.language.model.diagnostics import ReadFault

MAX_DEPTH = 200

_SEPARATOR = " "
_LFS_POINTER = b"version https://git-lfs.github.com/spec/"


class Node:
    """An XML element."""

    __slots__ = (
        "attributes",
        "children",
        "column",
        "line",
        "namespace",
        "obj",
        "offset",
        "parent",
        "prefixes",
        "tag",
        "text",
    )

    def __init__(
        self,
        name: str,
        attributes: list[str],
        prefixes: dict[str, str],
        parent: Node | None,
        position: tuple[int, int, int],
    ) -> None:
        namespace, _, self.tag = name.rpartition(_SEPARATOR)
        self.namespace = namespace
        self.attributes = attributes
        self.prefixes = prefixes
        self.parent = parent
        self.line, self.column, self.offset = position
        self.children: list[Node] = []
        self.text = ""
        self.obj: Any = None

    def get(self, name: str) -> str | None:
        """Returns the value of an attribute, None when it is absent."""
        attributes = self.attributes
        for index in range(0, len(attributes), 2):
            if attributes[index] == name:
                return attributes[index + 1]
        return None

    def __repr__(self) -> str:
        return f"<{self.tag}> at {self.line}:{self.column}"


@dataclass(slots=True)
class ParseResult:
    """The root element of a document, or the fault that hides it."""

    root: Node | None = None
    fault: ReadFault | None = None
    encoding: str = "utf-8"


class _Refused(Exception):  # noqa: N818 -- leaves the callbacks, never this module
    def __init__(self, fault: ReadFault) -> None:
        super().__init__(fault.message)
        self.fault = fault


def parse(data: bytes) -> ParseResult:
    """Parses a document.

    Returns:
        Its root element, or the one fault that ended the parse. Never raises for bad input.
    """
    # Before the parse: expat would only say that the first line is not well-formed.
    fault = _accident(data)
    if fault is not None:
        return ParseResult(fault=fault)
    builder = _TreeBuilder()
    try:
        builder.run(data)
    except _Refused as refused:
        return ParseResult(fault=refused.fault)
    except expat.ExpatError as error:
        return ParseResult(fault=_explain(error, data))
    except (LookupError, ValueError) as error:
        # pyexpat asks Python for encodings that expat lacks; multi-byte ones are refused so.
        return ParseResult(
            fault=ReadFault("JML006", f"the encoding cannot be read: {error}", _AS_UTF_8)
        )
    return ParseResult(root=builder.root, encoding=detect_encoding(data))


def element_ends(data: bytes) -> dict[int, int]:
    """Returns where the elements of a document end, by the offsets of their start tags.

    Returns:
        For an element with an end tag, the byte offset of that tag; else that behind its one tag.
    """
    parser = expat.ParserCreate()
    ends: dict[int, int] = {}
    open_tags: list[int] = []

    def start(_name: str, _attributes: object) -> None:
        open_tags.append(parser.CurrentByteIndex)

    def end(_name: str) -> None:
        ends[open_tags.pop()] = parser.CurrentByteIndex

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.Parse(data, True)  # noqa: FBT003 -- expat has no keywords
    return ends


def detect_encoding(data: bytes) -> str:
    """Returns the name of the encoding in which a document that parsed is written."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16-le" if data[0] == 0xFF else "utf-16-be"
    if data.startswith(b"<\x00"):
        return "utf-16-le"
    if data.startswith(b"\x00<"):
        return "utf-16-be"
    declared = re.match(rb"(?:\xef\xbb\xbf)?<\?xml[^>]*?encoding\s*=\s*[\"']([\w.:-]+)", data)
    return declared.group(1).decode("ascii").lower() if declared else "utf-8"


class _TreeBuilder:
    """Collects nodes from expat's callbacks."""

    def __init__(self) -> None:
        self.root: Node | None = None
        self._stack: list[Node] = []
        self._prefixes: dict[str, str] = {}
        self._declared: dict[str, str] = {}
        self._data = b""
        self._parser = expat.ParserCreate(namespace_separator=_SEPARATOR)
        # Else expat calls back for each line of a text, and texts are joined again and again.
        self._parser.buffer_text = True
        # A flat list of names and values: a dictionary for each element costs time and memory.
        self._parser.ordered_attributes = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._characters
        self._parser.StartNamespaceDeclHandler = self._declare
        self._parser.StartDoctypeDeclHandler = self._doctype

    def run(self, data: bytes) -> None:
        self._data = data
        self._parser.Parse(data, True)  # noqa: FBT003 -- expat has no keywords

    def _start(self, name: str, attributes: list[str]) -> None:
        parser = self._parser
        stack = self._stack
        parent = stack[-1] if stack else None
        # Most elements declare no prefix and share the mapping of their parent.
        prefixes = parent.prefixes if parent is not None else self._prefixes
        if self._declared:
            prefixes = {**prefixes, **self._declared}
            self._declared = {}
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        node = Node(name, attributes, prefixes, parent, (line, column, parser.CurrentByteIndex))
        if parent is None:
            self.root = node
        else:
            parent.children.append(node)
        stack.append(node)
        if len(stack) > MAX_DEPTH:
            message = f"elements are nested more than {MAX_DEPTH} deep"
            raise _Refused(ReadFault("JML008", message, line=line, column=column))

    def _end(self, _name: str) -> None:
        self._stack.pop()

    def _characters(self, text: str) -> None:
        node = self._stack[-1]
        # Nothing but the space before each further child, in elements that have many.
        if not (node.children and text.isspace() and node.text.isspace()):
            node.text += text

    def _declare(self, prefix: str | None, uri: str | None) -> None:
        self._declared[prefix or ""] = uri or ""

    def _doctype(self, *_: object) -> None:
        # expat calls this behind the name; the finding belongs where the declaration starts.
        line, column = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1
        start = self._data.rfind(b"<!DOCTYPE", 0, self._parser.CurrentByteIndex + 1)
        if start >= 0:
            line = self._data.count(b"\n", 0, start) + 1
            before = self._data[self._data.rfind(b"\n", 0, start) + 1 : start]
            column = len(before.decode("utf-8", errors="replace")) + 1
        # Entities can read other files, and grow without bounds (the attack of a billion laughs).
        hint = "models need none; delete the <!DOCTYPE ...> declaration"
        raise _Refused(ReadFault("JML007", "a DOCTYPE is not accepted", hint, line, column))


def _accident(data: bytes) -> ReadFault | None:
    """Recognises files that are no XML for a reason that can be told."""
    if not data.strip():
        return ReadFault("JML003", "the file is empty")
    if data.startswith(_LFS_POINTER):
        return ReadFault(
            "JML005", "the file is a Git LFS pointer, not a model", "run `git lfs pull`"
        )
    return None


def _explain(error: expat.ExpatError, data: bytes) -> ReadFault:
    line, column = max(error.lineno, 1), error.offset + 1
    # Markers of a merge give all kinds of errors of XML; which one does not help.
    conflict, first = conflicts.unmerged(data)
    if conflict:
        return ReadFault(conflicts.UNMERGED, conflict, conflicts.UNMERGED_HINT, first)
    reason = expat.ErrorString(error.code) or str(error)
    rule, hint = "JML004", ""
    if error.code in _ENCODING_ERRORS:
        rule = "JML006"
        reason, hint = f"the encoding cannot be read: {reason}", _AS_UTF_8
    # A UTF-16 file begins with its byte order mark; what else has no `<` first is no XML.
    elif line == 1 and not data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"<", b"\xff", b"\xfe")):
        reason = f"the file is not XML: {reason}"
    else:
        reason = f"not well-formed XML: {reason}"
        hint = _AS_UTF_8 if error.code == _INVALID_TOKEN and not _is_utf_8(data) else ""
    return ReadFault(rule, reason, hint, line, column)


def _is_utf_8(data: bytes) -> bool:
    try:
        data.decode(detect_encoding(data))
    except (LookupError, ValueError):
        return False
    return True


_AS_UTF_8 = "save it as UTF-8, and let the XML declaration say so"
_INVALID_TOKEN = expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN]
_ENCODING_ERRORS = frozenset(
    expat.errors.codes[message]
    for message in (
        expat.errors.XML_ERROR_UNKNOWN_ENCODING,
        expat.errors.XML_ERROR_INCORRECT_ENCODING,
        expat.errors.XML_ERROR_PARTIAL_CHAR,
    )
)

_CHUNK = 512
_TOKEN = re.compile(r"""\s+([^\s=/>]+)\s*=\s*("[^"]*"|'[^']*')""")
_NAME = re.compile(r"<[^\s/>]+")
_WHOLE = re.compile(r"""<[^"'>]*(?:(?:"[^"]*"|'[^']*')[^"'>]*)*>""")


def attribute_positions(
    data: bytes, encoding: str, node: Node
) -> dict[tuple[str, str], tuple[int, int]]:
    """Returns line and column of the names of the attributes of an element.

    Returns:
        The places by namespace URI, empty for an attribute that has none, and local name.
    """
    tag = _start_tag(data, encoding, node.offset)
    line, start = node.line, 1 - node.column
    positions: dict[tuple[str, str], tuple[int, int]] = {}
    match = _NAME.match(tag)
    at = match.end() if match else 0
    while match := _TOKEN.match(tag, at):
        prefix, _, local = match.group(1).rpartition(":")
        written = node.prefixes.get(prefix, "") if prefix else ""
        begin = match.start(1)
        if newlines := tag.count("\n", at, begin):
            line += newlines
            start = tag.rfind("\n", at, begin) + 1
        positions.setdefault((written, local), (line, begin - start + 1))
        if newlines := tag.count("\n", begin, match.end()):
            line += newlines
            start = tag.rfind("\n", begin, match.end()) + 1
        at = match.end()
    return positions


def _start_tag(data: bytes, encoding: str, offset: int) -> str:
    """Decodes a start tag, whose end is the first `>` outside quotes."""
    size = _CHUNK
    while True:
        # The chunk may end within a character; the next, larger chunk has all of it.
        text = data[offset : offset + size].decode(encoding, errors="ignore")
        # Lines are counted as expat counts them: \r\n is one end.
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        if _WHOLE.match(text) or offset + size >= len(data):
            return text
        # Start tags are short as a rule, and a list of references may be long.
        size *= 4
