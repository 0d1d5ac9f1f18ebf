"""Lexical forms of attribute values, as EMF reads them.

Python's own conversions are too lenient for this: `1_000`, ` 5 ` and `INF` are numbers to Python
and faults to EMF.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

from jausml.language.metamodel import DataTypeTable, ValueKind
from jausml.language.model.diagnostics import ReadFault

_INTEGER = re.compile(r"[+-]?[0-9]+")
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_SPECIAL_REALS = {
    "NaN": math.nan,
    "Infinity": math.inf,
    "+Infinity": math.inf,
    "-Infinity": -math.inf,
}
_LONGEST_SHOWN = 40


def convert(text: str, data_type: DataTypeTable) -> tuple[Any, ReadFault | None]:
    """Converts the text of an attribute.

    Returns:
        The value and None, or None and the fault.
    """
    kind = data_type.kind
    if kind is ValueKind.STRING:
        return _string(text, data_type)
    if kind is ValueKind.ENUMERATION:
        literal = data_type.literals.get(text)
        return (literal, None) if literal is not None else (None, _no_literal(text, data_type))
    if kind is ValueKind.BOOLEAN:
        value = {"true": True, "false": False}.get(text.lower())
        return (value, None) if value is not None else (None, _wrong(text, "true or false"))
    if kind is ValueKind.INTEGER:
        return _integer(text, data_type)
    return _real(text)


def nearest(wrong: str, known: Iterable[str]) -> str:
    """Returns the known word that a wrong one most likely means, or an empty text."""
    words = list(known)
    near = get_close_matches(wrong, words, n=1, cutoff=0.6)
    folded = [word for word in words if word.lower() == wrong.lower()]
    return (folded or near or [""])[0]


def suggest(wrong: str, known: Iterable[str]) -> str:
    """Returns the hint that names the nearest known word, or an empty text."""
    near = nearest(wrong, known)
    return f"did you mean '{near}'?" if near else ""


def suggest_or_list(wrong: str, known: Iterable[str]) -> str:
    """Returns the hint that names the nearest known word, or those that there are."""
    words = tuple(known)
    return suggest(wrong, words) or (f"it has {', '.join(words)}" if words else "")


def show(text: str) -> str:
    """Quotes a text for a message, shortened and on one line."""
    flat = " ".join(text.split()) if any(character in text for character in "\r\n\t") else text
    if len(flat) > _LONGEST_SHOWN:
        flat = flat[: _LONGEST_SHOWN - 3] + "..."
    return f"'{flat}'"


def _string(text: str, data_type: DataTypeTable) -> tuple[Any, ReadFault | None]:
    if data_type.pattern is None or data_type.pattern.fullmatch(text):
        return text, None
    reason = f"{show(text)} does not match the pattern {data_type.pattern_text}"
    return None, ReadFault("JML107", f"{reason} of {data_type.name}")


def _integer(text: str, data_type: DataTypeTable) -> tuple[Any, ReadFault | None]:
    if not _INTEGER.fullmatch(text):
        return None, _wrong(text, "an integer")
    # The length guards against texts that Python refuses to convert.
    value = int(text) if len(text) <= 100 else data_type.maximum + 1
    if data_type.minimum <= value <= data_type.maximum:
        return value, None
    return None, _wrong(text, f"an integer in {data_type.minimum}..{data_type.maximum}")


def _real(text: str) -> tuple[Any, ReadFault | None]:
    stripped = text.strip()
    if _REAL.fullmatch(stripped):
        return float(stripped), None
    if stripped in _SPECIAL_REALS:
        return _SPECIAL_REALS[stripped], None
    return None, _wrong(text, "a number")


def _wrong(text: str, wanted: str) -> ReadFault:
    return ReadFault("JML106", f"{show(text)} is not {wanted}")


def _no_literal(text: str, data_type: DataTypeTable) -> ReadFault:
    hint = suggest(text, data_type.legal) or f"one of {', '.join(data_type.legal)}"
    return ReadFault("JML105", f"{show(text)} is not a literal of {data_type.name}", hint)
