"""Codecs of fields of one struct item: numbers, scaled numbers, bit fields, fixed text."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.messages.codec import Scalar, as_number, as_object, no_words, shown
from jausml.live.messages.errors import EncodeError, did_you_mean, similar
from jausml.live.messages.legal import Ranges, integers_in_words, legal_integer, listed

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

# Part of a step by which floating point may miss an integer that was decoded before.
_SLACK = 1e-3


class Integer(Scalar):
    """An integer.

    Attributes:
        ranges: Smallest and largest legal integer of each range.
        names: Names of listed values.
        units: Unit of the value, empty without one.
        offset: What the value is more than the integer on the wire.
    """

    __slots__ = ("names", "offset", "ranges", "units")

    def __init__(
        self,
        struct_format: str,
        ranges: Ranges,
        names: Mapping[int, str] | None = None,
        units: str = "",
        offset: int = 0,
    ) -> None:
        super().__init__(struct_format)
        self.ranges = ranges
        self.names = dict(names or {})
        self.units = units
        self.offset = offset

    def from_wire(self, item: Any) -> int:
        """Returns the value of an integer on the wire."""
        value: int = item + self.offset
        return value

    def to_wire(self, value: Any) -> int:
        """Returns the wire item of an integer, or of the name of one."""
        return legal_integer(value, self.ranges, self.names) - self.offset

    def legal(self) -> str:
        """Returns the legal values with their names and unit."""
        return with_unit(integers_in_words(self.ranges, self.names), self.units)


class Real(Scalar):
    """A floating point number.

    Attributes:
        lower: Smallest legal value.
        upper: Largest legal value.
        units: Unit of the value, empty without one.
    """

    __slots__ = ("lower", "units", "upper")

    def __init__(self, struct_format: str, lower: float, upper: float, units: str = "") -> None:
        super().__init__(struct_format)
        self.lower = lower
        self.upper = upper
        self.units = units

    def to_wire(self, value: Any) -> float:
        """Returns the wire item of a real number, which is neither infinite nor no number."""
        number = as_number(value)
        if self.lower <= number <= self.upper:
            return number
        raise EncodeError(f"{shown(number)} is outside {self.lower!r} .. {self.upper!r}")

    def legal(self) -> str:
        """Returns the range with its unit."""
        return with_unit(f"{self.lower!r} .. {self.upper!r}", self.units)


class Scaled(Scalar):
    """An unsigned integer that stands for a real number (AS5684 scale_range).

    Attributes:
        lower: Value of the integer 0.
        upper: Value of the largest integer.
        step: Difference between the values of neighbouring integers.
        maximum: Largest integer.
        rounding: How a value between two integers is encoded: `round`, `floor` or `ceiling`.
        units: Unit of the value, empty without one.
    """

    __slots__ = ("lower", "maximum", "rounding", "step", "units", "upper")

    def __init__(
        self, struct_format: str, lower: float, upper: float, rounding: str, units: str = ""
    ) -> None:
        super().__init__(struct_format)
        self.lower = lower
        self.upper = upper
        self.maximum = (1 << 8 * self.minimum_size) - 1
        self.step = (upper - lower) / self.maximum
        self.rounding = rounding
        self.units = units

    def from_wire(self, item: Any) -> float:
        """Returns the value that an integer means."""
        value: float = item * self.step + self.lower
        return value

    def to_wire(self, value: Any) -> int:
        """Returns the integer of a value that lies in the range."""
        number = as_number(value)
        try:
            position = (number - self.lower) / self.step
        except OverflowError:
            position = math.inf
        # A limit that went through text or through the sum above may miss its end by a trifle.
        slack = _SLACK + self.maximum * 2.0**-50
        if not -slack <= position <= self.maximum + slack:
            raise EncodeError(f"{shown(number)} is outside {self.lower!r} .. {self.upper!r}")
        return min(max(self._rounded(position), 0), self.maximum)

    def legal(self) -> str:
        """Returns the range with its unit."""
        return with_unit(f"{self.lower!r} .. {self.upper!r}", self.units)

    def _rounded(self, position: float) -> int:
        if self.rounding == "floor":
            return math.floor(position + _SLACK)
        if self.rounding == "ceiling":
            return math.ceil(position - _SLACK)
        return round(position)


@dataclass(frozen=True)
class Bits:
    """A group of bits of a bit field.

    Attributes:
        name: Name in the definition.
        low: Lowest bit.
        mask: Its bits, shifted down.
        ranges: Smallest and largest legal integer of each range.
        names: Names of listed values.
        offset: What the value is more than the bits.
    """

    name: str
    low: int
    mask: int
    ranges: Ranges
    names: Mapping[int, str]
    offset: int = 0

    def legal(self) -> str:
        """Returns the legal values with their names; see `Codec.legal`."""
        return integers_in_words(self.ranges, self.names)


class BitField(Scalar):
    """An unsigned integer divided into groups of bits, an object of integers.

    Attributes:
        groups: The groups of bits.
    """

    __slots__ = ("_known", "groups")

    def __init__(self, struct_format: str, groups: Sequence[Bits]) -> None:
        super().__init__(struct_format)
        self.groups = tuple(groups)
        self._known = {group.name: group for group in groups}

    def from_wire(self, item: Any) -> dict[str, int]:
        """Returns the integers of the groups."""
        return {each.name: (item >> each.low & each.mask) + each.offset for each in self.groups}

    def to_wire(self, value: Any) -> int:
        """Returns the integer that the groups make."""
        fields = as_object(value)
        check_names(fields, self._known, self._known, lambda name: self._known[name].legal())
        whole = 0
        for group in self.groups:
            try:
                value = legal_integer(fields[group.name], group.ranges, group.names)
            except EncodeError as error:
                raise error.inside(group.name) from None
            whole |= value - group.offset << group.low
        return whole

    def legal(self) -> str:
        """Returns the names of the groups."""
        return f"an object of {listed([*self._known])}"


class FixedText(Scalar):
    """Text of a fixed number of bytes, padded with NUL.

    Attributes:
        length: Number of bytes.
    """

    __slots__ = ("length",)

    def __init__(self, length: int) -> None:
        super().__init__(f"{length}s")
        self.length = length

    def from_wire(self, item: Any) -> str:
        """Returns the text before the first NUL."""
        text: str = item.split(b"\0", 1)[0].decode("latin-1")
        return text

    def to_wire(self, value: Any) -> bytes:
        """Returns the padded bytes of a text."""
        text = latin1(value)
        if len(text) > self.length:
            raise EncodeError(f"{len(text)} characters do not fit {self.length} bytes")
        if b"\0" in text:
            raise EncodeError(f"{shown(value)} has a NUL, which would end it")
        return text.ljust(self.length, b"\0")

    def legal(self) -> str:
        """Returns the longest text."""
        return f"text of at most {self.length} characters"


def latin1(value: Any) -> bytes:
    """Returns a text as bytes, one for each character.

    Args:
        value: The text.

    Raises:
        EncodeError: It is no text or has characters beyond Latin-1.
    """
    if not isinstance(value, str):
        raise EncodeError(f"{shown(value)} is not a string")
    try:
        return value.encode("latin-1")
    except UnicodeEncodeError:
        raise EncodeError(f"{shown(value)} has characters beyond Latin-1") from None


def with_unit(text: str, units: str) -> str:
    """Returns a number or a range with its unit, if it has one.

    Args:
        text: The number or range.
        units: The unit as the definition says it.
    """
    return f"{text} {units}" if units and units != "one" else text


def check_names(
    fields: Mapping[str, Any],
    known: Collection[str],
    needed: Iterable[str],
    legal: Callable[[str], str] = no_words,
) -> None:
    """Refuses an object with unknown or without needed fields.

    Args:
        fields: The object.
        known: Names that may stand in it.
        needed: Names that must stand in it.
        legal: Returns what may stand in a needed field, in words.

    Raises:
        EncodeError: A field is unknown or absent.
    """
    for name in fields:
        if name not in known:
            absent = [each for each in known if each not in fields]
            hint = did_you_mean(similar(str(name), absent) or similar(str(name), known))
            if not hint and absent:
                hint = f"; it may be {listed(absent)}"
            raise EncodeError(f"unknown field{hint}", str(name))
    for name in needed:
        if name not in fields:
            words = legal(name)
            raise EncodeError(f"this field is absent{f', it takes {words}' * bool(words)}", name)
