"""Fields of a fixed size: items of a struct, and what they mean (SAE AS5684)."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from jausml.language import wire
from jausml.live.messages.errors import CodecError, DecodeError, DefinitionError, EncodeError
from jausml.live.messages.values import (
    NamedValue,
    as_number,
    as_object,
    check_names,
    integers_in_words,
    latin1,
    legal_integer,
    named_values,
    number_of,
    shown,
)


class Item(NamedTuple):
    """An item of a struct.

    Attributes:
        format: The struct format without the byte order.
        from_wire: Returns the value that an item means; None where the item is the value.
        to_wire: Returns the item of a value, or raises EncodeError for one that is not legal.
    """

    format: str
    size: int
    from_wire: Callable[[Any], Any] | None
    to_wire: Callable[[Any], Any]


class Codec(NamedTuple):
    """Reader and writer of a field.

    Attributes:
        read: Returns the value at an offset of the whole payload, and the offset after it; raises
            DecodeError for bytes that are no such field.
        write: Appends a value in its JSON shape to the bytes written so far; raises EncodeError for
            one that has no place on the wire.
    """

    read: Callable[[bytes, int], tuple[Any, int]]
    write: Callable[[Any, bytearray], None]


def item_of(kind: wire.Scalar) -> Item:
    """Returns how a field becomes an item of a struct, and back."""
    match kind:
        case wire.Integer():
            return _integer(kind)
        case wire.Real():
            return _real(kind)
        case wire.Scaled():
            return _scaled(kind)
        case wire.BitField():
            return _bit_field(kind)
        case wire.FixedText():
            return _fixed_text(kind)


def unsigned(number: wire.IntegerType) -> Item:
    """Returns the item of a tag or presence vector."""
    return _integer(wire.Integer(number, wire.LegalIntegers(((number.lower, number.upper),))))


def _integer(kind: wire.Integer) -> Item:
    ranges, names, offset = kind.legal.ranges, kind.legal.names, kind.legal.offset

    named = named_values(names)

    def from_wire(item: int) -> int | NamedValue:
        return named.get(item + offset, item + offset)

    def to_wire(value: Any) -> int:
        return legal_integer(value, ranges, names, kind.units) - offset

    is_plain = not (offset or named)
    return Item(kind.type.format, kind.type.size, None if is_plain else from_wire, to_wire)


def _real(kind: wire.Real) -> Item:
    lower, upper = kind.legal.lower, kind.legal.upper

    def to_wire(value: Any) -> float:
        number = as_number(number_of(value, kind.units))
        if lower <= number <= upper:
            return number
        raise EncodeError(f"{shown(number)} is outside {lower!r} .. {upper!r}")

    return Item(kind.type.format, kind.type.size, None, to_wire)


def _scaled(kind: wire.Scaled) -> Item:
    def to_wire(value: Any) -> int:
        number = as_number(number_of(value, kind.units))
        try:
            return kind.integer_of(number)
        except ValueError:
            limits = f"{kind.lower!r} .. {kind.upper!r}"
            raise EncodeError(f"{shown(number)} is outside {limits}") from None

    return Item(kind.type.format, kind.type.size, kind.value_of, to_wire)


def _bit_field(kind: wire.BitField) -> Item:
    check_distinct(group.name for group in kind.groups)
    groups = {group.name: group for group in kind.groups}
    named = {group.name: named_values(group.legal.names) for group in kind.groups}

    def in_words(name: str) -> str:
        return integers_in_words(groups[name].legal.ranges, groups[name].legal.names)

    def from_wire(item: int) -> dict[str, int | NamedValue]:
        values: dict[str, int | NamedValue] = {}
        for name, group in groups.items():
            number = (item >> group.low & group.mask) + group.legal.offset
            values[name] = named[name].get(number, number)
        return values

    def to_wire(value: Any) -> int:
        fields = as_object(value)
        check_names(fields, groups, groups, in_words)
        whole = 0
        for name, group in groups.items():
            try:
                number = legal_integer(fields[name], group.legal.ranges, group.legal.names)
            except EncodeError as error:
                raise error.inside(name) from None
            whole |= number - group.legal.offset << group.low
        return whole

    return Item(kind.type.format, kind.type.size, from_wire, to_wire)


def _fixed_text(kind: wire.FixedText) -> Item:
    length = kind.length

    def from_wire(item: bytes) -> str:
        return item.split(b"\0", 1)[0].decode("latin-1")

    def to_wire(value: Any) -> bytes:
        text = latin1(value)
        if len(text) > length:
            raise EncodeError(f"{len(text)} characters do not fit {length} bytes")
        if b"\0" in text:
            raise EncodeError(f"{shown(value)} has a NUL, which would end it")
        return text.ljust(length, b"\0")

    return Item(f"{length}s", length, from_wire, to_wire)


def too_short(size: int, buffer: bytes, offset: int) -> DecodeError:
    """Returns the error of a payload that ends within a field of some bytes."""
    left = max(len(buffer) - offset, 0)
    return DecodeError(f"{size} byte{'s' * (size != 1)} wanted at offset {offset}, {left} left")


def single(item: Item) -> Codec:
    """Returns the codec of an item by itself."""
    alone = struct.Struct(f"<{item.format}")
    size, from_wire, to_wire = item.size, item.from_wire, item.to_wire

    def read(buffer: bytes, offset: int) -> tuple[Any, int]:
        try:
            (value,) = alone.unpack_from(buffer, offset)
        except struct.error:
            raise too_short(size, buffer, offset) from None
        return value if from_wire is None else from_wire(value), offset + size

    def write(value: Any, out: bytearray) -> None:
        out += alone.pack(to_wire(value))

    return Codec(read, write)


class Run:
    """Neighbouring items, which share a struct."""

    __slots__ = ("_items", "_struct")

    def __init__(self, items: Sequence[tuple[str, Item]]) -> None:
        """Joins items, each with the name of its field."""
        self._items = tuple(items)
        self._struct = struct.Struct("<" + "".join(item.format for _, item in items))

    def read(self, fields: dict[str, Any], buffer: bytes, offset: int) -> int:
        """Puts the values into the fields and returns the offset after them."""
        try:
            values = self._struct.unpack_from(buffer, offset)
        except struct.error:
            raise self._too_short(buffer, offset) from None
        for (name, item), value in zip(self._items, values, strict=True):
            fields[name] = value if item.from_wire is None else item.from_wire(value)
        return offset + self._struct.size

    def write(self, fields: Mapping[str, Any], out: bytearray) -> None:
        """Appends the values of the fields."""
        name = ""
        values = []
        try:
            for name, item in self._items:
                values.append(item.to_wire(fields[name]))
        except EncodeError as error:
            raise error.inside(name) from None
        out += self._struct.pack(*values)

    def _too_short(self, buffer: bytes, offset: int) -> DecodeError:
        for name, item in self._items:
            if offset + item.size > len(buffer):
                return too_short(item.size, buffer, offset).inside(name)
            offset += item.size
        raise AssertionError("a run that fits was said to be too short")


class Named:
    """A codec and the name of its field, which errors tell."""

    __slots__ = ("_codec", "_name")

    def __init__(self, name: str, codec: Codec) -> None:
        self._name = name
        self._codec = codec

    def read(self, fields: dict[str, Any], buffer: bytes, offset: int) -> int:
        """Puts the value into the fields and returns the offset after it."""
        try:
            fields[self._name], offset = self._codec.read(buffer, offset)
        except CodecError as error:
            raise error.inside(self._name) from None
        return offset

    def write(self, fields: Mapping[str, Any], out: bytearray) -> None:
        """Appends the value of the field."""
        try:
            self._codec.write(fields[self._name], out)
        except CodecError as error:
            raise error.inside(self._name) from None


def check_distinct(names: Iterable[str], reserved: str = "") -> None:
    """Refuses names of which one stands twice or is reserved."""
    seen = {reserved}
    for name in names:
        if name in seen:
            raise DefinitionError(f"the name '{name}' is taken twice")
        seen.add(name)
