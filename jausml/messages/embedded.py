"""Messages inside messages: in byte fields that hold a message code and a body."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.messages.blobs import MESSAGE, FormattedOctets, Octets
from jausml.messages.containers import TAG, Array, List, Record, Variant
from jausml.messages.errors import MessageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.messages.codec import Codec
    from jausml.messages.entries import MessageEntry, ServiceEntry

MAXIMUM_DEPTH = 8


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
        embedded: The messages inside it, in their order.
    """

    entry: MessageEntry
    fields: dict[str, Any]
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

    def to_json(self, service: ServiceEntry | None = None) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it and `Catalogue.encode` takes it.

        Args:
            service: The service to name; by default the first that defines the message.
        """
        named = service or self.entry.services[0]
        return {
            "message": self.entry.name,
            "code": self.entry.code_text,
            "service": named.urn,
            "service_version": named.version,
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
    if not may_hold(entry.codec):
        return ()
    found = []
    for path, holder in holders(entry.codec, fields):
        try:
            found.append(EmbeddedMessage(path, decode(bytes.fromhex(holder["hex"]))))
        except MessageError as error:
            found.append(EmbeddedMessage(path, None, str(error)))
    return tuple(found)


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
