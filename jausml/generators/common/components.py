"""What targets ask about JAUS components: address, services, settings of their transport."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml.generators.common import runtime
from jausml.generators.python.layout import Call

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.metamodel.classes import jaus, ros
    from jausml.metamodel.classes.system import Host, System

CORE = "urn:jaus:jss:core:"
"""Prefix of the URNs of the core services (AS5710)."""

RUNTIME_SERVICES = frozenset(
    [
        CORE + "AccessControl",
        CORE + "Discovery",
        CORE + "Events",
        CORE + "ListManager",
        CORE + "Liveliness",
        CORE + "Liveness",
        CORE + "Management",
        CORE + "Time",
        CORE + "Transport",
        "urn:jaus:jss:iop:UnsolicitedHeartbeat",
        "urn:jaus:jss:manipulator:ListManager",
        "urn:jaus:jss:mobility:ListManager",
    ]
)
"""Services whose messages the runtime handles itself."""

CORE_MESSAGES = {
    "SetAuthority": 0x0001,
    "Shutdown": 0x0002,
    "Standby": 0x0003,
    "Resume": 0x0004,
    "Reset": 0x0005,
    "SetEmergency": 0x0006,
    "ClearEmergency": 0x0007,
    "RequestControl": 0x000D,
    "ReleaseControl": 0x000E,
    "ConfirmControl": 0x000F,
    "RejectControl": 0x0010,
    "SetTime": 0x0011,
    "CreateEvent": 0x01F0,
    "UpdateEvent": 0x01F1,
    "CancelEvent": 0x01F2,
    "ConfirmEventRequest": 0x01F3,
    "RejectEventRequest": 0x01F4,
    "CreateCommandEvent": 0x01F6,
    "SetElement": 0x041A,
    "DeleteElement": 0x041B,
    "ConfirmElementRequest": 0x041C,
    "RejectElementRequest": 0x041D,
    "RegisterServices": 0x0B00,
    "QueryAuthority": 0x2001,
    "QueryStatus": 0x2002,
    "QueryTimeout": 0x2003,
    "QueryControl": 0x200D,
    "QueryTime": 0x2011,
    "QueryEvents": 0x21F0,
    "QueryEventTimeout": 0x21F2,
    "QueryHeartbeatPulse": 0x2202,
    "QueryElement": 0x241A,
    "QueryElementList": 0x241B,
    "QueryElementCount": 0x241C,
    "QueryIdentification": 0x2B00,
    "QueryConfiguration": 0x2B01,
    "QuerySubsystemList": 0x2B02,
    "QueryServices": 0x2B03,
    "QueryServiceList": 0x2B04,
    "ReportAuthority": 0x4001,
    "ReportStatus": 0x4002,
    "ReportTimeout": 0x4003,
    "ReportControl": 0x400D,
    "ReportTime": 0x4011,
    "ReportEvents": 0x41F0,
    "Event": 0x41F1,
    "ReportEventTimeout": 0x41F2,
    "CommandEvent": 0x41F6,
    "ReportHeartbeatPulse": 0x4202,
    "ReportElement": 0x441A,
    "ReportElementList": 0x441B,
    "ReportElementCount": 0x441C,
    "ReportIdentification": 0x4B00,
    "ReportConfiguration": 0x4B01,
    "ReportSubsystemList": 0x4B02,
    "ReportServices": 0x4B03,
    "ReportServiceList": 0x4B04,
}
"""Messages of the module core_messages of the runtime, by name."""

SUBSYSTEM_TYPES = {
    "vehicle": 10001,
    "ocu": 20001,
    "other": 30001,
    "node": 40001,
    "payload": 50001,
    "component": 60001,
}
"""Type that Discovery reports, by literal of SubsystemType (AS5710, ReportIdentification)."""


def is_core_message(message: jaus.MessageDef) -> bool:
    """Tells whether the runtime brings the class of a message.

    Args:
        message: The message.
    """
    owner = message.eContainer()
    of_core = owner is not None and str(owner.urn).startswith(CORE)
    return of_core and CORE_MESSAGES.get(str(message.name)) == int(str(message.code), 16)


def with_inherited(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services and those that they inherit, the inherited ones first, each once.

    Args:
        services: The services.
    """
    found: list[jaus.Service] = []
    for service in services:
        chain = [service]
        while chain[-1].inherits is not None and chain[-1].inherits not in chain:
            chain.append(chain[-1].inherits)
        found += [each for each in reversed(chain) if each not in found]
    return found


def inherits(service: jaus.Service, name: str) -> bool:
    """Tells whether a service is, or inherits, a core service.

    Args:
        service: The service.
        name: Name of the core service, e.g. `Management`.
    """
    return any(each.urn == CORE + name for each in with_inherited([service]))


def service_identities(services: Iterable[jaus.Service]) -> tuple[Call, ...]:
    """Returns what Discovery reports of services and those that they inherit.

    Service sets of different age may inherit different versions of a core service; the component
    speaks the newest of them.

    Args:
        services: The services.
    """
    versions: dict[str, tuple[int, int]] = {}
    for service in with_inherited(services):
        major, minor = (int(part) for part in str(service.version).split("."))
        urn = str(service.urn)
        versions[urn] = max(versions.get(urn, (0, 0)), (major, minor))
    return tuple(
        Call("ServiceIdentity", (python_string(urn), str(major), str(minor)))
        for urn, (major, minor) in versions.items()
    )


def address_call(component: jaus.Component) -> Call:
    """Returns the address of a component as a Python expression.

    Args:
        component: The component.
    """
    return Call("JausAddress", tuple(str(int(part)) for part in component.address.split(".")))


TRANSPORTS = {"judp": "judp", "jtcp": "jtcp", "nodeManager": "node-manager"}
"""Values of the option `--jaus-transport` of a process, by literal of Transport."""

_TRANSPORT_KINDS = {"jtcp": "JTCP", "nodeManager": "NODE_MANAGER"}


def host_of(system: System, element: jaus.Component | ros.Node) -> Host | None:
    """Returns the host that an element runs on, the first one without a placement, or None.

    Args:
        system: The system.
        element: A component, bridge or node of the system.
    """
    for placement in system.placements:
        if element in (*placement.components, *placement.nodes):
            return placement.host
    return system.hosts[0] if system.hosts else None


def transport_settings(system: System, component: jaus.Component) -> Call:
    """Returns the transport settings of the host that a component runs on.

    Args:
        system: The system.
        component: The component.
    """
    host = host_of(system, component)
    if host is None:
        return Call("TransportSettings", ())
    arguments: list[str | Call] = [
        f"interface={python_string(host.interface)}",
        f"port={int(host.port)}",
        f"multicast_group={python_string(host.multicastGroup)}",
        f"multicast_ttl={int(host.multicastTtl)}",
    ]
    if host.transport.name in _TRANSPORT_KINDS:
        arguments.append(f"transport=TransportKind.{_TRANSPORT_KINDS[host.transport.name]}")
    others = _peers_elsewhere(system, host)
    if others:
        arguments.append(Call("address_book=peers", tuple(map(python_string, others))))
    return Call("TransportSettings", tuple(arguments))


def transport_names(system: System, component: jaus.Component) -> set[tuple[str, str]]:
    """Returns what `transport_settings` needs, as pairs of module and name.

    Args:
        system: The system.
        component: The component.
    """
    host = host_of(system, component)
    names = {"TransportSettings"}
    if host is not None and host.transport.name in _TRANSPORT_KINDS:
        names.add("TransportKind")
    if host is not None and _peers_elsewhere(system, host):
        names.add("peers")
    return {(runtime.FACE, name) for name in names}


def _peers_elsewhere(system: System, host: Host) -> list[str]:
    """Returns the components on other hosts, which TCP cannot find by itself."""
    if host.transport.name != "jtcp":
        return []
    elements = [*system.components, *system.bridges]
    placed = [(each, host_of(system, each)) for each in elements]
    return [
        f"{element.address}={where.interface}:{where.port}"
        for element, where in placed
        if where is not None and where is not host
    ]


def query_for(report: jaus.MessageDef, services: Iterable[jaus.Service]) -> jaus.MessageDef | None:
    """Returns the query that a report answers: QueryX for ReportX, or X.

    Args:
        report: The report.
        services: Where to look for the query.
    """
    name = str(report.name)
    wanted = f"Query{name.removeprefix('Report')}"
    for service in services:
        for query in service.inputs:
            if query.name == wanted:
                return query
    return None


def report_for(query: jaus.MessageDef, services: Iterable[jaus.Service]) -> jaus.MessageDef | None:
    """Returns the report that answers a query: ReportX, or X, for QueryX.

    Args:
        query: The query.
        services: Where to look for the report.
    """
    name = str(query.name)
    if not name.startswith("Query"):
        return None
    stem = name.removeprefix("Query")
    for service in services:
        for report in service.outputs:
            if report.name in (f"Report{stem}", stem):
                return report
    return None
