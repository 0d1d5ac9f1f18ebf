"""Messages of who controls a component (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from ..wire.codec import U8, U16, unsigned
from ..wire.layout import Bodiless, message
from ..wire.message import Message


@message(0x0001)
@dataclass(slots=True, repr=False, eq=False)
class SetAuthority(Message):
    """Gives the component another authority code, no greater than that of who sends it."""

    authority_code: U8 = 0


@message(0x000D)
@dataclass(slots=True, repr=False, eq=False)
class RequestControl(Message):
    """Asks for control, and asks for it to go on."""

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
    """Tells a client that it controls the component no more, or could not release it."""

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
    """Tells the authority code of the component."""

    authority_code: U8 = 0


@message(0x4003)
@dataclass(slots=True, repr=False, eq=False)
class ReportTimeout(Message):
    """Tells after which time control lapses, unless it is requested again."""

    class Timeout(IntEnum):
        TIMEOUT_FEATURE_DISABLED = 0

    timeout: U8 = 0  # seconds


@message(0x400D)
@dataclass(slots=True, repr=False, eq=False)
class ReportControl(Message):
    """Tells who controls the component; zeros for nobody."""

    subsystem_id: U16 = 0
    node_id: U8 = 0
    component_id: U8 = 0
    authority_code: U8 = 0
