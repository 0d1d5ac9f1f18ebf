"""Bytes from lines of hexadecimal, as people paste them."""

from __future__ import annotations

import re

from jausml.live.traffic.captures import TrafficError

_COMMENT = re.compile(r"(?:#|//|;).*")
_BYTE_PREFIX = re.compile(r"(?<![0-9A-Fa-f])0[xX]|\\x")
_SEPARATORS = str.maketrans("", "", " \t\r\n:,-_\v\f")
_WRONG = re.compile(r"[^0-9A-Fa-f \t\r\n:,\-_\v\f]")


def parse_hex(line: str) -> bytes:
    r"""Returns the bytes of a line; a blank line or a comment has none.

    Blanks, colons, commas, hyphens, `0x` and `\x` may stand between bytes; `#`, `;` and `//`
    begin a comment.

    Raises:
        TrafficError: It is not hexadecimal; the text names the column.
    """
    text = _COMMENT.sub("", line)
    # Two blanks keep the columns of what follows a prefix.
    digits = _BYTE_PREFIX.sub("  ", text)
    wrong = _WRONG.search(digits)
    if wrong is not None:
        column = wrong.start() + 1
        raise TrafficError(f"column {column}: {wrong.group()!a} is no hexadecimal digit")
    packed = digits.translate(_SEPARATORS)
    if len(packed) % 2:
        raise TrafficError(f"{len(packed)} hexadecimal digits make no whole number of bytes")
    return bytes.fromhex(packed)
