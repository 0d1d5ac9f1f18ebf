"""Typing: texts as an editor sends them become bytes as their file has them."""

from __future__ import annotations

import codecs
import re

from jausml.authoring.editing.commands import EditError

_LINE_END = re.compile(rb"\r\n|\n|\r")


def typed(text: str, before: bytes) -> bytes:
    """Returns the bytes of a text, with the byte order mark and the line ends of its file.

    Args:
        text: The text; where its lines end with line feeds alone, an editor may have made them so.

    Raises:
        EditError: The text has characters that no file can hold.
    """
    ends = set(_LINE_END.findall(before))
    if len(ends) == 1 and "\r" not in text:
        text = text.replace("\n", ends.pop().decode())
    mark = codecs.BOM_UTF8 if before.startswith(codecs.BOM_UTF8) else b""
    try:
        return mark + text.removeprefix("\ufeff").encode()
    except UnicodeEncodeError as error:
        message = f"the text has half a character, U+{ord(text[error.start]):04X}"
        raise EditError(message) from error
