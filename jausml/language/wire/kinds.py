"""Kinds of fields on the wire, one class each (SAE AS5684). All of them are frozen values."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import TypeAlias

from jausml.language.wire.numbers import INTEGERS, IntegerType, LegalIntegers, Number

PRESENCE_VECTOR = "PresenceVector"
"""Field of a query that names the optional fields which its report shall hold (AS6009)."""

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
        low: Lowest bit; bit 0 is the least significant.
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
    """An unsigned integer divided into groups of bits (AS5684 bit_field)."""

    type: IntegerType
    groups: tuple[Bits, ...]

    @property
    def is_time_stamp(self) -> bool:
        """Whether it is a TimeStamp (AS5710): milliseconds up to the day of the month."""
        places = sorted((group.low, group.high) for group in self.groups)
        expected = [(low, high) for _, low, high, *_ in TIME_STAMP]
        return self.type.name == "uint32" and places == expected

    @property
    def is_published_time_stamp(self) -> bool:
        """Whether it is a TimeStamp to the letter (AS5710): names, order and limits too."""
        groups = tuple(
            (group.name, group.low, group.high, *_limits(group)) for group in self.groups
        )
        return self.type.name == "uint32" and groups == TIME_STAMP

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.type.size


@dataclass(frozen=True)
class FixedText:
    """Text in Latin-1 of a fixed number of bytes, padded with NUL (AS5684 fixed_length_string)."""

    length: int

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.length


@dataclass(frozen=True)
class Count:
    """A count before bytes or elements (AS5684 count_field).

    Attributes:
        lower: Fewest that are written; peers may send fewer.
        upper: Most that are written and read.
    """

    type: IntegerType
    lower: int
    upper: int


@dataclass(frozen=True)
class Text:
    """A count and that many bytes of text in Latin-1 (AS5684 variable_length_string)."""

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
    """A format of bytes (AS5684 format_enum)."""

    index: int
    name: str


@dataclass(frozen=True)
class FormattedOctets:
    """A format (one byte), a count and that many bytes (AS5684 variable_format_field)."""

    formats: tuple[Format, ...]
    count: Count

    @property
    def names(self) -> dict[int, str]:
        """The names of the formats by index."""
        return {data_format.index: data_format.name for data_format in self.formats}

    def holds_message(self, index: int) -> bool:
        """Tells whether bytes of a format are a message."""
        return self.names.get(index) == JAUS_MESSAGE

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + self.count.type.size


@dataclass(frozen=True)
class Alternative:
    """A type that a variable number may take (AS5684 type_and_units_enum)."""

    index: int
    name: str
    documentation: str
    number: Number


@dataclass(frozen=True)
class VariableNumber:
    """The index of a type (one byte) and a number of that type (AS5684 variable_field)."""

    alternatives: tuple[Alternative, ...]

    @property
    def by_index(self) -> dict[int, Number]:
        """The numbers by index."""
        return {alternative.index: alternative.number for alternative in self.alternatives}

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + min(alternative.number.minimum_size for alternative in self.alternatives)


@dataclass(frozen=True)
class Field:
    """A field in its place: a body, a member, an element or an option.

    Attributes:
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
        presence: Wire type of the presence vector before them; None without one.
    """

    members: tuple[Field, ...]
    presence: IntegerType | None = None

    @property
    def known_bits(self) -> int:
        """The bits of the presence vector that stand for members.

        Of a published vector that is too short, members behind it have none, and cannot be sent.
        """
        bits = sum(member.bit for member in self.members)
        return bits & (self.presence.upper if self.presence else 0)

    @property
    def minimum_size(self) -> int:
        """Fewest bytes on the wire."""
        always = (member.kind.minimum_size for member in self.members if not member.is_optional)
        return sum(always) + (self.presence.size if self.presence else 0)


@dataclass(frozen=True)
class Sequence(Record):
    """Containers one after the other (AS5684 sequence); on the wire a record."""


@dataclass(frozen=True)
class List:
    """A count and that many equal fields (AS5684 list).

    Attributes:
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
        return self.tag.size + min((option.kind.minimum_size for option in self.options), default=0)


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


def comparable(layout: object, leaving_out: Collection[str]) -> object:
    """Returns a value that is equal for layouts which differ in nothing that matters.

    Args:
        leaving_out: Attributes of layouts that do not matter, e.g. `documentation`.
    """
    if isinstance(layout, tuple):
        return tuple(comparable(part, leaving_out) for part in layout)
    names = getattr(layout, "__dataclass_fields__", ())  # many: `fields` takes five times as long
    if not names:
        return layout
    values = (
        comparable(getattr(layout, name), leaving_out) for name in names if name not in leaving_out
    )
    return (type(layout).__name__, *values)
