"""Kinds of fields on the wire, one class each (SAE AS5684). All of them are frozen values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.wire.numbers import INTEGERS, IntegerType, RealType

if TYPE_CHECKING:
    from jausml.language.wire.legal import LegalIntegers, LegalReals


@dataclass(frozen=True)
class Integer:
    """An integer (AS5684 fixed_field).

    Attributes:
        type: Wire type.
        legal: Legal values.
        units: Unit, as the model says it; empty without one.
    """

    type: IntegerType
    legal: LegalIntegers
    units: str = ""

    @property
    def reach(self) -> tuple[int, int]:
        """Smallest and largest value that the wire can bring, legal or not."""
        return self.type.lower + self.legal.offset, self.type.upper + self.legal.offset

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class Real:
    """A floating point number, finite (AS5684 fixed_field).

    Attributes:
        type: Wire type.
        legal: Legal values.
        units: Unit, as the model says it; empty without one.
    """

    type: RealType
    legal: LegalReals
    units: str = ""

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class Scaled:
    """An unsigned integer that stands for a real number (AS5684 scale_range).

    The value is `lower + integer * step`.

    Attributes:
        type: Wire type.
        lower: Value of the integer 0.
        upper: Value of the largest integer.
        rounding: How a value between two integers is encoded: `round`, `floor` or `ceiling`.
        units: Unit of the value, as the model says it; empty without one.
    """

    type: IntegerType
    lower: float
    upper: float
    rounding: str
    units: str = ""

    @property
    def ratio(self) -> tuple[float, int]:
        """The step as dividend and divisor, for those who print it as a division."""
        return self.upper - self.lower, self.type.upper

    @cached_property
    def step(self) -> float:
        """Difference between the values of neighbouring integers."""
        span, steps = self.ratio
        return span / steps

    def value_of(self, integer: int) -> float:
        """Returns the value that an integer on the wire means."""
        return integer * self.step + self.lower

    def integer_of(self, value: float) -> int:
        """Returns the integer on the wire that stands for a value.

        A limit that went through text or through `value_of` may miss its end by a trifle.

        Raises:
            ValueError: The value lies outside of the limits, or is no number at all.
        """
        try:
            position = (value - self.lower) / self.step
        except OverflowError:
            position = math.inf
        slack = _SLACK + self.type.upper * 2.0**-50
        if not -slack <= position <= self.type.upper + slack:
            raise ValueError(f"the value is not within {self.lower!r} .. {self.upper!r}")
        return min(max(self._rounded(position), 0), self.type.upper)

    def _rounded(self, position: float) -> int:
        if self.rounding == "floor":
            return math.floor(position + _SLACK)
        if self.rounding == "ceiling":
            return math.ceil(position - _SLACK)
        return round(position)

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


_SLACK = 1e-3
"""Part of a step by which floating point may miss an integer that was decoded before."""

Number: TypeAlias = Integer | Real | Scaled

TIME_STAMP = (
    ("Milliseconds", 0, 9, 0, 999),
    ("Seconds", 10, 15, 0, 59),
    ("Minutes", 16, 21, 0, 59),
    ("Hour", 22, 26, 0, 23),
    ("Day", 27, 31, 1, 31),
)
"""Bits of a TimeStamp of JAUS: name, lowest and highest bit, smallest and largest value."""


@dataclass(frozen=True)
class Bits:
    """A group of bits of a bit field (AS5684 sub_field).

    Attributes:
        name: Name in the model.
        documentation: Text of the model.
        low: Lowest bit; bit 0 is the least significant.
        high: Highest bit.
        legal: Legal values.
    """

    name: str
    documentation: str
    low: int
    high: int
    legal: LegalIntegers

    @property
    def width(self) -> int:
        """Number of bits."""
        return self.high - self.low + 1

    @property
    def mask(self) -> int:
        """The bits, shifted down."""
        return (1 << self.width) - 1

    @property
    def reach(self) -> tuple[int, int]:
        """Smallest and largest value that the wire can bring, legal or not."""
        return self.legal.offset, self.mask + self.legal.offset


def _limits(bits: Bits) -> tuple[int, ...]:
    """Returns the smallest and largest value of bits; nothing when more than a range is said."""
    legal = bits.legal
    is_range = len(legal.ranges) == 1 and not legal.listed and not legal.offset
    return legal.ranges[0] if is_range else ()


@dataclass(frozen=True)
class BitField:
    """An unsigned integer divided into groups of bits (AS5684 bit_field).

    Attributes:
        type: Wire type.
        groups: The groups in the order of the definition.
    """

    type: IntegerType
    groups: tuple[Bits, ...]

    @property
    def is_time_stamp(self) -> bool:
        """Whether it is a TimeStamp (AS5710): milliseconds up to the day of the month."""
        places = sorted((each.low, each.high) for each in self.groups)
        expected = [(low, high) for _, low, high, *_ in TIME_STAMP]
        return self.type.name == "uint32" and places == expected

    @property
    def is_published_time_stamp(self) -> bool:
        """Whether it is a TimeStamp to the letter (AS5710): names, order and limits too."""
        groups = tuple((each.name, each.low, each.high, *_limits(each)) for each in self.groups)
        return self.type.name == "uint32" and groups == TIME_STAMP

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class FixedText:
    """Text in Latin-1 of a fixed number of bytes, padded with NUL (AS5684 fixed_length_string).

    Attributes:
        length: Bytes.
    """

    length: int

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.length


@dataclass(frozen=True)
class Count:
    """A count before bytes or elements (AS5684 count_field).

    Attributes:
        type: Wire type.
        lower: Fewest that are written; peers may send fewer.
        upper: Most that are written and read.
    """

    type: IntegerType
    lower: int
    upper: int


@dataclass(frozen=True)
class Text:
    """A count and that many bytes of text in Latin-1 (AS5684 variable_length_string).

    Attributes:
        count: The count.
    """

    count: Count

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count.type.size


JAUS_MESSAGE = "JAUS MESSAGE"
"""Format of bytes that are a message code and a body (AS5684)."""


@dataclass(frozen=True)
class Octets:
    """A count and that many bytes (AS5684 variable_length_field).

    Attributes:
        count: The count.
        content: Format of the bytes; `JAUS_MESSAGE` means a message code and a body.
    """

    count: Count
    content: str

    @property
    def holds_message(self) -> bool:
        """Whether the bytes are a message."""
        return self.content == JAUS_MESSAGE

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count.type.size


@dataclass(frozen=True)
class Format:
    """A format of bytes (AS5684 format_enum).

    Attributes:
        index: Its index on the wire.
        name: Its name; `JAUS_MESSAGE` means a message code and a body.
    """

    index: int
    name: str


@dataclass(frozen=True)
class FormattedOctets:
    """The index of a format (one byte), a count and that many bytes (AS5684 variable_format_field).

    Attributes:
        formats: The formats to choose from.
        count: The count.
    """

    formats: tuple[Format, ...]
    count: Count

    @property
    def names(self) -> dict[int, str]:
        """The names of the formats by index."""
        return {each.index: each.name for each in self.formats}

    def holds_message(self, index: int) -> bool:
        """Tells whether bytes of a format are a message."""
        return self.names.get(index) == JAUS_MESSAGE

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + self.count.type.size


@dataclass(frozen=True)
class Alternative:
    """A type that a variable number may take (AS5684 type_and_units_enum).

    Attributes:
        index: Its index on the wire.
        name: Name in the model.
        documentation: Text of the model.
        number: The number.
    """

    index: int
    name: str
    documentation: str
    number: Number


@dataclass(frozen=True)
class VariableNumber:
    """The index of a type (one byte) and a number of that type (AS5684 variable_field).

    Attributes:
        alternatives: The types to choose from.
    """

    alternatives: tuple[Alternative, ...]

    @property
    def by_index(self) -> dict[int, Number]:
        """The numbers by index."""
        return {each.index: each.number for each in self.alternatives}

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + min(each.number.minimum_size for each in self.alternatives)


@dataclass(frozen=True)
class Field:
    """A field in its place: a body, a member, an element or an option.

    Attributes:
        name: Name in the model: that of the outermost reference to a declared type.
        documentation: Text of the model.
        kind: What stands on the wire.
        bit: Its bit in the presence vector, e.g. 4; 0 for what is always there.
    """

    name: str
    documentation: str
    kind: Kind
    bit: int = 0

    @property
    def is_optional(self) -> bool:
        """Whether a presence vector says if it is there."""
        return self.bit != 0


@dataclass(frozen=True)
class Record:
    """Fields one after the other (AS5684 record).

    Attributes:
        members: The fields in wire order.
        presence: Wire type of the presence vector before them; None without one.
    """

    members: tuple[Field, ...]
    presence: IntegerType | None = None

    @property
    def known_bits(self) -> int:
        """The bits of the presence vector that stand for members."""
        return sum(member.bit for member in self.members)

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        always = (each.kind.minimum_size for each in self.members if not each.is_optional)
        return sum(always) + (self.presence.size if self.presence else 0)


@dataclass(frozen=True)
class Sequence(Record):
    """Containers one after the other (AS5684 sequence); on the wire a record."""


@dataclass(frozen=True)
class List:
    """A count and that many equal fields (AS5684 list).

    Attributes:
        element: The field.
        count: The count.
        stated: Smallest count that the definition states, which is not enforced.
    """

    element: Field
    count: Count
    stated: int = 0

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count.type.size


@dataclass(frozen=True)
class Array:
    """A fixed number of equal fields without a count (AS5684 array).

    Attributes:
        element: The field.
        dimensions: Size of each dimension; the first varies slowest.
    """

    element: Field
    dimensions: tuple[int, ...]

    @property
    def length(self) -> int:
        """Number of elements."""
        return math.prod(self.dimensions)

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.length * self.element.kind.minimum_size


@dataclass(frozen=True)
class Variant:
    """A tag and the option that it chooses (AS5684 variant).

    Attributes:
        tag: Wire type of the tag, the position of the option counted from 0.
        options: The fields to choose from; with none the tag 0 stands alone.
    """

    tag: IntegerType
    options: tuple[Field, ...]

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.tag.size + min((each.kind.minimum_size for each in self.options), default=0)


Scalar: TypeAlias = Number | BitField | FixedText
"""Every kind of field of a fixed size that holds no other fields: one item of a struct."""

Leaf: TypeAlias = Scalar | Text | Octets | FormattedOctets | VariableNumber
"""Every kind of field that holds no other fields."""

Kind: TypeAlias = Leaf | Record | Sequence | List | Array | Variant
"""Every kind of field. A reader that treats each of them treats every message."""

HEADER = INTEGERS["uint16"]
"""Wire type of the message code, the header of every message (AS5684, AS5669A)."""


@dataclass(frozen=True)
class Message:
    """A message.

    Attributes:
        name: Name in the model.
        code: Message code.
        is_command: Whether it is of the command class (AS5710, AccessControl).
        body: The body; None for a message of its code alone.
        documentation: Text of the model.
        service: URN of the service that defines it; empty outside of services.
    """

    name: str
    code: int
    is_command: bool
    body: Field | None
    documentation: str = ""
    service: str = ""

    @property
    def header(self) -> IntegerType:
        """Wire type of the code, which stands before the body."""
        return HEADER

    @property
    def members(self) -> tuple[Field, ...]:
        """The fields that codecs expose: those of a record or sequence, else the body itself."""
        if self.body is None:
            return ()
        return self.body.kind.members if isinstance(self.body.kind, Record) else (self.body,)
