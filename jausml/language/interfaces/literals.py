"""Defaults and constants: from the notation of definitions to that of models.

In models an integer stands in decimal digits, a truth value as `true` or `false`, a text as it is;
the elements of an array are written as JSON.
"""

from __future__ import annotations

import json
import math
import re
from typing import Any

from jausml.language.interfaces.definitions import BOUNDED, FIXED, SINGLE, TEXTS, FieldType

_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_LONGEST_NUMBER = 400
_JSON_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# What ends a line of a definition, or starts a comment.
_UNSAYABLE = re.compile("[#\x00-\x1f\x7f\x85\u2028\u2029]")
_BITS = {"byte": (0, 255), "char": (0, 255)}


class ValueTextError(ValueError):
    """A text is no value of a type."""


def parse_value(text: str, kind: FieldType) -> str:
    """Returns a default or a constant as models write it."""
    if not kind.is_primitive:
        raise ValueTextError(f"a {kind.name} cannot have a default")
    if kind.array == SINGLE:
        value = _element(text, kind)
        return value if isinstance(value, str) else _shown(value)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueTextError("is no array: its elements stand between [ and ]")
    elements = _strings(text[1:-1]) if kind.name in TEXTS else _split(text[1:-1])
    size = kind.array_size
    if kind.array == FIXED and len(elements) != size:
        raise ValueTextError(f"has {len(elements)} elements, not {size}")
    if kind.array == BOUNDED and len(elements) > size:
        raise ValueTextError(f"has {len(elements)} elements, more than {size}")
    # As rosidl has it, blanks at the ends of an element are lost even inside quotes.
    values = [_element(each.strip(), kind) for each in elements]
    if kind.name in TEXTS:
        return json.dumps(values, ensure_ascii=False)
    return f"[{', '.join(map(_shown, values))}]"


def write_value(value: str, kind: FieldType, *, is_default: bool = False) -> str:
    """Returns a default or a constant as definitions write it.

    Raises:
        ValueTextError: It is no value of the type, or no definition can say it.
    """
    unsayable = _UNSAYABLE.search(value)
    if unsayable or (is_default and "=" in value):
        character = unsayable[0] if unsayable else "="
        raise ValueTextError(f"has a {character!a}, which no definition can hold there")
    if kind.name not in TEXTS or not kind.is_primitive:
        parse_value(value, kind)
        return value
    if kind.array == SINGLE:
        text = _quoted(value)
    else:
        text = f"[{', '.join(map(_quoted, _json_texts(value)))}]"
    if parse_value(text, kind) != value:
        raise ValueTextError("has blanks or quotes at the ends of an element, which are lost")
    return text


def _quoted(text: str) -> str:
    escaped = text.replace('"', '\\"')
    return f'"{escaped}"'


def _json_texts(value: str) -> list[str]:
    try:
        elements = json.loads(value)
    except ValueError as error:
        raise ValueTextError("is no array in JSON") from error
    if not isinstance(elements, list) or not all(isinstance(each, str) for each in elements):
        raise ValueTextError("is no array of texts in JSON")
    if value != json.dumps(elements, ensure_ascii=False):
        raise ValueTextError(f"is written {json.dumps(elements, ensure_ascii=False)}")
    return elements


def integer_range(name: str) -> tuple[int, int]:
    """Returns the smallest and the largest value of an integer type, `byte` and `char` included."""
    if name in _BITS:
        return _BITS[name]
    bits = int(name.lstrip("uint"))
    return (0, 2**bits - 1) if name.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _shown(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _element(text: str, kind: FieldType) -> Any:
    if kind.name in TEXTS:
        return _bounded(_unquoted(text), kind)
    if kind.name == "bool":
        if text.lower() not in _TRUTH:
            raise ValueTextError("is not true or false")
        return _TRUTH[text.lower()]
    if len(text) > _LONGEST_NUMBER:
        raise ValueTextError("is too long for a number")
    if kind.name.startswith("float"):
        return _real(text)
    return _integer(text, kind.name)


def _real(text: str) -> str:
    if _REAL.fullmatch(text) is None:
        raise ValueTextError("is not a number")
    if not math.isfinite(float(text)):
        raise ValueTextError("is larger than any number of its type")
    return text if _JSON_NUMBER.fullmatch(text) else repr(float(text))


def _integer(text: str, name: str) -> int:
    low, high = integer_range(name)
    try:
        value = int(text)
    except ValueError:
        try:
            value = int(text, 0)
        except ValueError as error:
            raise ValueTextError("is not an integer") from error
    if not low <= value <= high:
        raise ValueTextError(f"is not in {low}..{high}")
    return value


def _bounded(text: str, kind: FieldType) -> str:
    if kind.string_bound and len(text) > kind.string_bound:
        raise ValueTextError(f"is longer than {kind.string_bound} characters")
    return text


def _unquoted(text: str) -> str:
    quote = text[:1]
    if quote not in ("'", '"'):
        return text
    if len(text) < 2 or not text.endswith(quote):
        raise ValueTextError(
            "has a quote that is not closed; a # starts a comment inside quotes too"
        )
    inner = text[1:-1]
    if re.search(rf"(?<!\\){quote}", inner):
        raise ValueTextError(f"has a {quote} inside without a \\ before it")
    return inner.replace(f"\\{quote}", quote)


def _split(text: str) -> list[str]:
    return text.split(",") if text.strip() else []


def _strings(text: str) -> list[str]:
    """Returns the elements of an array of strings, which may hold commas between quotes."""
    found: list[str] = []
    rest = text.strip()
    while rest:
        if rest[0] in "'\"":
            match = re.match(rf"{rest[0]}((?:[^\\{rest[0]}]|\\.)*){rest[0]}\s*(,|$)", rest)
            if match is None:
                raise ValueTextError("has a quote that is not closed, or no comma behind it")
            found.append(match[1].replace(f"\\{rest[0]}", rest[0]))
            has_comma, rest = bool(match[2]), rest[match.end() :].lstrip()
        else:
            element, comma, rest = rest.partition(",")
            if not element.strip():
                raise ValueTextError("has an element without a value")
            found.append(element.rstrip())
            has_comma, rest = bool(comma), rest.lstrip()
        if has_comma and not rest:
            raise ValueTextError("has an element without a value")
    return found
