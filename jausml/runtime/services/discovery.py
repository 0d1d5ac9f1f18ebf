"""The Discovery service: who is there, and what it provides (AS5710)."""

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

MAX_LIST = 255  # entries that a list of a report holds

INSTANCE_ID = 0
"""InstanceID of every component: old systems had several at one address, here there is one."""


def register_services(services: Iterable[ServiceIdentity]) -> RegisterServices:
    """Returns the registration of a component's services."""
    return RegisterServices(service_list=_records(services))


def report_services(query: QueryServices, catalog: Catalog, subsystem: int) -> ReportServices:
    """Returns what is known of the nodes and components that a QueryServices names.

    Unknown nodes and components are left out, so that a query for one unknown node yields an
    empty list.
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
    """Returns what is known of the subsystems, nodes and components that a query names.

    A SearchFilter keeps the services whose identifier contains it; one of several filters of an
    address is enough. Filters of one address beyond the length of a list are left out.
    """
    # JAUS-DEVIATION: the meaning of SearchFilter is not known to us; a part of the URI is taken.
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
                # Each is looked for in all services: thousands of them would hold up the rest.
                if len(texts) < MAX_LIST:
                    texts.add(component.search_filter or "")
    matches: dict[JausAddress, Sequence[ServiceIdentity]] = {}
    for address, services in catalog.items():
        texts = set().union(*(filters.get(name, ()) for name in _matching_patterns(address)))
        matching = [service for service in services if any(text in service.urn for text in texts)]
        # Without a filter a component is named even if it has no services.
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
    """Returns the nodes of some components, with what these provide."""
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
    """Returns what stands for a component."""
    return ReportServices.ComponentRec(component_id=address.component, instance_id=INSTANCE_ID)


def _records(services: Iterable[ServiceIdentity]) -> list[ReportServices.ServiceRec]:
    return [
        ReportServices.ServiceRec(service.urn, service.major, service.minor) for service in services
    ]


def services_of(
    component: RegisterServices | ReportServices.ComponentSeq,
) -> tuple[ServiceIdentity, ...]:
    """Returns the services that a component registers, or that a report names."""
    return tuple(
        ServiceIdentity(service.uri, service.major_version_number, service.minor_version_number)
        for service in component.service_list
    )


def _matching_patterns(address: JausAddress) -> list[JausAddress]:
    """Returns the address itself and all wildcard addresses that include it.

    A query may name tens of thousands of addresses; looking these few up in it keeps the answer
    cheap.
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
    """Groups addresses by one of their parts.

    Groups beyond `MAX_LIST` are dropped: a list on the wire holds no more.
    """
    groups: dict[int, list[JausAddress]] = {}
    for address in sorted(addresses):
        groups.setdefault(key(address), []).append(address)
    return list(groups.items())[:MAX_LIST]


Type = ReportIdentification.Type


class DiscoveryService:
    """Answers for the component, its node or its subsystem (AS5710, Discovery).

    A component that provides Discovery v1.0 knows no QueryServiceList. A query whose scope is wider
    than the service's own stays unanswered; one that answers for others has a `Directory` of them.
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
        component.provide(QueryConfiguration, ReportConfiguration, _not_told)
        component.provide(QuerySubsystemList, ReportSubsystemList, _not_told)
        component.handle(RegisterServices, self._ignore)

    def _identification(
        self, query: QueryIdentification, _sender: JausAddress
    ) -> ReportIdentification | None:
        if not Scope.SYSTEM <= query.query_type <= Scope.COMPONENT:
            return None
        scope = Scope(query.query_type)
        # Operator units ask single components for the system: it has the name of the subsystem.
        if Scope.SYSTEM < scope < self._scope:
            return None
        name = self._component.name
        if scope <= Scope.SUBSYSTEM:
            name = self._component.settings.subsystem_name or name
        # What a JAUS string cannot hold is replaced.
        text = name.encode("latin-1", "replace").decode("latin-1")[:255]
        return ReportIdentification(scope, self._type(scope), text)

    def _type(self, scope: Scope) -> int:
        known = self._component.component_type
        if scope is Scope.NODE:
            return Type.NODE
        if scope is Scope.COMPONENT:
            return known if known >= Type.PAYLOAD else Type.COMPONENT
        return known if known < Type.NODE else Type.OTHER_SUBSYSTEM

    def _services(self, query: QueryServices, _sender: JausAddress) -> ReportServices:
        own = self._component.address.subsystem
        members = {
            address: services
            for address, services in self._catalog().items()
            if address.subsystem == own
        }
        return report_services(query, members, own)

    def _catalog(self) -> Mapping[JausAddress, tuple[ServiceIdentity, ...]]:
        """Returns the services of whom it answers for."""
        own = {self._component.address: self._component.services}
        return own if self._directory is None else self._directory.catalog()

    def _ignore(self, _message: RegisterServices, _sender: JausAddress) -> None:
        self._component.counters.add("discovery.registration_ignored")


def _not_told(_query: Message, _sender: JausAddress) -> None:
    """Leaves what concerns others to a component that answers for them."""
