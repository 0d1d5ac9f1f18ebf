"""The plainest legal value of a field, to make a query of which only the code matters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.messages.blobs import FormattedOctets, Octets, Text, VariableNumber
from jausml.messages.containers import Array, List, Record, Variant
from jausml.messages.scalars import BitField, FixedText, Integer, Real, Scaled

if TYPE_CHECKING:
    from jausml.messages.codec import Codec


def sample(codec: Codec) -> Any:
    """Returns a legal value in the shape that `MessageEntry.encode` takes.

    Numbers are the smallest legal ones (0 if legal), optional members are left out, lists are as
    short as they may be.

    Args:
        codec: The codec of the field.
    """
    if isinstance(codec, Record):
        return {each.name: sample(each.codec) for each in codec.members if not each.bit}
    if isinstance(codec, List):
        return [sample(codec.element) for _ in range(codec.counted.lower)]
    if isinstance(codec, Array):
        return [sample(codec.element) for _ in range(codec.count)]
    if isinstance(codec, Variant):
        if not codec.options:
            return {"_tag": 0}
        name, option = codec.options[0]
        return {"_tag": 0, name: sample(option)}
    return _leaf(codec)


def _leaf(codec: Codec) -> Any:
    if isinstance(codec, Integer):
        return _smallest(codec.ranges)
    if isinstance(codec, Scaled | Real):
        return min(max(0.0, codec.lower), codec.upper)
    if isinstance(codec, BitField):
        return {group.name: _smallest(group.ranges) for group in codec.groups}
    if isinstance(codec, Octets):
        return {"hex": bytes(codec.counted.lower).hex()}
    if isinstance(codec, FormattedOctets):
        return {"format": min(codec.formats), "hex": bytes(codec.counted.lower).hex()}
    if isinstance(codec, VariableNumber):
        index = min(codec.alternatives)
        return {"index": index, "value": sample(codec.alternatives[index])}
    if isinstance(codec, Text):
        return " " * codec.counted.lower
    if isinstance(codec, FixedText):
        return ""
    raise TypeError(f"no sample of a {type(codec).__name__}")


def _smallest(ranges: tuple[tuple[int, int], ...]) -> int:
    legal_zero = any(low <= 0 <= high for low, high in ranges)
    return 0 if legal_zero else ranges[0][0]
