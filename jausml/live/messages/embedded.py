"""Messages inside messages: in byte fields that hold a message code and a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from jausml.language import wire
from jausml.live.messages.codec import TAG
from jausml.live.messages.counted import MESSAGE
from jausml.live.messages.errors import MessageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.live.messages.entries import MessageEntry, ServiceEntry

MAXIMUM_DEPTH = 8
"""Messages inside messages that are decoded; what stands deeper remains hex."""


@dataclass(frozen=True)
class DecodedMessage:
    """A message with its fields."""

    entry: MessageEntry
    fields: dict[str, Any]
    service: ServiceEntry

    def to_json(self) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it and `Catalogue.encode` takes it."""
        return {
            "message": self.entry.name,
            "code": self.entry.code_text,
            "service": self.service.urn,
            "service_version": self.service.version,
            "fields": self.fields,
        }


class EmbeddedMessage(dict[str, Any]):
    """A message inside another, as `DecodedMessage.to_json` has it.

    Attributes:
        decoded: The message; None when it cannot be decoded, and the object says why.
    """

    def __init__(self, decoded: DecodedMessage | None, error: str = "") -> None:
        super().__init__({"error": error} if decoded is None else decoded.to_json())
        self.decoded = decoded


class DecodeMessage(Protocol):
    """Decodes an embedded message; None leaves it as it is."""

    def __call__(self, payload: bytes, /) -> DecodedMessage | None:
        """Returns the message of a payload."""


def as_it_is(_payload: bytes, /) -> None:
    """Decodes no embedded message."""


def put_in_place(record: wire.Record, fields: dict[str, Any], decode: DecodeMessage) -> None:
    """Puts messages in the place of their hex; what cannot be decoded stays, and says why."""
    for holder in holders(record, fields):
        try:
            found = decode(bytes.fromhex(holder["hex"]))
        except MessageError as error:
            holder[MESSAGE] = EmbeddedMessage(None, str(error))
            continue
        if found is not None:
            del holder["hex"]
            holder[MESSAGE] = EmbeddedMessage(found)


def shortened(value: Any) -> Any:
    """Returns a value in which messages have the fields of `MessageEntry.shortened`."""
    match value:
        case EmbeddedMessage(decoded=DecodedMessage() as decoded):
            return {**value, "fields": decoded.entry.shortened(decoded.fields)}
        case dict():
            return {name: shortened(each) for name, each in value.items()}
        case list():
            return [shortened(each) for each in value]
        case _:
            return value


def holds(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> bool:
    """Tells whether a decoded byte field holds a message."""
    if isinstance(kind, wire.Octets):
        return kind.holds_message
    return kind.holds_message(int(value["format"]))


def holders(kind: wire.Kind, value: Any) -> Iterator[dict[str, Any]]:
    """Yields the objects of a decoded field that hold a message."""
    if isinstance(kind, wire.Octets | wire.FormattedOctets):
        if holds(kind, value):
            yield value
        return
    for _, inner, part in parts(kind, value):
        yield from holders(inner, part)


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
