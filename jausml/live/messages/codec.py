"""The interpreting codec: two functions that read and write a field of any kind (SAE AS5684).

Decoding is as lenient as the layout allows: an integer that a value set does not list and a byte
string that is too short are carried on, because peers send them. Encoding is strict, but for lists
that are too short. The fields have the shapes of JSON: objects, lists, numbers, strings.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from jausml.language import wire
from jausml.live.messages.counted import (
    EncodeMessage,
    count_of,
    formatted_of,
    octets_of,
    text_of,
    variable_of,
)
from jausml.live.messages.errors import DecodeError, DefinitionError, EncodeError
from jausml.live.messages.items import (
    Codec,
    Item,
    Named,
    Run,
    check_distinct,
    item_of,
    single,
    too_short,
    unsigned,
)
from jausml.live.messages.values import (
    as_list,
    as_object,
    check_names,
    in_words,
    legal_integer,
    options_in_words,
    shown,
)

PRESENCE = "_pv"
"""Name under which a presence vector stands among the members."""

TAG = "_tag"
"""Name under which the tag of a variant stands beside its option."""


def codec_of(kind: wire.Kind, encode_message: EncodeMessage) -> Codec:
    """Returns reader and writer of a kind of field."""
    match kind:
        case wire.Record():
            record = _Record(kind, encode_message)
            return Codec(record.read, record.write)
        case wire.List():
            return _list(kind, encode_message)
        case wire.Array():
            return _array(kind, encode_message)
        case wire.Variant():
            variant = _Variant(kind, encode_message)
            return Codec(variant.read, variant.write)
        case wire.Text():
            return text_of(kind)
        case wire.Octets():
            return octets_of(kind, encode_message)
        case wire.FormattedOctets():
            return formatted_of(kind, encode_message)
        case wire.VariableNumber():
            return variable_of(kind)
        case _:
            return single(item_of(kind))


def may_hold_message(kind: wire.Kind) -> bool:
    """Tells whether a field can hold a message, which `codec_of` then encodes."""
    match kind:
        case wire.Record():
            return any(may_hold_message(member.kind) for member in kind.members)
        case wire.List() | wire.Array():
            return may_hold_message(kind.element.kind)
        case wire.Variant():
            return any(may_hold_message(option.kind) for option in kind.options)
        case wire.FormattedOctets():
            return any(map(kind.holds_message, kind.names))
        case wire.Octets():
            return kind.holds_message
        case _:
            return False


# -- records ---------------------------------------------------------------------------------------


class _Record:
    """Reads and writes a record or sequence: an object of its members, with `_pv` for a vector."""

    def __init__(self, kind: wire.Record, encode_message: EncodeMessage) -> None:
        check_distinct((member.name for member in kind.members), PRESENCE)
        self._kind = kind
        self._parts = {member.name: _inner(member, encode_message) for member in kind.members}
        self._needed = [member.name for member in kind.members if not member.is_optional]
        self._presence = _presence(kind, kind.presence) if kind.presence is not None else None
        vector = [] if kind.presence is None else [PRESENCE]
        self._known = dict.fromkeys([*self._parts, *vector])
        self._segments = _segments(kind, self._parts)

    def read(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        fields: dict[str, Any] = {}
        vector = 0
        if self._presence is not None:
            offset = self._presence.read(fields, buffer, offset)
            vector = fields[PRESENCE]
        for bit, segment in self._segments:
            if not bit or vector & bit:
                offset = segment.read(fields, buffer, offset)
        return fields, offset

    def write(self, value: Any, out: bytearray) -> None:
        fields = as_object(value)
        try:
            check_names(fields, self._known, self._needed, self._legal)
            vector = 0
            if self._presence is not None:
                vector = _vector_of(fields, self._kind)
                self._presence.write({PRESENCE: vector}, out)
            for bit, segment in self._segments:
                if not bit or vector & bit:
                    segment.write(fields, out)
        except EncodeError as error:
            raise error.beside(self._faults(fields, error.path)) from None

    def _faults(self, fields: Mapping[str, Any], path: str) -> Iterator[EncodeError]:
        """Yields the faults of the members, but for the one that was raised."""
        for name, part in self._parts.items():
            # A name may hold dots and brackets itself.
            is_raised = path == name or path.startswith((f"{name}.", f"{name}["))
            if name not in fields or is_raised:
                continue
            try:
                Named(name, _alone(part)).write(fields, bytearray())
            except EncodeError as error:
                yield error

    def _legal(self, name: str) -> str:
        return next(in_words(member.kind) for member in self._kind.members if member.name == name)


def _presence(kind: wire.Record, vector_type: wire.IntegerType) -> Named:
    """Returns the codec of a presence vector as a member, which writes those of `_vector_of`."""
    known_bits = kind.known_bits

    def from_wire(vector: int) -> int:
        if unknown := vector & ~known_bits:
            raise DecodeError(f"bits 0x{unknown:X} stand for no member")
        return vector

    item = unsigned(vector_type)
    return Named(PRESENCE, single(item._replace(from_wire=from_wire)))


def _vector_of(fields: Mapping[str, Any], kind: wire.Record) -> int:
    """Returns the presence vector of the members that are there; one that is given must agree."""
    there = [member for member in kind.members if member.name in fields]
    vector = sum(field.bit for field in there)
    presence = fields.get(PRESENCE, vector)
    if type(presence) is not int or presence != vector:
        reason = f"{shown(presence)} given, but the members that are there make {vector}"
        raise EncodeError(reason, PRESENCE)
    # A definition may have more optional members than its vector has bits.
    bits = kind.presence.bits if kind.presence is not None else 0
    if vector >> bits:
        name = next(field.name for field in there if field.bit >> bits)
        reason = f"no bit stands for {name}, the vector has {bits}: leave it out"
        raise EncodeError(reason, PRESENCE)
    return vector


def _segments(
    kind: wire.Record, parts: Mapping[str, Item | Codec]
) -> list[tuple[int, Run | Named]]:
    """Returns what is read together, each with its bit in the presence vector; 0 if always there.

    Neighbouring items that are always there share a struct.
    """
    segments: list[tuple[int, Run | Named]] = []
    waiting: list[tuple[str, Item]] = []
    for member in kind.members:
        part = parts[member.name]
        if isinstance(part, Item) and not member.bit:
            waiting.append((member.name, part))
            continue
        if waiting:
            segments.append((0, Run(waiting)))
            waiting = []
        segments.append((member.bit, Named(member.name, _alone(part))))
    return [*segments, (0, Run(waiting))] if waiting else segments


def _inner(field: wire.Field, encode_message: EncodeMessage) -> Item | Codec:
    """Returns the codec of a field inside of another; its errors name the path to the field."""
    try:
        if isinstance(field.kind, wire.Scalar):
            return item_of(field.kind)
        return codec_of(field.kind, encode_message)
    except DefinitionError as error:
        raise error.inside(field.name) from None


def _alone(part: Item | Codec) -> Codec:
    return single(part) if isinstance(part, Item) else part


# -- lists, arrays, variants -----------------------------------------------------------------------


def _list(kind: wire.List, encode_message: EncodeMessage) -> Codec:
    elements = _elements(kind.element, encode_message)
    count = count_of(kind.count, "count")
    # An element of no bytes would make any count possible.
    least = max(1, kind.element.kind.minimum_size)

    def read(buffer: bytes, offset: int) -> tuple[list[Any], int]:
        length, offset = count.read(buffer, offset)
        # Before memory is taken.
        room = len(buffer) - offset
        if length * least > room:
            raise DecodeError(f"count {length} needs more than the {room} bytes that follow")
        return elements.read(length, buffer, offset)

    def write(value: Any, out: bytearray) -> None:
        values = as_list(value)
        count.write(len(values), out)
        elements.write(values, out)

    return Codec(read, write)


def _array(kind: wire.Array, encode_message: EncodeMessage) -> Codec:
    elements = _elements(kind.element, encode_message)
    length, size = kind.length, kind.minimum_size

    def read(buffer: bytes, offset: int) -> tuple[list[Any], int]:
        room = max(len(buffer) - offset, 0)
        if size > room:
            raise DecodeError(f"{length} elements need more than the {room} bytes that follow")
        return elements.read(length, buffer, offset)

    def write(value: Any, out: bytearray) -> None:
        values = as_list(value)
        if len(values) != length:
            raise EncodeError(f"{len(values)} elements instead of {length}")
        elements.write(values, out)

    return Codec(read, write)


class _Elements(NamedTuple):
    """Reader and writer of a known number of equal fields; there must be room for them."""

    read: Callable[[int, bytes, int], tuple[list[Any], int]]
    write: Callable[[Sequence[Any], bytearray], None]


def _elements(element: wire.Field, encode_message: EncodeMessage) -> _Elements:
    part = _inner(element, encode_message)
    one = _alone(part)

    def read(count: int, buffer: bytes, offset: int) -> tuple[list[Any], int]:
        values: list[Any] = []
        try:
            for _ in range(count):
                value, offset = one.read(buffer, offset)
                values.append(value)
        except DecodeError as error:
            raise error.inside(f"[{len(values)}]") from None
        return values, offset

    def write(values: Sequence[Any], out: bytearray) -> None:
        index = 0
        try:
            for index, value in enumerate(values):  # noqa: B007 - the error tells it
                one.write(value, out)
        except EncodeError as error:
            raise error.inside(f"[{index}]") from None

    if isinstance(part, Item) and not part.format.endswith("s"):
        return _Elements(_read_run(part), write)
    return _Elements(read, write)


def _read_run(item: Item) -> Callable[[int, bytes, int], tuple[list[Any], int]]:
    """Returns the function that reads a number of equal numbers at once."""

    def read(count: int, buffer: bytes, offset: int) -> tuple[list[Any], int]:
        size = count * item.size
        if offset + size > len(buffer):
            raise too_short(size, buffer, offset)
        numbers = struct.unpack_from(f"<{count}{item.format}", buffer, offset)
        values = list(numbers) if item.from_wire is None else [*map(item.from_wire, numbers)]
        return values, offset + size

    return read


class _Variant:
    """Reads and writes a tag and the option that it chooses, as `{"_tag": ..., OPTION: ...}`."""

    def __init__(self, kind: wire.Variant, encode_message: EncodeMessage) -> None:
        check_distinct((option.name for option in kind.options), TAG)
        self._options = kind.options
        self._codecs = [
            Named(option.name, _alone(_inner(option, encode_message))) for option in kind.options
        ]
        self._tag = Named(TAG, single(unsigned(kind.tag)))
        self._choices = options_in_words(kind)

    def read(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        fields: dict[str, Any] = {}
        offset = self._tag.read(fields, buffer, offset)
        tag = fields[TAG]
        if not self._options:
            return fields, offset
        if tag >= len(self._options):
            raise DecodeError(f"{tag} names no option, {self._choices}", TAG)
        return fields, self._codecs[tag].read(fields, buffer, offset)

    def write(self, value: Any, out: bytearray) -> None:
        fields = as_object(value)
        tag = self._tag_of(fields)
        self._tag.write({TAG: tag}, out)
        if not self._options:
            check_names(fields, (TAG,), ())
            return
        name, kind = self._options[tag].name, self._options[tag].kind
        check_names(fields, (TAG, name), (name,), lambda _: in_words(kind))
        self._codecs[tag].write(fields, out)

    def _tag_of(self, fields: Mapping[str, Any]) -> int:
        """Returns the tag, which a single known option tells when it is absent."""
        if TAG not in fields:
            named = [tag for tag, field in enumerate(self._options) if field.name in fields]
            if len(named) != 1:
                raise EncodeError(f"this field is absent, {self._choices}", TAG)
            return named[0]
        try:
            return legal_integer(fields[TAG], ((0, max(len(self._options) - 1, 0)),))
        except EncodeError as error:
            raise EncodeError(f"{error.reason}, {self._choices}", TAG) from None
