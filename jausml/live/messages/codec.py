"""Codecs: small objects that each know how one field stands on the wire (SAE AS5684).

Decoding is as lenient as the layout allows: an integer that a value set does not list and a byte
string that is too short are carried on, because peers send them. Encoding is strict, but for lists
that are too short. The fields have the shapes of JSON: objects, lists, numbers, strings.
"""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from numbers import Integral, Real
from typing import Any

from jausml.live.messages.errors import DecodeError, EncodeError

MAXIMUM_SHOWN = 60


class Codec(ABC):
    """A field on the wire.

    Attributes:
        minimum_size: Fewest bytes on the wire.
    """

    __slots__ = ()

    minimum_size: int

    @abstractmethod
    def decode(self, buffer: bytes, offset: int) -> tuple[Any, int]:
        """Returns the value at an offset, and the offset after it.

        Args:
            buffer: The whole payload.
            offset: Where the field begins.

        Raises:
            DecodeError: The bytes are no such field.
        """

    @abstractmethod
    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a value.

        Args:
            value: The value in its JSON shape.
            out: The bytes written so far.

        Raises:
            EncodeError: The value has no place on the wire.
        """

    @abstractmethod
    def legal(self) -> str:
        """Returns what may stand in the field, in words for an error message."""


class Scalar(Codec):
    """A field of a fixed number of bytes, one item of a struct format.

    Attributes:
        format: The struct format without the byte order.
        struct: The compiled format; little endian.
    """

    __slots__ = ("format", "minimum_size", "struct")

    def __init__(self, struct_format: str) -> None:
        self.format = struct_format
        self.struct = struct.Struct(f"<{struct_format}")
        self.minimum_size = self.struct.size

    def decode(self, buffer: bytes, offset: int) -> tuple[Any, int]:
        """Returns the value at an offset, and the offset after it."""
        try:
            (item,) = self.struct.unpack_from(buffer, offset)
        except struct.error:
            raise too_short(self.minimum_size, buffer, offset) from None
        return self.from_wire(item), offset + self.minimum_size

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a value."""
        out += self.struct.pack(self.to_wire(value))

    def from_wire(self, item: Any) -> Any:
        """Returns the value that the wire item means.

        Args:
            item: What the struct unpacked.
        """
        return item

    @abstractmethod
    def to_wire(self, value: Any) -> Any:
        """Returns the wire item of a value.

        Args:
            value: The value.

        Raises:
            EncodeError: The value is not legal.
        """


def no_words(_name: str) -> str:
    """Returns nothing, where it goes without saying what may stand in a field."""
    return ""


def too_short(size: int, buffer: bytes, offset: int) -> DecodeError:
    """Returns the error of a payload that ends within a field.

    Args:
        size: Bytes of the field.
        buffer: The whole payload.
        offset: Where the field begins.
    """
    left = max(len(buffer) - offset, 0)
    return DecodeError(f"{size} byte{'s' * (size != 1)} wanted at offset {offset}, {left} left")


def shown(value: Any) -> str:
    """Returns a value for an error message, cut when it is long.

    Args:
        value: The value.
    """
    if isinstance(value, (dict, list, tuple)):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, int) and value.bit_length() > 4 * MAXIMUM_SHOWN:
        return f"an integer of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= MAXIMUM_SHOWN else f"{text[:MAXIMUM_SHOWN]}..."


def as_number(value: Any) -> int | float:
    """Returns a value that is a number.

    Args:
        value: The value.

    Raises:
        EncodeError: It is something else; true and false are no numbers either.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    if isinstance(value, Real) and not isinstance(value, bool):  # such as those of numpy
        return int(value) if isinstance(value, Integral) else float(value)
    raise EncodeError(f"{shown(value)} is not a number")


def as_object(value: Any) -> dict[str, Any]:
    """Returns a value that is an object.

    Args:
        value: The value.

    Raises:
        EncodeError: It is something else.
    """
    if isinstance(value, dict):
        return value
    raise EncodeError(f"{shown(value)} is not an object of fields")


def as_list(value: Any) -> list[Any]:
    """Returns a value that is a list.

    Args:
        value: The value.

    Raises:
        EncodeError: It is something else.
    """
    if isinstance(value, (list, tuple)):
        return list(value)
    raise EncodeError(f"{shown(value)} is not a list")
