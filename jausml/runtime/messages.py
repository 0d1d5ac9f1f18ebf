"""The messages of the JAUS core services (SAE AS5710A).

Each class declares the fields of its message, in their order on the wire; `wire.layout` makes the
codec of that. A message that begins with `Query` asks for the one that begins with `Report`. Names
are those of the standard, whose records are offered by the messages that hold them.
"""

# Annotations are read when the classes are made.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, ClassVar, TypeAlias

from .wire.codec import integer, one_of
from .wire.kinds import (
    U8,
    U16,
    U32,
    Counted,
    LongList,
    Scalar,
    ShortList,
    Tagged,
    Text,
    bits,
    fixed_text,
    scaled_unsigned,
    unsigned,
)
from .wire.layout import message, record
from .wire.message import Message
from .wire.stamped_message import StampedMessage
from .wire.time_stamp import TimeStamp

# ---------------------------------------------------------------------- fields and records

_Rate = Annotated[float, scaled_unsigned(1092.0)]  # hertz
_Payload = Annotated[bytes, Counted("I", least=2)]  # a message: its code and body
_EventType = Annotated[int, unsigned(1, upper=1)]


def _component_type(value: int, field: str) -> int:
    return one_of(value, ((0, 0), (10001, 65535)), field)


@dataclass(slots=True)
class _DateStamp:
    """A day as a bit field of 16 bits; years count from 2000."""

    day: int = 1
    month: int = 1
    year: int = 0

    def to_integer(self) -> int:
        """Return the integer that holds the bits."""
        found = integer(self.day, 1, 31, "day")
        found |= integer(self.month, 1, 12, "month") << 5
        found |= integer(self.year, 0, 127, "year") << 9
        return found

    @classmethod
    def from_integer(cls, found: int) -> "_DateStamp":
        """Return what the bits of an integer say, legal or not."""
        return cls(found & 0x1F, found >> 5 & 0xF, found >> 9 & 0x7F)


@record("RequestIDRec")
@dataclass(slots=True)
class _RequestIDRec:
    """The request that an answer is to name."""

    request_id: U8 = 0


@record("ElementData")
@dataclass(slots=True)
class _ElementData:
    """What an element is: a message, or bytes of a format of the user."""

    format_index: Annotated[int, unsigned(1, upper=1)] = 0
    data: Annotated[bytes, Counted("H")] = b""


@record("ElementRec")
@dataclass(slots=True)
class _ElementRec:
    """An element of a list, with its neighbours."""

    element_uid: U16 = 0
    previous_uid: U16 = 0
    next_uid: U16 = 0
    element_data: _ElementData = field(default_factory=_ElementData)


@record("ServiceRec")
@dataclass(slots=True)
class _ServiceRec:
    """A service and its version."""

    uri: Text = ""
    major_version_number: U8 = 0
    minor_version_number: U8 = 0


@record("NodeRec")
@dataclass(slots=True)
class _NodeRec:
    """A node by its number."""

    node_id: U8 = 0


@record("ComponentRec")
@dataclass(slots=True)
class _ComponentRec:
    """A component by its numbers."""

    component_id: U8 = 0
    instance_id: U8 = 0


@record("ComponentSeq")
@dataclass(slots=True)
class _ComponentSeq:
    """What a component provides."""

    component_rec: _ComponentRec = field(default_factory=_ComponentRec)
    service_list: ShortList[_ServiceRec] = field(default_factory=list)


@record("NodeSeq")
@dataclass(slots=True)
class _NodeSeq:
    """What the components of a node provide."""

    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_ComponentSeq] = field(default_factory=list)


@record("SubsystemRec")
@dataclass(slots=True)
class _SubsystemRec:
    """A subsystem by its number."""

    subsystem_id: U16 = 0


# A dataclass would take an alias in its own body for a field: hence these bases.


class _Dated(StampedMessage):
    __slots__ = ()

    DateStamp: TypeAlias = _DateStamp


class _WithElements(Message):
    __slots__ = ()

    RequestIDRec: TypeAlias = _RequestIDRec
    ElementData: TypeAlias = _ElementData
    ElementRec: TypeAlias = _ElementRec


class _WithServices(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _ComponentRec
    ServiceRec: TypeAlias = _ServiceRec
    ComponentSeq: TypeAlias = _ComponentSeq
    NodeSeq: TypeAlias = _NodeSeq


@dataclass(slots=True)
class _Plain(Message):
    """A message without fields."""


# ---------------------------------------------------------------------- commands


@message(0x0001)
@dataclass(slots=True)
class SetAuthority(Message):
    """Gives the component another authority code, no greater than that of who sends it."""

    authority_code: U8 = 0


@message(0x0002)
class Shutdown(_Plain):
    __slots__ = ()


@message(0x0003)
class Standby(_Plain):
    __slots__ = ()


@message(0x0004)
class Resume(_Plain):
    __slots__ = ()


@message(0x0005)
class Reset(_Plain):
    __slots__ = ()


@message(0x0006)
@dataclass(slots=True)
class SetEmergency(Message):
    """Has the component go to Emergency."""

    class EmergencyCode(IntEnum):
        STOP = 1

    emergency_code: Annotated[int, unsigned(2, 1, 1)] = 1


@message(0x0007)
@dataclass(slots=True)
class ClearEmergency(Message):
    """Ends an emergency of the same sender."""

    EmergencyCode = SetEmergency.EmergencyCode

    emergency_code: Annotated[int, unsigned(2, 1, 1)] = 1


@message(0x000D)
@dataclass(slots=True)
class RequestControl(Message):
    """Asks for control, and asks for it to go on."""

    authority_code: U8 = 0


@message(0x000E)
class ReleaseControl(_Plain):
    __slots__ = ()


@message(0x000F)
@dataclass(slots=True)
class ConfirmControl(Message):
    """Answers RequestControl."""

    class ResponseCode(IntEnum):
        CONTROL_ACCEPTED = 0
        NOT_AVAILABLE = 1
        INSUFFICIENT_AUTHORITY = 2

    response_code: Annotated[int, unsigned(1, upper=2)] = 0


@message(0x0010)
@dataclass(slots=True)
class RejectControl(Message):
    """Tells a client that it controls the component no more, or could not release it."""

    class ResponseCode(IntEnum):
        CONTROL_RELEASED = 0
        NOT_AVAILABLE = 1

    response_code: Annotated[int, unsigned(1, upper=1)] = 0


@message(0x0011)
@dataclass(slots=True)
class SetTime(_Dated):
    """Sets the clock of the component."""

    time_stamp: Annotated[TimeStamp, bits(4, TimeStamp)] | None = None
    date_stamp: Annotated[_DateStamp, bits(2, _DateStamp)] | None = None


@message(0x01F0)
@dataclass(slots=True)
class CreateEvent(Message):
    """Asks for the answer of a query periodically or at every change."""

    class EventType(IntEnum):
        PERIODIC_SC = 0
        EVERY_CHANGE = 1

    request_id: U8 = 0
    event_type: _EventType = 0
    requested_periodic_rate: _Rate = 0.0
    query_message: _Payload = b""


@message(0x01F1)
@dataclass(slots=True)
class UpdateEvent(Message):
    """Changes an event, which also renews it."""

    EventType = CreateEvent.EventType

    request_id: U8 = 0
    event_type: _EventType = 0
    requested_periodic_rate: _Rate = 0.0
    event_id: U8 = 0
    query_message: _Payload = b""


@message(0x01F2)
@dataclass(slots=True)
class CancelEvent(Message):
    """Ends an event."""

    request_id: U8 = 0
    event_id: U8 = 0


@message(0x01F3)
@dataclass(slots=True)
class ConfirmEventRequest(Message):
    """Answers CreateEvent, UpdateEvent and CancelEvent, with the rate that is given."""

    request_id: U8 = 0
    event_id: U8 = 0
    confirmed_periodic_rate: _Rate = 0.0


@message(0x01F4)
@dataclass(slots=True)
class RejectEventRequest(Message):
    """Answers the same when nothing comes of it."""

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
@dataclass(slots=True)
class CreateCommandEvent(Message):
    """Has a command executed, whose end a CommandEvent tells."""

    request_id: U8 = 0
    maximum_allowed_duration: U32 = 0  # seconds
    command_message: _Payload = b""


@message(0x041A)
@dataclass(slots=True)
class SetElement(_WithElements):
    """Adds elements to a list, or replaces them."""

    class ElementDataFormat(IntEnum):
        JAUS_MESSAGE = 0
        USER_DEFINED = 1

    request_id_rec: _RequestIDRec = field(default_factory=_RequestIDRec)
    element_list: ShortList[_ElementRec] = field(default_factory=list)


@message(0x041B)
@dataclass(slots=True)
class DeleteElement(_WithElements):
    """Deletes elements of a list."""

    @record("DeleteElement.DeleteElementRec")
    @dataclass(slots=True)
    class DeleteElementRec:
        """An element to delete; 65535 means all."""

        element_uid: U16 = 0

    request_id_rec: _RequestIDRec = field(default_factory=_RequestIDRec)
    delete_element_list: ShortList[DeleteElementRec] = field(default_factory=list)


@message(0x041C)
@dataclass(slots=True)
class ConfirmElementRequest(Message):
    """Answers SetElement and DeleteElement."""

    request_id: U8 = 0


@message(0x041D)
@dataclass(slots=True)
class RejectElementRequest(Message):
    """Answers the same when the list was left as it is."""

    class ResponseCode(IntEnum):
        INVALID_ELEMENT_ID = 1
        INVALID_PREVIOUS_ELEMENT = 2
        INVALID_NEXT_ELEMENT = 3
        UNSUPPORTED_ELEMENT_TYPE = 4
        ELEMENT_ID_NOT_FOUND = 5
        OUT_OF_MEMORY = 6
        UNSPECIFIED_ERROR = 7

    request_id: U8 = 0
    response_code: Annotated[int, unsigned(1, 1, 7)] = 1


@message(0x0B00)
@dataclass(slots=True)
class RegisterServices(_WithServices):
    """Tells the Discovery service of a subsystem what a component provides."""

    service_list: ShortList[_ServiceRec] = field(default_factory=list)


# ---------------------------------------------------------------------- queries


@message(0x2001)
class QueryAuthority(_Plain):
    __slots__ = ()


@message(0x2002)
class QueryStatus(_Plain):
    __slots__ = ()


@message(0x2003)
class QueryTimeout(_Plain):
    __slots__ = ()


@message(0x200D)
class QueryControl(_Plain):
    __slots__ = ()


@message(0x2011)
@dataclass(slots=True)
class QueryTime(Message):
    """The presence vector says which fields are asked for."""

    presence_vector: U8 = 0


@message(0x21F0)
@dataclass(slots=True)
class QueryEvents(Message):
    """Asks for the events of a message, of a type, of an id, or for all."""

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
class QueryEventTimeout(_Plain):
    __slots__ = ()


@message(0x2202)
class QueryHeartbeatPulse(_Plain):
    __slots__ = ()


@message(0x241A)
@dataclass(slots=True)
class QueryElement(Message):
    """Asks for an element of a list."""

    element_uid: U16 = 0


@message(0x241B)
class QueryElementList(_Plain):
    __slots__ = ()


@message(0x241C)
class QueryElementCount(_Plain):
    __slots__ = ()


@message(0x2B00)
@dataclass(slots=True)
class QueryIdentification(Message):
    """Asks who is there, for a system, subsystem, node or component."""

    class QueryType(IntEnum):
        RESERVED = 0
        SYSTEM_IDENTIFICATION = 1
        SUBSYSTEM_IDENTIFICATION = 2
        NODE_IDENTIFICATION = 3
        COMPONENT_IDENTIFICATION = 4

    query_type: U8 = 0


@message(0x2B01)
@dataclass(slots=True)
class QueryConfiguration(Message):
    """Asks for the components of a subsystem or node."""

    class QueryType(IntEnum):
        RESERVED = 0
        RESERVED_2 = 1
        SUBSYSTEM_IDENTIFICATION = 2
        NODE_IDENTIFICATION = 3

    query_type: U8 = 0


@message(0x2B02)
class QuerySubsystemList(_Plain):
    __slots__ = ()


@record("QueryServices.ComponentRec")
@dataclass(slots=True)
class _AskedComponent:
    """A component, or all by a wildcard."""

    component_id: U8 = 0


@record("QueryServices.NodeSeq")
@dataclass(slots=True)
class _AskedNode:
    """Components of a node, or of all by a wildcard."""

    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_AskedComponent] = field(default_factory=list)


class _AskedServices(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _AskedComponent
    NodeSeq: TypeAlias = _AskedNode


@message(0x2B03)
@dataclass(slots=True)
class QueryServices(_AskedServices):
    """Asks what components provide."""

    class NodeID(IntEnum):
        RESERVED = 0
        ALL_NODES_IN_THE_SUBSYSTEM = 255

    class ComponentID(IntEnum):
        RESERVED = 0
        ALL_COMPONENTS_IN_THE_SUBSYSTEM = 255

    node_list: ShortList[_AskedNode] = field(default_factory=list)


@record("QueryServiceList.ComponentRec")
@dataclass(slots=True)
class _FilteredComponent:
    """A component, or all, and what the URNs of its services must contain."""

    component_id: U8 = 0
    search_filter: Text | None = None


@record("QueryServiceList.NodeSeq")
@dataclass(slots=True)
class _FilteredNode:
    """Components of a node, or of all by a wildcard."""

    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_FilteredComponent] = field(default_factory=list)


@record("QueryServiceList.SubsystemSeq")
@dataclass(slots=True)
class _FilteredSubsystem:
    """Nodes of a subsystem, or of all by a wildcard."""

    subsystem_rec: _SubsystemRec = field(default_factory=_SubsystemRec)
    node_list: ShortList[_FilteredNode] = field(default_factory=list)


class _FilteredServices(Message):
    __slots__ = ()

    SubsystemRec: TypeAlias = _SubsystemRec
    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _FilteredComponent
    NodeSeq: TypeAlias = _FilteredNode
    SubsystemSeq: TypeAlias = _FilteredSubsystem


@message(0x2B04)
@dataclass(slots=True)
class QueryServiceList(_FilteredServices):
    """Asks a Discovery service what is known to it."""

    NodeID = QueryServices.NodeID
    ComponentID = QueryServices.ComponentID

    class SubsystemID(IntEnum):
        RESERVED = 0
        ALL_SUBSYSTEMS_IN_THE_SYSTEM = 65535

    subsystem_list: LongList[_FilteredSubsystem] = field(default_factory=list)


# ---------------------------------------------------------------------- reports


@message(0x4001)
@dataclass(slots=True)
class ReportAuthority(Message):
    """Tells the authority code of the component."""

    authority_code: U8 = 0


@message(0x4002)
@dataclass(slots=True)
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


@message(0x4003)
@dataclass(slots=True)
class ReportTimeout(Message):
    """Tells after which time control lapses, unless it is requested again."""

    class Timeout(IntEnum):
        TIMEOUT_FEATURE_DISABLED = 0

    timeout: U8 = 0  # seconds


@message(0x400D)
@dataclass(slots=True)
class ReportControl(Message):
    """Tells who controls the component; zeros for nobody."""

    subsystem_id: U16 = 0
    node_id: U8 = 0
    component_id: U8 = 0
    authority_code: U8 = 0


@message(0x4011)
@dataclass(slots=True)
class ReportTime(_Dated):
    """Tells the time of the component."""

    time_stamp: Annotated[TimeStamp, bits(4, TimeStamp)] | None = None
    date_stamp: Annotated[_DateStamp, bits(2, _DateStamp)] | None = None


@message(0x41F0)
@dataclass(slots=True)
class ReportEvents(Message):
    """Tells which events there are."""

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
@dataclass(slots=True)
class Event(Message):
    """Brings a report that an event asked for."""

    event_id: U8 = 0
    sequence_number: U8 = 0
    report_message: _Payload = b""


@message(0x41F2)
@dataclass(slots=True)
class ReportEventTimeout(Message):
    """Tells after which time an event lapses, unless it is updated."""

    class Timeout(IntEnum):
        TIMEOUT_FEATURE_DISABLED = 0

    timeout: U8 = 0  # minutes


@message(0x41F6)
@dataclass(slots=True)
class CommandEvent(Message):
    """Tells how a command of CreateCommandEvent ended."""

    class CommandResult(IntEnum):
        SUCCESSFUL = 0
        UNSUCCESSFUL = 1

    event_id: U8 = 0
    command_result: Annotated[int, unsigned(1, upper=1)] = 0


@message(0x4202)
class ReportHeartbeatPulse(_Plain):
    __slots__ = ()


@message(0x441A)
@dataclass(slots=True)
class ReportElement(_WithElements):
    """Tells an element of a list."""

    ElementDataFormat = SetElement.ElementDataFormat

    element_uid: U16 = 0
    previous_uid: U16 = 0
    next_uid: U16 = 0
    element_data: _ElementData = field(default_factory=_ElementData)


@message(0x441B)
@dataclass(slots=True)
class ReportElementList(Message):
    """Tells the elements of a list, in order."""

    @record("ReportElementList.ElementListRec")
    @dataclass(slots=True)
    class ElementListRec:
        """An element of a list."""

        element_uid: U16 = 0

    element_list: LongList[ElementListRec] = field(default_factory=list)


@message(0x441C)
@dataclass(slots=True)
class ReportElementCount(Message):
    """Tells how long a list is."""

    element_count: U16 = 0


@message(0x4B00)
@dataclass(slots=True)
class ReportIdentification(Message):
    """Tells what kind of component, node or subsystem is there, and its name."""

    QueryType = QueryIdentification.QueryType

    class Type(IntEnum):
        RESERVED = 0
        VEHICLE = 10001
        OCU = 20001
        OTHER_SUBSYSTEM = 30001
        NODE = 40001
        PAYLOAD = 50001
        COMPONENT = 60001

    query_type: U8 = 0
    type_: Annotated[int, Scalar("H", _component_type)] = 0
    identification: Text = ""


@record("ReportConfiguration.NodeSeq")
@dataclass(slots=True)
class _ConfiguredNode:
    """The components of a node."""

    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_ComponentRec] = field(default_factory=list)


class _Configuration(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _ComponentRec
    NodeSeq: TypeAlias = _ConfiguredNode


@message(0x4B01)
@dataclass(slots=True)
class ReportConfiguration(_Configuration):
    """Tells the components of a subsystem or node."""

    node_list: ShortList[_ConfiguredNode] = field(default_factory=list)


@message(0x4B02)
@dataclass(slots=True)
class ReportSubsystemList(Message):
    """Tells which subsystems are known."""

    @record("ReportSubsystemList.SubsystemRec")
    @dataclass(slots=True)
    class SubsystemRec:
        """A subsystem, by the component that answers for it."""

        subsystem_id: U16 = 0
        node_id: U8 = 0
        component_id: U8 = 0

    subsystem_list: ShortList[SubsystemRec] = field(default_factory=list)


@message(0x4B03)
@dataclass(slots=True)
class ReportServices(_WithServices):
    """Tells what components provide."""

    node_list: ShortList[_NodeSeq] = field(default_factory=list)


@record("ReportServiceList.SubsystemSeq")
@dataclass(slots=True)
class _SubsystemSeq:
    """What the components of a subsystem provide."""

    subsystem_rec: _SubsystemRec = field(default_factory=_SubsystemRec)
    node_list: ShortList[_NodeSeq] = field(default_factory=list)


class _WithSubsystems(_WithServices):
    __slots__ = ()

    SubsystemRec: TypeAlias = _SubsystemRec
    SubsystemSeq: TypeAlias = _SubsystemSeq


@message(0x4B04)
@dataclass(slots=True)
class ReportServiceList(_WithSubsystems):
    """Tells what is known to a Discovery service."""

    subsystem_list: LongList[_SubsystemSeq] = field(default_factory=list)
