"""Messages inside of messages: which fields can hold one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.messages.blobs import FormattedOctets, Octets
from jausml.live.messages.containers import Array, List, Record, Variant

if TYPE_CHECKING:
    from jausml.live.messages.codec import Codec


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
