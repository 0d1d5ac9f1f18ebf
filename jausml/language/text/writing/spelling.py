"""How names, values, documentation and the heads of elements are spelt."""

from __future__ import annotations

import math
import re
from typing import Any, TypeVar, cast

from jausml.language.metamodel import DataTypeTable, FeatureTable, ValueKind
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.text import tree
from jausml.language.text.comments import documentation_text, is_documentation
from jausml.language.text.keywords import KEYWORDS

_STEP = r"\w+(?:\[\d+\])*"
_PATH = re.compile(rf"/?(?!\d){_STEP}(?:[./]{_STEP})*|\.")
_ANY_WIDTH = 80
_SINGLE_BLANK = re.compile(r"(?<=\S) (?=\S)")
_ENDS = re.compile(r"\*(\\*)/")
_SHORT = {"\n": "\\n", "\t": "\\t", "\r": "\\r", "\\": "\\\\"}


def word(text: str) -> str:
    """Returns a name in the notation: in back quotes where it is no plain word."""
    # A path may end with an index, a name may not.
    plain = _PATH.fullmatch(text) and not text.endswith("]") and text not in KEYWORDS
    return text if plain else f"`{_escaped(text, '`')}`"


def path(text: str) -> str:
    """Returns a path in the notation; unlike a name it may end with an index."""
    return text if text.endswith("]") and _PATH.fullmatch(text) else word(text)


def feature_name(text: str) -> str:
    """Returns the name of a feature, which may be a keyword."""
    return text if text in KEYWORDS else word(text)


def quoted(text: str) -> str:
    """Returns a text in quotation marks."""
    return f'"{_escaped(text, chr(34))}"'


def can_document(text: str) -> bool:
    """Tells whether a documentation comment can hold a text to the letter."""
    # Read back, since escapes and line breaks of comments have several pitfalls.
    comment = "\n".join(documentation(text, _ANY_WIDTH))
    # A return alone is read as the end of a line.
    is_read_back = is_documentation(comment) and documentation_text(comment) == text
    return is_read_back and "\r" not in text


def documentation(text: str, room: int) -> list[str]:
    """Returns the lines of a documentation comment.

    Args:
        text: What it says: paragraphs with empty lines between them.
        room: Columns within which lines end, where words are short enough.
    """
    # "*/" within the text would end the comment.
    text = _ENDS.sub(r"*\\\1/", text)
    short = f"/** {text} */"
    if len(short) <= room and "\n" not in text:
        return [short]
    lines = [part for line in text.split("\n") for part in _wrapped(line, room - len(" * "))]
    return ["/**", *(f" * {line}".rstrip() for line in lines), " */"]


def _wrapped(line: str, room: int) -> list[str]:
    """Returns a line in parts that end within some columns, broken at single blanks."""
    parts: list[str] = []
    # Other runs of blanks are kept as they are.
    for part in _SINGLE_BLANK.split(line):
        if parts and len(parts[-1]) + 1 + len(part) <= room:
            parts[-1] += f" {part}"
        else:
            parts.append(part)
    return parts


def _escaped(text: str, mark: str) -> str:
    return "".join(_escape(character) if character != mark else f"\\{mark}" for character in text)


def _escape(character: str) -> str:
    if character in _SHORT:
        return _SHORT[character]
    if character.isprintable():
        return character
    # Characters beyond 16 bits are two escapes, as in JSON.
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[at : at + 2].hex()}" for at in range(0, len(units), 2))


NO_VALUE = tree.Href("")
"""Stands where a feature that has a default has no value, which XMI writes as `xsi:nil`."""

_NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?|0x[0-9A-Fa-f]+")
_ADDRESS = re.compile(r"[0-9]+\.[0-9]+\.[0-9]+")
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*")
# Texts that are sentences stay quoted even if they are one word.
_PROSE = frozenset({"documentation", "holdReason", "units"})


def is_number(text: str) -> bool:
    """Tells whether a text is a number of the notation."""
    return _NUMBER.fullmatch(text) is not None


def number(value: float) -> tree.Number | tree.Text:
    """Returns a real number without a needless fraction; as text where it is no number."""
    if not math.isfinite(value):
        return tree.Text("NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity")
    return tree.Number(repr(float(value)).removesuffix(".0"))


def constant(text: str) -> tree.Name | tree.Number | tree.Text:
    """Returns a text that stands for a number, for true or false, or for itself."""
    if text in ("true", "false"):
        return tree.Name(text)
    return tree.Number(text) if is_number(text) else tree.Text(text)


def word_or_constant(text: str) -> tree.Name | tree.Number | tree.Text:
    """Returns a text without quotation marks where it is a number or a word."""
    return tree.Name(text) if _WORD.fullmatch(text) else constant(text)


def attribute_value(
    value: Any, feature: FeatureTable
) -> tree.Name | tree.Number | tree.Text | tree.Href:
    """Returns one value of an attribute."""
    if value is None:
        return NO_VALUE
    kind = cast("DataTypeTable", feature.data_type).kind
    if kind is ValueKind.ENUMERATION:
        return tree.Name(str(value.literal or value.name) if hasattr(value, "name") else str(value))
    if kind is ValueKind.BOOLEAN:
        return tree.Name("true" if value else "false")
    if kind is ValueKind.INTEGER:
        return tree.Number(str(value))
    if kind is ValueKind.REAL:
        return number(value)
    if feature.name in _PROSE:
        return tree.Text(value)
    return tree.Number(value) if _ADDRESS.fullmatch(value) else word_or_constant(value)


def is_name(text: str | None) -> bool:
    """Tells whether a text can stand as a name, with or without back quotes.

    Names of several steps are names too (`geometry_msgs/Twist`, `Receiving.Ready`), but no step of
    them may be empty; a topic may begin with "/".
    """
    if not text or "`" in text or not text.isprintable() or text != text.strip():
        return False
    return all(re.split("[./]", text.removeprefix("/")))


IN_THE_HEAD = frozenset({"name", "documentation"})
"""Features that stand before the block, where a name and a comment can hold them."""

_AnyItem = TypeVar("_AnyItem", bound=tree.Item)


def head_name(obj: EObject) -> tree.Name | None:
    """Returns the name that stands behind the keyword of an element, None where none can."""
    name = getattr(obj, "name", None)
    return tree.Name(name) if name is not None and is_name(name) else None


def is_comment(text: str | None) -> bool:
    """Tells whether a documentation comment can hold a text without changes."""
    return text is not None and text.replace("\n", "").isprintable() and can_document(text)


def needs_feature(obj: EObject, feature: str) -> bool:
    """Tells whether only a feature can hold a name or documentation."""
    if feature == "name":
        return not is_name(getattr(obj, "name", None))
    return feature == "documentation" and not is_comment(getattr(obj, "documentation", None))


def documented(item: _AnyItem, obj: EObject) -> _AnyItem:
    """Returns an item with the documentation of its element, where a comment can hold it."""
    text = getattr(obj, "documentation", None)
    if text is not None and is_comment(text):
        item.documentation = text
    return item
