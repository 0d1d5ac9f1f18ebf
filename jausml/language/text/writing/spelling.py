"""Spelling of words, texts and documentation, so that they are read as what they are."""

from __future__ import annotations

import re

from jausml.language.text.comments import documentation_text, is_documentation
from jausml.language.text.keywords import KEYWORDS

_STEP = r"\w+(?:\[\d+\])*"
_PATH = re.compile(rf"/?(?!\d){_STEP}(?:[./]{_STEP})*|\.")
_ANY_WIDTH = 80
_SINGLE_BLANK = re.compile(r"(?<=\S) (?=\S)")
_ENDS = re.compile(r"\*(\\*)/")
_SHORT = {"\n": "\\n", "\t": "\\t", "\r": "\\r", "\\": "\\\\"}


def word(text: str) -> str:
    """Returns a name as it is written: in back quotes where it is no plain word."""
    plain = _PATH.fullmatch(text) and not text.endswith("]") and text not in KEYWORDS
    return text if plain else f"`{_escaped(text, '`')}`"


def path(text: str) -> str:
    """Returns a path as it is written; unlike a name it may end with an index."""
    return text if text.endswith("]") and _PATH.fullmatch(text) else word(text)


def feature_name(text: str) -> str:
    """Returns the name of a feature, which may be a keyword."""
    return text if text in KEYWORDS else word(text)


def quoted(text: str) -> str:
    """Returns a text in quotation marks."""
    return f'"{_escaped(text, chr(34))}"'


def can_document(text: str) -> bool:
    """Tells whether a documentation comment can hold a text to the letter."""
    comment = "\n".join(documentation(text, _ANY_WIDTH))
    return is_documentation(comment) and documentation_text(comment) == text


def documentation(text: str, room: int) -> list[str]:
    """Returns the lines of a documentation comment.

    Args:
        text: What it says: paragraphs with empty lines between them.
        room: Columns within which lines end, where words are short enough.
    """
    text = _ENDS.sub(r"*\\\1/", text)
    short = f"/** {text} */"
    if len(short) <= room and "\n" not in text:
        return [short]
    lines = [part for line in text.split("\n") for part in _wrapped(line, room - len(" * "))]
    return ["/**", *(f" * {line}".rstrip() for line in lines), " */"]


def _wrapped(line: str, room: int) -> list[str]:
    """Returns a line in parts that end within some columns, broken at single blanks."""
    parts: list[str] = []
    for part in _SINGLE_BLANK.split(line):
        if parts and len(parts[-1]) + 1 + len(part) <= room:
            parts[-1] += f" {part}"
        else:
            parts.append(part)
    return parts


def _escaped(text: str, mark: str) -> str:
    return "".join(_escape(each) if each != mark else f"\\{mark}" for each in text)


def _escape(character: str) -> str:
    if character in _SHORT:
        return _SHORT[character]
    if character.isprintable():
        return character
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[at : at + 2].hex()}" for at in range(0, len(units), 2))
