"""Messages of ROS as they stand in CDR (OMG DDSI-RTPS 10, XCDR1): a list of leaves.

A primitive type is aligned to its own size, counted from behind the encapsulation. A structure
without fields has one octet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.flat.errors import NotFlatError

if TYPE_CHECKING:
    from collections.abc import Iterator

LETTERS = {
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
"""Letters of struct formats of the primitive types of fixed size."""
SIZES = {"?": 1, "b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "f": 4, "q": 8, "Q": 8, "d": 8}
"""Sizes of these, which are their alignments too."""

# More elements of an array than these are not read one by one.
_MOST_ELEMENTS = 1000


@dataclass(frozen=True)
class Number:
    """A value of fixed size.

    Attributes:
        path: Its path in the message.
        letter: Its letter in struct formats.
    """

    path: str
    letter: str


@dataclass(frozen=True)
class Text:
    """A string.

    Attributes:
        path: Its path in the message.
    """

    path: str


@dataclass(frozen=True)
class Many:
    """A sequence.

    Attributes:
        path: Its path in the message.
        field: The field, whose elements these are.
    """

    path: str
    field: ros.Field


Leaf: TypeAlias = Number | Text | Many


def leaves(message_type: ros.MessageType, prefix: str = "") -> Iterator[Leaf]:
    """Yields what a message consists of, in order.

    Args:
        message_type: The type of the message.
        prefix: Path of the message, with a dot at its end; empty for the whole.

    Raises:
        NotFlatError: It has what is not read from bytes.
    """
    if not message_type.fields:
        yield Number(f"{prefix}structure_needs_at_least_one_member", "B")
    for field in message_type.fields:
        path = f"{prefix}{field.name}"
        kind = field.arrayKind.name
        if kind == "fixedArray":
            if field.arraySize > _MOST_ELEMENTS:
                raise NotFlatError(f"{path} has {field.arraySize} elements")
            for index in range(field.arraySize):
                yield from element_leaves(field, f"{path}[{index}]")
        elif kind == "single":
            yield from element_leaves(field, path)
        else:
            yield Many(path, field)


def element_leaves(field: ros.Field, path: str) -> Iterator[Leaf]:
    """Yields what one value of a field consists of.

    Args:
        field: The field.
        path: Path of the value.

    Raises:
        NotFlatError: It has what is not read from bytes.
    """
    if isinstance(field, ros.MessageField):
        yield from leaves(field.messageType, f"{path}." if path else "")
    elif isinstance(field, ros.PrimitiveField) and field.type.name == "string":
        yield Text(path)
    elif isinstance(field, ros.PrimitiveField) and field.type.name in LETTERS:
        yield Number(path, LETTERS[field.type.name])
    else:
        raise NotFlatError(f"{path} is a wide string")
