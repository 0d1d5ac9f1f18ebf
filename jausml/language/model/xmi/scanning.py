"""Positions of attributes: found in the text of a start tag when somebody asks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.model.xmi.parsing import Node

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
    found: dict[tuple[str, str], tuple[int, int]] = {}
    match = _NAME.match(tag)
    at = match.end() if match else 0
    while match := _TOKEN.match(tag, at):
        prefix, _, local = match.group(1).rpartition(":")
        written = node.prefixes.get(prefix, "") if prefix else ""
        begin = match.start(1)
        if newlines := tag.count("\n", at, begin):
            line += newlines
            start = tag.rfind("\n", at, begin) + 1
        found.setdefault((written, local), (line, begin - start + 1))
        if newlines := tag.count("\n", begin, match.end()):
            line += newlines
            start = tag.rfind("\n", begin, match.end()) + 1
        at = match.end()
    return found


def _start_tag(data: bytes, encoding: str, offset: int) -> str:
    """Decodes a start tag, whose end is the first `>` outside quotes."""
    size = _CHUNK
    while True:
        text = data[offset : offset + size].decode(encoding, errors="ignore")
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        if _WHOLE.match(text) or offset + size >= len(data):
            return text
        size *= 4
