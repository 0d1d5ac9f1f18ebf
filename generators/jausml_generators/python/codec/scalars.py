"""Fields of messages on the wire (SAE AS5684): what a codec says of each.

Each class describes one kind of value and answers what templates/messages.py.j2 asks: the Python
type, a default, and the expressions that turn the value into its wire form and back.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, replace
from typing import ClassVar

from jausml.generation.literals import python_literal
from jausml.language import wire

_SCALED = {"round": "scaled", "floor": "scaled_down", "ceiling": "scaled_up"}
_TYPES: tuple[wire.IntegerType | wire.RealType, ...] = (
    *wire.INTEGERS.values(),
    *wire.REALS.values(),
)
_WORDS = {
    kind.format: kind.name.upper().replace("UINT", "U").replace("INT", "I").replace("FLOAT", "F")
    for kind in _TYPES
}


def struct_name(struct_format: str) -> str:
    """Returns the name of the constant for a struct, e.g. `_U16_U8X2` for `HBB`."""
    items: list[tuple[str, int]] = []
    for count, letter in re.findall("([0-9]*)([A-Za-z])", struct_format):
        if letter == "s":
            items.append((f"CHAR{count}", 1))
        elif items and items[-1][0] == _WORDS[letter]:
            items[-1] = (items[-1][0], items[-1][1] + int(count or 1))
        else:
            items.append((_WORDS[letter], int(count or 1)))
    return "".join(f"_{word}X{count}" if count > 1 else f"_{word}" for word, count in items)


@dataclass(frozen=True)
class Fixed:
    """A value of a fixed number of bytes, one item of a struct format.

    Attributes:
        default: A legal value, as Python text.
        check: Function that checks and converts a value for the wire.
        limits: Arguments of that function between the value and the attribute name.
        back: What turns the integer on the wire (`{}`) into the value.
        reader: Function that turns the wire item into the value, instead of `back`.
        scale: Lower and upper limit of a scaled field.
        ranges: Legal ranges of an integer.
        reach: Smallest and largest integer that the wire can bring, legal or not.
        offset: What the value of an integer is more than the integer on the wire.
    """

    kind: ClassVar[str] = "fixed"
    format: str
    python_type: str
    default: str
    check: str
    limits: tuple[str, ...]
    back: str = "{}"
    reader: str = ""
    range_text: str = ""
    scale: tuple[float, float] | None = None
    listed: tuple[tuple[str, int], ...] = ()
    offset: int = 0
    ranges: wire.Ranges = ()
    reach: tuple[int, int] | None = None

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return struct.calcsize(f"<{self.format}")

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.size

    @property
    def struct(self) -> str:
        """Name of the constant for the value alone."""
        return struct_name(self.format)

    @property
    def is_plain(self) -> bool:
        """Whether the wire item is the value."""
        return self.back == "{}" and not self.reader

    def pack(self, value: str, field: str) -> str:
        """Returns the expression that makes the wire item."""
        call = f'{self.check}({value}, {", ".join(self.limits)}, "{field}")'
        return f"{call}{_plus(-self.offset)}"

    def unpack(self, raw: str) -> str:
        """Returns the expression that makes the value."""
        return f"{self.reader}({raw})" if self.reader else self.back.format(raw)


@dataclass(frozen=True)
class Bits(Fixed):
    """A bit field: an integer on the wire, an instance of a nested class in Python.

    Attributes:
        is_stamp: Whether it is the time stamp that the base of the message brings.
    """

    is_stamp: bool = False

    def pack(self, value: str, field: str) -> str:
        """Returns the expression that makes the wire item."""
        del field
        return f"{value}.to_integer()"


@dataclass(frozen=True)
class Tag(Fixed):
    """A variant without options: a tag alone, which JSIDL writes where nothing is chosen."""


@dataclass(frozen=True)
class Blob:
    """Counted bytes, or text when `is_text`."""

    kind: ClassVar[str] = "blob"
    count_format: str
    lower: int
    upper: int
    is_text: bool
    content: str

    @property
    def python_type(self) -> str:
        """Type in Python."""
        return "str" if self.is_text else "bytes"

    @property
    def default(self) -> str:
        """An empty value."""
        return '""' if self.is_text else 'b""'

    @property
    def range_text(self) -> str:
        """Legal lengths in words."""
        shortest = f"{self.lower} .. " if self.lower else "up to "
        return f"{shortest}{self.upper} bytes"

    @property
    def count_struct(self) -> str:
        """Name of the constant for the count."""
        return struct_name(self.count_format)

    @property
    def count_size(self) -> int:
        """Bytes of the count."""
        return struct.calcsize(f"<{self.count_format}")

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count_size

    def taken(self, field: str) -> str:
        """Returns the expression that reads the bytes after the count, which is in `size`."""
        take = "take_text" if self.is_text else "take"
        return f'{take}(buffer, offset + {self.count_size}, size, {self.upper}, "{field}")'

    def sized(self, value: str, field: str) -> str:
        """Returns the expression for the checked length of a value."""
        return f'sized({value}, {self.lower}, {self.upper}, "{field}")'


def as_real(value: Fixed) -> Fixed:
    """Describes a number whose Python type is float because another choice of it is."""
    if value.python_type == "float":
        return value
    check = "whole_of" if value.check == "one_of" else "whole"
    return replace(value, python_type="float", check=check)


def number(kind: wire.Number) -> Fixed:
    """Describes a number."""
    match kind:
        case wire.Integer():
            return legal_integer(kind.type.format, kind)
        case wire.Real():
            return _real(kind)
        case wire.Scaled():
            return _scaled(kind)


def legal_integer(struct_format: str, kind: wire.Integer | wire.Bits) -> Fixed:
    """Describes an integer with the meanings of its values."""
    legal = kind.legal
    return replace(
        integer(struct_format, legal.ranges),
        listed=tuple((listed_value.name, listed_value.value) for listed_value in legal.listed),
        offset=legal.offset,
        back=f"{{}}{_plus(legal.offset)}",
        reach=kind.reach,
    )


def _plus(offset: int) -> str:
    """Returns the text that adds an offset to an integer, empty for 0."""
    return f" {'+' if offset > 0 else '-'} {abs(offset)}" if offset else ""


def integer(struct_format: str, ranges: wire.Ranges) -> Fixed:
    """Describes an integer."""
    default = 0 if any(a <= 0 <= b for a, b in ranges) else ranges[0][0]
    text = ", ".join(str(a) if a == b else f"{a} .. {b}" for a, b in ranges)
    if len(ranges) == 1:
        check, limits = "integer", tuple(map(str, ranges[0]))
    else:
        check = "one_of"
        limits = ("({})".format(", ".join(f"({a}, {b})" for a, b in ranges)),)
    return Fixed(struct_format, "int", str(default), check, limits, range_text=text, ranges=ranges)


def _real(kind: wire.Real) -> Fixed:
    lower, upper = kind.legal.lower, kind.legal.upper
    text = "" if upper == kind.type.largest else f"{lower!r} .. {upper!r}"
    limits = (python_literal(lower), python_literal(upper))
    default = python_literal(0.0 if lower <= 0.0 <= upper else lower)
    return Fixed(kind.type.format, "float", default, "real", limits, range_text=text)


def _scaled(kind: wire.Scaled) -> Fixed:
    lower, upper = kind.lower, kind.upper
    span, steps = kind.ratio
    step = f"{python_literal(span)} / 0x{steps:X}"
    # The sum and the product are the standard's own: value = lower + raw * step.
    if lower == 0.0:
        back = f"{{}} * ({step})"
    else:
        back = f"{{}} * ({step}) {'-' if lower < 0 else '+'} {python_literal(abs(lower))}"
    return Fixed(
        kind.type.format,
        "float",
        python_literal(0.0 if lower <= 0.0 <= upper else lower),
        _SCALED[kind.rounding],
        (python_literal(lower), step, f"0x{kind.type.upper:X}"),
        back,
        range_text=f"{lower:.12g} .. {upper:.12g}",
        scale=(lower, upper),
    )


def fixed_text(length: int) -> Fixed:
    """Describes a string of fixed length."""
    return Fixed(
        f"{length}s",
        "str",
        '""',
        "padded",
        (str(length),),
        reader="unpadded",
        range_text=f"up to {length} characters",
    )
