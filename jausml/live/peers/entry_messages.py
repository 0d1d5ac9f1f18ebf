"""Messages of the catalogue in the shape that the runtime's components send and receive."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

from jausml.live.messages import AmbiguousMessageError, MessageError, UnknownMessageError
from jausml.runtime.wire.message import DecodeError, EncodeError, Message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.runtime.services.definitions import ServiceIdentity


class EntryMessage(Message):
    """A message whose layout comes from the catalogue instead of generated code.

    Attributes:
        fields: The fields in the shapes of `MessageEntry.decode`.
    """

    __slots__ = ("fields",)

    ENTRY: ClassVar[MessageEntry]

    def __init__(self, fields: dict[str, Any] | None = None) -> None:
        """Makes a message."""
        self.fields: dict[str, Any] = {} if fields is None else fields

    def encode(self) -> bytes:
        """Returns the message code and the body as bytes.

        Raises:
            EncodeError: A field is absent, unknown or not legal.
        """
        try:
            return self.ENTRY.encode(self.fields)
        except MessageError as error:
            raise EncodeError(self.NAME, str(error)) from error

    @classmethod
    def decode(cls, payload: bytes) -> EntryMessage:
        """Returns the message that the bytes hold."""
        try:
            return cls(cls.ENTRY.decode(payload))
        except MessageError as error:
            raise DecodeError(cls.NAME, str(error)) from error


@lru_cache(maxsize=1024)
def message_class(entry: MessageEntry) -> type[EntryMessage]:
    """Returns the class of a message of the catalogue; always the same one for an entry."""
    body = {"__slots__": (), "ENTRY": entry, "CODE": entry.code, "NAME": entry.name}
    return type(entry.name, (EntryMessage,), body)


def find_message(
    catalogue: Catalogue, name: str, services: Sequence[ServiceIdentity] = ()
) -> MessageEntry:
    """Returns the message of a name or code.

    Args:
        services: Services of the component that the message is for; of several messages of one
            name that of these services is meant.

    Raises:
        MessageError: There is none, or there are several.
    """
    try:
        return catalogue.message(name)
    except AmbiguousMessageError:
        for service in services:
            label = f"{service.urn}/{service.major}.{service.minor}"
            try:
                return catalogue.message(name, label)
            except MessageError:
                continue
        raise


def find_exchange(
    catalogue: Catalogue, name: str, services: Sequence[ServiceIdentity] = ()
) -> tuple[MessageEntry, MessageEntry]:
    """Returns the query and the report that a name means.

    Args:
        name: Name or code of the query or of the report, or what both names have in common,
            e.g. `VelocityState`.
    """
    topic = name.removeprefix("Query").removeprefix("Report")
    query = _first(catalogue, (f"Query{topic}", name), services)
    if query.name.startswith("Report"):  # by its code
        query = _first(catalogue, (query.name.replace("Report", "Query", 1), query.name), services)
    if not query.name.startswith("Query"):
        raise UnknownMessageError(f"{query.name} is no query, and none is known for it")
    topic = query.name.removeprefix("Query")
    return query, _first(catalogue, (f"Report{topic}", topic), services)


def _first(
    catalogue: Catalogue, names: Sequence[str], services: Sequence[ServiceIdentity]
) -> MessageEntry:
    for name in names[:-1]:
        try:
            return find_message(catalogue, name, services)
        except UnknownMessageError:
            continue
    return find_message(catalogue, names[-1], services)
