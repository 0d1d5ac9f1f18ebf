"""Comments of ros2jaus text: which of them document what stands behind them, and what they say."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_APART = re.compile(r'"(?:[^"\\]|\\.)*"|`(?:[^`\\]|\\.)*`|//[^\n]*|/\*.*?\*/', re.DOTALL)
"""Texts, quoted names and comments: within one there is none of the others."""
_LINE_START = re.compile(r"[ \t\r]*\*?[ ]?")
_LINE_BREAK = re.compile(r"(?<!\n)\n(?!\n)")
_ESCAPED_END = re.compile(r"\*\\(\\*)/")


def is_documentation(comment: str) -> bool:
    """Tells whether a comment documents what stands behind it."""
    is_marked = comment.startswith("/**") and comment[3] not in "*/"
    return is_marked and bool(documentation_text(comment))


def ordinary_comments(text: str) -> list[str]:
    """Returns the comments of a text that document nothing, in order."""
    found = (match.group() for match in comments_in(text))
    return [each for each in found if not is_documentation(each)]


def comments_in(text: str) -> Iterator[re.Match[str]]:
    """Yields the comments of a text, with their marks and places."""
    return (match for match in _APART.finditer(text) if match.group()[0] == "/")


def documentation_text(comment: str) -> str:
    r"""Returns what a documentation comment says, without its marks and the stars of its lines.

    A line break stands for a blank; empty lines stand between paragraphs.
    """
    first, *further = comment[3:-2].split("\n")
    lines = [each.strip(" \t\r") for each in (first, *map(_without_star, further))]
    text = "\n".join(lines).strip("\n")
    return _ESCAPED_END.sub(r"*\1/", _LINE_BREAK.sub(" ", text))


def _without_star(line: str) -> str:
    match = _LINE_START.match(line)
    if match is None or "*" not in match.group():
        return line.lstrip(" \t\r")
    return line[match.end() :]
