"""Messages of Events: reports that are sent periodically or at every change (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, ClassVar

from ..wire.codec import (
    U8,
    U16,
    U32,
    Counted,
    ShortList,
    Tagged,
    fixed_text,
    scaled_unsigned,
    unsigned,
)
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message

_Rate = Annotated[float, scaled_unsigned(1092.0)]  # hertz
_Payload = Annotated[bytes, Counted("I", least=2)]  # a message: its code and body
_EventType = Annotated[int, unsigned(1, upper=1)]


@message(0x01F0)
@dataclass(slots=True, repr=False, eq=False)
class CreateEvent(Message):
    """Requests the answer to a query periodically or at every change."""

    class EventType(IntEnum):
        PERIODIC_SC = 0
        EVERY_CHANGE = 1

    request_id: U8 = 0
    event_type: _EventType = 0
    requested_periodic_rate: _Rate = 0.0
    query_message: _Payload = b""


@message(0x01F1)
@dataclass(slots=True, repr=False, eq=False)
class UpdateEvent(Message):
    """Changes an event, which also renews it."""

    EventType = CreateEvent.EventType

    request_id: U8 = 0
    event_type: _EventType = 0
    requested_periodic_rate: _Rate = 0.0
    event_id: U8 = 0
    query_message: _Payload = b""


@message(0x01F2)
@dataclass(slots=True, repr=False, eq=False)
class CancelEvent(Message):
    """Ends an event."""

    request_id: U8 = 0
    event_id: U8 = 0


@message(0x01F3)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmEventRequest(Message):
    """Confirms CreateEvent, UpdateEvent or CancelEvent, with the granted rate."""

    request_id: U8 = 0
    event_id: U8 = 0
    confirmed_periodic_rate: _Rate = 0.0


@message(0x01F4)
@dataclass(slots=True, repr=False, eq=False)
class RejectEventRequest(Message):
    """Rejects CreateEvent, UpdateEvent or CancelEvent."""

    class ResponseCode(IntEnum):
        PERIODIC_EVENTS_NOT_SUPPORTED = 1
        CHANGE_BASED_EVENTS_NOT_SUPPORTED = 2
        CONNECTION_REFUSED = 3
        INVALID_EVENT_SETUP = 4
        MESSAGE_NOT_SUPPORTED = 5
        ERROR_INVALID_EVENT_ID_FOR_UPDATE_EVENT_REQUEST = 6

    request_id: U8 = 0
    response_code: Annotated[int, unsigned(1, 1, 6)] | None = None
    error_message: Annotated[str, fixed_text(80)] | None = None


@message(0x01F6)
@dataclass(slots=True, repr=False, eq=False)
class CreateCommandEvent(Message):
    """Requests the execution of a command, whose result is sent by CommandEvent."""

    request_id: U8 = 0
    maximum_allowed_duration: U32 = 0  # seconds
    command_message: _Payload = b""


@message(0x21F0)
@dataclass(slots=True, repr=False, eq=False)
class QueryEvents(Message):
    """Asks for the events of a query, of a type, of an id, or for all."""

    EventType = CreateEvent.EventType

    @record("QueryEvents.MessageIDRec")
    @dataclass(slots=True)
    class MessageIDRec:
        """Events of a query, by its code."""

        TAG: ClassVar[int] = 0

        message_code: U16 = 0

    @record("QueryEvents.EventTypeRec")
    @dataclass(slots=True)
    class EventTypeRec:
        """Events of a type."""

        TAG: ClassVar[int] = 1

        event_type: _EventType = 0

    @record("QueryEvents.EventIDRec")
    @dataclass(slots=True)
    class EventIDRec:
        """One event."""

        TAG: ClassVar[int] = 2

        event_id: U8 = 0

    @record("QueryEvents.AllEventsRec")
    @dataclass(slots=True)
    class AllEventsRec:
        """All events."""

        TAG: ClassVar[int] = 3

        all_events: Annotated[int, unsigned(1, upper=0)] = 0

    QueryEventsVar = MessageIDRec | EventTypeRec | EventIDRec | AllEventsRec

    query_events_var: Annotated[QueryEventsVar, Tagged("QueryEvents.QueryEventsVar")] = field(
        default_factory=MessageIDRec
    )


@message(0x21F2)
class QueryEventTimeout(Bodiless):
    __slots__ = ()


@message(0x41F0)
@dataclass(slots=True, repr=False, eq=False)
class ReportEvents(Message):
    """Reports the selected events."""

    EventType = CreateEvent.EventType

    @record("ReportEvents.ReportEventRec")
    @dataclass(slots=True)
    class ReportEventRec:
        """An event, with the query that it answers."""

        event_type: _EventType = 0
        event_id: U8 = 0
        query_message: _Payload = b""

    event_list: ShortList[ReportEventRec] = field(default_factory=list)


@message(0x41F1)
@dataclass(slots=True, repr=False, eq=False)
class Event(Message):
    """Sends the report of an event."""

    event_id: U8 = 0
    sequence_number: U8 = 0
    report_message: _Payload = b""


@message(0x41F2)
@dataclass(slots=True, repr=False, eq=False)
class ReportEventTimeout(Message):
    """Reports the time after which an event lapses, unless it is updated."""

    class Timeout(IntEnum):
        TIMEOUT_FEATURE_DISABLED = 0

    timeout: U8 = 0  # minutes


@message(0x41F6)
@dataclass(slots=True, repr=False, eq=False)
class CommandEvent(Message):
    """Reports the result of a command of CreateCommandEvent."""

    class CommandResult(IntEnum):
        SUCCESSFUL = 0
        UNSUCCESSFUL = 1

    event_id: U8 = 0
    command_result: Annotated[int, unsigned(1, upper=1)] = 0
