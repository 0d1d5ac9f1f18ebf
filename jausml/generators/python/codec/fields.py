"""How values stand on the wire (SAE AS5684): what a codec says of one field of a message.

Each class describes one kind of value and answers what templates/messages.py.j2 asks: the Python
type, a default, and the expressions that turn the value into its wire form and back.
"""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from jausml.generation.literals import python_literal
from jausml.generators.python.layout import Call

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.generators.python.layout import Expression

FORMATS = {
    "uint8": "B",
    "int8": "b",
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}
_FLOAT_LIMITS = {"float32": 3.4028234663852886e38, "float64": 1.7976931348623157e308}
_SCALED = {"round": "scaled", "floor": "scaled_down", "ceiling": "scaled_up"}

Ranges = tuple[tuple[int, int], ...]


def name_of(value: Any) -> str:
    """Returns the name of an enumeration literal of a model (or of a default, a plain string)."""
    return str(getattr(value, "name", value))


def bits_of(numeric_type: str) -> int:
    """Returns the number of bits of a wire type."""
    return 8 * struct.calcsize(f"<{FORMATS[numeric_type]}")


def integer_limits(numeric_type: str) -> tuple[int, int]:
    """Returns the smallest and the largest integer of a wire type."""
    bits = bits_of(numeric_type)
    return (
        (0, 2**bits - 1)
        if numeric_type.startswith("u")
        else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    )


def length_format(numeric_type: str) -> str:
    """Returns the struct format of a count or tag.

    Raises:
        ValueError: It is not an unsigned integer.
    """
    if not numeric_type.startswith("u"):
        raise ValueError(f"{numeric_type} cannot count")
    return FORMATS[numeric_type]


_WORDS = {
    letter: name.upper().replace("UINT", "U").replace("INT", "I").replace("FLOAT", "F")
    for name, letter in FORMATS.items()
}


def struct_name(struct_format: str) -> str:
    """Returns the name of the constant for a struct, e.g. `_U16_U8X2` for `HBB`.

    Args:
        struct_format: Its format without the byte order.
    """
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
        format: Its struct format.
        python_type: Its type in Python.
        default: A legal value, as Python text.
        check: Function that checks and converts a value for the wire.
        limits: Arguments of that function between the value and the attribute name.
        back: What turns the integer on the wire (`{}`) into the value.
        reader: Function that turns the wire item into the value, instead of `back`.
        range_text: Its legal values in words.
        scale: Lower and upper limit of a scaled field.
        listed: Names and values of single legal integers, as the model has them.
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

    def pack(self, value: str, field: str) -> Call:
        """Returns the expression that makes the wire item.

        Args:
            value: The value, as Python text.
            field: Attribute that an error names.
        """
        return Call(self.check, (value, *self.limits, f'"{field}"'))

    def unpack(self, raw: str) -> Expression:
        """Returns the expression that makes the value.

        Args:
            raw: The wire item, as Python text.
        """
        return Call(self.reader, (raw,)) if self.reader else self.back.format(raw)


@dataclass(frozen=True)
class Bits(Fixed):
    """A bit field: an integer on the wire, an instance of a nested class in Python."""

    def pack(self, value: str, field: str) -> Call:
        """Returns the expression that makes the wire item."""
        del field
        return Call(f"{value}.to_integer", ())


@dataclass(frozen=True)
class Tag(Fixed):
    """A variant without options: a tag alone, which JSIDL writes where nothing is chosen."""


@dataclass(frozen=True)
class Blob:
    """Counted bytes, or text when `is_text`.

    Attributes:
        count_format: Struct format of the count.
        lower: Smallest legal length.
        upper: Largest legal length.
        is_text: Whether the value is a string.
        content: What the bytes are, in words.
    """

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

    def taken(self, field: str) -> Call:
        """Returns the expression that reads the bytes after the count, which is in `size`."""
        at = f"offset + {self.count_size}"
        limits = (str(self.upper), f'"{field}"')
        return Call("take_text" if self.is_text else "take", ("buffer", at, "size", *limits))

    def sized(self, value: str, field: str) -> Call:
        """Returns the expression for the checked length of a value."""
        return Call("sized", (value, str(self.lower), str(self.upper), f'"{field}"'))


def value_ranges(value_set: Any, lower: int, upper: int) -> Ranges:
    """Returns the legal integers of a value set.

    Args:
        value_set: The ValueSet, or None.
        lower: Smallest integer of the type.
        upper: Largest integer of the type.
    """
    found = []
    for value in value_set.values if value_set is not None else ():
        if value.eClass.name == "EnumeratedValue":
            found.append((int(value.value), int(value.value)))
        else:
            first = math.ceil(value.lower) if value.lowerInclusive else math.floor(value.lower) + 1
            last = math.floor(value.upper) if value.upperInclusive else math.ceil(value.upper) - 1
            found.append((first, last))
    legal = merge((max(first, lower), min(last, upper)) for first, last in found)
    return legal or ((lower, upper),)


def listed_values(value_set: Any) -> tuple[tuple[str, int], ...]:
    """Returns names and values of the single integers of a value set.

    Args:
        value_set: The ValueSet, or None.
    """
    return tuple(
        (str(value.name), int(value.value))
        for value in (value_set.values if value_set is not None else ())
        if value.eClass.name == "EnumeratedValue"
    )


def merge(ranges: Iterable[tuple[int, int]]) -> Ranges:
    """Returns as few ranges as hold the same integers.

    Args:
        ranges: Smallest and largest integer of each; one with none in it is left out.
    """
    merged: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if first > last:
            continue
        if merged and first <= merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], max(last, merged[-1][1]))
        else:
            merged.append((first, last))
    return tuple(merged)


def as_real(value: Fixed) -> Fixed:
    """Describes a number whose Python type is float because another choice of it is.

    Args:
        value: The number.
    """
    if value.python_type == "float":
        return value
    check = "whole_of" if value.check == "one_of" else "whole"
    return replace(value, python_type="float", check=check)


def count_limits(count_type: str, lower: int, upper: int) -> tuple[int, int]:
    """Returns the smallest and the largest legal count.

    Args:
        count_type: Wire type of the count.
        lower: Smallest count.
        upper: Largest count; 0 means as many as the type can say.
    """
    largest = integer_limits(count_type)[1]
    return lower, min(upper, largest) if upper > 0 else largest


def size_of(struct_format: str) -> int:
    """Returns the bytes of a struct format."""
    return struct.calcsize(f"<{struct_format}")


def number(numeric_type: str, scale: Any, value_set: Any) -> Fixed:
    """Describes a number.

    Args:
        numeric_type: Its wire type.
        scale: Its ScaleRange, or None.
        value_set: Its ValueSet, or None.
    """
    if numeric_type in _FLOAT_LIMITS:
        return _real(numeric_type, value_set)
    if scale is not None:
        return _scaled(numeric_type, scale)
    ranges = value_ranges(value_set, *integer_limits(numeric_type))
    return replace(integer(FORMATS[numeric_type], ranges), listed=listed_values(value_set))


def integer(struct_format: str, ranges: Ranges) -> Fixed:
    """Describes an integer.

    Args:
        struct_format: Its struct format.
        ranges: Its legal values.
    """
    default = 0 if any(a <= 0 <= b for a, b in ranges) else ranges[0][0]
    text = ", ".join(str(a) if a == b else f"{a} .. {b}" for a, b in ranges)
    if len(ranges) == 1:
        limits: tuple[str, ...] = (str(ranges[0][0]), str(ranges[0][1]))
        return Fixed(struct_format, "int", str(default), "integer", limits, range_text=text)
    pairs = "({})".format(", ".join(f"({a}, {b})" for a, b in ranges))
    return Fixed(struct_format, "int", str(default), "one_of", (pairs,), range_text=text)


def _real(numeric_type: str, value_set: Any) -> Fixed:
    limit = _FLOAT_LIMITS[numeric_type]
    lower, upper = -limit, limit
    values = list(value_set.values) if value_set is not None else []
    # A set of single reals has no use; of ranges the outer limits are kept.
    if values and all(value.eClass.name == "ValueRange" for value in values):
        starts = [_end(numeric_type, v.lower, inclusive=v.lowerInclusive, up=True) for v in values]
        ends = [_end(numeric_type, v.upper, inclusive=v.upperInclusive, up=False) for v in values]
        lower, upper = max(lower, min(starts)), min(upper, max(ends))
    text = "" if upper == limit else f"{lower!r} .. {upper!r}"
    limits = (python_literal(lower), python_literal(upper))
    default = python_literal(0.0 if lower <= 0.0 <= upper else lower)
    return Fixed(FORMATS[numeric_type], "float", default, "real", limits, range_text=text)


def _end(numeric_type: str, limit: float, *, inclusive: bool, up: bool) -> float:
    """Returns the last legal number at an end of a range.

    Args:
        numeric_type: Wire type, whose precision counts.
        limit: The limit that the model states.
        inclusive: Whether the limit itself is legal.
        up: Whether legal numbers lie above the limit.
    """
    if numeric_type == "float64" or abs(limit) > _FLOAT_LIMITS[numeric_type]:
        return limit if inclusive else math.nextafter(limit, math.inf if up else -math.inf)
    single: float = struct.unpack("<f", struct.pack("<f", limit))[0]
    # A limit that is not a single is met by the single next to it.
    if inclusive:
        return min(single, limit) if up else max(single, limit)
    beyond = single > limit if up else single < limit
    return single if beyond else _next_single(single, up=up)


def _next_single(value: float, *, up: bool) -> float:
    """Returns the single precision number above or below another."""
    if value == 0.0:
        return 2.0**-149 if up else -(2.0**-149)
    bits: int = struct.unpack("<I", struct.pack("<f", value))[0]
    step = 1 if up == (value > 0) else -1
    following: float = struct.unpack("<f", struct.pack("<I", bits + step))[0]
    return following


def _scaled(numeric_type: str, scale: Any) -> Fixed:
    lower, upper = float(scale.lower), float(scale.upper)
    if not lower < upper or not numeric_type.startswith("u"):
        raise ValueError(f"scale {lower} .. {upper} of {numeric_type} has no meaning in AS5684")
    maximum = f"0x{integer_limits(numeric_type)[1]:X}"
    step = f"{python_literal(upper - lower)} / {maximum}"
    # The sum and the product are the standard's own: value = lower + raw * step.
    if lower == 0.0:
        back = f"{{}} * ({step})"
    else:
        back = f"{{}} * ({step}) {'-' if lower < 0 else '+'} {python_literal(abs(lower))}"
    return Fixed(
        FORMATS[numeric_type],
        "float",
        python_literal(0.0 if lower <= 0.0 <= upper else lower),
        _SCALED[name_of(scale.rounding)],
        (python_literal(lower), step, maximum),
        back,
        range_text=f"{lower:.12g} .. {upper:.12g}",
        scale=(lower, upper),
    )


def fixed_text(length: int) -> Fixed:
    """Describes a string of fixed length.

    Args:
        length: Its bytes.
    """
    return Fixed(
        f"{length}s",
        "str",
        '""',
        "padded",
        (str(length),),
        reader="unpadded",
        range_text=f"up to {length} characters",
    )
