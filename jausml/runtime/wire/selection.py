"""The fields of a report that a query asks for."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .message import Message, MessageT


def asked_for(query: Message, report: MessageT) -> MessageT:
    """Returns the report without the optional fields that its query does not ask for.

    The field PresenceVector of a query names the optional fields of the report, by the bits of the
    report's own presence vector (AS5710, AS6009, queries). A query without that field asks for all.

    Args:
        report: What the component has to report; it is not changed.
    """
    wanted = _wanted(query)
    if wanted is None:
        return report
    message_class: type = type(report)
    names = optional_fields(message_class)
    if not ~wanted & (1 << len(names)) - 1:
        return report
    left_out = {
        name: None
        for bit, name in enumerate(names)
        if not wanted >> bit & 1 and getattr(report, name) is not None
    }
    return replace(report, **left_out) if left_out else report  # type: ignore[type-var]


def asked_for_in(query: Message, report_class: type[Message], report: bytes) -> bytes:
    """Returns an encoded report without the optional fields that its query does not ask for.

    Args:
        report: Message code and body. It is read only where the query may leave something out.

    Raises:
        DecodeError: The report is of another message, or cannot be read.
        EncodeError: A value of the report does not fit its field.
    """
    report_class.check_code(report)
    if asks_for_all(query, report_class):
        return report
    whole = report_class.decode(report)
    part = asked_for(query, whole)
    return report if part is whole else part.encode()


def asks_for_all(query: Message, report_class: type[Message]) -> bool:
    """Returns whether a query asks for every field that its report can have."""
    wanted = _wanted(query)
    message_class: type = report_class
    every = (1 << len(optional_fields(message_class))) - 1
    return wanted is None or wanted & every == every


def _wanted(query: Message) -> int | None:
    """Returns the presence vector of the report that a query asks for, or None for all."""
    wanted = getattr(query, "presence_vector", None)
    return wanted if isinstance(wanted, int) else None


@cache
def optional_fields(message_class: type) -> tuple[str, ...]:
    """Returns the attributes of a message's optional fields in the order of their presence bits.

    Args:
        message_class: Generated codec; its optional fields, and they alone, default to None.
    """
    if not is_dataclass(message_class):
        return ()
    return tuple(field.name for field in fields(message_class) if field.default is None)
