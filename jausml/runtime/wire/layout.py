"""Codecs of messages that declare on their fields how these stand on the wire.

The annotation of a field is `Annotated` with its kind: a `Scalar`, or what is `Counted`, `Listed`
or `Tagged`. A field whose type is a record needs no kind, and one that may be None is optional: a
presence vector of one byte, before all fields, has a bit for each of these, which come last.
`message` and `record` give a class what writes and reads it. Values are checked, and errors worded,
as in the messages that generators write (`codec`), to which each declared message is equal.

Scalars that follow each other are packed together, and judged one by one only where something does
not fit: a call for each of them would cost more than all the rest.
"""

from __future__ import annotations

import operator
import struct
import types
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, Union, get_args, get_origin

from .codec import (
    check_count,
    check_presence,
    integer,
    latin1,
    padded,
    scaled,
    sized,
    take,
    take_text,
    unpadded,
)
from .message import DecodeError, Message

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    Write = Callable[[Any, bytearray], None]
    Read = Callable[[bytes, int, list[Any]], int]
    ReadFrom = Callable[[Any, bytes, int], tuple[Any, int]]

ClassT = TypeVar("ClassT", bound=type)
ElementT = TypeVar("ElementT")
MessageClassT = TypeVar("MessageClassT", bound=type[Message])

_TAG = struct.Struct("<B")
_MISFITS = (struct.error, TypeError, ValueError, OverflowError)


# ---------------------------------------------------------------------- kinds of fields


@dataclass(frozen=True)
class Scalar:
    """A field of a fixed size.

    Attributes:
        format: Its format for `struct`.
        put: Returns what is packed of a value; it is also given the attribute that an error names.
        get: Returns the value of what was unpacked; None for that itself.
        limits: Least and greatest value of an integer that is packed as it is; None for others.
    """

    format: str
    put: Callable[[Any, str], Any]
    get: Callable[[Any], Any] | None = None
    limits: tuple[int, int] | None = None


def unsigned(size: int, lower: int = 0, upper: int | None = None) -> Scalar:
    """Returns the kind of an integer of some bytes, 1, 2 or 4, which fills them by default."""
    end = 256**size - 1 if upper is None else upper

    def put(value: int, field: str) -> int:
        return integer(value, lower, end, field)

    return Scalar({1: "B", 2: "H", 4: "I"}[size], put, limits=(lower, end))


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
        count: Format of the number for `struct`.
        least: Fewest bytes that may be sent.
    """

    count: str
    least: int = 0
    is_text: bool = False


@dataclass(frozen=True)
class Listed:
    """Records behind their number, whose format for `struct` is `count`."""

    count: str


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


# ---------------------------------------------------------------------- classes


def message(code: int) -> Callable[[MessageClassT], MessageClassT]:
    """Returns what makes a message of a code out of a dataclass, with the name of the class."""

    def declare(cls: MessageClassT) -> MessageClassT:
        cls.CODE, cls.NAME = code, cls.__name__
        _give_codec(cls, cls.__name__)
        return cls

    return declare


def record(name: str) -> Callable[[ClassT], ClassT]:
    """Returns what makes a record of a dataclass, which texts and errors call by a name."""

    def declare(cls: ClassT) -> ClassT:
        cls.__qualname__ = name
        _give_codec(cls, name)
        return cls

    return declare


class _Field(NamedTuple):
    name: str
    kind: Any  # None for a record
    type: Any
    is_optional: bool = False


class _Part(NamedTuple):
    """Fields that are written and read in one go.

    Attributes:
        write: Appends them to the bytes written so far.
        read: Appends them to the values read so far; returns the offset after them.
        size: Fewest bytes that they take.
        read_from: Reads a class that has no other fields, where that is quicker than `read`.
    """

    write: Write
    read: Read
    size: int
    read_from: ReadFrom | None = None


def _give_codec(cls: Any, name: str) -> None:
    """Gives a dataclass what writes and reads it; a message without fields has that already."""
    found = [_field(each.name, each.type) for each in fields(cls)]
    optional = [each for each in found if each.is_optional]
    parts = _parts(found[: len(found) - len(optional)])
    cls.LEAST_SIZE = sum(each.size for each in parts) + bool(optional)
    if optional:
        cls.write_to, read_from = _with_presence(parts, optional, name)
        cls.read_from = classmethod(read_from)
    elif parts:
        cls.write_to = parts[0].write if len(parts) == 1 else _all_written(parts)
        only = parts[0].read_from if len(parts) == 1 else None
        cls.read_from = classmethod(only or _all_read(parts))


def _field(name: str, declared: Any) -> _Field:
    options = get_args(declared) if get_origin(declared) in (Union, types.UnionType) else ()
    if type(None) in options:
        return _field(name, options[0])._replace(is_optional=True)
    if get_origin(declared) is Annotated:
        return _Field(name, declared.__metadata__[0], get_args(declared)[0])
    return _Field(name, None, declared)


def _parts(found: Sequence[_Field]) -> list[_Part]:
    """Returns the parts of some fields, in order."""
    parts, run = [], []
    for each in found:
        if isinstance(each.kind, Scalar):
            run.append(each)
            continue
        if run:
            parts.append(_scalars(run))
            run = []
        make = _record if each.kind is None else _MAKERS[type(each.kind)]
        parts.append(make(each))
    return [*parts, _scalars(run)] if run else parts


def _all_written(parts: Sequence[_Part]) -> Write:
    writes = [each.write for each in parts]

    def write_to(self: Any, out: bytearray) -> None:
        for write in writes:
            write(self, out)

    return write_to


def _all_read(parts: Sequence[_Part]) -> ReadFrom:
    reads = [each.read for each in parts]

    def read_from(cls: Any, buffer: bytes, offset: int) -> tuple[Any, int]:
        values: list[Any] = []
        for read in reads:
            offset = read(buffer, offset, values)
        return cls(*values), offset

    return read_from


def _with_presence(
    parts: Sequence[_Part], optional: Sequence[_Field], name: str
) -> tuple[Write, ReadFrom]:
    """Returns what writes and reads a class whose last fields are optional."""
    always, reads = _all_written(parts), [each.read for each in parts]
    maybe = [(1 << bit, each.name, *_parts([each])[0][:2]) for bit, each in enumerate(optional)]
    known = (1 << len(optional)) - 1

    def write_to(self: Any, out: bytearray) -> None:
        start = len(out)
        out.append(0)
        always(self, out)
        for bit, attribute, write, _ in maybe:
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
        for bit, _, _, read in maybe:
            if presence & bit:
                offset = read(buffer, offset, values)
            else:
                values.append(None)
        return cls(*values), offset

    return write_to, read_from


# ---------------------------------------------------------------------- parts


def _scalars(run: Sequence[_Field]) -> _Part:
    """Returns scalars that are packed together."""
    packer = struct.Struct("<" + "".join(each.kind.format for each in run))
    pack, unpack_from, size = packer.pack, packer.unpack_from, packer.size
    puts = [(each.name, each.kind.put) for each in run]
    gets = [(index, each.kind.get) for index, each in enumerate(run) if each.kind.get]

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

    if any(each.kind.limits is None for each in run):
        return _Part(write, read, size)
    return _Part(_quick(run, pack, write), read, size, read_from)


def _quick(run: Sequence[_Field], pack: Callable[..., bytes], careful: Write) -> Write:
    """Returns what writes integers at once, and leaves it to another one to word an error."""
    value_of = operator.attrgetter(*(each.name for each in run))
    lower, upper = run[0].kind.limits
    # Whether an integer fits its bytes is found when it is packed.
    narrow = [
        (index, *each.kind.limits)
        for index, each in enumerate(run)
        if each.kind.limits != unsigned(struct.calcsize(each.kind.format)).limits
    ]

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
    name, least, is_text = field.name, field.kind.least, field.kind.is_text
    counter, upper = _counter(field.kind.count)
    width = counter.size
    take_value: Callable[..., Any] = take_text if is_text else take

    def write(part: Any, out: bytearray) -> None:
        value = getattr(part, name)
        if is_text:
            value = latin1(value, name)
        out += counter.pack(sized(value, least, upper, name))
        out += value

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        (size,) = counter.unpack_from(buffer, offset)
        offset += width
        values.append(take_value(buffer, offset, size, upper, name))
        return offset + int(size)

    return _Part(write, read, width)


def _listed(field: _Field) -> _Part:
    name = field.name
    (element,) = get_args(field.type)
    read_element, least = element.read_from, element.LEAST_SIZE
    counter, upper = _counter(field.kind.count)

    def write(part: Any, out: bytearray) -> None:
        found = getattr(part, name)
        out += counter.pack(sized(found, 0, upper, name))
        for item in found:
            item.write_to(out)

    def read(buffer: bytes, offset: int, values: list[Any]) -> int:
        (size,) = counter.unpack_from(buffer, offset)
        offset += counter.size
        check_count(size, upper, len(buffer) - offset, least, name)
        found = []
        for _ in range(size):
            item, offset = read_element(buffer, offset)
            found.append(item)
        values.append(found)
        return offset

    return _Part(write, read, counter.size)


def _tagged(field: _Field) -> _Part:
    name, where = field.name, field.kind.name
    options = {each.TAG: each for each in get_args(field.type)}

    def write(part: Any, out: bytearray) -> None:
        chosen = getattr(part, name)
        out += _TAG.pack(chosen.TAG)
        chosen.write_to(out)

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


def _counter(count: str) -> tuple[struct.Struct, int]:
    """Returns what packs a number of a format, and the largest one."""
    counter = struct.Struct("<" + count)
    return counter, 256**counter.size - 1


_MAKERS: dict[type, Callable[[_Field], _Part]] = {
    Counted: _counted,
    Listed: _listed,
    Tagged: _tagged,
}
