"""Fields of queries: so plain that only the code matters, or so that all is asked for."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from jausml.language import wire
from jausml.language.semantics.answers import PRESENCE_VECTOR
from jausml.live.messages.samples import sample

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.live.messages import MessageEntry

_EVERYTHING = {"NodeRec": {"NodeID": 255}, "ComponentList": [{"ComponentID": 255}]}
_TELLING_FIELDS: dict[str, dict[str, Any]] = {
    "QueryIdentification": {"QueryIdentificationRec": {"QueryType": 4}},
    "QueryConfiguration": {"QueryConfigurationRec": {"QueryType": 3}},
    "QueryServices": {"NodeList": [_EVERYTHING]},
    "QueryServiceList": {
        "SubsystemList": [{"SubsystemRec": {"SubsystemID": 65535}, "NodeList": [_EVERYTHING]}]
    },
    "QueryEvents": {"QueryEventsVar": {"_tag": 3, "AllEventsRec": {"AllEvents": 0}}},
}
"""Fields with which the core queries are answered with more than an empty report (AS5710)."""


def plain_query(query: MessageEntry) -> dict[str, Any]:
    """Returns fields with which a query is answered with something, as far as we can know.

    Args:
        query: The query.
    """
    if query.name in _TELLING_FIELDS:
        return deepcopy(_TELLING_FIELDS[query.name])
    fields: dict[str, Any] = sample(query.record)
    return fields


def full_query(query: MessageEntry, report: MessageEntry) -> dict[str, Any]:
    """Returns the fields of a query that asks for everything its report may hold.

    Args:
        query: The query.
        report: Its report.
    """
    fields = plain_query(query)
    holder = presence_holder(fields)
    if holder is not None:
        holder[PRESENCE_VECTOR] = optional_bits([report])
    return fields


def presence_holder(fields: Any) -> dict[str, Any] | None:
    """Returns the object of a query's fields that holds its presence vector, if it has one.

    Args:
        fields: The fields of a query.
    """
    if not isinstance(fields, dict):
        return None
    if isinstance(fields.get(PRESENCE_VECTOR), int):
        return fields
    found = (presence_holder(value) for value in fields.values())
    return next((each for each in found if each is not None), None)


def optional_bits(reports: Sequence[MessageEntry]) -> int:
    """Returns the presence vector with all bits of the first record that has optional fields.

    Args:
        reports: Reports that may answer a query.
    """
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
