"""Counted bytes, and fields whose type an index on the wire chooses (SAE AS5684)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from jausml.language import wire
from jausml.live.messages.errors import DecodeError, EncodeError, did_you_mean, similar
from jausml.live.messages.items import Codec, Item, Named, item_of, single, too_short
from jausml.live.messages.values import (
    as_object,
    check_names,
    formats_in_words,
    latin1,
    legal_integer,
    listed,
    named_values,
    number_of,
    shown,
    symbol,
)

MESSAGE = "message"
"""Name under which the decoded form of an embedded message stands beside its `hex`."""


EncodeMessage = Callable[[Any], bytes]
"""Returns the payload of an embedded message in the shape that `jausml decode` prints."""


def count_of(count: wire.Count, what: str) -> Codec:
    """Returns the codec of a count; a peer may send fewer than may be written."""
    lower, upper = count.lower, count.upper

    def from_wire(number: int) -> int:
        if number > upper:
            raise DecodeError(f"{what} {number} is more than {upper}")
        return number

    def to_wire(number: int) -> int:
        if not lower <= number <= upper:
            raise EncodeError(f"{what} {number} is outside {lower} .. {upper}")
        return number

    return single(Item(count.type.format, count.type.size, from_wire, to_wire))


def _counted(limits: wire.Count) -> Codec:
    """Returns the codec of bytes with their count before them."""
    count = count_of(limits, "length")

    def read(buffer: bytes, offset: int) -> tuple[bytes, int]:
        size, start = count.read(buffer, offset)
        data = bytes(buffer[start : start + size])
        if len(data) != size:
            raise DecodeError(f"length {size} is more than the {len(data)} bytes that follow")
        return data, start + size

    def write(data: bytes, out: bytearray) -> None:
        count.write(len(data), out)
        out += data

    return Codec(read, write)


def text_of(kind: wire.Text) -> Codec:
    """Returns the codec of text with its count before it."""
    counted = _counted(kind.count)

    def read(buffer: bytes, offset: int) -> tuple[str, int]:
        data, offset = counted.read(buffer, offset)
        return data.decode("latin-1"), offset

    def write(value: Any, out: bytearray) -> None:
        counted.write(latin1(value), out)

    return Codec(read, write)


def octets_of(kind: wire.Octets, encode_message: EncodeMessage) -> Codec:
    """Returns the codec of counted bytes, as `{"hex": ...}`."""
    counted = _counted(kind.count)
    encode_inner = encode_message if kind.holds_message else None

    def read(buffer: bytes, offset: int) -> tuple[dict[str, str], int]:
        data, offset = counted.read(buffer, offset)
        return {"hex": data.hex()}, offset

    def write(value: Any, out: bytearray) -> None:
        counted.write(_bytes_of(_by_message(as_object(value)), encode_inner), out)

    return Codec(read, write)


def formatted_of(kind: wire.FormattedOctets, encode_message: EncodeMessage) -> Codec:
    """Returns the codec of bytes with a format, as `{"format": ..., "hex": ...}`."""
    counted = _counted(kind.count)
    names = kind.names
    named = named_values(names)
    ranges = tuple((index, index) for index in sorted(names))
    of_messages = [index for index in names if kind.holds_message(index)]

    def read(buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        if offset >= len(buffer):
            raise too_short(1, buffer, offset).inside("format")
        try:
            data, end = counted.read(buffer, offset + 1)
        except DecodeError as error:
            raise error.inside("hex") from None
        index = buffer[offset]
        return {"format": named.get(index, index), "hex": data.hex()}, end

    def write(value: Any, out: bytearray) -> None:
        fields = _by_message(as_object(value))
        if MESSAGE in fields and len(of_messages) == 1:
            fields = {"format": of_messages[0], **fields}
        known = ("format", "hex", MESSAGE)
        check_names(fields, known, ("format",), lambda _: formats_in_words(kind))
        try:
            index = legal_integer(fields["format"], ranges, names)
        except EncodeError as error:
            raise error.inside("format") from None
        out.append(index)
        encode_inner = encode_message if kind.holds_message(index) else None
        counted.write(_bytes_of(fields, encode_inner, "format"), out)

    return Codec(read, write)


def _by_message(fields: dict[str, Any]) -> dict[str, Any]:
    """Returns an object in which `{NAME: FIELDS}`, alone, has become a message of this name."""
    others = [name for name in fields if name not in ("format", "hex", MESSAGE)]
    is_given = "hex" in fields or MESSAGE in fields
    if is_given or len(others) != 1 or not isinstance(fields[others[0]], dict):
        return fields
    message = {MESSAGE: others[0], "fields": fields[others[0]]}
    return {name: value for name, value in fields.items() if name != others[0]} | {MESSAGE: message}


def _bytes_of(fields: Mapping[str, Any], encode_inner: EncodeMessage | None, *more: str) -> bytes:
    """Returns the bytes that an object of a byte field describes.

    Args:
        fields: The object: `hex`, and for an embedded message its decoded form, which counts only
            when there is no `hex`.
    """
    known = ("hex", *more) if encode_inner is None else ("hex", MESSAGE, *more)
    encode = encode_inner if MESSAGE in fields and "hex" not in fields else None
    instead = "" if encode_inner is None else f", or {MESSAGE} in its stead an object of one"
    needed = ("hex",) if encode is None else ()
    check_names(fields, known, needed, lambda _: f"bytes in hexadecimal{instead}")
    if encode is not None:
        try:
            return encode(fields[MESSAGE])
        except EncodeError as error:
            raise error.inside(MESSAGE) from None
    text = fields["hex"]
    if not isinstance(text, str):
        raise EncodeError(f"{shown(text)} is not a string", "hex")
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise EncodeError(f"{shown(text)} is not hexadecimal", "hex") from None


def variable_of(kind: wire.VariableNumber) -> Codec:
    """Returns the codec of a number of some type, as `{"index": ..., "value": ...}`.

    It also takes `{UNIT: value}` and `"value UNIT"`, where the unit tells the index.
    """
    kinds_by_index = kind.by_index.items()
    numbers = {index: Named("value", single(item_of(number))) for index, number in kinds_by_index}
    known = f"known are {', '.join(map(str, numbers))}"

    def read(buffer: bytes, offset: int) -> tuple[dict[str, Any], int]:
        if offset >= len(buffer):
            raise too_short(1, buffer, offset).inside("index")
        index = buffer[offset]
        if index not in numbers:
            raise DecodeError(f"{index} names no type, {known}", "index")
        fields: dict[str, Any] = {"index": index}
        return fields, numbers[index].read(fields, buffer, offset + 1)

    by_unit = {
        unit: alternative.index for alternative in kind.alternatives for unit in _units(alternative)
    }

    def write(value: Any, out: bytearray) -> None:
        fields = as_object(_indexed(value, by_unit))
        check_names(fields, ("index", "value"), ("index", "value"))
        index = fields["index"]
        if type(index) is not int or index not in numbers:
            raise EncodeError(f"{shown(index)} names no type, {known}", "index")
        out.append(index)
        numbers[index].write(fields, out)

    return Codec(read, write)


def _units(alternative: wire.Alternative) -> set[str]:
    """Returns the words by which an alternative may be chosen."""
    unit = alternative.number.units
    return {alternative.name, unit, symbol(unit)} - {""}


def _indexed(value: Any, by_unit: Mapping[str, int]) -> Any:
    """Returns a value with the index of its unit; other values as they are."""
    if isinstance(value, dict) and len(value) == 1:
        ((unit, number),) = value.items()
        if unit not in (*by_unit, "index", "value"):
            hint = (
                did_you_mean(similar(str(unit), by_unit)) or f"; it may be {listed(list(by_unit))}"
            )
            raise EncodeError(f"unknown field{hint}", str(unit))
        return {"index": by_unit[unit], "value": number} if unit in by_unit else value
    unit = value.partition(" ")[2] if isinstance(value, str) else ""
    return {"index": by_unit[unit], "value": number_of(value, unit)} if unit in by_unit else value
