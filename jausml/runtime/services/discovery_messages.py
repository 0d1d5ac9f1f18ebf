"""Builds the nested lists of what the Discovery service reports."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.address import WILDCARD_COMPONENT, WILDCARD_NODE, WILDCARD_SUBSYSTEM, JausAddress
from ..messages import (
    QueryServiceList,
    QueryServices,
    RegisterServices,
    ReportServiceList,
    ReportServices,
)
from .definitions import ServiceIdentity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    Catalog = Mapping[JausAddress, Sequence[ServiceIdentity]]

MAX_LIST = 255  # entries that a list of a report holds

INSTANCE_ID = 0
"""InstanceID of every component: old systems had several at one address, here there is one."""


def register_services(services: Iterable[ServiceIdentity]) -> RegisterServices:
    """Return the registration of a component's services."""
    return RegisterServices(service_list=_records(services))


def report_services(query: QueryServices, catalog: Catalog, subsystem: int) -> ReportServices:
    """Return what is known of the nodes and components that a QueryServices names.

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
    """Return what is known of the subsystems, nodes and components that a query names.

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
    """Return the nodes of some components, with what these provide."""
    return [
        ReportServices.NodeSeq(
            node_rec=ReportServices.NodeRec(node_id=node),
            component_list=[
                ReportServices.ComponentSeq(
                    component_rec=component_record(address), service_list=_records(catalog[address])
                )
                for address in members
            ],
        )
        for node, members in grouped(addresses, lambda address: address.node)
    ]


def component_record(address: JausAddress) -> ReportServices.ComponentRec:
    """Return what stands for a component."""
    return ReportServices.ComponentRec(component_id=address.component, instance_id=INSTANCE_ID)


def _records(services: Iterable[ServiceIdentity]) -> list[ReportServices.ServiceRec]:
    return [
        ReportServices.ServiceRec(service.urn, service.major, service.minor) for service in services
    ]


def services_of(
    component: RegisterServices | ReportServices.ComponentSeq,
) -> tuple[ServiceIdentity, ...]:
    """Return the services that a component registers, or that a report names."""
    return tuple(
        ServiceIdentity(service.uri, service.major_version_number, service.minor_version_number)
        for service in component.service_list
    )


def _matching_patterns(address: JausAddress) -> list[JausAddress]:
    """Return the address itself and all wildcard addresses that include it.

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
    """Group addresses by one of their parts.

    Groups beyond `MAX_LIST` are dropped: a list on the wire holds no more.
    """
    groups: dict[int, list[JausAddress]] = {}
    for address in sorted(addresses):
        groups.setdefault(key(address), []).append(address)
    return list(groups.items())[:MAX_LIST]
