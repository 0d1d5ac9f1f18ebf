"""Attributes of JSIDL elements as values: texts, numbers, types."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.importers.jsidl.scopes import MissingError, NumberError
from jausml.language.importers.jsidl.vocabulary import VOCABULARY
from jausml.language.model.values import show, suggest

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from jausml.language.importers.jsidl.scopes import Scope, Scopes
    from jausml.language.model.reading.problems import Findings, NodePlace
    from jausml.language.model.xmi.parsing import Node

NUMERIC_TYPES: Mapping[str, str] = MappingProxyType(
    {
        "byte": "int8",
        "short integer": "int16",
        "integer": "int32",
        "long integer": "int64",
        "unsigned byte": "uint8",
        "unsigned short integer": "uint16",
        "unsigned integer": "uint32",
        "unsigned long integer": "uint64",
        "float": "float32",
        "long float": "float64",
    }
)
"""The types of the model by those of JSIDL (AS5684, field_type)."""

INT = (-(2**31), 2**31 - 1)
LONG = (-(2**63), 2**63 - 1)


def folded(text: str | None) -> str:
    """Returns a text with each run of white space as one blank: editors fold long lines."""
    return " ".join((text or "").split())


def documentation(*nodes: Node | None) -> str | None:
    """Returns what elements say about themselves, in `interpretation` or as text."""
    texts = []
    for node in nodes:
        if node is not None:
            texts += [folded(node.get("interpretation")), folded(node.text)]
    return " ".join(dict.fromkeys(text for text in texts if text)) or None


def joined(*texts: str | None) -> str | None:
    """Returns texts one after the other, None when there are none."""
    return " ".join(text for text in texts if text) or None


class Values:
    """Reads values and reports those that are none."""

    def __init__(self, scopes: Scopes, findings: Findings) -> None:
        self._scopes = scopes
        self._findings = findings

    def text(self, place: NodePlace, name: str) -> str:
        """Returns an attribute with folded white space, or what is assumed without it."""
        value = place.node.get(name)
        if value is None:
            return VOCABULARY[place.node.tag].assumed.get(name, "")
        return folded(value)

    def flag(self, place: NodePlace, name: str) -> bool:
        """Returns an attribute that is true or false; false without it."""
        text = self.text(place, name).lower()
        if text not in ("", "true", "false", "1", "0"):
            self._wrong(place, name, "is not true or false", suggest(text, ("true", "false")))
        return text in ("true", "1")

    def choice(self, place: NodePlace, name: str, choices: Mapping[str, str]) -> str | None:
        """Returns what an attribute stands for, None when it stands for nothing."""
        text = self.text(place, name)
        value = choices.get(text) or choices.get(text.lower())
        if value is None and text:
            hint = suggest(text, choices) or f"one of {', '.join(choices)}"
            self._wrong(place, name, "is not known", hint)
        elif value is None and place.node.get(name) is not None:
            self._wrong(place, name, "is empty")
        return value

    def numeric_type(self, place: NodePlace, name: str) -> str | None:
        """Returns the numeric type that an attribute names."""
        return self.choice(place, name, NUMERIC_TYPES)

    def unsigned_type(self, place: NodePlace) -> str | None:
        """Returns the unsigned integer type that an attribute names."""
        unsigned = {key: each for key, each in NUMERIC_TYPES.items() if each.startswith("u")}
        return self.choice(place, "field_type_unsigned", unsigned)

    def integer(
        self, scope: Scope, place: NodePlace, name: str, bounds: tuple[int, int] = INT
    ) -> int | None:
        """Returns an integer, None when there is none."""
        value = self._number(scope, place, name)
        if value is None:
            return None
        if value.denominator != 1:
            self._wrong(place, name, "is not an integer")
        elif not bounds[0] <= value <= bounds[1]:
            self._wrong(place, name, f"is not in {bounds[0]}..{bounds[1]}")
        else:
            return int(value)
        return None

    def real(self, scope: Scope, place: NodePlace, name: str) -> float | None:
        """Returns a number, None when there is none."""
        value = self._number(scope, place, name)
        if value is None:
            return None
        try:
            return float(value)
        except OverflowError:
            self._wrong(place, name, "is out of all bounds")
            return None

    def _number(self, scope: Scope, place: NodePlace, name: str) -> Fraction | None:
        text = place.node.get(name)
        if text is None:
            return None
        try:
            return self._scopes.number(scope, text)
        except NumberError as error:
            self._wrong(place, name, str(error))
        except MissingError:
            pass  # the missing set was reported
        return None

    def _wrong(self, place: NodePlace, name: str, reason: str, hint: str = "") -> None:
        text = show(place.node.get(name) or "")
        self._findings.report("JML605", place.at(name), f"'{name}' {text} {reason}", hint)


def largest(unsigned: str) -> int:
    """Returns the largest integer of an unsigned type such as `uint8`."""
    return (1 << int(unsigned.removeprefix("uint"))) - 1
