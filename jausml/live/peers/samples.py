"""Plainest legal values of fields, to make a query of which only the code matters."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.containers import Array, List, Record, Variant
from jausml.live.messages.scalars import BitField, FixedText, Integer, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.live.messages import MessageEntry
    from jausml.live.messages.codec import Codec


PRESENCE_VECTOR = "PresenceVector"
"""Field of a query that names the optional fields which the report shall hold (AS6009)."""

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
    fields: dict[str, Any] = sample(query.codec)
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
        for record in _records(report.codec):
            bits = sum(member.bit for member in record.members)
            if bits:
                return bits
    return 0


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


def _records(codec: Any) -> Iterator[Record]:
    if isinstance(codec, Record):
        yield codec
        for member in codec.members:
            yield from _records(member.codec)
