"""Messages of the catalogue as classes that components of the runtime send and receive.

It also finds messages by names, and fills the fields of queries.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import deepcopy
from functools import lru_cache
from typing import Any, ClassVar

from jausml.language import wire
from jausml.language.wire.kinds import PRESENCE_VECTOR
from jausml.live.messages import (
    AmbiguousMessageError,
    Catalogue,
    MessageEntry,
    MessageError,
    UnknownMessageError,
)
from jausml.live.messages.text import sample
from jausml.live.peers.discovery import label_of
from jausml.runtime.services.definitions import ServiceIdentity
from jausml.runtime.wire.message import DecodeError, EncodeError, Message

_EVERYTHING = {"NodeRec": {"NodeID": 255}, "ComponentList": [{"ComponentID": 255}]}

# Fields of core queries whose reports would be empty otherwise (AS5710).
_QUERY_FIELDS: dict[str, dict[str, Any]] = {
    "QueryIdentification": {"QueryIdentificationRec": {"QueryType": 4}},
    "QueryConfiguration": {"QueryConfigurationRec": {"QueryType": 3}},
    "QueryServices": {"NodeList": [_EVERYTHING]},
    "QueryServiceList": {
        "SubsystemList": [{"SubsystemRec": {"SubsystemID": 65535}, "NodeList": [_EVERYTHING]}]
    },
    "QueryEvents": {"QueryEventsVar": {"_tag": 3, "AllEventsRec": {"AllEvents": 0}}},
}


class EntryMessage(Message):
    """A message with the layout of an entry of the catalogue instead of generated code."""

    __slots__ = ("fields",)

    ENTRY: ClassVar[MessageEntry]

    def __init__(self, fields: dict[str, Any] | None = None) -> None:
        self.fields: dict[str, Any] = {} if fields is None else fields

    def encode(self) -> bytes:
        """Returns the message code and the body as bytes (`EncodeError`: a field is wrong)."""
        try:
            return self.ENTRY.encode(self.fields)
        except MessageError as error:
            raise EncodeError(self.NAME, str(error)) from error

    @classmethod
    def decode(cls, payload: bytes) -> EntryMessage:
        """Returns the message in a payload (`DecodeError`: it is none)."""
        try:
            return cls(cls.ENTRY.decode(payload))
        except MessageError as error:
            raise DecodeError(cls.NAME, str(error)) from error


@lru_cache(maxsize=1024)
def message_class(entry: MessageEntry) -> type[EntryMessage]:
    """Returns the class of a message of the catalogue."""
    body = {"__slots__": (), "ENTRY": entry, "CODE": entry.code, "NAME": entry.name}
    return type(entry.name, (EntryMessage,), body)


def find_message(
    catalogue: Catalogue, name: str, services: Sequence[ServiceIdentity] = ()
) -> MessageEntry:
    """Returns the message of a name or code.

    Args:
        services: Services of the receiver, to choose among several messages of one name.

    Raises:
        MessageError: There is none, or there are several.
    """
    try:
        return catalogue.message(name)
    except AmbiguousMessageError:
        for service in services:
            try:
                return catalogue.message(name, label_of(service))
            except MessageError:
                continue
        raise


def find_exchange(
    catalogue: Catalogue, name: str, services: Sequence[ServiceIdentity] = ()
) -> tuple[MessageEntry, MessageEntry]:
    """Returns the query and its report for a name.

    Args:
        name: Name or code of the query or of the report, or the common part of both names,
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


def plain_query(query: MessageEntry) -> dict[str, Any]:
    """Returns fields of a query for which its report is not empty, as far as known."""
    if query.name in _QUERY_FIELDS:
        return deepcopy(_QUERY_FIELDS[query.name])
    fields: dict[str, Any] = sample(query.record)
    return fields


def full_query(query: MessageEntry, report: MessageEntry) -> dict[str, Any]:
    """Returns the fields of a query that requests all optional fields of its report."""
    fields = plain_query(query)
    holder = presence_holder(fields)
    if holder is not None:
        holder[PRESENCE_VECTOR] = optional_bits([report])
    return fields


def presence_holder(fields: Any) -> dict[str, Any] | None:
    """Returns the object with the presence vector in the fields of a query, if there is one."""
    if not isinstance(fields, dict):
        return None
    if isinstance(fields.get(PRESENCE_VECTOR), int):
        return fields
    holders = (presence_holder(value) for value in fields.values())
    return next((holder for holder in holders if holder is not None), None)


def optional_bits(reports: Sequence[MessageEntry]) -> int:
    """Returns all presence bits of the first record of reports that has optional fields."""
    for report in reports:
        for record in _records(report.record):
            if record.known_bits:
                return record.known_bits
    return 0


def _records(kind: wire.Kind) -> Iterator[wire.Record]:
    if isinstance(kind, wire.Record):
        yield kind
        for member in kind.members:
            yield from _records(member.kind)
