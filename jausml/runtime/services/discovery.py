"""The Discovery service: components and the services that they provide (AS5710)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ..base.address import WILDCARD_COMPONENT, WILDCARD_NODE, WILDCARD_SUBSYSTEM, JausAddress
from ..base.api import optional_part
from ..messages import (
    QueryConfiguration,
    QueryIdentification,
    QueryServiceList,
    QueryServices,
    QuerySubsystemList,
    RegisterServices,
    ReportConfiguration,
    ReportIdentification,
    ReportServiceList,
    ReportServices,
    ReportSubsystemList,
)
from ..wire.message import Message
from .definitions import CORE, VERSION_1_1, Scope, ServiceIdentity
from .host import Host

Catalog = Mapping[JausAddress, Sequence[ServiceIdentity]]

MAX_LIST = 255  # most entries of a list in a report
INSTANCE_ID = 0  # InstanceID of every component, since each has an address of its own


def register_services(services: Iterable[ServiceIdentity]) -> RegisterServices:
    """Returns the registration of a component's services."""
    return RegisterServices(service_list=_records(services))


def report_services(query: QueryServices, catalog: Catalog, subsystem: int) -> ReportServices:
    """Returns the services of the nodes and components that a QueryServices names.

    Unknown ones are left out, so that a query for one unknown node yields an empty list.
    """
    patterns = {
        JausAddress(subsystem, node.node_rec.node_id, component.component_id)
        for node in query.node_list
        for component in node.component_list
    }
    matches = {
        address: services
        for address, services in catalog.items()
        if not patterns.isdisjoint(_matching_patterns(address))
    }
    return ReportServices(node_list=_nodes(matches, matches))


def report_service_list(query: QueryServiceList, catalog: Catalog) -> ReportServiceList:
    """Returns the services of the subsystems, nodes and components that a query names.

    A SearchFilter selects services whose identifier contains it; one of several filters of an
    address is enough. Filters of one address beyond `MAX_LIST` are ignored.
    """
    # JAUS-DEVIATION: the meaning of SearchFilter is not known to us; taken as a part of the URI.
    filters: dict[JausAddress, set[str]] = {}
    for subsystem_entry in query.subsystem_list:
        for node_entry in subsystem_entry.node_list:
            for component in node_entry.component_list:
                pattern = JausAddress(
                    subsystem_entry.subsystem_rec.subsystem_id,
                    node_entry.node_rec.node_id,
                    component.component_id,
                )
                texts = filters.setdefault(pattern, set())
                # Each is searched for in all services; thousands would block the loop.
                if len(texts) < MAX_LIST:
                    texts.add(component.search_filter or "")
    matches: dict[JausAddress, Sequence[ServiceIdentity]] = {}
    for address, services in catalog.items():
        texts = set().union(*(filters.get(name, ()) for name in _matching_patterns(address)))
        matching = [service for service in services if any(text in service.urn for text in texts)]
        # Without a filter a component is listed even if it has no services.
        if matching or "" in texts:
            matches[address] = matching
    return ReportServiceList(
        subsystem_list=[
            ReportServiceList.SubsystemSeq(
                subsystem_rec=ReportServiceList.SubsystemRec(subsystem_id=subsystem),
                node_list=_nodes(members, matches),
            )
            for subsystem, members in grouped(matches, lambda address: address.subsystem)
        ]
    )


def _nodes(addresses: Iterable[JausAddress], catalog: Catalog) -> list[ReportServices.NodeSeq]:
    """Returns the nodes of components, with the services of these."""
    return [
        ReportServices.NodeSeq(
            node_rec=ReportServices.NodeRec(node_id=node),
            component_list=[
                ReportServices.ComponentSeq(component_record(address), _records(catalog[address]))
                for address in members
            ],
        )
        for node, members in grouped(addresses, lambda address: address.node)
    ]


def component_record(address: JausAddress) -> ReportServices.ComponentRec:
    """Returns the record of a component."""
    return ReportServices.ComponentRec(component_id=address.component, instance_id=INSTANCE_ID)


def _records(services: Iterable[ServiceIdentity]) -> list[ReportServices.ServiceRec]:
    return [
        ReportServices.ServiceRec(service.urn, service.major, service.minor) for service in services
    ]


def services_of(
    component: RegisterServices | ReportServices.ComponentSeq,
) -> tuple[ServiceIdentity, ...]:
    """Returns the services in a registration, or of a component in a report."""
    return tuple(
        ServiceIdentity(service.uri, service.major_version_number, service.minor_version_number)
        for service in component.service_list
    )


def _matching_patterns(address: JausAddress) -> list[JausAddress]:
    """Returns the address itself and all wildcard addresses that include it.

    A query may name tens of thousands of addresses, among which these eight are looked up.
    """
    return [
        JausAddress(subsystem, node, component)
        for subsystem in (address.subsystem, WILDCARD_SUBSYSTEM)
        for node in (address.node, WILDCARD_NODE)
        for component in (address.component, WILDCARD_COMPONENT)
    ]


def grouped(
    addresses: Iterable[JausAddress], key: Callable[[JausAddress], int]
) -> list[tuple[int, list[JausAddress]]]:
    """Returns addresses grouped by one of their parts, at most `MAX_LIST` groups."""
    groups: dict[int, list[JausAddress]] = {}
    for address in sorted(addresses):
        groups.setdefault(key(address), []).append(address)
    return list(groups.items())[:MAX_LIST]


Type = ReportIdentification.Type


class DiscoveryService:
    """Answers for the component, its node or its subsystem (AS5710, Discovery).

    A query of a wider scope is not answered. A service for more than its component has a
    `Directory` of the others. Discovery v1.0 has no QueryServiceList.
    """

    urns = frozenset([CORE + "Discovery"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._scope = component.settings.discovery_scope
        self._directory: Any = None

    def attach(self) -> None:
        """Takes the messages of Discovery."""
        component = self._component
        component.provide(QueryIdentification, ReportIdentification, self._identification)
        component.provide(QueryServices, ReportServices, self._services)
        if component.core_version("Discovery") >= VERSION_1_1:
            component.provide(
                QueryServiceList,
                ReportServiceList,
                lambda query, _: report_service_list(query, self._catalog()),
            )
        if self._scope < Scope.COMPONENT:
            self._directory = component.part(optional_part("services.directory", "Directory"))
            return
        component.provide(QueryConfiguration, ReportConfiguration, _no_answer)
        component.provide(QuerySubsystemList, ReportSubsystemList, _no_answer)
        component.handle(RegisterServices, self._ignore)

    def _identification(
        self, query: QueryIdentification, _sender: JausAddress
    ) -> ReportIdentification | None:
        if not Scope.SYSTEM <= query.query_type <= Scope.COMPONENT:
            return None
        scope = Scope(query.query_type)
        # Operator units send each component queries for the system, answered like the subsystem.
        if Scope.SYSTEM < scope < self._scope:
            return None
        name = self._component.name
        if scope <= Scope.SUBSYSTEM:
            name = self._component.settings.subsystem_name or name
        # Characters that a JAUS string cannot have are replaced.
        text = name.encode("latin-1", "replace").decode("latin-1")[:255]
        return ReportIdentification(scope, self._type(scope), text)

    def _type(self, scope: Scope) -> int:
        own = self._component.component_type
        if scope is Scope.NODE:
            return Type.NODE
        if scope is Scope.COMPONENT:
            return own if own >= Type.PAYLOAD else Type.COMPONENT
        return own if own < Type.NODE else Type.OTHER_SUBSYSTEM

    def _services(self, query: QueryServices, _sender: JausAddress) -> ReportServices:
        own = self._component.address.subsystem
        members = {
            address: services
            for address, services in self._catalog().items()
            if address.subsystem == own
        }
        return report_services(query, members, own)

    def _catalog(self) -> Mapping[JausAddress, tuple[ServiceIdentity, ...]]:
        """Returns the services of all components that it answers for."""
        own = {self._component.address: self._component.services}
        return own if self._directory is None else self._directory.catalog()

    def _ignore(self, _message: RegisterServices, _sender: JausAddress) -> None:
        self._component.counters.add("discovery.registration_ignored")


def _no_answer(_query: Message, _sender: JausAddress) -> None:
    """Returns None, as a component with a wider scope answers."""
