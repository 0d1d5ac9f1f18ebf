"""Peers that are named, or found by the services that they provide, and kept while they live.

Who provides a service is told by Discovery, also by that of somebody who does not know that a
component is gone. A component is taken for a peer when its own transport acknowledges a message,
and let go when it acknowledges no more: that needs no service of it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial

from ..base.address import WILDCARD_COMPONENT, WILDCARD_NODE, WILDCARD_SUBSYSTEM, JausAddress
from ..base.clocks import Alarm
from ..messages import QueryHeartbeatPulse, QueryIdentification
from ..services.definitions import Scope
from ..services.host import Host
from .discovery_client import DiscoveryClient, FoundComponent
from .peer_binding import OnChange


class PeerChoice(Enum):
    """Which of the components that a search finds are taken."""

    NEAREST = "nearest"
    """One: of the same node, else of the same subsystem, else any; then the lowest address."""
    FIRST = "first"
    """One: that which answers first."""
    ALL = "all"
    """Every one."""


@dataclass(frozen=True)
class PeerSearch:
    """A search for components by what they provide and where they are.

    Attributes:
        services: URNs of services that a component must provide, all of them, of any version.
        subsystem: Where it must be, 1 to 65534; 0 means any subsystem.
        node: Where it must be, 1 to 254; 0 means any node.
        within: Where it must be, as seen from who searches: SYSTEM means anywhere, SUBSYSTEM in
            the same subsystem, NODE on the same node.
        choice: Which of those that are found are taken.

    Raises:
        ValueError: A number is out of its range, or the scope is COMPONENT.
    """

    services: tuple[str, ...]
    subsystem: int = 0
    node: int = 0
    within: Scope = Scope.SYSTEM
    choice: PeerChoice = PeerChoice.NEAREST

    def __post_init__(self) -> None:
        if not (
            0 <= self.subsystem < WILDCARD_SUBSYSTEM
            and 0 <= self.node < WILDCARD_NODE
            and self.within < Scope.COMPONENT
        ):
            raise ValueError(f"nothing can be found: {self}")

    def matches(self, own: JausAddress, address: JausAddress, urns: Collection[str]) -> bool:
        """Returns whether a component is one that the search looks for: never who searches."""
        return (
            address != own
            and self.subsystem in (0, address.subsystem)
            and self.node in (0, address.node)
            # SYSTEM lets a distance of 2 pass, SUBSYSTEM of 1, NODE none.
            and distance(own, address) <= Scope.NODE - self.within
            and all(urn in urns for urn in self.services)
        )

    def where_to_ask(self, own: JausAddress) -> JausAddress:
        """Returns the wildcard address of those who may know such components.

        Every node of a subsystem is asked, since one component may answer for all of them.
        """
        subsystem = self.subsystem if self.within is Scope.SYSTEM else own.subsystem
        return JausAddress(subsystem or WILDCARD_SUBSYSTEM, WILDCARD_NODE, WILDCARD_COMPONENT)

    def find(self, component: Host, on_change: OnChange) -> None:
        """Looks for such components until one stops, and tells all of them whenever they change."""
        component.part(PeerClient).find(self, on_change)

    def __str__(self) -> str:
        places = [
            f"on node {self.node}" if self.node else "",
            f"in subsystem {self.subsystem}" if self.subsystem else "",
            f"of the same {self.within.name.lower()}" if self.within > Scope.SYSTEM else "",
        ]
        services = " and ".join(urn.rpartition(":")[2] for urn in self.services)
        return " ".join(filter(None, [services, *places]))


def distance(own: JausAddress, address: JausAddress) -> int:
    """Returns how far another component is: 0 on the same node, 1 in the same subsystem, else 2."""
    if address.subsystem != own.subsystem:
        return 2
    return 0 if address.node == own.node else 1


CHECK_INTERVAL = 1.0
"""Seconds between two checks of a peer, and between two looks around at the fastest."""

MISSED_CHECKS = 3
"""Checks without acknowledgement after which a peer is taken for gone."""

COLLECTING_TIME = 0.3
"""Seconds from the first answer to the choice, in which further components may answer."""

SLOWEST_SEARCH = 5.0
"""Longest time in seconds between two looks around while a search has found nobody."""

STEADY_SEARCH = 15.0
"""Seconds between two looks around of a search that takes all and has some."""

MAX_PROVIDERS = 1024
"""Components that are remembered; inventions of a peer must not fill the memory."""


@dataclass
class _Provider:
    """A component of which Discovery says that it provides what somebody searches for."""

    address: JausAddress
    urns: frozenset[str]
    lives: bool = False
    missed: int = 0


class _RunningSearch:
    """A search under way, and all of the component who are told what it finds."""

    def __init__(self, component: Host, search: PeerSearch) -> None:
        self.search = search
        self.bound: tuple[JausAddress, ...] = ()
        self._component = component
        self._listeners: list[OnChange] = []

    def add(self, listener: OnChange) -> None:
        self._listeners.append(listener)
        if self.bound:
            self._component.loop.call_soon(partial(self._tell, listener))

    def matches(self, provider: _Provider) -> bool:
        return self.search.matches(self._component.address, provider.address, provider.urns)

    def choose(self, living: Sequence[_Provider]) -> None:
        """Keeps the peers that live, and takes others when they are wanted."""
        addresses = [provider.address for provider in living if self.matches(provider)]
        if self.search.choice is PeerChoice.ALL:
            chosen = tuple(sorted(addresses))
        else:
            kept = [address for address in self.bound if address in addresses]
            chosen = tuple(kept or self._best(addresses))
        if chosen != self.bound:
            self.bound = chosen
            for listener in self._listeners:
                self._tell(listener)

    def _best(self, addresses: list[JausAddress]) -> list[JausAddress]:
        if self.search.choice is PeerChoice.FIRST:
            return addresses[:1]
        own = self._component.address
        return sorted(addresses, key=lambda address: (distance(own, address), address))[:1]

    def _tell(self, listener: OnChange) -> None:
        self._component.call(listener, self.bound)


class PeerClient:
    """The searches of one component, and the peers that they have found."""

    def __init__(self, component: Host) -> None:
        """Listens to what Discovery tells; nothing is asked before there is a search."""
        self._component = component
        self._discovery = component.part(DiscoveryClient)
        self._finders: dict[PeerSearch, _RunningSearch] = {}
        # In the order in which they were found to live.
        self._providers: dict[JausAddress, _Provider] = {}
        self._timer = Alarm(component.loop)
        self._choice = Alarm(component.loop)
        self._next_search = 0.0
        self._interval = CHECK_INTERVAL
        component.on_message(QueryIdentification, self._newcomer)
        component.when_stopped(self.stop)

    def find(self, search: PeerSearch, on_change: OnChange) -> None:
        """Looks for peers until the component stops; tells all of them whenever they change."""
        if not self._finders:
            self._discovery.watch(self._sighted)
            self._component.when_started(self._check)
        if search not in self._finders:
            self._finders[search] = _RunningSearch(self._component, search)
            self._interval, self._next_search = CHECK_INTERVAL, 0.0
        self._finders[search].add(on_change)

    def stop(self) -> None:
        """Looks for nobody any more."""
        self._timer.cancel()
        self._choice.cancel()

    # ---- looking around ---------------------------------------------------------------------

    def _check(self) -> None:
        """Looks after the peers, and looks around when somebody is missing."""
        loop = self._component.loop
        self._timer.set(CHECK_INTERVAL, self._check)
        for address in self._bound():
            self._probe(self._providers[address])
        searching = [finder for finder in self._finders.values() if self._is_open(finder)]
        if searching and loop.now() >= self._next_search:
            self._look_around(searching)

    def _look_around(self, searching: Sequence[_RunningSearch]) -> None:
        own = self._component.address
        for place in {finder.search.where_to_ask(own) for finder in searching}:
            self._discovery.ask_for_services(place)
        if all(finder.bound for finder in searching):
            self._interval = STEADY_SEARCH
        else:
            self._interval = min(self._interval * 2, SLOWEST_SEARCH)
        self._next_search = self._component.loop.now() + self._interval

    def _bound(self) -> set[JausAddress]:
        return {address for finder in self._finders.values() for address in finder.bound}

    @staticmethod
    def _is_open(finder: _RunningSearch) -> bool:
        return not finder.bound or finder.search.choice is PeerChoice.ALL

    def _newcomer(self, _query: QueryIdentification, sender: JausAddress) -> None:
        """Asks a component that speaks at its start at once, not at the next look around."""
        if sender not in self._providers and any(map(self._is_open, self._finders.values())):
            self._discovery.ask_for_services(sender)

    # ---- providers --------------------------------------------------------------------------

    def _sighted(self, component: FoundComponent) -> None:
        urns = frozenset(service.urn for service in component.services)
        provider = _Provider(component.address, urns)
        known = self._providers.get(component.address)
        if known is not None:
            known.urns = urns
            if known.lives:
                self._choose_soon()
        elif not any(finder.matches(provider) for finder in self._finders.values()):
            return
        elif len(self._providers) >= MAX_PROVIDERS:
            self._component.counters.count("peer_client.too_many_found", str(component.address))
        else:
            self._providers[component.address] = provider
            self._probe(provider)

    def _probe(self, provider: _Provider) -> None:
        """Sends something that the provider's transport acknowledges, whatever it provides."""
        self._component.transport.send(
            self._component.address,
            provider.address,
            QueryHeartbeatPulse().encode(),
            acknowledge=True,
            on_result=partial(self._probed, provider),
        )

    def _probed(self, provider: _Provider, acknowledged: bool) -> None:  # noqa: FBT001 - OnResult
        if self._providers.get(provider.address) is not provider or not self._component.running:
            return
        provider.missed = 0 if acknowledged else provider.missed + 1
        if acknowledged and not provider.lives:
            provider.lives = True
            del self._providers[provider.address]
            self._providers[provider.address] = provider
            self._choose_soon()
        elif not acknowledged and (provider.missed >= MISSED_CHECKS or not provider.lives):
            self._forget(provider)

    def _forget(self, provider: _Provider) -> None:
        """Lets a provider go that is gone; whoever needs another looks around at once."""
        del self._providers[provider.address]
        if not provider.lives:
            return
        self._component.counters.count("peer_client.lost", str(provider.address))
        bound = self._bound()
        for other in list(self._providers.values()):
            if other.lives and other.address not in bound:  # that was a while ago
                other.lives = False
                self._probe(other)
        self._interval, self._next_search = CHECK_INTERVAL, 0.0
        self._choose()

    # ---- choice -----------------------------------------------------------------------------

    def _choose_soon(self) -> None:
        if not self._choice.is_set:
            self._choice.set(COLLECTING_TIME, self._choose)

    def _choose(self) -> None:
        self._choice.cancel()
        living = [provider for provider in self._providers.values() if provider.lives]
        for finder in self._finders.values():
            finder.choose(living)


class PeerFinder(Host):
    """A component that finds others by what they provide."""

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Reports each component that provides a service, by its URN, once for each found."""
        with self.loop.lock:
            self.part(DiscoveryClient).discover(urn, on_found)

    def find_peers(
        self, search: PeerSearch, on_change: Callable[[Sequence[JausAddress]], None]
    ) -> None:
        """Finds components by what they provide, and looks after them, until the component stops.

        Discovery tells who provides the services; a component is taken when its transport
        acknowledges a message, and let go when three in a row stay unacknowledged. One that is
        taken is kept while it lives, also when a nearer one appears.

        Args:
            on_change: Told all of them, in order, whenever they change; none when they are gone.
        """
        with self.loop.lock:
            self.part(PeerClient).find(search, on_change)
