"""JAUS components as targets see them: address, services, messages, settings of transport."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from jausml.generation.errors import GenerationError
from jausml.generation.literals import python_string
from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.system import Host, System
from jausml.language.model.model import Model
from jausml.language.project import library
from jausml.language.semantics.connections import calls
from jausml.language.semantics.hosts import endpoint_of, host_of
from jausml.language.semantics.jaus.core_services import (
    CORE,
    NEWEST_SET,
    answers_for_subsystem,
    with_standard,
)
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import (
    inputs_by_name,
    outputs_by_name,
    query_name,
    service_versions,
)
from jausml_generators.python.statements import call

SUBSYSTEM_TYPES = {
    "vehicle": 10001,
    "ocu": 20001,
    "other": 30001,
    "node": 40001,
    "payload": 50001,
    "component": 60001,
}
"""Type that Discovery reports, by literal of SubsystemType (AS5710, ReportIdentification)."""


def plain_components(system: System) -> list[jaus.Component]:
    """Returns the components of a system that are no bridges, and are not there already."""
    return [
        component
        for component in system.components
        if not isinstance(component, bridge.Bridge) and not component.external
    ]


def own_bridges(system: System) -> list[bridge.Bridge]:
    """Returns the bridges of a system that are not there already."""
    return [system_bridge for system_bridge in system.bridges if not system_bridge.external]


def with_inherited(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services and those that they inherit, the inherited ones first, each once."""
    return list(
        dict.fromkeys(ancestor for service in services for ancestor in reversed(lineage(service)))
    )


def inherits(service: jaus.Service, name: str) -> bool:
    """Tells whether a service is, or inherits, a core service."""
    return any(ancestor.urn == CORE + name for ancestor in lineage(service))


def provides(component: jaus.Component, name: str) -> bool:
    """Tells whether a component provides a core service."""
    return any(inherits(service, name) for service in with_standard(component))


def service_identities(component: jaus.Component) -> tuple[str, ...]:
    """Returns the identities for Discovery of the services of a component, inherited ones too."""
    versions = service_versions(component)
    urns = dict.fromkeys(str(service.urn) for service in with_inherited(with_standard(component)))
    return tuple(
        call("ServiceIdentity", python_string(urn), *map(str, versions[urn])) for urn in urns
    )


_OPTIONAL_SERVICES = {
    "urn:jaus:jss:iop:EnhancedAccessControl": "HandoffService",
    "urn:jaus:jss:iop:DigitalResourceDiscovery": "DigitalResourceService",
    "urn:jaus:jss:core:Time": "TimeService",
    "urn:jausml:MachineStates": "MachineStatesService",
    **{
        f"urn:jaus:jss:{owner}:ListManager": "ListManagerService"
        for owner in ("core", "mobility", "manipulator")
    },
}
"""Core services that a component of the runtime has where its class names them, by their URNs."""


def optional_services(component: jaus.Component) -> tuple[str, ...]:
    """Returns the classes of core services that not every component of the runtime has."""
    urns = (str(service.urn) for service in with_inherited(with_standard(component)))
    classes = dict.fromkeys(_OPTIONAL_SERVICES.get(urn, "") for urn in urns)
    return tuple(filter(None, classes))


def clients(system: System, component: jaus.Component) -> tuple[str, ...]:
    """Returns the classes of clients of others that a component of a system has from the start."""
    is_greeting = any(element.greet and element.external for element in _elements(system))
    is_server = answers_for_subsystem(component, _elements(system))
    return (*(("Greeter",) if is_greeting else ()), *(("Directory",) if is_server else ()))


def component_settings(system: System, component: jaus.Component) -> str:
    """Returns the modelled behaviour of a component as a Python expression."""
    arguments = [
        f"default_authority={int(component.defaultAuthority)}",
        f"control_timeout={int(component.controlTimeout)}",
        f"event_timeout={int(component.eventTimeout)}",
    ]
    arguments += _stated(component, _EVENT_BUDGETS)
    if answers_for_subsystem(component, _elements(system)):
        arguments.append("discovery_scope=Scope.SUBSYSTEM")
    greeted = [
        f"{address_call(element)}: Scope.{_SCOPES.get(element.type.name, 'COMPONENT')}"
        for element in _elements(system)
        if element.greet and element.external
    ]
    if greeted:
        arguments.append(f"greeted={{{', '.join(greeted)}}}")
    return call("ComponentSettings", *arguments)


def address_call(component: jaus.Component) -> str:
    """Returns the address of a component as a Python expression."""
    return call("JausAddress", *(str(int(part)) for part in component.address.split(".")))


def search_call(search: jaus.PeerSearch) -> str:
    """Returns a search for peers as a Python expression."""
    urns = [python_string(str(service.urn)) for service in search.services]
    arguments = [f"({', '.join(urns)},)" if len(urns) == 1 else f"({', '.join(urns)})"]
    arguments += [
        f"{feature}={number}"
        for feature, number in (("subsystem", search.subsystem), ("node", search.node))
        if number
    ]
    if search.within.name != "system":
        arguments.append(f"within=Scope.{search.within.name.upper()}")
    if search.choice.name != "nearest":
        arguments.append(f"choice=PeerChoice.{search.choice.name.upper()}")
    return call("PeerSearch", *arguments)


TRANSPORTS = {"judp": "judp", "jtcp": "jtcp", "nodeManager": "node-manager"}
"""Values of the option `--jaus-transport` of a process, by literal of Transport."""

_SCOPES = {"vehicle": "SUBSYSTEM", "ocu": "SUBSYSTEM", "other": "SUBSYSTEM", "node": "NODE"}
_FRAGMENT_SIZE = 4079
_EVENT_BUDGETS = {"maxEvents": "max_events", "eventRateBudget": "event_rate_budget"}
_TRANSPORT_BUDGETS = {
    "amplificationLimit": "amplification_limit",
    "maxPeers": "max_peers",
    "maxConnections": "max_connections",
    "idleTimeout": "idle_timeout",
}
_TRANSPORTS = {"jtcp": "JtcpTransport", "nodeManager": "NodeManagerTransport"}


def transport_settings(system: System, component: jaus.Component) -> str:
    """Returns the transport settings of a component: of its host, of its peers, and its own."""
    arguments = [*_host_arguments(system, component), *_source_arguments(component)]
    return call("TransportSettings", *arguments)


def _host_arguments(system: System, component: jaus.Component) -> list[str]:
    """Returns the arguments that differ from the runtime's defaults because of host and peers."""
    host = host_of(system, component)
    arguments = [] if host is None else _network_arguments(host)
    book = _address_book(system, host)
    if book:
        arguments.append(f"address_book={call('peers', *map(python_string, book))}")
    return arguments


def _network_arguments(host: Host) -> list[str]:
    arguments = [
        f"interface={python_string(host.interface)}",
        f"port={int(host.port)}",
        f"multicast_group={python_string(host.multicastGroup)}",
        f"multicast_ttl={int(host.multicastTtl)}",
    ]
    if host.fragmentSize != _FRAGMENT_SIZE:
        arguments.append(f"fragment_size={int(host.fragmentSize)}")
    if host.transport.name in _TRANSPORTS:
        # Named by its class, which a workspace has for being imported.
        arguments.append(f"transport={_TRANSPORTS[host.transport.name]}.KIND")
    return arguments


def _source_arguments(component: jaus.Component) -> list[str]:
    """Returns the arguments for the hosts from which a bridge takes messages."""
    if not isinstance(component, bridge.Bridge):
        return []
    arguments = []
    if component.allowedHosts:
        hosts = ", ".join(map(python_string, component.allowedHosts))
        comma = "," if len(component.allowedHosts) == 1 else ""
        arguments.append(f"allowed_hosts=({hosts}{comma})")
    if component.fixedSources:
        arguments.append("fixed_sources=True")
    return [*arguments, *_stated(component, _TRANSPORT_BUDGETS)]


def _stated(component: jaus.Component, budgets: Mapping[str, str]) -> list[str]:
    """Returns the budgets of a bridge that are not as the runtime has them by itself."""
    if not isinstance(component, bridge.Bridge):
        return []
    default = bridge.Bridge()
    return [
        f"{argument}={getattr(component, feature)!r}"
        for feature, argument in budgets.items()
        if getattr(component, feature) != getattr(default, feature)
    ]


def _address_book(system: System, host: Host | None) -> list[str]:
    """Returns the components that are not found from a host without being told where they are.

    Those are external components with a place of their own, and for TCP all on other hosts. Behind
    a node manager it is the node manager that knows.
    """
    transport = "judp" if host is None else host.transport.name
    if transport == "nodeManager":
        return []
    entries = []
    for element in _elements(system):
        where = host_of(system, element)
        place = endpoint_of(system, element)
        is_told = element.external if where is None else transport == "jtcp" and where is not host
        if is_told and place is not None:
            entries.append(f"{element.address}={place[0]}:{place[1]}")
    return entries


def _elements(system: System) -> list[jaus.Component]:
    return [*system.components, *system.bridges]


def query_for(
    report: jaus.MessageDef, services: Iterable[jaus.Service], whose: str
) -> jaus.MessageDef:
    """Returns the query that a report answers: QueryX for ReportX, or X.

    Raises:
        GenerationError: Neither the service of the report nor another of these has one.
    """
    own, wanted = report.eContainer(), query_name(report)
    for service in (*([own] if own is not None else []), *with_inherited(services)):
        if wanted in (known := inputs_by_name(service)):
            return known[wanted]
    raise GenerationError(f"{whose}: no query for {report.name}")


def report_for(query: jaus.MessageDef, services: Iterable[jaus.Service]) -> jaus.MessageDef | None:
    """Returns the report that answers a query: ReportX, or X, for QueryX."""
    name = str(query.name)
    if not name.startswith("Query"):
        return None
    stem = name.removeprefix("Query")
    for service in services:
        named = outputs_by_name(service)
        report = named.get(f"Report{stem}") or named.get(stem)
        if report is not None:
            return report
    return None


def services_of(
    components: Iterable[jaus.Component], bridges: Iterable[bridge.Bridge]
) -> Iterator[jaus.Service]:
    """Yields the services that components and bridges provide, use, or have messages of."""
    for component in components:
        yield from component.provides
        yield from component.uses
        for connection in component.connections:
            yield from _owners(connection.message, connection.query)
    for owner in bridges:
        for bridge_connection in owner.bridgeConnections:
            yield from _owners(bridge_connection.map.message, bridge_connection.query)
        for each_call in owner.serviceConnections:
            yield from _owners(*calls.messages(each_call))
        for each_list in owner.actionConnections:
            yield each_list.driver
            yield from _owners(each_list.element.message)


def _owners(*messages: jaus.MessageDef | None) -> Iterator[jaus.Service]:
    owners = (message.eContainer() for message in messages if message is not None)
    yield from (owner for owner in owners if owner is not None)


def used_services(model: Model) -> list[jaus.Service]:
    """Returns the services whose messages the components of a system send or receive.

    The core services come last; every component has some of them from the runtime.
    """
    system = system_of(model)
    services = list(
        dict.fromkeys(services_of((*system.components, *system.bridges), system.bridges))
    )
    own = [service for service in with_inherited(services) if not _is_core(service)]
    old = [service for service in with_inherited(services) if _is_core(service)]
    return [*own, *library_services(NEWEST_SET), *old]


def library_services(pattern: str = "*.xmi") -> list[jaus.Service]:
    """Returns the services of the shipped library, by file and place in it.

    Args:
        pattern: Which of its JAUS models.
    """
    model = library("jaus")
    meant = [document for document in model.documents if document.path.match(pattern)]
    return [
        service for service in model.instances(jaus.Service) if model.document_of(service) in meant
    ]


def _is_core(service: jaus.Service) -> bool:
    return str(service.urn).startswith(CORE)
