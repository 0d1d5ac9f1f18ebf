"""Sources of translations by chance, with what no peer should send, and what becomes of them."""

import inspect
import math
import struct
from dataclasses import dataclass
from random import Random
from types import SimpleNamespace
from typing import Any

from jausml.language.metamodel.classes import ros

# Written here again: a test that took them from the generator would not see a wrong one.
FORMATS = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_ODD = (0.0, -0.0, 1.0, -1.0, 0.5, math.nan, math.inf, -math.inf, 1e300, -1e300, 1e-9, 100.0)
_TEXTS = ("", "odom", "base_link", "ä", "€uro", "x" * 300, "left_joint", "one")


def ros_value(kind: ros.MessageType, chance: Random) -> SimpleNamespace:
    """Returns a message of a type with values by chance."""
    values = {field.name: _field(field, chance) for field in kind.fields}
    return SimpleNamespace(**values)


def _field(field: Any, chance: Random) -> Any:
    array = field.arrayKind.name
    if array == "single":
        return _one(field, chance)
    size = field.arraySize if array == "fixedArray" else chance.choice([0, 1, 2, 3, 5, 7, 20])
    return [_one(field, chance) for _ in range(size)]


def _one(field: Any, chance: Random) -> Any:
    if isinstance(field, ros.MessageField):
        return ros_value(field.messageType, chance)
    letter = FORMATS.get(field.type.name, "")
    if not letter:
        return chance.choice(_TEXTS)
    if letter == "?":
        return chance.random() < 0.5
    if letter in "fd":
        return _real(letter, chance)
    bits = 8 * struct.calcsize(letter)
    low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if letter.islower() else (0, 2**bits - 1)
    return chance.choice([low, high, 0, 1, 100 % high, chance.randint(low, high)])


def _real(letter: str, chance: Random) -> float:
    wide = 10.0 ** chance.randint(0, 7)
    value = chance.choice([*_ODD, *[chance.uniform(-wide, wide) for _ in range(24)]])
    if letter == "f":
        try:
            return struct.unpack("f", struct.pack("f", value))[0]  # type: ignore[no-any-return]
        except OverflowError:
            return math.inf
    return value


class Cdr:
    """Encodes messages in one of the orders of bytes (XCDR1), with odd bytes where none matter."""

    def __init__(self, order: str) -> None:
        self.order = order
        self.out = bytearray(b"\0\1\0\0" if order == "<" else b"\0\0\0\0")

    def number(self, letter: str, value: Any) -> None:
        size = struct.calcsize(letter)
        self.out += b"\xbf" * (-(len(self.out) - 4) % size)
        self.out += struct.pack(self.order + letter, value)

    def message(self, kind: ros.MessageType, value: Any) -> None:
        if not kind.fields:
            self.number("B", 0)
        for field in kind.fields:
            self.field(field, getattr(value, field.name))

    def field(self, field: Any, value: Any) -> None:
        array = field.arrayKind.name
        if array == "single":
            self.one(field, value)
            return
        if array != "fixedArray":
            self.number("I", len(value))
        for entry in value:
            self.one(field, entry)

    def one(self, field: Any, value: Any) -> None:
        if isinstance(field, ros.MessageField):
            self.message(field.messageType, value)
        elif field.type.name == "string":
            text = value.encode()
            self.number("I", len(text) + 1)
            self.out += text + b"\0"
        else:
            self.number(FORMATS[field.type.name], value)


def cdr(kind: ros.MessageType, value: Any, order: str = "<") -> bytes:
    """Returns a message as bytes."""
    encoder = Cdr(order)
    encoder.message(kind, value)
    return bytes(encoder.out)


@dataclass(frozen=True)
class Outcome:
    """What became of a source.

    Attributes:
        result: The bytes that were made, None, or the class of the error.
        counts: What the limits of the connection counted.
    """

    result: Any
    counts: dict[Any, int]


def outcome(connection: Any, translate: Any, *arguments: Any, **joins: Any) -> Outcome:
    """Translates, and returns what became of it."""
    connection.statistics.out_of_range.clear()
    try:
        result = translate(*arguments, **joins)
    except Exception as error:
        result = type(error)
    return Outcome(result, dict(connection.statistics.out_of_range))


def by_bytes(bridge: Any, name: str) -> Any:
    """Returns the translation of a connection from bytes to bytes, as it runs."""
    translate = getattr(bridge, f"translate_{name}")
    base = vars(inspect.getmodule(type(bridge).__mro__[1]))
    source = base[translate.__annotations__["source"]]

    def run(data: bytes, **joins: Any) -> bytes | None:
        is_of_ros = hasattr(source, "from_cdr")
        target = translate(source.from_cdr(data) if is_of_ros else source.decode(data), **joins)
        if target is None:
            return None
        made: bytes = target.encode() if is_of_ros else target.to_cdr()
        return made

    return run
