"""Messages of the handoff of control (IOP, EnhancedAccessControl and HandoffController)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, TypeAlias

from ..wire.codec import U8, ShortList, Text, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message


class HandoffDecision(IntEnum):
    """The decision of a controller on a request for control."""

    GRANTED = 0
    DENIED = 1
    WAIT = 2


@record("RequestReleaseControlRec")
@dataclass(slots=True)
class _Request:
    """A request for control: its id, client, authority and explanation."""

    id_: U8 = 0
    src_subsystem_id: Annotated[int, unsigned(2, 1, 65534)] = 1
    src_node_id: Annotated[int, unsigned(1, upper=254)] = 0
    src_component_id: Annotated[int, unsigned(1, upper=254)] = 0
    authority_code: U8 = 0
    explanation: Text = ""


@record("ReleaseControlRec")
@dataclass(slots=True)
class _Decision:
    """The decision on a request."""

    id_: U8 = 0
    response_code: Annotated[int, unsigned(1, upper=2)] = 0


# A dataclass would take an alias in its own body for a field: hence such bases.
class _WithRequests(Message):
    __slots__ = ()

    RequestReleaseControlRec: TypeAlias = _Request


class _WithDecisions(Message):
    __slots__ = ()

    ReleaseControlRec: TypeAlias = _Decision
    ResponseCode: TypeAlias = HandoffDecision


@message(0xFF31)
@dataclass(slots=True, repr=False, eq=False)
class RequestHandoff(Message):
    """Requests a component's control from its controller; renews the request when repeated."""

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
    """Withdraws a request."""

    id_: U8 = 0


@message(0xFF35)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmHandoffRequest(Message):
    """Reports the state of a request to its client."""

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
    """Reports the time in which the controller must decide a request."""

    timeout: U8 = 0  # seconds


@message(0xFF37)
@dataclass(slots=True, repr=False, eq=False)
class ReportEnhancedTimeout(Message):
    """Reports the time after which a request lapses, unless it is repeated."""

    timeout: U8 = 0  # seconds


@message(0xFF38)
@dataclass(slots=True, repr=False, eq=False)
class RequestReleaseControl(_WithRequests):
    """Reports the undecided requests for a component to its controller."""

    request_release_control_list: ShortList[_Request] = field(default_factory=list)


@message(0xFF39)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmReleaseControl(_WithDecisions):
    """Reports the controller's decisions on requests to the component."""

    release_control_list: ShortList[_Decision] = field(default_factory=list)
