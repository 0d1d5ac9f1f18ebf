"""Codecs of what holds other fields: records and sequences, lists, arrays, variants."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, NamedTuple

from jausml.live.messages.codec import Codec, Scalar, as_list, as_object, shown, too_short
from jausml.live.messages.errors import CodecError, DecodeError, EncodeError
from jausml.live.messages.legal import legal_integer, listed
from jausml.live.messages.scalars import check_names

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.live.messages.blobs import Counted

PRESENCE = "_pv"
"""Name under which a presence vector stands among the members."""

TAG = "_tag"
"""Name under which the tag of a variant stands beside its option."""

_MAXIMUM_LAYOUTS = 256


class Member(NamedTuple):
    """A member of a record or sequence.

    Attributes:
        name: Name in the definition.
        codec: How it stands on the wire.
        bit: Its bit of the presence vector; 0 when it is always there.
    """

    name: str
    codec: Codec
    bit: int = 0


class Run:
    """Neighbouring scalars, which share a struct."""

    __slots__ = ("_scalars", "_struct")

    def __init__(self, members: Sequence[tuple[str, Scalar]]) -> None:
        self._scalars = tuple(members)
        self._struct = struct.Struct("<" + "".join(scalar.format for _, scalar in members))

    def decode(self, fields: dict[str, Any], buffer: bytes, offset: int) -> int:
        """Puts the values into the fields and returns the offset after them."""
        try:
            items = self._struct.unpack_from(buffer, offset)
        except struct.error:
            raise self._too_short(buffer, offset) from None
        for (name, scalar), item in zip(self._scalars, items, strict=True):
            fields[name] = scalar.from_wire(item)
        return offset + self._struct.size

    def encode(self, fields: dict[str, Any], out: bytearray) -> None:
        """Appends the values of the fields."""
        name = ""
        items = []
        try:
            for name, scalar in self._scalars:
                items.append(scalar.to_wire(fields[name]))
        except EncodeError as error:
            raise error.inside(name) from None
        out += self._struct.pack(*items)

    def _too_short(self, buffer: bytes, offset: int) -> DecodeError:
        for name, scalar in self._scalars:
            if offset + scalar.minimum_size > len(buffer):
                return too_short(scalar.minimum_size, buffer, offset).inside(name)
            offset += scalar.minimum_size
        raise AssertionError("a run that fits was said to be too short")


class Single:
    """A member that has no fixed size."""

    __slots__ = ("_codec", "_name")

    def __init__(self, name: str, codec: Codec) -> None:
        self._name = name
        self._codec = codec

    def decode(self, fields: dict[str, Any], buffer: bytes, offset: int) -> int:
        """Puts the value into the fields and returns the offset after it."""
        try:
            fields[self._name], offset = self._codec.decode(buffer, offset)
        except CodecError as error:
            raise error.inside(self._name) from None
        return offset

    def encode(self, fields: dict[str, Any], out: bytearray) -> None:
        """Appends the value of the field."""
        try:
            self._codec.encode(fields[self._name], out)
        except CodecError as error:
            raise error.inside(self._name) from None


Layout = tuple["Run | Single", ...]


def _layout(members: Sequence[Member]) -> Layout:
    segments: list[Run | Single] = []
    waiting: list[tuple[str, Scalar]] = []
    for member in members:
        if isinstance(member.codec, Scalar):
            waiting.append((member.name, member.codec))
            continue
        if waiting:
            segments.append(Run(waiting))
            waiting = []
        segments.append(Single(member.name, member.codec))
    if waiting:
        segments.append(Run(waiting))
    return tuple(segments)


class Record(Codec):
    """A record or sequence: an object of its members.

    Attributes:
        members: The members in their order.
        presence: The integer of the presence vector, None without one.
    """

    __slots__ = ("_known", "_layouts", "_mask", "_needed", "members", "minimum_size", "presence")

    def __init__(self, members: Sequence[Member], presence: Scalar | None = None) -> None:
        self.members = tuple(members)
        self.presence = presence
        always = [member for member in members if not member.bit]
        self.minimum_size = sum(member.codec.minimum_size for member in always)
        self._needed = tuple(member.name for member in always)
        self._known = {member.name: member for member in members}
        self._mask = sum(member.bit for member in members)
        self._layouts: dict[int, Layout] = {}
        if presence is not None:
            self.minimum_size += presence.minimum_size

    def decode(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        """Returns the members at an offset, and the offset after them."""
        fields: dict[str, Any] = {}
        vector = 0
        if self.presence is not None:
            try:
                vector, offset = self.presence.decode(buffer, offset)
            except DecodeError as error:
                raise error.inside(PRESENCE) from None
            if vector & ~self._mask:
                unknown = vector & ~self._mask
                raise DecodeError(f"bits 0x{unknown:X} stand for no member", PRESENCE)
            fields[PRESENCE] = vector
        for segment in self._layout(vector):
            offset = segment.decode(fields, buffer, offset)
        return fields, offset

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends the members; `_pv` is made of those that are there."""
        fields = as_object(value)
        known = self._known if self.presence is None else (*self._known, PRESENCE)
        check_names(fields, known, self._needed, lambda name: self._known[name].codec.legal())
        vector = 0
        if self.presence is not None:
            vector = sum(self._known[name].bit for name in fields if name != PRESENCE)
            given = fields.get(PRESENCE, vector)
            if type(given) is not int or given != vector:
                reason = f"{shown(given)} given, but the members that are there make {vector}"
                raise EncodeError(reason, PRESENCE)
            # A definition may have more optional members than its vector has bits.
            try:
                self.presence.encode(vector, out)
            except EncodeError:
                bits = 8 * self.presence.minimum_size
                present = (each for each in self.members if each.name in fields)
                name = next(each.name for each in present if each.bit >> bits)
                reason = f"no bit stands for {name}, the vector has {bits}: leave it out"
                raise EncodeError(reason, PRESENCE) from None
        for segment in self._layout(vector):
            segment.encode(fields, out)

    def legal(self) -> str:
        """Returns the names of the members."""
        names = [each.name for each in self.members]
        return f"an object of {listed(names)}" if names else "an empty object"

    def _layout(self, vector: int) -> Layout:
        """Returns the segments of the members that a presence vector names."""
        layout = self._layouts.get(vector)
        if layout is None:
            present = [each for each in self.members if not each.bit or vector & each.bit]
            layout = _layout(present)
            if len(self._layouts) < _MAXIMUM_LAYOUTS:
                self._layouts[vector] = layout
        return layout


def _decode_elements(codec: Codec, count: int, buffer: bytes, offset: int) -> tuple[list[Any], int]:
    """Returns a number of equal fields, and the offset after them; there must be room for them."""
    if isinstance(codec, Scalar) and not codec.format.endswith("s"):
        size = count * codec.minimum_size
        if offset + size > len(buffer):
            raise too_short(size, buffer, offset)
        items = struct.unpack_from(f"<{count}{codec.format}", buffer, offset)
        return [codec.from_wire(item) for item in items], offset + size
    values: list[Any] = []
    try:
        for _ in range(count):
            value, offset = codec.decode(buffer, offset)
            values.append(value)
    except DecodeError as error:
        raise error.inside(f"[{len(values)}]") from None
    return values, offset


def _encode_elements(codec: Codec, values: Sequence[Any], out: bytearray) -> None:
    index = 0
    try:
        for index, value in enumerate(values):  # noqa: B007 - the error tells it
            codec.encode(value, out)
    except EncodeError as error:
        raise error.inside(f"[{index}]") from None


class List(Codec):
    """A count and that many equal fields.

    Attributes:
        element: The field.
        counted: The count and its limits.
    """

    __slots__ = ("counted", "element", "minimum_size")

    def __init__(self, element: Codec, counted: Counted) -> None:
        self.element = element
        self.counted = counted
        self.minimum_size = counted.size

    def decode(self, buffer: bytes, offset: int) -> tuple[list[Any], int]:
        """Returns the elements at an offset, and the offset after them."""
        count = self.counted.read_count(buffer, offset, "count")
        offset += self.counted.size
        # Before memory is taken; an element of no bytes would make any count possible.
        room = len(buffer) - offset
        if count * max(1, self.element.minimum_size) > room:
            raise DecodeError(f"count {count} needs more than the {room} bytes that follow")
        return _decode_elements(self.element, count, buffer, offset)

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a list."""
        values = as_list(value)
        self.counted.write_count(len(values), out, "count")
        _encode_elements(self.element, values, out)

    def legal(self) -> str:
        """Returns how many elements there may be."""
        return f"a list of {self.counted.lower} .. {self.counted.upper} elements"


class Array(Codec):
    """A fixed number of equal fields; a list in wire order, the first dimension slowest.

    Attributes:
        element: The field.
        count: Number of elements.
    """

    __slots__ = ("count", "element", "minimum_size")

    def __init__(self, element: Codec, count: int) -> None:
        self.element = element
        self.count = count
        self.minimum_size = count * element.minimum_size

    def decode(self, buffer: bytes, offset: int) -> tuple[list[Any], int]:
        """Returns the elements at an offset, and the offset after them."""
        room = max(len(buffer) - offset, 0)
        if self.minimum_size > room:
            raise DecodeError(f"{self.count} elements need more than the {room} bytes that follow")
        return _decode_elements(self.element, self.count, buffer, offset)

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a list of exactly the right length."""
        values = as_list(value)
        if len(values) != self.count:
            raise EncodeError(f"{len(values)} elements instead of {self.count}")
        _encode_elements(self.element, values, out)

    def legal(self) -> str:
        """Returns how many elements there must be."""
        return f"a list of {self.count} elements"


class Variant(Codec):
    """A tag and the option that it chooses, as `{"_tag": ..., OPTION: ...}`.

    Attributes:
        tag: The integer of the tag.
        options: Names and codecs in the order of their tags; there may be none.
    """

    __slots__ = ("minimum_size", "options", "tag")

    def __init__(self, tag: Scalar, options: Sequence[tuple[str, Codec]]) -> None:
        self.tag = tag
        self.options = tuple(options)
        smallest = min((codec.minimum_size for _, codec in options), default=0)
        self.minimum_size = tag.minimum_size + smallest

    def decode(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        """Returns tag and option at an offset, and the offset after them."""
        try:
            tag, offset = self.tag.decode(buffer, offset)
        except DecodeError as error:
            raise error.inside(TAG) from None
        fields: dict[str, Any] = {TAG: tag}
        if not self.options:
            return fields, offset
        if tag >= len(self.options):
            raise DecodeError(f"{tag} names no option, {self._choices}", TAG)
        name, codec = self.options[tag]
        try:
            fields[name], offset = codec.decode(buffer, offset)
        except DecodeError as error:
            raise error.inside(name) from None
        return fields, offset

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a tag and its option."""
        fields = as_object(value)
        tag = self._tag_of(fields)
        self.tag.encode(tag, out)
        if not self.options:
            check_names(fields, (TAG,), ())
            return
        name, codec = self.options[tag]
        check_names(fields, (TAG, name), (name,), lambda _: codec.legal())
        try:
            codec.encode(fields[name], out)
        except EncodeError as error:
            raise error.inside(name) from None

    def legal(self) -> str:
        """Returns the names of the options."""
        return f"an object of one option, {self._choices}"

    def _tag_of(self, fields: dict[str, Any]) -> int:
        """Returns the tag, which a single known option tells when it is absent."""
        if TAG not in fields:
            named = [tag for tag, (name, _) in enumerate(self.options) if name in fields]
            if len(named) != 1:
                raise EncodeError(f"this field is absent, {self._choices}", TAG)
            return named[0]
        try:
            return legal_integer(fields[TAG], ((0, max(len(self.options) - 1, 0)),))
        except EncodeError as error:
            raise EncodeError(f"{error.reason}, {self._choices}", TAG) from None

    @property
    def _choices(self) -> str:
        names: Iterator[str] = (f"{tag} {name}" for tag, (name, _) in enumerate(self.options))
        return "the options are " + (", ".join(names) or "none: write 0")
