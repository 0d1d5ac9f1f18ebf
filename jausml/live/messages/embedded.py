"""Messages inside messages: in byte fields that hold a message code and a body."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language import wire
from jausml.live.messages.codec import TAG
from jausml.live.messages.counted import MESSAGE
from jausml.live.messages.errors import MessageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from jausml.live.messages.entries import MessageEntry, ServiceEntry

MAXIMUM_DEPTH = 8
"""Messages inside messages that are decoded; what stands deeper remains hex."""


@dataclass(frozen=True)
class EmbeddedMessage:
    """A message inside another.

    Attributes:
        message: The message, None when it cannot be decoded.
    """

    path: str
    message: DecodedMessage | None
    error: str = ""

    def to_json(self) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it, or an object with the error."""
        return self.message.to_json() if self.message is not None else {"error": self.error}


@dataclass(frozen=True)
class DecodedMessage:
    """A message with its fields."""

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
            holders(self.entry.record, fields), self.embedded, strict=True
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
    """Returns the messages inside a message; what cannot be decoded says why."""
    if not entry.may_hold_messages:
        return ()
    found = []
    for path, holder in holders(entry.record, fields):
        try:
            found.append(EmbeddedMessage(path, decode(bytes.fromhex(holder["hex"]))))
        except MessageError as error:
            found.append(EmbeddedMessage(path, None, str(error)))
    return tuple(found)


def holds(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> bool:
    """Tells whether a decoded byte field holds a message."""
    if isinstance(kind, wire.Octets):
        return kind.holds_message
    return kind.holds_message(value["format"])


def holders(kind: wire.Kind, value: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Yields the objects of a decoded field that hold a message, with their paths."""
    if isinstance(kind, wire.Octets | wire.FormattedOctets):
        if holds(kind, value):
            yield path, value
        return
    for step, inner, part in parts(kind, value):
        joint = "" if not path or step.startswith("[") else "."
        yield from holders(inner, part, f"{path}{joint}{step}")


def parts(kind: wire.Kind, value: Any) -> Iterator[tuple[str, wire.Kind, Any]]:
    """Yields the fields inside a decoded field: their names or `[index]`, kinds and values."""
    match kind:
        case wire.Record():
            for member in kind.members:
                if member.name in value:
                    yield member.name, member.kind, value[member.name]
        case wire.List() | wire.Array():
            for index, item in enumerate(value):
                yield f"[{index}]", kind.element.kind, item
        case wire.Variant() if kind.options:
            option = kind.options[value[TAG]]
            yield option.name, option.kind, value[option.name]
        case _:
            pass  # a leaf
