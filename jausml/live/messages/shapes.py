"""Questions to a codec as a whole: whether it equals another, whether it can hold a message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.containers import Array, List, Record, Variant
from jausml.live.messages.scalars import BitField, Integer, Real, Scaled

if TYPE_CHECKING:
    from jausml.live.messages.blobs import Counted
    from jausml.live.messages.codec import Codec


def shape(codec: Codec) -> tuple[Any, ...]:
    """Returns a value that is equal for two codecs which decode and encode the same.

    Units and the names of values do not count.

    Args:
        codec: The codec.
    """
    if isinstance(codec, Record):
        presence = codec.presence.format if codec.presence is not None else ""
        members = tuple((name, shape(inner), bit) for name, inner, bit in codec.members)
        return ("record", presence, members)
    if isinstance(codec, List):
        return ("list", _counted(codec.counted), shape(codec.element))
    if isinstance(codec, Array):
        return ("array", codec.count, shape(codec.element))
    if isinstance(codec, Variant):
        options = tuple((name, shape(inner)) for name, inner in codec.options)
        return ("variant", codec.tag.format, options)
    if isinstance(codec, VariableNumber):
        return ("number", tuple((i, shape(inner)) for i, inner in codec.alternatives.items()))
    return _leaf(codec)


def _leaf(codec: Codec) -> tuple[Any, ...]:
    if isinstance(codec, Text):
        return ("text", _counted(codec.counted))
    if isinstance(codec, Octets):
        return ("octets", _counted(codec.counted), codec.holds_message)
    if isinstance(codec, FormattedOctets):
        indices = tuple((index, codec.holds_message(index)) for index in codec.formats)
        return ("formatted", _counted(codec.counted), indices)
    if isinstance(codec, Integer):
        return ("integer", codec.format, codec.ranges, codec.offset)
    if isinstance(codec, Real):
        return ("real", codec.format, codec.lower, codec.upper)
    if isinstance(codec, Scaled):
        return ("scaled", codec.format, codec.lower, codec.upper, codec.rounding)
    if isinstance(codec, BitField):
        groups = tuple(
            (each.name, each.low, each.mask, each.ranges, each.offset) for each in codec.groups
        )
        return ("bits", codec.format, groups)
    return (type(codec).__name__, getattr(codec, "format", ""))


def _counted(counted: Counted) -> tuple[str, int, int]:
    return (counted.count_format, counted.lower, counted.upper)


def may_hold(codec: Codec) -> bool:
    """Tells whether a field can hold a message.

    Args:
        codec: The codec of the field.
    """
    if isinstance(codec, Record):
        return any(may_hold(member.codec) for member in codec.members)
    if isinstance(codec, (List, Array)):
        return may_hold(codec.element)
    if isinstance(codec, Variant):
        return any(may_hold(option) for _, option in codec.options)
    if isinstance(codec, FormattedOctets):
        return any(map(codec.holds_message, codec.formats))
    return isinstance(codec, Octets) and codec.holds_message
