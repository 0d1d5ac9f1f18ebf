"""Messages of Discovery: components and their services (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, TypeAlias

from ..wire.codec import U8, U16, LongList, Scalar, ShortList, Text, one_of
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message


def _component_type(value: int, field: str) -> int:
    return one_of(value, ((0, 0), (10001, 65535)), field)


@record("ServiceRec")
@dataclass(slots=True)
class _ServiceRec:
    uri: Text = ""
    major_version_number: U8 = 0
    minor_version_number: U8 = 0


@record("NodeRec")
@dataclass(slots=True)
class _NodeRec:
    node_id: U8 = 0


@record("ComponentRec")
@dataclass(slots=True)
class _ComponentRec:
    component_id: U8 = 0
    instance_id: U8 = 0


@record("ComponentSeq")
@dataclass(slots=True)
class _ComponentSeq:
    component_rec: _ComponentRec = field(default_factory=_ComponentRec)
    service_list: ShortList[_ServiceRec] = field(default_factory=list)


@record("NodeSeq")
@dataclass(slots=True)
class _NodeSeq:
    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_ComponentSeq] = field(default_factory=list)


@record("SubsystemRec")
@dataclass(slots=True)
class _SubsystemRec:
    subsystem_id: U16 = 0


# A dataclass would take an alias in its own body for a field: hence such bases.
class _WithServices(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _ComponentRec
    ServiceRec: TypeAlias = _ServiceRec
    ComponentSeq: TypeAlias = _ComponentSeq
    NodeSeq: TypeAlias = _NodeSeq


@message(0x0B00)
@dataclass(slots=True, repr=False, eq=False)
class RegisterServices(_WithServices):
    """Registers the services of a component with the Discovery of its subsystem."""

    service_list: ShortList[_ServiceRec] = field(default_factory=list)


@message(0x2B00)
@dataclass(slots=True, repr=False, eq=False)
class QueryIdentification(Message):
    """Asks for the identification of a system, subsystem, node or component."""

    class QueryType(IntEnum):
        RESERVED = 0
        SYSTEM_IDENTIFICATION = 1
        SUBSYSTEM_IDENTIFICATION = 2
        NODE_IDENTIFICATION = 3
        COMPONENT_IDENTIFICATION = 4

    query_type: U8 = 0


@message(0x2B01)
@dataclass(slots=True, repr=False, eq=False)
class QueryConfiguration(Message):
    """Asks for the components of a subsystem or node."""

    class QueryType(IntEnum):
        RESERVED = 0
        RESERVED_2 = 1
        SUBSYSTEM_IDENTIFICATION = 2
        NODE_IDENTIFICATION = 3

    query_type: U8 = 0


@message(0x2B02)
class QuerySubsystemList(Bodiless):
    __slots__ = ()


@record("QueryServices.ComponentRec")
@dataclass(slots=True)
class _QueriedComponent:
    """A component, or all by a wildcard."""

    component_id: U8 = 0


@record("QueryServices.NodeSeq")
@dataclass(slots=True)
class _QueriedNode:
    """Components of a node, or of all by a wildcard."""

    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_QueriedComponent] = field(default_factory=list)


class _QueriedServices(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _QueriedComponent
    NodeSeq: TypeAlias = _QueriedNode


@message(0x2B03)
@dataclass(slots=True, repr=False, eq=False)
class QueryServices(_QueriedServices):
    """Asks for the services of components."""

    class NodeID(IntEnum):
        RESERVED = 0
        ALL_NODES_IN_THE_SUBSYSTEM = 255

    class ComponentID(IntEnum):
        RESERVED = 0
        ALL_COMPONENTS_IN_THE_SUBSYSTEM = 255

    node_list: ShortList[_QueriedNode] = field(default_factory=list)


@record("QueryServiceList.ComponentRec")
@dataclass(slots=True)
class _FilteredComponent:
    """A component, or all by a wildcard, and a text that URNs of its services must contain."""

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
@dataclass(slots=True, repr=False, eq=False)
class QueryServiceList(_FilteredServices):
    """Asks a Discovery service for all services that it knows."""

    NodeID = QueryServices.NodeID
    ComponentID = QueryServices.ComponentID

    class SubsystemID(IntEnum):
        RESERVED = 0
        ALL_SUBSYSTEMS_IN_THE_SYSTEM = 65535

    subsystem_list: LongList[_FilteredSubsystem] = field(default_factory=list)


@message(0x4B00)
@dataclass(slots=True, repr=False, eq=False)
class ReportIdentification(Message):
    """Reports type and name of a component, node or subsystem."""

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
    node_rec: _NodeRec = field(default_factory=_NodeRec)
    component_list: ShortList[_ComponentRec] = field(default_factory=list)


class _Configuration(Message):
    __slots__ = ()

    NodeRec: TypeAlias = _NodeRec
    ComponentRec: TypeAlias = _ComponentRec
    NodeSeq: TypeAlias = _ConfiguredNode


@message(0x4B01)
@dataclass(slots=True, repr=False, eq=False)
class ReportConfiguration(_Configuration):
    """Reports the components of a subsystem or node."""

    node_list: ShortList[_ConfiguredNode] = field(default_factory=list)


@message(0x4B02)
@dataclass(slots=True, repr=False, eq=False)
class ReportSubsystemList(Message):
    """Reports the known subsystems."""

    @record("ReportSubsystemList.SubsystemRec")
    @dataclass(slots=True)
    class SubsystemRec:
        """A subsystem, by the address of its Discovery."""

        subsystem_id: U16 = 0
        node_id: U8 = 0
        component_id: U8 = 0

    subsystem_list: ShortList[SubsystemRec] = field(default_factory=list)


@message(0x4B03)
@dataclass(slots=True, repr=False, eq=False)
class ReportServices(_WithServices):
    """Reports the services of components."""

    node_list: ShortList[_NodeSeq] = field(default_factory=list)


@record("ReportServiceList.SubsystemSeq")
@dataclass(slots=True)
class _SubsystemSeq:
    subsystem_rec: _SubsystemRec = field(default_factory=_SubsystemRec)
    node_list: ShortList[_NodeSeq] = field(default_factory=list)


class _WithSubsystems(_WithServices):
    __slots__ = ()

    SubsystemRec: TypeAlias = _SubsystemRec
    SubsystemSeq: TypeAlias = _SubsystemSeq


@message(0x4B04)
@dataclass(slots=True, repr=False, eq=False)
class ReportServiceList(_WithSubsystems):
    """Reports the services that a Discovery service knows."""

    subsystem_list: LongList[_SubsystemSeq] = field(default_factory=list)
