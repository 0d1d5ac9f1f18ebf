"""Kinds of fields, by which the classes of messages declare how these stand on the wire.

The annotation of a field is `Annotated` with its kind: a `Scalar`, or what is `Counted`, `Listed`
or `Tagged`. A field whose type is a record needs no kind.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from .codec import integer, padded, scaled, take, take_text, unpadded

if TYPE_CHECKING:
    from collections.abc import Callable

ElementT = TypeVar("ElementT")


def greatest(letter: str) -> int:
    """Returns the greatest unsigned integer of a format of `struct`."""
    return (1 << 8 * struct.calcsize(f"<{letter}")) - 1


@dataclass(frozen=True)
class Scalar:
    """A field of a fixed size.

    Attributes:
        format: Its format for `struct`.
        put: Returns what is packed of a value; it is also given the attribute that an error names.
        get: Returns the value of what was unpacked; None for that itself.
        limits: Least and greatest value of an integer that is packed as it is; None for others.
        is_narrow: Whether its bytes can hold more than these, which packing does not find.
    """

    format: str
    put: Callable[[Any, str], Any]
    get: Callable[[Any], Any] | None = None
    limits: tuple[int, int] | None = None
    is_narrow: bool = False


def unsigned(size: int, lower: int = 0, upper: int | None = None) -> Scalar:
    """Returns the kind of an integer of some bytes, 1, 2 or 4, which fills them by default."""
    letter = {1: "B", 2: "H", 4: "I"}[size]
    most = greatest(letter)
    end = most if upper is None else upper

    def put(value: int, field: str) -> int:
        return integer(value, lower, end, field)

    is_narrow = (lower, end) != (0, most)
    return Scalar(letter, put, limits=(lower, end), is_narrow=is_narrow)


def scaled_unsigned(upper: float) -> Scalar:
    """Returns the kind of a number from 0, as a scaled integer of two bytes."""
    step = upper / 0xFFFF
    return Scalar("H", lambda value, field: scaled(value, 0.0, step, 0xFFFF, field), step.__mul__)


def fixed_text(length: int) -> Scalar:
    """Returns the kind of a string of a fixed number of bytes."""
    return Scalar(f"{length}s", lambda value, field: padded(value, length, field), unpadded)


def bits(size: int, bit_field: Any) -> Scalar:
    """Returns the kind of a bit field of some bytes, 2 or 4, which has a class."""

    def put(value: Any, _: str) -> Any:
        return value.to_integer()

    return Scalar({2: "H", 4: "I"}[size], put, bit_field.from_integer)


@dataclass(frozen=True)
class Counted:
    """Bytes, or a string of Latin-1, behind their number.

    Attributes:
        format: Format of the number for `struct`.
        least: Fewest bytes that may be sent.
    """

    format: str
    least: int = 0
    is_text: bool = False

    @property
    def most(self) -> int:
        """Most bytes."""
        return greatest(self.format)

    @property
    def take(self) -> Callable[..., Any]:
        """What takes them, as the type of the field."""
        return take_text if self.is_text else take


@dataclass(frozen=True)
class Listed:
    """Records behind their number, which has a format for `struct`."""

    format: str

    @property
    def most(self) -> int:
        """Most records."""
        return greatest(self.format)


@dataclass(frozen=True)
class Tagged:
    """One of several records, behind a byte that says which one: its `TAG`.

    Attributes:
        name: What an error calls the field.
    """

    name: str


U8 = Annotated[int, unsigned(1)]
U16 = Annotated[int, unsigned(2)]
U32 = Annotated[int, unsigned(4)]
Text = Annotated[str, Counted("B", is_text=True)]
ShortList = Annotated[list[ElementT], Listed("B")]
LongList = Annotated[list[ElementT], Listed("H")]
