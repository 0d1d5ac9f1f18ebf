"""Layout of ROS messages in XCDR version 1: what the types of a model are made of."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from jausml.language.interfaces.definitions import BOUNDED, FIXED, SINGLE, TEXTS
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.ros_types import package_of

LARGEST_INLINED = 64
"""Most fields of messages inside a message that are read and written together with its own."""


class CdrError(ValueError):
    """A type whose messages have no serialized form."""


@dataclass(frozen=True)
class Primitive:
    """A type of numbers.

    Attributes:
        code: Format character of `struct`.
        size: Bytes.
        python: Type in Python.
        zero: The value 0 as Python text.
        idl: Type by rosidl in `get_fields_and_field_types`.
    """

    code: str
    size: int
    python: str
    zero: str
    idl: str


PRIMITIVES = {
    "bool": Primitive("?", 1, "bool", "False", "boolean"),
    "byte": Primitive("B", 1, "int", "0", "octet"),
    "char": Primitive("B", 1, "int", "0", "uint8"),
    "float32": Primitive("f", 4, "float", "0.0", "float"),
    "float64": Primitive("d", 8, "float", "0.0", "double"),
    **{
        f"{sign}int{8 << power}": Primitive(code, 1 << power, "int", "0", f"{sign}int{8 << power}")
        for sign, codes in (("", "bhiq"), ("u", "BHIQ"))
        for power, code in enumerate(codes)
    },
}


@dataclass(frozen=True)
class FieldLayout:
    """A field of a message.

    Attributes:
        array: How many it has: `single`, `fixedArray`, `boundedSequence` or `unboundedSequence`.
        count: Elements of a fixed array, most elements of a bounded sequence; else 0.
        primitive: Type of a number, or of the elements; None for others.
        text: `string` or `wstring`; empty for others.
        bound: Most characters of a text; 0 without a limit.
        message: Type of a message inside; None for others.
        default: Default of the model as Python value; None without one.
    """

    name: str
    array: str
    count: int = 0
    primitive: Primitive | None = None
    text: str = ""
    bound: int = 0
    message: ros.MessageType | None = None
    default: Any = None

    @property
    def is_single(self) -> bool:
        """Whether it is no array."""
        return self.array == SINGLE

    @property
    def is_fixed(self) -> bool:
        """Whether it is an array of fixed size."""
        return self.array == FIXED

    @property
    def is_bounded(self) -> bool:
        """Whether it is a sequence with a largest number of elements."""
        return self.array == BOUNDED

    @property
    def idl(self) -> str:
        """Its type by rosidl in `get_fields_and_field_types`."""
        if self.primitive is not None:
            base = self.primitive.idl
        elif self.message is not None:
            base = short_name(self.message)
        else:
            base = f"{self.text}<{self.bound}>" if self.bound else self.text
        if self.is_single:
            return base
        if self.is_fixed:
            return f"{base}[{self.count}]"
        return f"sequence<{base}, {self.count}>" if self.is_bounded else f"sequence<{base}>"


def short_name(message_type: ros.MessageType) -> str:
    """Returns package and name, e.g. `geometry_msgs/Quaternion`."""
    return f"{package_of(message_type)}/{message_type.name}"


def fields_of(message: ros.MessageType) -> tuple[FieldLayout, ...]:
    """Returns the fields of a message in order."""
    return tuple(_field(field) for field in message.fields)


def _field(field: ros.Field) -> FieldLayout:
    name, array = str(field.name), field.arrayKind.name
    if isinstance(field, ros.MessageField):
        return FieldLayout(name, array, field.arraySize, message=field.messageType)
    if not isinstance(field, ros.PrimitiveField):
        raise CdrError(f"field {name} has no type")
    kind = field.type.name
    default = None if field.defaultValue is None else _default(field.defaultValue, kind, array)
    text = kind if kind in TEXTS else ""
    number, bound = PRIMITIVES.get(kind), field.stringBound
    return FieldLayout(name, array, field.arraySize, number, text, bound, default=default)


def _default(text: str, kind: str, array: str) -> Any:
    if array != SINGLE:
        return json.loads(text)
    if kind in TEXTS:
        return text
    if kind == "bool":
        return text == "true"
    return float(text) if kind.startswith("float") else int(text)


def types_within(roots: Iterable[ros.MessageType]) -> list[ros.MessageType]:
    """Returns types and those of the messages inside them, the inner ones first.

    Raises:
        CdrError: A message contains itself.
    """
    types: dict[ros.MessageType, None] = {}
    for root in sorted(set(roots), key=short_name):
        _collect(root, types, ())
    return list(types)


def _collect(
    message: ros.MessageType,
    types: dict[ros.MessageType, None],
    around: tuple[ros.MessageType, ...],
) -> None:
    """Adds a type behind those of the messages inside it."""
    if message in around:
        raise CdrError(f"ROS type {short_name(message)} contains itself")
    if message not in types:
        for inner in nested(message):
            _collect(inner, types, (*around, message))
        types[message] = None


def nested(message: ros.MessageType) -> Iterator[ros.MessageType]:
    """Yields the types of the messages inside a message, each once, in order."""
    inner = (field.messageType for field in message.fields if isinstance(field, ros.MessageField))
    yield from dict.fromkeys(inner)


class Sizes:
    """Sizes of messages, each worked out once."""

    def __init__(self) -> None:
        self._fewest: dict[ros.MessageType, int] = {}
        self._counts: dict[ros.MessageType, int] = {}

    def fewest_bytes(self, message: ros.MessageType) -> int:
        """Returns the fewest bytes that a message takes, without padding."""
        if message not in self._fewest:
            least = sum(self._fewest_of(field) for field in fields_of(message))
            self._fewest[message] = max(least, 1)
        return self._fewest[message]

    def _fewest_of(self, field: FieldLayout) -> int:
        if not (field.is_single or field.is_fixed):
            return 4
        if field.primitive is not None:
            one = field.primitive.size
        else:
            one = 4 if field.message is None else self.fewest_bytes(field.message)
        return one * (field.count if field.is_fixed else 1)

    def count(self, message: ros.MessageType) -> int:
        """Returns the number of the fields of a message, those of messages inside it included."""
        if message not in self._counts:
            inner = (
                self.count(field.message) if field.is_single and field.message is not None else 1
                for field in fields_of(message)
            )
            self._counts[message] = sum(inner) or 1
        return self._counts[message]

    def is_inlined(self, message: ros.MessageType) -> bool:
        """Whether a message is read and written together with the one around it."""
        return self.count(message) <= LARGEST_INLINED
