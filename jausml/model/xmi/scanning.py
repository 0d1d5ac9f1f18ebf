"""Positions of attributes: found in the text of a start tag when somebody asks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.model.xmi.parsing import Node

_CHUNK = 512
_TOKEN = re.compile(r"""\s+([^\s=/>]+)\s*=\s*("[^"]*"|'[^']*')""")
_NAME = re.compile(r"<[^\s/>]+")
_WHOLE = re.compile(r"""<[^"'>]*(?:(?:"[^"]*"|'[^']*')[^"'>]*)*>""")


def attribute_position(
    data: bytes, encoding: str, node: Node, namespace: str, name: str
) -> tuple[int, int]:
    """Returns line and column of an attribute of an element.

    Args:
        data: The document.
        encoding: Its encoding.
        node: The element.
        namespace: Namespace URI of the attribute, empty when it has none.
        name: Its local name.

    Returns:
        The place of the attribute's name; that of the element when it has no such attribute.
    """
    tag = _start_tag(data, encoding, node.offset)
    line, column = node.line, node.column
    match = _NAME.match(tag)
    at = match.end() if match else 0
    while match := _TOKEN.match(tag, at):
        prefix, _, local = match.group(1).rpartition(":")
        written = node.prefixes.get(prefix, "") if prefix else ""
        if local == name and written == namespace:
            before = tag[: match.start(1)]
            newlines = before.count("\n")
            if newlines:
                return line + newlines, len(before) - before.rfind("\n")
            return line, column + len(before)
        at = match.end()
    return line, column


def _start_tag(data: bytes, encoding: str, offset: int) -> str:
    """Decodes a start tag, whose end is the first `>` outside quotes."""
    size = _CHUNK
    while True:
        text = data[offset : offset + size].decode(encoding, errors="ignore")
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        if _WHOLE.match(text) or offset + size >= len(data):
            return text
        size *= 4
