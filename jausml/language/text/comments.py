"""Comments of ros2jaus text, ordinary ones and documentation."""

from __future__ import annotations

import re

_APART = re.compile(r'"(?:[^"\\]|\\.)*"|`(?:[^`\\]|\\.)*`|//[^\n]*|/\*.*?\*/', re.DOTALL)
"""Texts, quoted names and comments: within one there is none of the others."""
_LINE_START = re.compile(r"[ \t\r]*\*?[ ]?")
_LINE_BREAK = re.compile(r"(?<!\n)\n(?!\n)")
_ESCAPED_END = re.compile(r"\*\\(\\*)/")
"""An end mark within documentation, with a backslash added so that it ends nothing."""


def is_documentation(comment: str) -> bool:
    """Tells whether a comment documents the item behind it."""
    is_marked = comment.startswith("/**") and comment[3] not in "*/"
    return is_marked and bool(documentation_text(comment))


def ordinary_comments(text: str) -> list[str]:
    """Returns the comments of a text that document nothing, in order."""
    comments = (part for part in _APART.findall(text) if part[0] == "/")
    return [comment for comment in comments if not is_documentation(comment)]


def documentation_text(comment: str) -> str:
    r"""Returns the text of a documentation comment, without its marks and the stars of its lines.

    A line break stands for a blank; empty lines stand between paragraphs.
    """
    first, *further = comment[3:-2].split("\n")
    lines = [line.strip(" \t\r") for line in (first, *map(_without_star, further))]
    text = "\n".join(lines).strip("\n")
    return _ESCAPED_END.sub(r"*\1/", _LINE_BREAK.sub(" ", text))


def _without_star(line: str) -> str:
    match = _LINE_START.match(line)
    if match is None or "*" not in match.group():
        return line.lstrip(" \t\r")
    return line[match.end() :]
