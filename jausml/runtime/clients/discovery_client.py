"""Search for components by what they provide (AS5710, Discovery)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..base.address import BROADCAST, JausAddress
from ..base.quirks import Quirk
from ..messages import QueryServiceList, QueryServices, ReportServiceList, ReportServices
from ..services.definitions import ServiceIdentity
from ..services.discovery import services_of
from ..services.host import Host
from .registration import Registration


def query_services(component: JausAddress = BROADCAST) -> QueryServices:
    """Returns the query for the services of one component, or of all by wildcards.

    Some stacks know no wildcards, and report nothing.
    """
    record = QueryServices.ComponentRec(component_id=component.component)
    node = QueryServices.NodeSeq(
        node_rec=QueryServices.NodeRec(node_id=component.node), component_list=[record]
    )
    return QueryServices(node_list=[node])


def query_service_lists(component: JausAddress = BROADCAST) -> QueryServiceList:
    """Returns the query of v1.1 for the services of one component, or of all by wildcards."""
    record = QueryServiceList.ComponentRec(component_id=component.component)
    node = QueryServiceList.NodeSeq(
        node_rec=QueryServiceList.NodeRec(node_id=component.node), component_list=[record]
    )
    subsystem = QueryServiceList.SubsystemSeq(
        subsystem_rec=QueryServiceList.SubsystemRec(subsystem_id=component.subsystem),
        node_list=[node],
    )
    return QueryServiceList(subsystem_list=[subsystem])


def reported_services(
    report: ReportServices | ReportServiceList, subsystem: int
) -> Iterator[tuple[JausAddress, tuple[ServiceIdentity, ...]]]:
    """Yields the components of a report and their services.

    ReportServices names no subsystem: its components are of `subsystem`.
    """
    if isinstance(report, ReportServices):
        subsystems = [(subsystem, report.node_list)]
    else:
        subsystems = [
            (entry.subsystem_rec.subsystem_id, entry.node_list) for entry in report.subsystem_list
        ]
    for subsystem_id, nodes in subsystems:
        for node in nodes:
            for component in node.component_list:
                component_id = component.component_rec.component_id
                address = JausAddress(subsystem_id, node.node_rec.node_id, component_id)
                yield address, services_of(component)


INTERVAL = 5.0  # seconds after which a component that reports nothing is asked again
_MAX_ASKED = 4096
MAX_FOUND = 4096  # components that a search remembers; a peer may invent any number


class ServicesById:
    """Asks peers whose report to a query with wildcards was empty for their own services."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._asked_at: dict[JausAddress, float] = {}

    def take(self, report: ReportServices, sender: JausAddress) -> None:
        """Asks the sender of an empty report; notes a sender that knows no wildcards."""
        now = self._component.loop.now()
        asked_at = self._asked_at.get(sender, -math.inf)
        if any(node.component_list for node in report.node_list):
            if now < asked_at + INTERVAL:
                quirks = self._component.transport.quirks
                quirks.learn(sender, Quirk.NO_WILDCARDS, "it reported nothing to a wildcard")
            return
        if now < asked_at + INTERVAL:
            return
        if len(self._asked_at) >= _MAX_ASKED:
            self._asked_at.clear()
        self._asked_at[sender] = now
        self._component.send(query_services(sender), sender)


@dataclass(frozen=True)
class FoundComponent:
    """A component that Discovery has found."""

    address: JausAddress
    services: tuple[ServiceIdentity, ...]


@dataclass
class _Search:
    urn: str
    on_found: Callable[[FoundComponent], None]
    addresses: set[JausAddress]


class DiscoveryClient:
    """Finds the providers of services for one component."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._searches: list[_Search] = []
        self._watchers: list[Callable[[FoundComponent], None]] = []
        self._services_by_id = ServicesById(component)
        component.on_message(ReportServices, self._services_reported)
        component.on_message(ReportServiceList, self._take)

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Searches for the providers of a service until the component stops."""
        self._searches.append(_Search(urn, on_found, set()))
        registration = self._component.part(Registration)
        if len(self._searches) == 1:
            registration.ask_as_well(lambda: self.ask_for_services(BROADCAST))
        elif self._component.running:
            registration.start()

    def watch(self, on_sighting: Callable[[FoundComponent], None]) -> None:
        """Calls `on_sighting` with each component of each report; sends no query."""
        self._watchers.append(on_sighting)

    def ask_for_services(self, place: JausAddress) -> None:
        """Sends the queries for services to an address, which may have wildcards."""
        # Peers of v1.0 know the first one alone.
        self._component.send(query_services(), place)
        self._component.send(query_service_lists(), place)

    def _services_reported(self, report: ReportServices, sender: JausAddress) -> None:
        if self._searches or self._watchers:
            self._services_by_id.take(report, sender)
        self._take(report, sender)

    def _take(self, report: ReportServices | ReportServiceList, sender: JausAddress) -> None:
        """Calls watchers and searches; the report is not read without any of them."""
        is_wanted = self._searches or self._watchers
        for address, services in reported_services(report, sender.subsystem) if is_wanted else ():
            component = FoundComponent(address, services)
            for watcher in self._watchers:
                watcher(component)
            for search in tuple(self._searches):
                self._add(search, component)

    def _add(self, search: _Search, component: FoundComponent) -> None:
        is_provider = any(service.urn == search.urn for service in component.services)
        if not is_provider or component.address in search.addresses:
            return
        if len(search.addresses) >= MAX_FOUND:
            self._component.counters.count(
                "discovery_client.too_many_found", str(component.address)
            )
        else:
            search.addresses.add(component.address)
            self._component.call(search.on_found, component)
