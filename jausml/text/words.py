"""Writes words, texts and documentation so that they are read as what they are."""

from __future__ import annotations

import re

from jausml.text.comments import documentation_text, is_documentation
from jausml.text.expectations import KEYWORDS

_STEP = r"\w+(?:\[\d+\])*"
_PATH = re.compile(rf"/?(?!\d){_STEP}(?:[./]{_STEP})*|\.")
_ENDS = re.compile(r"\*(\\*)/")
_SHORT = {"\n": "\\n", "\t": "\\t", "\r": "\\r", "\\": "\\\\"}


def word(text: str) -> str:
    """Returns a name as it is written: in back quotes where it is no plain word.

    Args:
        text: Any text.
    """
    plain = _PATH.fullmatch(text) and not text.endswith("]") and text not in KEYWORDS
    return text if plain else f"`{_escaped(text, '`')}`"


def path(text: str) -> str:
    """Returns a path as it is written; unlike a name it may end with an index.

    Args:
        text: Any text.
    """
    return text if text.endswith("]") and _PATH.fullmatch(text) else word(text)


def feature_name(text: str) -> str:
    """Returns the name of a feature, which may be a keyword.

    Args:
        text: Any text.
    """
    return text if text in KEYWORDS else word(text)


def quoted(text: str) -> str:
    """Returns a text in quotation marks.

    Args:
        text: Any text.
    """
    return f'"{_escaped(text, chr(34))}"'


def can_document(text: str) -> bool:
    """Tells whether a documentation comment can hold a text to the letter.

    Args:
        text: Any text.
    """
    comment = "\n".join(documentation(text))
    return is_documentation(comment) and documentation_text(comment) == text


def documentation(text: str) -> list[str]:
    """Returns the lines of a documentation comment.

    Args:
        text: What it says.
    """
    lines = _ENDS.sub(r"*\\\1/", text).split("\n")
    if len(lines) == 1:
        return [f"/** {lines[0]} */"]
    return ["/**", *(f" * {line}".rstrip() for line in lines), " */"]


def _escaped(text: str, mark: str) -> str:
    return "".join(_escape(each) if each != mark else f"\\{mark}" for each in text)


def _escape(character: str) -> str:
    if character in _SHORT:
        return _SHORT[character]
    if character.isprintable():
        return character
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[at : at + 2].hex()}" for at in range(0, len(units), 2))
