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
EAGER_INTERVAL = 5.0  # seconds between these attempts

# Seconds between later attempts, which also renew the registration; IOP demands one in 5 minutes.
STEADY_INTERVAL = 15.0

# Component types of operator control units, which also query for the Discovery of the system.
OCU_TYPES = range(20001, 30001)


class Registration:
    """Registers one component with the Discovery of its subsystem, again and again."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._askers: list[Callable[[], None]] = []
        self._timer = Alarm(component.loop)
        self._tries = 0
        # The Discovery with which it is registered; None without any.
        self.server: JausAddress | None = None
        self._heard = 0.0
        settings = component.settings
        serves = any(service.urn == CORE + "Discovery" for service in component.services)
        # The server of a subsystem sends the queries to find the servers of other subsystems.
        self._is_server = serves and settings.discovery_scope <= Scope.SUBSYSTEM
        self._registers = settings.register_services and not self._is_server
        component.on_message(ReportIdentification, self._identified)
        component.when_stopped(self.stop)

    def ask_as_well(self, ask: Callable[[], None]) -> None:
        """Has `ask` called at each attempt from now on, to send further queries."""
        self._askers.append(ask)
        if self._component.running:
            self.start()

    def start(self) -> None:
        """Makes an attempt now, and further ones at intervals."""
        self._tries = 0
        self._attempt()

    def stop(self) -> None:
        """Stops making attempts."""
        self._timer.cancel()

    def _attempt(self) -> None:
        self.stop()
        self._notice_loss()
        sends_query = self._registers or self._is_server
        if sends_query:
            self._component.send(QueryIdentification(query_type=Scope.SUBSYSTEM), BROADCAST)
            if self._component.component_type in OCU_TYPES:
                self._component.send(QueryIdentification(query_type=Scope.SYSTEM), BROADCAST)
        for ask in self._askers:
            ask()
        if sends_query or self._askers:
            self._tries += 1
            delay = EAGER_INTERVAL if self._tries < EAGER_TRIES else STEADY_INTERVAL
            self._timer.set(delay, self._attempt)

    def _notice_loss(self) -> None:
        """Drops a server after `discovery_timeout` seconds without an answer."""
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
