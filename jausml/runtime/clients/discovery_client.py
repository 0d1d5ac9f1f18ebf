"""Who is there: registration, search (AS5710, Discovery), and when each was last heard."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..base.address import BROADCAST
from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..base.quirks import Quirk
from ..messages import QueryIdentification, ReportIdentification, ReportServiceList, ReportServices
from ..services.definitions import CORE, Scope
from ..services.discovery_messages import (
    query_service_lists,
    query_services,
    register_services,
    reported_services,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..services.definitions import ServiceIdentity
    from ..services.host import Host

INTERVAL = 5.0
"""Seconds after which a component that reports nothing is asked again."""

_MOST_ASKED = 4096


class ServicesById:
    """Asks who reports no component to a query with wildcards for its own services."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._asked: dict[JausAddress, float] = {}

    def take(self, report: ReportServices, sender: JausAddress) -> None:
        """Ask if a report is empty; learn of who reports something then."""
        now = self._component.loop.now()
        asked = self._asked.get(sender, -math.inf)
        if any(node.component_list for node in report.node_list):
            if now < asked + INTERVAL:
                quirks = self._component.transport.quirks
                quirks.learn(sender, Quirk.NO_WILDCARDS, "it reported nothing to a wildcard")
            return
        if now < asked + INTERVAL:
            return
        if len(self._asked) >= _MOST_ASKED:
            self._asked.clear()
        self._asked[sender] = now
        self._component.send(query_services(sender), sender)


EAGER_TRIES = 3
"""Attempts in quick succession after the start."""

EAGER_INTERVAL = 5.0
"""Seconds between them."""

STEADY_INTERVAL = 15.0
"""Seconds between two attempts later on; also renews the registration.

IOP asks every component to look around at least once in 5 minutes.
"""

MAX_FOUND = 4096
"""Components that a search remembers; inventions of a peer must not fill the memory."""

OCU_TYPES = range(20001, 30001)
"""Component types of operator control units, which also look for the system's Discovery."""


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
    """Registers one component with its subsystem and finds the providers of services."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._searches: list[_Search] = []
        self._watchers: list[Callable[[FoundComponent], None]] = []
        self._asking_by_id = ServicesById(component)
        self._timer = Alarm(component.loop)
        self._tries = 0
        self.server: JausAddress | None = None
        self._heard = 0.0
        settings = component.settings
        serves = any(service.urn == CORE + "Discovery" for service in component.services)
        # The server of a subsystem looks around to know the servers of other subsystems.
        self._is_server = serves and settings.discovery_scope <= Scope.SUBSYSTEM
        self._registers = settings.register_services and not self._is_server
        component.on_message(ReportIdentification, self._identified)
        component.on_message(ReportServices, self._services_reported)
        component.on_message(ReportServiceList, self._take)
        component.when_stopped(self.stop)

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Search for the providers of a service until the component stops."""
        self._searches.append(_Search(urn, on_found, set()))
        if self._component.running:
            self.start()

    def watch(self, on_sighting: Callable[[FoundComponent], None]) -> None:
        """Tell every component that an answer names, each time; nobody is asked for that."""
        self._watchers.append(on_sighting)

    def ask_for_services(self, place: JausAddress) -> None:
        """Ask for components and their services.

        Args:
            place: Whom to ask: a component, or several by a wildcard.
        """
        # Peers of v1.0 know the first alone.
        self._component.send(query_services(), place)
        self._component.send(query_service_lists(), place)

    def start(self) -> None:
        """Look around now, and again and again."""
        self._tries = 0
        self._look_around()

    def stop(self) -> None:
        """Look around no more."""
        self._timer.cancel()

    def _look_around(self) -> None:
        self.stop()
        self._notice_loss()
        identifies = self._registers or self._is_server
        if identifies:
            self._component.send(QueryIdentification(query_type=Scope.SUBSYSTEM), BROADCAST)
            if self._component.component_type in OCU_TYPES:
                self._component.send(QueryIdentification(query_type=Scope.SYSTEM), BROADCAST)
        if self._searches:
            self.ask_for_services(BROADCAST)
        if identifies or self._searches:
            self._tries += 1
            delay = EAGER_INTERVAL if self._tries < EAGER_TRIES else STEADY_INTERVAL
            self._timer.set(delay, self._look_around)

    def _notice_loss(self) -> None:
        """Take a server for lost that answered nothing for long, and look for it eagerly."""
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

    def _services_reported(self, report: ReportServices, sender: JausAddress) -> None:
        if self._searches or self._watchers:
            self._asking_by_id.take(report, sender)
        self._take(report, sender)

    def _take(self, report: ReportServices | ReportServiceList, sender: JausAddress) -> None:
        """Tell what was found; nothing is read when nobody wants to know."""
        is_wanted = self._searches or self._watchers
        for address, services in reported_services(report, sender.subsystem) if is_wanted else ():
            component = FoundComponent(address, services)
            for watcher in self._watchers:
                watcher(component)
            for search in tuple(self._searches):
                self._tell(search, component)

    def _tell(self, search: _Search, component: FoundComponent) -> None:
        offered = any(service.urn == search.urn for service in component.services)
        if not offered or component.address in search.addresses:
            return
        if len(search.addresses) >= MAX_FOUND:
            self._component.counters.count(
                "discovery_client.too_many_found", str(component.address)
            )
        else:
            search.addresses.add(component.address)
            self._component.call(search.on_found, component)


SILENCE = 2.0
"""Seconds without a message after which a component that speaks again has come back."""

_NEVER = float("-inf")


class Presence:
    """When each component that is waited for has sent its last message, of whatever kind.

    Attributes:
        heard: By component when that was; kept by who takes the messages.
    """

    def __init__(self, component: Host) -> None:
        self._loop = component.loop
        self.heard: dict[JausAddress, float] = {}
        self._on_return: dict[JausAddress, list[Callable[[], None]]] = {}

    def watch(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Wait for a component.

        Args:
            on_return: Called when it speaks for the first time, or after a silence.
        """
        self.heard.setdefault(address, _NEVER)
        self._on_return.setdefault(address, []).append(on_return)

    def note(self, address: JausAddress, at: float) -> None:
        """Note a message of a component, which did not pass those who take messages."""
        last = self.heard.get(address)
        if last is not None:
            self.heard[address] = at
            if at - last > SILENCE:
                self.returned(address)

    def forget(self, address: JausAddress, on_return: Callable[[], None]) -> None:
        """Undo ``watch``."""
        actions = self._on_return.get(address, [])
        if on_return in actions:
            actions.remove(on_return)
        if not actions:
            self._on_return.pop(address, None)
            self.heard.pop(address, None)

    def returned(self, address: JausAddress) -> None:
        """Tell who waits for a component that it speaks again, after what its message says."""
        for action in self._on_return[address]:
            self._loop.call_soon(action)

    def heard_since(self, address: JausAddress, when: float) -> bool:
        """Tell whether a component that is waited for has sent a message since a time."""
        return self.heard.get(address, _NEVER) >= when

    def heard_lately(self, address: JausAddress) -> bool:
        """Tell whether a component that is waited for is audible now."""
        return self.heard_since(address, self._loop.now() - SILENCE)


PATIENCE = 3
"""Greetings without an answer after which somebody is told, once in each silence."""


class Greeter:
    """Asks peers for their identification until they speak, and again when they fall silent.

    Operator units of competitions, and components behind a router without multicast, learn of
    this component by that alone. Each peer gets one small query in ``EAGER_INTERVAL`` seconds at
    most, which is not repeated otherwise, and none while it was heard, with whatever message,
    within ``discovery_timeout`` of the settings: it may have been restarted after such a silence.

    Attributes:
        unanswered: How often each peer was greeted since it spoke last.
    """

    def __init__(self, component: Host) -> None:
        self._component = component
        self._presence = component.part(Presence)
        self.unanswered = dict.fromkeys(component.settings.greeted, 0)
        self._timer = Alarm(component.loop)
        component.when_stopped(self.stop)

    def start(self) -> None:
        """Greet now, and whoever is silent again and again."""
        for peer in self.unanswered:
            self._presence.watch(peer, self._heard)
        if self.unanswered:
            self._look()

    def stop(self) -> None:
        """Greet no more."""
        self._timer.cancel()
        for peer in self.unanswered:
            self._presence.forget(peer, self._heard)

    def _look(self) -> None:
        """Greet whoever was not heard for long."""
        component = self._component
        since = component.loop.now() - component.settings.discovery_timeout
        for peer in self.unanswered:
            if not self._presence.heard_since(peer, since):
                self._greet(peer)
        self._timer.set(EAGER_INTERVAL, self._look)

    def _greet(self, peer: JausAddress) -> None:
        self.unanswered[peer] += 1
        scope = self._component.settings.greeted[peer]
        self._component.counters.add("greeter.sent")
        self._component.send(QueryIdentification(query_type=scope), peer)
        if self.unanswered[peer] == PATIENCE:
            self._component.counters.count(
                "greeter.unanswered", f"{peer} has answered none of {PATIENCE} greetings"
            )

    def _heard(self) -> None:
        """Tell once of each peer that speaks after it was greeted."""
        since = self._component.loop.now() - self._component.settings.discovery_timeout
        for peer, tries in self.unanswered.items():
            if tries and self._presence.heard_since(peer, since):
                LOGGER.info("%s speaks, and is greeted no more", peer)
                self.unanswered[peer] = 0
