"""Use of the Discovery service of others: registration and search (AS5710, Discovery)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..address import BROADCAST
from ..core_messages import QueryIdentification, ReportIdentification, ReportServices
from ..services.definitions import Scope
from ..services.discovery_messages import (
    all_of,
    query_all_services,
    register_services,
    reported_services,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..address import JausAddress
    from ..component_base import ComponentBase
    from ..loop import Timer
    from ..services.definitions import ServiceIdentity

EAGER_TRIES = 3
"""Attempts in quick succession after the start."""

EAGER_INTERVAL = 5.0
"""Seconds between them."""

STEADY_INTERVAL = 15.0
"""Seconds between two attempts later on; also renews the registration."""


@dataclass(frozen=True)
class FoundComponent:
    """A component that Discovery has found.

    Attributes:
        address: Its address.
        services: What it provides.
    """

    address: JausAddress
    services: tuple[ServiceIdentity, ...]


@dataclass
class _Search:
    urn: str
    on_found: Callable[[FoundComponent], None]
    found: set[JausAddress]


class DiscoveryClient:
    """Registers one component with its subsystem and finds the providers of services."""

    def __init__(self, component: ComponentBase) -> None:
        """Listen to the answers of Discovery services."""
        self._component = component
        self._searches: list[_Search] = []
        self._timer: Timer | None = None
        self._tries = 0
        settings = component.settings
        self._registers = settings.register_services and settings.discovery_scope > Scope.SUBSYSTEM
        component.on_message(ReportIdentification, self._identified)
        component.on_message(ReportServices, self._services_reported)

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Search for the providers of a service until the component stops."""
        self._searches.append(_Search(urn, on_found, set()))
        if self._component.running:
            self.start()

    def start(self) -> None:
        """Look around now, and again and again."""
        self._tries = 0
        self._look_around()

    def stop(self) -> None:
        """Look around no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _look_around(self) -> None:
        self.stop()
        if self._registers:
            everyone = all_of(self._component.address.subsystem)
            self._component.send(QueryIdentification(query_type=Scope.SUBSYSTEM), everyone)
        if self._searches:
            self._component.send(query_all_services(), BROADCAST)
        if self._registers or self._searches:
            self._tries += 1
            delay = EAGER_INTERVAL if self._tries < EAGER_TRIES else STEADY_INTERVAL
            self._timer = self._component.loop.call_later(delay, self._look_around)

    def _identified(self, report: ReportIdentification, sender: JausAddress) -> None:
        own = self._component.address
        if (
            self._registers
            and report.query_type == Scope.SUBSYSTEM
            and sender.subsystem == own.subsystem
            and sender != own
        ):
            self._component.send(register_services(self._component.services), sender)

    def _services_reported(self, report: ReportServices, sender: JausAddress) -> None:
        if not self._searches:
            return
        for address, services in reported_services(report, sender.subsystem):
            for search in tuple(self._searches):
                offered = any(service.urn == search.urn for service in services)
                if offered and address not in search.found:
                    search.found.add(address)
                    self._component.call(search.on_found, FoundComponent(address, services))
