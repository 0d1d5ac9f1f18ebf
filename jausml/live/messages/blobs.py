"""Codecs of counted bytes, and of fields whose type an index on the wire chooses."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, Protocol

from jausml.live.messages.codec import Codec, Scalar, as_object, shown, too_short
from jausml.live.messages.errors import DecodeError, EncodeError
from jausml.live.messages.legal import integers_in_words, legal_integer
from jausml.live.messages.scalars import check_names, latin1

if TYPE_CHECKING:
    from collections.abc import Mapping

JAUS_MESSAGE = "JAUS MESSAGE"
"""Format of a byte field that holds a message: its code and body."""

MESSAGE = "message"
"""Name under which the decoded form of an embedded message stands beside its `hex`."""


class EncodeMessage(Protocol):
    """Encodes an embedded message."""

    def __call__(self, message: Any, /) -> bytes:
        """Returns the payload of a message in the shape that `jausml decode` prints."""


class Counted:
    """A count and that many bytes.

    Attributes:
        count_format: Struct format of the count.
        lower: Smallest legal count; a peer may send fewer.
        upper: Largest legal count.
        size: Bytes of the count itself.
    """

    __slots__ = ("_count", "count_format", "lower", "size", "upper")

    def __init__(self, count_format: str, lower: int, upper: int) -> None:
        self.count_format = count_format
        self.lower = lower
        self.upper = upper
        self._count = struct.Struct(f"<{count_format}")
        self.size = self._count.size

    def read_count(self, buffer: bytes, offset: int, what: str = "length") -> int:
        """Returns the count at an offset.

        Args:
            buffer: The whole payload.
            offset: Where the count begins.
            what: What is counted, for the error.

        Raises:
            DecodeError: The payload ends before it, or it is larger than the definition allows.
        """
        try:
            (count,) = self._count.unpack_from(buffer, offset)
        except struct.error:
            raise too_short(self.size, buffer, offset) from None
        if count > self.upper:
            raise DecodeError(f"{what} {count} is more than {self.upper}")
        return int(count)

    def write_count(self, count: int, out: bytearray, what: str = "length") -> None:
        """Appends a count.

        Args:
            count: The count.
            out: The bytes written so far.
            what: What is counted, for the error.

        Raises:
            EncodeError: It is not legal.
        """
        if not self.lower <= count <= self.upper:
            raise EncodeError(f"{what} {count} is outside {self.lower} .. {self.upper}")
        out += self._count.pack(count)

    def read(self, buffer: bytes, offset: int) -> tuple[bytes, int]:
        """Returns the counted bytes, and the offset after them.

        Raises:
            DecodeError: The count is too large or the payload ends before it is met.
        """
        size = self.read_count(buffer, offset)
        start = offset + self.size
        data = bytes(buffer[start : start + size])
        if len(data) != size:
            raise DecodeError(f"length {size} is more than the {len(data)} bytes that follow")
        return data, start + size

    def write(self, data: bytes, out: bytearray) -> None:
        """Appends counted bytes.

        Raises:
            EncodeError: They are too few or too many.
        """
        self.write_count(len(data), out)
        out += data


class Text(Codec):
    """Counted text in Latin-1.

    Attributes:
        counted: The count and its limits.
    """

    __slots__ = ("counted", "minimum_size")

    def __init__(self, counted: Counted) -> None:
        self.counted = counted
        self.minimum_size = counted.size

    def decode(self, buffer: bytes, offset: int) -> tuple[str, int]:
        """Returns the text at an offset, and the offset after it."""
        data, end = self.counted.read(buffer, offset)
        return data.decode("latin-1"), end

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a text."""
        self.counted.write(latin1(value), out)

    def legal(self) -> str:
        """Returns how long the text may be."""
        return f"text of {self.counted.lower} .. {self.counted.upper} characters"


class Octets(Codec):
    """Counted bytes of a known format, as `{"hex": ...}`.

    Attributes:
        counted: The count and its limits.
        content: Format of the bytes, e.g. `JAUS MESSAGE`.
    """

    __slots__ = ("_encode_message", "content", "counted", "minimum_size")

    def __init__(self, counted: Counted, content: str, encode_message: EncodeMessage) -> None:
        self.counted = counted
        self.content = content
        self.minimum_size = counted.size
        self._encode_message = encode_message

    @property
    def holds_message(self) -> bool:
        """Whether the bytes are a message."""
        return self.content == JAUS_MESSAGE

    def decode(self, buffer: bytes, offset: int) -> tuple[dict[str, str], int]:
        """Returns the bytes at an offset, and the offset after them."""
        data, end = self.counted.read(buffer, offset)
        return {"hex": data.hex()}, end

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends bytes; without `hex` those of the embedded message."""
        fields = as_object(value)
        data = octets(fields, self._encode_message if self.holds_message else None)
        self.counted.write(data, out)

    def legal(self) -> str:
        """Returns the shape of the object."""
        return _octets_in_words(self.content, self.counted)


class FormattedOctets(Codec):
    """The index of a format and counted bytes, as `{"format": ..., "hex": ...}`.

    Attributes:
        formats: Names of the formats by index.
        counted: The count and its limits.
    """

    __slots__ = ("_encode_message", "_ranges", "counted", "formats", "minimum_size")

    def __init__(
        self, formats: Mapping[int, str], counted: Counted, encode_message: EncodeMessage
    ) -> None:
        self.formats = dict(formats)
        self.counted = counted
        self.minimum_size = 1 + counted.size
        self._ranges = tuple((index, index) for index in sorted(formats))
        self._encode_message = encode_message

    def holds_message(self, index: int) -> bool:
        """Tells whether the bytes are a message.

        Args:
            index: Index of their format.
        """
        return self.formats.get(index) == JAUS_MESSAGE

    def decode(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        """Returns format and bytes at an offset, and the offset after them."""
        if offset >= len(buffer):
            raise too_short(1, buffer, offset).inside("format")
        try:
            data, end = self.counted.read(buffer, offset + 1)
        except DecodeError as error:
            raise error.inside("hex") from None
        return {"format": buffer[offset], "hex": data.hex()}, end

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends a format and bytes; without `hex` those of the embedded message."""
        fields = as_object(value)
        known = ("format", "hex", MESSAGE)
        check_names(fields, known, ("format",), lambda _: self._formats_in_words)
        try:
            index = legal_integer(fields["format"], self._ranges, self.formats)
        except EncodeError as error:
            raise error.inside("format") from None
        out.append(index)
        encode_message = self._encode_message if self.holds_message(index) else None
        self.counted.write(octets(fields, encode_message, "format"), out)

    def legal(self) -> str:
        """Returns the shape of the object and the formats."""
        return f"an object of format and hex; format is {self._formats_in_words}"

    @property
    def _formats_in_words(self) -> str:
        return integers_in_words(self._ranges, self.formats)


def _octets_in_words(content: str, counted: Counted) -> str:
    shape = "an object of message or hex" if content == JAUS_MESSAGE else "an object of hex"
    what = f" of {content}" if content else ""
    return f"{shape}, {counted.lower} .. {counted.upper} bytes{what}"


def octets(fields: Mapping[str, Any], encode_message: EncodeMessage | None, *more: str) -> bytes:
    """Returns the bytes that an object of a byte field describes.

    Args:
        fields: The object: `hex`, and for an embedded message its decoded form, which counts only
            when there is no `hex`.
        encode_message: Encodes an embedded message; None when the bytes are none.
        more: Further names that may stand in the object.

    Raises:
        EncodeError: The object has neither, or what it has is wrong.
    """
    if encode_message is not None and MESSAGE in fields and "hex" not in fields:
        try:
            return encode_message(fields[MESSAGE])
        except EncodeError as error:
            raise error.inside(MESSAGE) from None
    known = ("hex", *more) if encode_message is None else ("hex", MESSAGE, *more)
    instead = "" if encode_message is None else f", or {MESSAGE} in its stead an object of one"
    check_names(fields, known, ("hex",), lambda _: f"bytes in hexadecimal{instead}")
    text = fields["hex"]
    if not isinstance(text, str):
        raise EncodeError(f"{shown(text)} is not a string", "hex")
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise EncodeError(f"{shown(text)} is not hexadecimal", "hex") from None


class VariableNumber(Codec):
    """The index of a type and a number of that type, as `{"index": ..., "value": ...}`.

    Attributes:
        alternatives: The types by index.
    """

    __slots__ = ("alternatives", "minimum_size")

    def __init__(self, alternatives: Mapping[int, Scalar]) -> None:
        self.alternatives = dict(alternatives)
        self.minimum_size = 1 + min(each.minimum_size for each in alternatives.values())

    def decode(self, buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        """Returns index and number at an offset, and the offset after them."""
        if offset >= len(buffer):
            raise too_short(1, buffer, offset).inside("index")
        index = buffer[offset]
        number = self.alternatives.get(index)
        if number is None:
            raise DecodeError(f"{index} names no type, known are {self._known}", "index")
        try:
            value, end = number.decode(buffer, offset + 1)
        except DecodeError as error:
            raise error.inside("value") from None
        return {"index": index, "value": value}, end

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends an index and a number."""
        fields = as_object(value)
        check_names(fields, ("index", "value"), ("index", "value"))
        index = fields["index"]
        number = self.alternatives.get(index) if type(index) is int else None
        if number is None:
            raise EncodeError(f"{shown(index)} names no type, known are {self._known}", "index")
        out.append(index)
        try:
            number.encode(fields["value"], out)
        except EncodeError as error:
            raise error.inside("value") from None

    def legal(self) -> str:
        """Returns the shape of the object and the types."""
        types = ", ".join(f"{index} ({each.legal()})" for index, each in self.alternatives.items())
        return f"an object of index and value; index is {types}"

    @property
    def _known(self) -> str:
        return ", ".join(map(str, self.alternatives))
