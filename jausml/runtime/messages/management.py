"""Messages of Management: the state of a component, and emergencies (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from ..wire.kinds import U32, unsigned
from ..wire.layout import Bodiless, message
from ..wire.message import Message


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
    """Has the component go to Emergency."""

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
    """Tells the state of the component."""

    class Status(IntEnum):
        INITIALIZE = 0
        READY = 1
        STANDBY = 2
        SHUTDOWN = 3
        FAILURE = 4
        EMERGENCY = 5

    status: Annotated[int, unsigned(1, upper=5)] = 0
    reserved: U32 = 0
