"""Messages of a component's control, states, heartbeat and clock (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, TypeAlias

from ..wire.codec import U8, U16, U32, StampedMessage, TimeStamp, bits, integer, unsigned
from ..wire.layout import Bodiless, message
from ..wire.message import Message


@message(0x0001)
@dataclass(slots=True, repr=False, eq=False)
class SetAuthority(Message):
    """Sets the authority code of the component, at most that of the sender."""

    authority_code: U8 = 0


@message(0x000D)
@dataclass(slots=True, repr=False, eq=False)
class RequestControl(Message):
    """Requests control of the component, or renews it."""

    authority_code: U8 = 0


@message(0x000E)
class ReleaseControl(Bodiless):
    __slots__ = ()


@message(0x000F)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmControl(Message):
    """Answers RequestControl."""

    class ResponseCode(IntEnum):
        CONTROL_ACCEPTED = 0
        NOT_AVAILABLE = 1
        INSUFFICIENT_AUTHORITY = 2

    response_code: Annotated[int, unsigned(1, upper=2)] = 0


@message(0x0010)
@dataclass(slots=True, repr=False, eq=False)
class RejectControl(Message):
    """Reports to a client that its control has ended, or could not be released."""

    class ResponseCode(IntEnum):
        CONTROL_RELEASED = 0
        NOT_AVAILABLE = 1

    response_code: Annotated[int, unsigned(1, upper=1)] = 0


@message(0x2001)
class QueryAuthority(Bodiless):
    __slots__ = ()


@message(0x2003)
class QueryTimeout(Bodiless):
    __slots__ = ()


@message(0x200D)
class QueryControl(Bodiless):
    __slots__ = ()


@message(0x4001)
@dataclass(slots=True, repr=False, eq=False)
class ReportAuthority(Message):
    """Reports the authority code of the component."""

    authority_code: U8 = 0


@message(0x4003)
@dataclass(slots=True, repr=False, eq=False)
class ReportTimeout(Message):
    """Reports the time after which control lapses, unless it is requested again."""

    class Timeout(IntEnum):
        TIMEOUT_FEATURE_DISABLED = 0

    timeout: U8 = 0  # seconds


@message(0x400D)
@dataclass(slots=True, repr=False, eq=False)
class ReportControl(Message):
    """Reports the controller of the component; zeros without one."""

    subsystem_id: U16 = 0
    node_id: U8 = 0
    component_id: U8 = 0
    authority_code: U8 = 0


@message(0x0002)
class Shutdown(Bodiless):
    __slots__ = ()


@message(0x0003)
class Standby(Bodiless):
    __slots__ = ()


@message(0x0004)
class Resume(Bodiless):
    __slots__ = ()


@message(0x0005)
class Reset(Bodiless):
    __slots__ = ()


@message(0x0006)
@dataclass(slots=True, repr=False, eq=False)
class SetEmergency(Message):
    """Puts the component into Emergency."""

    class EmergencyCode(IntEnum):
        STOP = 1

    emergency_code: Annotated[int, unsigned(2, 1, 1)] = 1


@message(0x0007)
@dataclass(slots=True, repr=False, eq=False)
class ClearEmergency(Message):
    """Ends an emergency of the same sender."""

    EmergencyCode = SetEmergency.EmergencyCode

    emergency_code: Annotated[int, unsigned(2, 1, 1)] = 1


@message(0x2002)
class QueryStatus(Bodiless):
    __slots__ = ()


@message(0x4002)
@dataclass(slots=True, repr=False, eq=False)
class ReportStatus(Message):
    """Reports the state of the component."""

    class Status(IntEnum):
        INITIALIZE = 0
        READY = 1
        STANDBY = 2
        SHUTDOWN = 3
        FAILURE = 4
        EMERGENCY = 5

    status: Annotated[int, unsigned(1, upper=5)] = 0
    reserved: U32 = 0


@dataclass(slots=True)
class _DateStamp:
    """A day as a bit field of 16 bits; years count from 2000."""

    day: int = 1
    month: int = 1
    year: int = 0

    def to_integer(self) -> int:
        """Returns the integer that holds the bits."""
        date_bits = integer(self.day, 1, 31, "day")
        date_bits |= integer(self.month, 1, 12, "month") << 5
        date_bits |= integer(self.year, 0, 127, "year") << 9
        return date_bits

    @classmethod
    def from_integer(cls, date_bits: int) -> "_DateStamp":
        """Returns the day of 16 bits, without a check of its parts."""
        return cls(date_bits & 0x1F, date_bits >> 5 & 0xF, date_bits >> 9 & 0x7F)


# A dataclass would take an alias in its own body for a field: hence this base.
class _Dated(StampedMessage):
    __slots__ = ()

    DateStamp: TypeAlias = _DateStamp


@message(0x0011)
@dataclass(slots=True, repr=False, eq=False)
class SetTime(_Dated):
    """Sets the clock of the component."""

    time_stamp: Annotated[TimeStamp, bits(4, TimeStamp)] | None = None
    date_stamp: Annotated[_DateStamp, bits(2, _DateStamp)] | None = None


@message(0x2011)
@dataclass(slots=True, repr=False, eq=False)
class QueryTime(Message):
    """Asks for the fields of a presence vector."""

    presence_vector: U8 = 0


@message(0x2202)
class QueryHeartbeatPulse(Bodiless):
    __slots__ = ()


@message(0x4011)
@dataclass(slots=True, repr=False, eq=False)
class ReportTime(_Dated):
    """Reports the time of the component."""

    time_stamp: Annotated[TimeStamp, bits(4, TimeStamp)] | None = None
    date_stamp: Annotated[_DateStamp, bits(2, _DateStamp)] | None = None


@message(0x4202)
class ReportHeartbeatPulse(Bodiless):
    __slots__ = ()
