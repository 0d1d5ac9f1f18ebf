"""Messages inside messages: in byte fields that hold a message code and a body."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import MESSAGE, FormattedOctets, Octets
from jausml.live.messages.containers import TAG, Array, List, Record, Variant
from jausml.live.messages.errors import MessageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.live.messages.codec import Codec
    from jausml.live.messages.entries import MessageEntry, ServiceEntry

MAXIMUM_DEPTH = 8
"""Messages inside messages that are decoded; what stands deeper remains hex."""


@dataclass(frozen=True)
class EmbeddedMessage:
    """A message inside another.

    Attributes:
        path: Path of the field that holds it.
        message: The message, None when it cannot be decoded.
        error: Why it cannot be decoded, empty when it can.
    """

    path: str
    message: DecodedMessage | None
    error: str = ""

    def to_json(self) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it, or an object with the error."""
        return self.message.to_json() if self.message is not None else {"error": self.error}


@dataclass(frozen=True)
class DecodedMessage:
    """A message with its fields.

    Attributes:
        entry: What the catalogue says of it.
        fields: The fields of its body.
        service: The service that is named with it, one of the entry's.
        embedded: The messages inside it, in their order.
    """

    entry: MessageEntry
    fields: dict[str, Any]
    service: ServiceEntry
    embedded: tuple[EmbeddedMessage, ...] = ()

    def fields_with_messages(self) -> dict[str, Any]:
        """Returns the fields; beside the `hex` of an embedded message stands its `message`."""
        if not self.embedded:
            return self.fields
        fields = deepcopy(self.fields)
        for (_, holder), found in zip(
            holders(self.entry.codec, fields), self.embedded, strict=True
        ):
            holder[MESSAGE] = found.to_json()
        return fields

    def to_json(self) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it and `Catalogue.encode` takes it."""
        return {
            "message": self.entry.name,
            "code": self.entry.code_text,
            "service": self.service.urn,
            "service_version": self.service.version,
            "fields": self.fields_with_messages(),
        }


def decode_embedded(
    entry: MessageEntry,
    fields: dict[str, Any],
    decode: Callable[[bytes], DecodedMessage],
) -> tuple[EmbeddedMessage, ...]:
    """Returns the messages inside a message; what cannot be decoded says why.

    Args:
        entry: What the catalogue says of the message.
        fields: Its fields.
        decode: Decodes a payload.
    """
    if not entry.may_hold_messages:
        return ()
    found = []
    for path, holder in holders(entry.codec, fields):
        try:
            found.append(EmbeddedMessage(path, decode(bytes.fromhex(holder["hex"]))))
        except MessageError as error:
            found.append(EmbeddedMessage(path, None, str(error)))
    return tuple(found)


def holders(codec: Codec, value: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Yields the objects of a decoded field that hold a message, with their paths.

    Args:
        codec: The codec of the field.
        value: Its decoded value.
        path: Path of the field.
    """
    if isinstance(codec, Octets):
        if codec.holds_message:
            yield path, value
    elif isinstance(codec, FormattedOctets):
        if codec.holds_message(value["format"]):
            yield path, value
    else:
        for step, inner, part in _parts(codec, value):
            joint = "" if not path or step.startswith("[") else "."
            yield from holders(inner, part, f"{path}{joint}{step}")


def _parts(codec: Codec, value: Any) -> Iterator[tuple[str, Codec, Any]]:
    """Yields the fields inside a decoded field: their names or indices, codecs and values."""
    if isinstance(codec, Record):
        for name, inner, _ in codec.members:
            if name in value:
                yield name, inner, value[name]
    elif isinstance(codec, (List, Array)):
        for index, item in enumerate(value):
            yield f"[{index}]", codec.element, item
    elif isinstance(codec, Variant) and codec.options:
        name, inner = codec.options[value[TAG]]
        yield name, inner, value[name]
