"""Messages of control that is handed over (IOP, EnhancedAccessControl and HandoffController)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, TypeAlias

from ..wire.codec import U8, ShortList, Text, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message


class HandoffDecision(IntEnum):
    """What a controller has decided of a request for control."""

    GRANTED = 0
    DENIED = 1
    WAIT = 2


@record("RequestReleaseControlRec")
@dataclass(slots=True)
class _Asked:
    """A client that asks for control, and the number of its request."""

    id_: U8 = 0
    src_subsystem_id: Annotated[int, unsigned(2, 1, 65534)] = 1
    src_node_id: Annotated[int, unsigned(1, upper=254)] = 0
    src_component_id: Annotated[int, unsigned(1, upper=254)] = 0
    authority_code: U8 = 0
    explanation: Text = ""


@record("ReleaseControlRec")
@dataclass(slots=True)
class _Decided:
    """What was decided of a request."""

    id_: U8 = 0
    response_code: Annotated[int, unsigned(1, upper=2)] = 0


# A dataclass would take an alias in its own body for a field: hence such bases.
class _WithAsked(Message):
    __slots__ = ()

    RequestReleaseControlRec: TypeAlias = _Asked


class _WithDecided(Message):
    __slots__ = ()

    ReleaseControlRec: TypeAlias = _Decided
    ResponseCode: TypeAlias = HandoffDecision


@message(0xFF31)
@dataclass(slots=True, repr=False, eq=False)
class RequestHandoff(Message):
    """Asks the controller of a component to hand control over, and asks for it to go on."""

    authority_code: U8 = 0
    explanation: Text = ""


@message(0xFF32)
class QueryHandoffTimeout(Bodiless):
    __slots__ = ()


@message(0xFF33)
class QueryEnhancedTimeout(Bodiless):
    __slots__ = ()


@message(0xFF34)
@dataclass(slots=True, repr=False, eq=False)
class RemoveHandoffRequest(Message):
    """Takes a request back."""

    id_: U8 = 0


@message(0xFF35)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmHandoffRequest(Message):
    """Tells a client what has become of its request."""

    class ResponseCode(IntEnum):
        GRANTED = 0
        NOT_AVAILABLE = 1
        TIMEOUT = 2
        DENIED = 3
        QUEUED = 4
        DEFERRED = 5
        INSUFFICIENT_AUTHORITY = 6

    id_: U8 = 0
    response_code: Annotated[int, unsigned(1, upper=6)] = 0


@message(0xFF36)
@dataclass(slots=True, repr=False, eq=False)
class ReportHandoffTimeout(Message):
    """Tells for how long the controller may leave a request undecided."""

    timeout: U8 = 0  # seconds


@message(0xFF37)
@dataclass(slots=True, repr=False, eq=False)
class ReportEnhancedTimeout(Message):
    """Tells within which time a request is to be sent again."""

    timeout: U8 = 0  # seconds


@message(0xFF38)
@dataclass(slots=True, repr=False, eq=False)
class RequestReleaseControl(_WithAsked):
    """Tells the controller of a component who asks for control."""

    request_release_control_list: ShortList[_Asked] = field(default_factory=list)


@message(0xFF39)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmReleaseControl(_WithDecided):
    """Tells a component what its controller has decided of the requests."""

    release_control_list: ShortList[_Decided] = field(default_factory=list)
