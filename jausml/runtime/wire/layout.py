"""Codecs of messages whose fields are annotated with their kind on the wire (`codec`).

The decorators `message` and `record` add methods to a dataclass that write and read it. A field
that may be None is optional: optional fields come last, and a presence vector of one byte, before
all fields, has a bit for each. Checks and errors are those of generated messages.

Consecutive integers are packed together, and checked one by one only when packing fails: a call
for each would cost more than all the rest.
"""

from __future__ import annotations

import operator
import struct
import types
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any, NamedTuple, TypeVar, Union, get_args, get_origin

from .codec import Counted, Listed, Scalar, Tagged, check_count, check_presence, latin1, sized
from .message import DecodeError, EncodeError, Message

Write = Callable[[Any, bytearray], None]
Read = Callable[[bytes, int, list[Any]], int]
ReadFrom = Callable[[Any, bytes, int], tuple[Any, int]]

ClassT = TypeVar("ClassT", bound=type)
MessageClassT = TypeVar("MessageClassT", bound=type[Message])

_TAG = struct.Struct("<B")
_MISFITS = (EncodeError, struct.error, TypeError, ValueError, OverflowError, AttributeError)


# ---------------------------------------------------------------------- classes


def message(code: int) -> Callable[[MessageClassT], MessageClassT]:
    """Returns a decorator of dataclasses that are messages of a code, named like the class."""

    def declare(cls: MessageClassT) -> MessageClassT:
        cls.CODE, cls.NAME = code, cls.__name__
        _add_codec(cls, cls.__name__)
        return cls

    return declare


def record(name: str) -> Callable[[ClassT], ClassT]:
    """Returns a decorator of dataclasses that are records, with their name in texts and errors."""

    def declare(cls: ClassT) -> ClassT:
        cls.__qualname__ = name
        _add_codec(cls, name)
        return cls

    return declare


@dataclass(slots=True, repr=False, eq=False)
class Bodiless(Message):
    """A message without fields."""


class _Field(NamedTuple):
    name: str
    kind: Any  # None for a record
    type: Any
    is_optional: bool = False


class _Part(NamedTuple):
    """Functions that write and read one field, or consecutive scalars."""

    write: Write  # appends the fields of an object to the bytes written so far
    read: Read  # appends their values to those read so far; returns the offset after them
    size: int  # fewest bytes of the fields
    # Reads an object of a class without other fields; None unless faster than `read`.
    read_from: ReadFrom | None = None


def _add_codec(cls: Any, name: str) -> None:
    """Adds `LEAST_SIZE` and, unless it has no fields, `write_to` and `read_from` to a class."""
    members = [_field(field.name, field.type) for field in fields(cls)]
    optional = [field for field in members if field.is_optional]
    parts = _parts(members[: len(members) - len(optional)])
    cls.LEAST_SIZE = sum(part.size for part in parts) + bool(optional)
    if optional:
        cls.write_to, read_from = _with_presence(parts, optional, name)
        cls.read_from = classmethod(read_from)
    elif parts:
        cls.write_to = _joined_write(parts)
        cls.read_from = classmethod(_joined_read(parts))


def _field(name: str, declared: Any) -> _Field:
    options = get_args(declared) if get_origin(declared) in (Union, types.UnionType) else ()
    if type(None) in options:
        return _field(name, options[0])._replace(is_optional=True)
    if get_origin(declared) is Annotated:
        return _Field(name, declared.__metadata__[0], get_args(declared)[0])
    return _Field(name, None, declared)


def _parts(members: Sequence[_Field]) -> list[_Part]:
    parts: list[_Part] = []
    run: list[_Field] = []
    for field in members:
        if isinstance(field.kind, Scalar):
            run.append(field)
            continue
        if run:
            parts.append(_scalars(run))
        parts.append(_MAKERS[type(field.kind)](field))
        run = []
    return [*parts, _scalars(run)] if run else parts


def _joined_write(parts: Sequence[_Part]) -> Write:
    writes = [part.write for part in parts]

    def write_to(self: Any, out: bytearray) -> None:
        for write in writes:
            write(self, out)

    return writes[0] if len(writes) == 1 else write_to


def _joined_read(parts: Sequence[_Part]) -> ReadFrom:
    if len(parts) == 1 and parts[0].read_from is not None:
        return parts[0].read_from
    reads = [part.read for part in parts]

    def read_from(cls: Any, buffer: bytes, offset: int) -> tuple[Any, int]:
        values: list[Any] = []
        for read in reads:
            offset = read(buffer, offset, values)
        return cls(*values), offset

    return read_from


def _with_presence(
    parts: Sequence[_Part], optional: Sequence[_Field], name: str
) -> tuple[Write, ReadFrom]:
    """Returns functions that write and read a class whose last fields are optional."""
    write_parts, reads = _joined_write(parts), [part.read for part in parts]
    options = [
        (1 << bit, field.name, *_parts([field])[0][:2]) for bit, field in enumerate(optional)
    ]
    known = (1 << len(optional)) - 1

    def write_to(self: Any, out: bytearray) -> None:
        start = len(out)
        out.append(0)
        write_parts(self, out)
        for bit, attribute, write, _ in options:
            if getattr(self, attribute) is not None:
                out[start] |= bit
                write(self, out)

    def read_from(cls: Any, buffer: bytes, offset: int) -> tuple[Any, int]:
        (presence,) = _TAG.unpack_from(buffer, offset)
        offset += _TAG.size
        values: list[Any] = []
        for read in reads:
            offset = read(buffer, offset, values)
        check_presence(presence, known, name)
        for bit, _, _, read in options:
            if presence & bit:
                offset = read(buffer, offset, values)
            else:
                values.append(None)
        return cls(*values), offset

    return write_to, read_from


# ---------------------------------------------------------------------- parts


def _scalars(run: Sequence[_Field]) -> _Part:
    packer = struct.Struct("<" + "".join(field.kind.format for field in run))
    pack, unpack_from, size = packer.pack, packer.unpack_from, packer.size
    puts = [(field.name, field.kind.put) for field in run]
    gets = [(index, field.kind.get) for index, field in enumerate(run) if field.kind.get]

    def write(part: Any, out: bytearray) -> None:
        out += pack(*[put(getattr(part, name), name) for name, put in puts])

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        start = len(values)
        values += unpack_from(buffer, offset)
        for index, get in gets:
            values[start + index] = get(values[start + index])
        return offset + size

    def read_from(cls: Any, buffer: bytes, offset: int) -> tuple[Any, int]:
        return cls(*unpack_from(buffer, offset)), offset + size

    if any(field.kind.limits is None for field in run):
        return _Part(write, read, size)
    return _Part(_quick(run, pack, write), read, size, read_from)


def _quick(run: Sequence[_Field], pack: Callable[..., bytes], careful: Write) -> Write:
    """Returns a function that packs integers at once; `careful` raises the error at a misfit."""
    value_of = operator.attrgetter(*(field.name for field in run))
    # Indices and limits of fields whose bytes can hold more.
    narrow = [
        (index, *member.kind.limits) for index, member in enumerate(run) if member.kind.is_narrow
    ]
    lower, upper = run[0].kind.limits

    def write(part: Any, out: bytearray) -> None:
        try:
            values = value_of(part)
            for index, lower, upper in narrow:
                if not lower <= values[index] <= upper:
                    break
            else:
                out += pack(*values)
                return
        except _MISFITS:
            pass
        careful(part, out)

    def write_one(part: Any, out: bytearray) -> None:
        try:
            value = value_of(part)
            if lower <= value <= upper:
                out += pack(value)
                return
        except _MISFITS:
            pass
        careful(part, out)

    return write_one if len(run) == 1 else write


def _counted(field: _Field) -> _Part:
    name, kind = field.name, field.kind
    counter, most, take_value = struct.Struct(f"<{kind.format}"), kind.most, kind.take

    def write(part: Any, out: bytearray) -> None:
        value = getattr(part, name)
        if kind.is_text:
            value = latin1(value, name)
        out += counter.pack(sized(value, kind.least, most, name))
        out += value

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        (size,) = counter.unpack_from(buffer, offset)
        offset += counter.size
        values.append(take_value(buffer, offset, size, most, name))
        return offset + int(size)

    return _Part(write, read, counter.size)


def _listed(field: _Field) -> _Part:
    name = field.name
    (element,) = get_args(field.type)
    read_element, least = element.read_from, element.LEAST_SIZE
    counter, most = struct.Struct(f"<{field.kind.format}"), field.kind.most

    def write(part: Any, out: bytearray) -> None:
        items = getattr(part, name)
        out += counter.pack(sized(items, 0, most, name))
        for item in items:
            item.write_to(out)

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        (size,) = counter.unpack_from(buffer, offset)
        offset += counter.size
        check_count(size, most, len(buffer) - offset, least, name)
        items = []
        for _ in range(size):
            item, offset = read_element(buffer, offset)
            items.append(item)
        values.append(items)
        return offset

    return _Part(write, read, counter.size)


def _tagged(field: _Field) -> _Part:
    name, where = field.name, field.kind.name
    options = {option.TAG: option for option in get_args(field.type)}

    def write(part: Any, out: bytearray) -> None:
        option = getattr(part, name)
        out += _TAG.pack(option.TAG)
        option.write_to(out)

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        (tag,) = _TAG.unpack_from(buffer, offset)
        if tag not in options:
            raise DecodeError(where, f"tag {tag} names no option")
        value, offset = options[tag].read_from(buffer, offset + _TAG.size)
        values.append(value)
        return offset

    return _Part(write, read, _TAG.size)


def _record(field: _Field) -> _Part:
    name, read_record = field.name, field.type.read_from

    def write(part: Any, out: bytearray) -> None:
        getattr(part, name).write_to(out)

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        value, offset = read_record(buffer, offset)
        values.append(value)
        return offset

    return _Part(write, read, field.type.LEAST_SIZE)


_MAKERS: dict[type, Callable[[_Field], _Part]] = {
    Counted: _counted,
    Listed: _listed,
    Tagged: _tagged,
    type(None): _record,
}
