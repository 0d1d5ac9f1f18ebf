"""Registration with the Discovery service of the subsystem (AS5710, Discovery)."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import BROADCAST, JausAddress
from ..base.clocks import Alarm
from ..messages import QueryIdentification, ReportIdentification
from ..services.definitions import CORE, Scope
from ..services.discovery import register_services
from ..services.host import Host

EAGER_TRIES = 3  # attempts in quick succession after the start
EAGER_INTERVAL = 5.0  # seconds between them

STEADY_INTERVAL = 15.0
"""Seconds between two attempts later on; also renews the registration.

IOP asks every component to look around at least once in 5 minutes.
"""

OCU_TYPES = range(20001, 30001)
"""Component types of operator control units, which also look for the system's Discovery."""


class Registration:
    """Registers one component with its subsystem, and looks around for that again and again."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._askers: list[Callable[[], None]] = []
        self._timer = Alarm(component.loop)
        self._tries = 0
        # Where it is registered; None while nobody has answered.
        self.server: JausAddress | None = None
        self._heard = 0.0
        settings = component.settings
        serves = any(service.urn == CORE + "Discovery" for service in component.services)
        # The server of a subsystem looks around to know the servers of other subsystems.
        self._is_server = serves and settings.discovery_scope <= Scope.SUBSYSTEM
        self._registers = settings.register_services and not self._is_server
        component.on_message(ReportIdentification, self._identified)
        component.when_stopped(self.stop)

    def ask_as_well(self, ask: Callable[[], None]) -> None:
        """Asks somebody else's question whenever it looks around, from now on."""
        self._askers.append(ask)
        if self._component.running:
            self.start()

    def start(self) -> None:
        """Looks around now, and again and again."""
        self._tries = 0
        self._look_around()

    def stop(self) -> None:
        """Looks around no more."""
        self._timer.cancel()

    def _look_around(self) -> None:
        self.stop()
        self._notice_loss()
        identifies = self._registers or self._is_server
        if identifies:
            self._component.send(QueryIdentification(query_type=Scope.SUBSYSTEM), BROADCAST)
            if self._component.component_type in OCU_TYPES:
                self._component.send(QueryIdentification(query_type=Scope.SYSTEM), BROADCAST)
        for ask in self._askers:
            ask()
        if identifies or self._askers:
            self._tries += 1
            delay = EAGER_INTERVAL if self._tries < EAGER_TRIES else STEADY_INTERVAL
            self._timer.set(delay, self._look_around)

    def _notice_loss(self) -> None:
        """Takes a server for lost that answered nothing for long, and looks for it eagerly."""
        settings, now = self._component.settings, self._component.loop.now()
        if self.server is not None and now > self._heard + settings.discovery_timeout:
            self._component.counters.count("discovery_client.lost", str(self.server))
            self.server = None
            self._tries = 0

    def _identified(self, report: ReportIdentification, sender: JausAddress) -> None:
        own = self._component.address
        if (
            self._registers
            and report.query_type == Scope.SUBSYSTEM
            and sender.subsystem == own.subsystem
            and sender != own
        ):
            self.server = sender
            self._heard = self._component.loop.now()
            self._component.send(register_services(self._component.services), sender)
