"""Surveys of a network: subsystems, components and services by the answers of Discovery."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from jausml.live.peers.network import Network
from jausml.runtime import ComponentSettings, JausComponent, Scope
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.clients.discovery_client import ServicesById, query_services, reported_services
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import (
    QueryControl,
    QueryIdentification,
    QueryStatus,
    ReportControl,
    ReportIdentification,
    ReportServiceList,
    ReportServices,
    ReportStatus,
)
from jausml.runtime.services.definitions import ServiceIdentity

Services = dict[JausAddress, tuple[ServiceIdentity, ...]]

ROUND = 0.5  # least seconds between two rounds of queries, of which some may be lost

POLL = 0.01  # seconds between two checks for an answer

T = TypeVar("T")

_TYPE_NAMES = {
    10001: "vehicle",
    20001: "OCU",
    30001: "other subsystem",
    40001: "node",
    50001: "payload",
    60001: "component",
}


def awaited(look: Callable[[], T], seconds: float = math.inf) -> T:
    """Calls `look` until its result is true, at most so many seconds; returns the last result."""
    end = time.monotonic() + seconds
    while not (result := look()) and time.monotonic() < end:
        time.sleep(POLL)
    return result


def services_of(report: ReportServices | ReportServiceList, subsystem: int) -> Services:
    """Returns the services in a report by component (`subsystem`: for a ReportServices).

    Components of the JAUS Tool Set report a node record for each of their services.
    """
    services_by_address: dict[JausAddress, dict[ServiceIdentity, None]] = {}
    for address, services in reported_services(report, subsystem):
        services_by_address.setdefault(address, {}).update(dict.fromkeys(services))
    return {address: tuple(services) for address, services in services_by_address.items()}


def label_of(service: ServiceIdentity) -> str:
    """Returns the URN and version of a service, which is its label in the catalogue."""
    return f"{service.urn}/{service.major}.{service.minor}"


def controller_of(report: ReportControl) -> str:
    """Returns the JAUS id of the controller; 0.0.0 when there is none (AS5710)."""
    return f"{report.subsystem_id}.{report.node_id}.{report.component_id}"


@dataclass
class KnownComponent:
    """A component that was found.

    Attributes:
        type: Its reported type (AS5710, ReportIdentification), 0 if unknown.
        is_silent: Whether it answers other queries, but none of Discovery.
    """

    address: JausAddress
    identification: str = ""
    type: int = 0
    services: tuple[ServiceIdentity, ...] = ()
    is_silent: bool = False


@dataclass
class KnownSubsystem:
    """A subsystem and its components."""

    number: int
    identification: str = ""
    type: int = 0
    components: dict[JausAddress, KnownComponent] = field(default_factory=dict)


def type_name(number: int) -> str:
    """Returns the word for a type of ReportIdentification (AS5710); empty for 0."""
    return _TYPE_NAMES.get(number, f"type {number}" if number else "")


class Survey:
    """Sends queries of Discovery for one of our components, and collects the answers."""

    def __init__(self, component: JausComponent, peers: Sequence[JausAddress]) -> None:
        """Listens from now on.

        Args:
            peers: Components that are queried one by one, too, since multicast may miss them.
        """
        self._component = component
        self._peers = tuple(peers)
        self._subsystems: dict[int, KnownSubsystem] = {}
        self._queries_by_id = ServicesById(component)
        component.on_message(ReportIdentification, self._identified)
        component.on_message(ReportServices, self._services)
        component.on_message(ReportStatus, self._answered)
        component.on_message(ReportControl, self._answered)

    def take(self, duration: float) -> tuple[KnownSubsystem, ...]:
        """Queries all for `duration` seconds; returns the found subsystems, ordered by number."""
        end = time.monotonic() + duration
        while True:
            self.ask_all()
            left = end - time.monotonic()
            time.sleep(max(0.0, min(left, max(ROUND, duration / 3))))
            if time.monotonic() >= end:
                return self.known()

    def known(self) -> tuple[KnownSubsystem, ...]:
        """Returns the subsystems that were found so far, ordered by number."""
        with self._component.loop.lock:
            subsystems = [self._subsystems[number] for number in sorted(self._subsystems)]
            for subsystem in subsystems:
                subsystem.components = dict(sorted(subsystem.components.items()))
            return tuple(subsystems)

    def services(self, address: JausAddress) -> tuple[ServiceIdentity, ...]:
        """Returns the services of a component as known so far."""
        subsystem = self._subsystems.get(address.subsystem)
        component = subsystem.components.get(address) if subsystem else None
        return component.services if component else ()

    def services_within(self, seconds: float, address: JausAddress) -> tuple[ServiceIdentity, ...]:
        """Returns the services of a component; queries it and its subsystem if they are unknown."""
        known = self.services(address)
        if not known:
            self.ask(address)
            self.ask(JausAddress(address.subsystem, 255, 255))
            known = awaited(lambda: self.services(address), seconds)
        return known

    def forget(self, address: JausAddress) -> None:
        """Forgets a component, whose address another one may have now."""
        with self._component.loop.lock:
            subsystem = self._subsystems.get(address.subsystem)
            if subsystem is not None:
                subsystem.components.pop(address, None)

    def ask(self, destination: JausAddress) -> None:
        """Queries identification and services of one component, or of all of a wildcard."""
        for scope in (Scope.SUBSYSTEM, Scope.COMPONENT):
            self._component.send(QueryIdentification(query_type=scope), destination)
        self._component.send(query_services(), destination)

    def ask_all(self) -> None:
        """Queries all, also for state and controller, without waiting."""
        for destination in (BROADCAST, *self._peers):
            self.ask(destination)
            # Components without Discovery usually answer these.
            self._component.send(QueryStatus(), destination)
            self._component.send(QueryControl(), destination)

    def _identified(self, report: ReportIdentification, sender: JausAddress) -> None:
        if sender == self._component.address:
            return
        subsystem = self._subsystem(sender.subsystem)
        if report.query_type == Scope.SUBSYSTEM:
            subsystem.identification, subsystem.type = report.identification, report.type_
            self._at(sender).is_silent = False
        elif report.query_type == Scope.COMPONENT:
            component = self._at(sender)
            before, after = component.identification, report.identification
            if before and before != after:  # it is another component, with other services
                component.services = ()
                # Not for its name, which may differ each time.
                self._component.send(query_services(), sender)
            component.identification, component.type = after, report.type_
            component.is_silent = False

    def _services(self, report: ReportServices, sender: JausAddress) -> None:
        self._queries_by_id.take(report, sender)
        for address, services in services_of(report, sender.subsystem).items():
            if address != self._component.address and address.is_concrete:
                component = self._at(address)
                component.services, component.is_silent = services, False

    def _answered(self, _report: ReportStatus | ReportControl, sender: JausAddress) -> None:
        components = self._subsystem(sender.subsystem).components
        if sender not in components and sender != self._component.address:
            components[sender] = KnownComponent(sender, is_silent=True)

    def _subsystem(self, number: int) -> KnownSubsystem:
        return self._subsystems.setdefault(number, KnownSubsystem(number))

    def _at(self, address: JausAddress) -> KnownComponent:
        components = self._subsystem(address.subsystem).components
        return components.setdefault(address, KnownComponent(address))


def provided_services(
    network: Network, address: JausAddress, seconds: float
) -> tuple[ServiceIdentity, ...]:
    """Returns the services of a component, which a temporary component of ours queries."""
    with running_transport(network.settings) as transport:
        settings = ComponentSettings(register_services=False)
        component = JausComponent(
            transport, network.own, name="jausml", services=(), settings=settings
        )
        survey = Survey(component, tuple(network.settings.address_book))
        component.start()
        try:
            return survey.services_within(seconds, address)
        finally:
            component.stop()
