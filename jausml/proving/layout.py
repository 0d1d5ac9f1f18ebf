"""Where the numbers of a message stand in its bytes: of JAUS (AS5684) and of ROS (XCDR version 1).

One walk does both: it reads a message, or writes one of usual values where there is none yet.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from datetime import datetime, timezone

from jausml.language import wire
from jausml.language.cdr import FieldLayout, fields_of
from jausml.language.metamodel.classes import ros

NOW = datetime(2024, 2, 29, 13, 59, 58, 987_000, tzinfo=timezone.utc)
"""The time that translations are told, in which the time stamps of usual messages lie."""

JAUS, ROS = "JAUS", "ROS"
"""The sides of a map."""

UNSIGNED, SIGNED, FLOAT = "unsigned", "signed", "float"

_STAMP = {
    "Milliseconds": NOW.microsecond // 1000,
    "Seconds": NOW.second,
    "Minutes": NOW.minute,
    "Hour": NOW.hour,
    "Day": NOW.day,
}
SHARES = (0.6, 0.5, 0.25, 0.1, 0.9, 0.0)
"""Where between its limits the usual value of a number may lie: best at no zero and no extreme."""

_SPAN = 20  # of how many integers the usual one is taken

_REAL = 1.25
_ENCAPSULATION = b"\0\1\0\0"


@dataclass(frozen=True)
class Usual:
    """Which values are usual.

    Attributes:
        share: Where between its limits that of a number lies.
        option: Which option of variants, and of numbers of several types, is chosen.
        count: How many elements lists have.
    """

    share: float = SHARES[0]
    option: int = 0
    count: int = 1

    def one_of(self, count: int) -> int:
        """Returns the number of the chosen one of some options."""
        return min(self.option, count - 1)


USUAL = Usual()


class LayoutError(ValueError):
    """A message with an unknown layout of its numbers."""


@dataclass(frozen=True)
class Number:
    """A number in the bytes of a message.

    Attributes:
        size: Bytes of the integer that it is, or is a part of.
        shift: Its lowest bit in that integer.
        lower: Value of the integer 0.
    """

    path: str
    at: int
    size: int
    kind: str
    bits: int
    shift: int = 0
    lower: float = 0.0
    step: float = 1.0
    units: str = ""

    @property
    def _sign(self) -> int:
        return 1 << (self.bits - 1)

    @property
    def _code(self) -> str:
        return "<f" if self.size == 4 else "<d"

    @property
    def is_scaled(self) -> bool:
        """Whether its integers stand for real numbers."""
        return self.kind != FLOAT and self.step != 1.0

    @property
    def ends(self) -> tuple[float, float]:
        """Its least and its greatest finite value."""
        if self.kind == FLOAT:
            most = wire.REALS["float32" if self.size == 4 else "float64"].largest
            return -most, most
        return self.value(self.raw(0)), self.value(self.raw(2 * self._sign - 1))

    def raw(self, index: int) -> int:
        """Returns the bits of the value at a position in the order of values."""
        if self.kind == UNSIGNED:
            return index
        # With its sign bit turned, two's complement is in the order of values.
        if self.kind == SIGNED or index & self._sign:
            return index ^ self._sign
        # The bits of negative floats run against their values.
        return ~index & (2 * self._sign - 1)

    def index(self, raw: int) -> int:
        """Returns the position of bits in the order of values."""
        if self.kind == UNSIGNED:
            return raw
        if self.kind == SIGNED or not raw & self._sign:
            return raw ^ self._sign
        return ~raw & (2 * self._sign - 1)

    def value(self, raw: int) -> float:
        """Returns the value that bits mean."""
        if self.kind == FLOAT:
            return float(struct.unpack(self._code, raw.to_bytes(self.size, "little"))[0])
        is_negative = self.kind == SIGNED and raw & self._sign
        return (raw - 2 * self._sign if is_negative else raw) * self.step + self.lower

    def bits_of(self, value: float) -> int:
        """Returns the bits of a number of floating point."""
        return int.from_bytes(struct.pack(self._code, value), "little")

    def read(self, data: bytes) -> int:
        """Returns its bits in a message."""
        whole = int.from_bytes(data[self.at : self.at + self.size], "little")
        return whole >> self.shift & (2 * self._sign - 1)

    def put(self, data: bytes, raw: int) -> bytes:
        """Returns a message with other bits in its place."""
        whole = int.from_bytes(data[self.at : self.at + self.size], "little")
        mask = (2 * self._sign - 1) << self.shift
        changed = (whole & ~mask | raw << self.shift).to_bytes(self.size, "little")
        return data[: self.at] + changed + data[self.at + self.size :]


@dataclass
class Layout:
    """A message and its numbers, in the order of its bytes."""

    data: bytes
    numbers: list[Number] = field(default_factory=list)


def jaus_layout(message: wire.Message, data: bytes | None = None, usual: Usual = USUAL) -> Layout:
    """Returns a JAUS message, of usual values where none is given."""
    walk = _JausWalk(data, usual)
    walk.number("<H", message.code)
    if message.body is not None:
        is_flat = isinstance(message.body.kind, wire.Record)
        walk.field(message.body.kind, "" if is_flat else message.body.name)
    return walk.layout()


def ros_layout(type_: ros.MessageType, data: bytes | None = None, usual: Usual = USUAL) -> Layout:
    """Returns a message of ROS, of usual values where none is given."""
    walk = _RosWalk(data, usual)
    walk.message(type_, "")
    return walk.layout()


class _Walk:
    """Goes through bytes from front to back, or makes them."""

    def __init__(self, data: bytes | None, usual: Usual) -> None:
        self._read_data = data
        self.usual = usual
        self._data = bytearray(data or b"")
        self._at = 0
        self.numbers: list[Number] = []

    def layout(self) -> Layout:
        """Returns the layout of the message."""
        if self._at != len(self._data):
            raise LayoutError("there are bytes behind the message")
        return Layout(bytes(self._data), self.numbers)

    def number(self, code: str, usual: float) -> float:
        """Reads a number, or writes the usual one."""
        try:
            if self._read_data is None:
                self._data += struct.pack(code, usual)
            value: float = struct.unpack_from(code, self._data, self._at)[0]
        except struct.error as error:
            raise LayoutError(str(error)) from error
        self._at += struct.calcsize(code)
        return value

    def octets(self, count: int, usual: bytes) -> None:
        """Takes some bytes."""
        if self._read_data is None:
            self._data += usual[:count].ljust(count, usual[:1] or b"\0")
        self._at += count

    def note(self, path: str, size: int, kind: str, **more: float | str) -> None:
        """Notes the number that was taken last."""
        facts = {"bits": 8 * size, **more}
        self.numbers.append(Number(path, self._at - size, size, kind, **facts))  # type: ignore[arg-type]


class _JausWalk(_Walk):
    def field(self, kind: wire.Kind, path: str) -> None:  # noqa: C901 - a branch for each kind
        match kind:
            case wire.Record():
                known = self._presence(kind)
                for member in kind.members:
                    if not member.is_optional or member.bit & known:
                        self.field(member.kind, _joined(path, member.name))
            case wire.List():
                for at in range(self._count(kind.count, self.usual.count)):
                    self.field(kind.element.kind, f"{path}[{at}]")
            case wire.Array():
                for at in range(kind.length):
                    self.field(kind.element.kind, f"{path}[{at}]")
            case wire.Variant():
                usual = self.usual.one_of(len(kind.options))
                tag = int(self.number(f"<{kind.tag.format}", max(0, usual)))
                if tag < len(kind.options):
                    option = kind.options[tag]
                    self.field(option.kind, _joined(path, option.name))
            case wire.BitField():
                self._bits(kind, path)
            case wire.VariableNumber():
                usual = self.usual.one_of(len(kind.alternatives))
                index = int(self.number("<B", kind.alternatives[usual].index))
                choice = next(
                    (
                        alternative
                        for alternative in kind.alternatives
                        if alternative.index == index
                    ),
                    None,
                )
                if choice is not None:
                    self.field(choice.number, _joined(path, choice.name))
            case wire.FixedText():
                self.octets(kind.length, b"")
            case wire.FormattedOctets():
                self.number("<B", kind.formats[0].index)
                self.octets(self._count(kind.count), b"a")
            case wire.Text() | wire.Octets():
                self.octets(self._count(kind.count), b"a")
            case _:
                self._scalar(kind, path)

    def _presence(self, kind: wire.Record) -> int:
        if kind.presence is None:
            return 0
        return int(self.number(f"<{kind.presence.format}", kind.known_bits))

    def _count(self, count: wire.Count, usual: int = 1) -> int:
        return int(self.number(f"<{count.type.format}", max(count.lower, min(usual, count.upper))))

    def _bits(self, kind: wire.BitField, path: str) -> None:
        usual = 0
        for group in kind.groups:
            value = (
                _STAMP[group.name] if kind.is_published_time_stamp else self._integer(group.legal)
            )
            usual |= (value - group.legal.offset & group.mask) << group.low
        self.number(f"<{kind.type.format}", usual)
        for group in kind.groups:
            facts = {"bits": group.width, "shift": group.low, "lower": float(group.legal.offset)}
            self.note(_joined(path, group.name), kind.type.size, UNSIGNED, **facts)

    def _scalar(self, kind: wire.Number, path: str) -> None:
        code = f"<{kind.type.format}"
        match kind:
            case wire.Scaled():
                self.number(code, round(self.usual.share * kind.type.upper))
                facts = {"lower": kind.lower, "step": kind.step}
                self.note(path, kind.type.size, UNSIGNED, units=kind.units, **facts)
            case wire.Real():
                self.number(
                    code, min(max(_REAL * self.usual.share, kind.legal.lower), kind.legal.upper)
                )
                self.note(path, kind.type.size, FLOAT, units=kind.units)
            case wire.Integer():
                self.number(code, self._integer(kind.legal) - kind.legal.offset)
                sign = UNSIGNED if kind.type.is_unsigned else SIGNED
                lower = float(kind.legal.offset)
                self.note(path, kind.type.size, sign, units=kind.units, lower=lower)

    def _integer(self, legal: wire.LegalIntegers) -> int:
        """The usual integer: one with a meaning, or one near zero that is not zero."""
        if legal.listed:
            return legal.listed[round(self.usual.share * (len(legal.listed) - 1))].value
        low, high = next(
            (interval for interval in legal.ranges if interval[1] > 0), legal.ranges[0]
        )
        low = max(low, min(0, high))
        return low + round(self.usual.share * min(high - low, _SPAN))


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


class _RosWalk(_Walk):
    def __init__(self, data: bytes | None, usual: Usual) -> None:
        super().__init__(data, usual)
        self.octets(len(_ENCAPSULATION), _ENCAPSULATION)

    def message(self, type_: ros.MessageType, path: str) -> None:
        fields = fields_of(type_)
        for layout in fields:
            name = _joined(path, layout.name)
            if layout.is_single:
                self._one(layout, name)
            else:
                count = (
                    layout.count if layout.is_fixed else int(self._aligned("<I", self.usual.count))
                )
                for at in range(count):
                    self._one(layout, f"{name}[{at}]")
        if not fields:
            self.number("<B", 0)

    def _one(self, layout: FieldLayout, path: str) -> None:
        if layout.message is not None:
            self.message(layout.message, path)
        elif layout.primitive is None:
            if layout.text != "string":
                raise LayoutError("texts of wide characters")
            self.octets(int(self._aligned("<I", 1)), b"\0")
        else:
            self._primitive(layout.primitive.code, path)

    def _primitive(self, code: str, path: str) -> None:
        is_real = code in "fd"
        usual = _REAL * self.usual.share if is_real else 1
        # A time stamp of JAUS has no month, so only a time near the present comes back.
        if path.endswith("stamp.sec"):
            usual = int(NOW.timestamp())
        self._aligned(f"<{code}", usual)
        kind = FLOAT if is_real else UNSIGNED if code in "?BHIQ" else SIGNED
        bits = {"bits": 1} if code == "?" else {}
        self.note(path, struct.calcsize(f"<{code}"), kind, **bits)

    def _aligned(self, code: str, usual: float) -> float:
        # Numbers are aligned to their size, counted from behind the encapsulation.
        padding = (len(_ENCAPSULATION) - self._at) % struct.calcsize(code)
        self.octets(padding, b"\0")
        return self.number(code, usual)
