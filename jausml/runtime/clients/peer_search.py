"""Peers found by the services that they provide, and kept while they are alive.

Discovery reports the providers of a service, and may report components that are gone. So a provider
becomes a peer when its own transport acknowledges a message, and is dropped when its transport
acknowledges no more; no service of the peer is needed for that.
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
    """Which of the components that a search finds become peers."""

    # One: of the same node, else of the same subsystem, else any; of these the lowest address.
    NEAREST = "nearest"
    FIRST = "first"  # the one that answers first
    ALL = "all"


@dataclass(frozen=True)
class PeerSearch:
    """A search for components by their services and their place.

    Attributes:
        services: URNs of services that a component must provide, all of them, of any version.
        subsystem: Its subsystem, 1 to 65534; 0 means any.
        node: Its node, 1 to 254; 0 means any.
        within: Its distance from the searching component: SYSTEM means any, SUBSYSTEM the same
            subsystem, NODE the same node.
        choice: Which of the found components become peers.

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
        """Returns whether another component than the own one has the services and the place."""
        return (
            address != own
            and self.subsystem in (0, address.subsystem)
            and self.node in (0, address.node)
            # SYSTEM lets a distance of 2 pass, SUBSYSTEM of 1, NODE none.
            and distance(own, address) <= Scope.NODE - self.within
            and all(urn in urns for urn in self.services)
        )

    def where_to_ask(self, own: JausAddress) -> JausAddress:
        """Returns the wildcard address to which the queries of the search are sent.

        It names every node of a subsystem, as one component may answer for all of them.
        """
        subsystem = self.subsystem if self.within is Scope.SYSTEM else own.subsystem
        return JausAddress(subsystem or WILDCARD_SUBSYSTEM, WILDCARD_NODE, WILDCARD_COMPONENT)

    def find(self, component: Host, on_change: OnChange) -> None:
        """Searches until a component stops; calls `on_change` with all peers at each change."""
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
    """Returns 0 for a component on the same node, 1 in the same subsystem, else 2."""
    if address.subsystem != own.subsystem:
        return 2
    return 0 if address.node == own.node else 1


CHECK_INTERVAL = 1.0  # seconds between two checks of a peer; the shortest between two queries
MISSED_CHECKS = 3  # checks in a row without acknowledgement after which a peer is gone
COLLECTING_TIME = 0.3  # seconds from the first answer to the choice, for further answers
SLOWEST_SEARCH = 5.0  # longest time in seconds between two queries while a search has no peer
STEADY_SEARCH = 15.0  # seconds between two queries of a search for all peers that has some
MAX_PROVIDERS = 1024  # providers that are remembered; a peer may invent any number


@dataclass
class _Provider:
    """A component that matches a search, according to Discovery."""

    address: JausAddress
    urns: frozenset[str]
    is_alive: bool = False
    missed: int = 0  # checks in a row without acknowledgement


class _RunningSearch:
    """A search under way, and its listeners in the component.

    Attributes:
        bound: The peers that it has found, which are kept while they are alive.
    """

    def __init__(self, component: Host, search: PeerSearch) -> None:
        self.criteria = search
        self.bound: tuple[JausAddress, ...] = ()
        self._component = component
        self._listeners: list[OnChange] = []

    def add(self, listener: OnChange) -> None:
        self._listeners.append(listener)
        if self.bound:
            self._component.loop.call_soon(partial(self._call, listener))

    def matches(self, provider: _Provider) -> bool:
        return self.criteria.matches(self._component.address, provider.address, provider.urns)

    def choose(self, alive: Sequence[_Provider]) -> None:
        """Keeps the peers that are alive, and replaces lost ones; calls listeners at a change."""
        addresses = [provider.address for provider in alive if self.matches(provider)]
        if self.criteria.choice is PeerChoice.ALL:
            chosen = tuple(sorted(addresses))
        else:
            kept = [address for address in self.bound if address in addresses]
            chosen = tuple(kept or self._best(addresses))
        if chosen != self.bound:
            self.bound = chosen
            for listener in self._listeners:
                self._call(listener)

    def _best(self, addresses: list[JausAddress]) -> list[JausAddress]:
        if self.criteria.choice is PeerChoice.FIRST:
            return addresses[:1]
        own = self._component.address
        return sorted(addresses, key=lambda address: (distance(own, address), address))[:1]

    def _call(self, listener: OnChange) -> None:
        self._component.call(listener, self.bound)


class PeerClient:
    """The searches of one component, and the peers that they have found."""

    def __init__(self, component: Host) -> None:
        """Sends nothing before the first search."""
        self._component = component
        self._discovery = component.part(DiscoveryClient)
        self._searches: dict[PeerSearch, _RunningSearch] = {}
        # In the order of their first acknowledgements.
        self._providers: dict[JausAddress, _Provider] = {}
        self._timer = Alarm(component.loop)
        self._choice = Alarm(component.loop)
        self._next_search = 0.0
        self._interval = CHECK_INTERVAL
        component.on_message(QueryIdentification, self._take_identification_query)
        component.when_stopped(self.stop)

    def find(self, search: PeerSearch, on_change: OnChange) -> None:
        """Searches until the component stops; calls `on_change` with all peers at each change."""
        if not self._searches:
            self._discovery.watch(self._add_provider)
            self._component.when_started(self._check)
        if search not in self._searches:
            self._searches[search] = _RunningSearch(self._component, search)
            self._interval, self._next_search = CHECK_INTERVAL, 0.0
        self._searches[search].add(on_change)

    def stop(self) -> None:
        """Stops all searches."""
        self._timer.cancel()
        self._choice.cancel()

    # ---- queries ----------------------------------------------------------------------------

    def _check(self) -> None:
        """Probes the peers, and sends the queries of open searches when due."""
        loop = self._component.loop
        self._timer.set(CHECK_INTERVAL, self._check)
        for address in self._peers():
            self._probe(self._providers[address])
        open_searches = [search for search in self._searches.values() if self._is_open(search)]
        if open_searches and loop.now() >= self._next_search:
            self._query(open_searches)

    def _query(self, searches: Sequence[_RunningSearch]) -> None:
        own = self._component.address
        for place in {search.criteria.where_to_ask(own) for search in searches}:
            self._discovery.ask_for_services(place)
        if all(search.bound for search in searches):
            self._interval = STEADY_SEARCH
        else:
            self._interval = min(self._interval * 2, SLOWEST_SEARCH)
        self._next_search = self._component.loop.now() + self._interval

    def _peers(self) -> set[JausAddress]:
        """Returns the peers of all searches."""
        return {address for search in self._searches.values() for address in search.bound}

    @staticmethod
    def _is_open(search: _RunningSearch) -> bool:
        return not search.bound or search.criteria.choice is PeerChoice.ALL

    def _take_identification_query(self, _query: QueryIdentification, sender: JausAddress) -> None:
        """Queries a component at once that identifies others, as components do at their start."""
        if sender not in self._providers and any(map(self._is_open, self._searches.values())):
            self._discovery.ask_for_services(sender)

    # ---- providers --------------------------------------------------------------------------

    def _add_provider(self, component: FoundComponent) -> None:
        urns = frozenset(service.urn for service in component.services)
        provider = _Provider(component.address, urns)
        former = self._providers.get(component.address)
        if former is not None:
            former.urns = urns
            if former.is_alive:
                self._choose_soon()
        elif not any(search.matches(provider) for search in self._searches.values()):
            return
        elif len(self._providers) >= MAX_PROVIDERS:
            self._component.counters.count("peer_client.too_many_found", str(component.address))
        else:
            self._providers[component.address] = provider
            self._probe(provider)

    def _probe(self, provider: _Provider) -> None:
        """Sends a message that the transport of any component acknowledges."""
        self._component.transport.send(
            self._component.address,
            provider.address,
            QueryHeartbeatPulse().encode(),
            acknowledge=True,
            on_result=partial(self._take_probe_result, provider),
        )

    def _take_probe_result(self, provider: _Provider, acknowledged: bool) -> None:  # noqa: FBT001
        if self._providers.get(provider.address) is not provider or not self._component.running:
            return
        provider.missed = 0 if acknowledged else provider.missed + 1
        if acknowledged and not provider.is_alive:
            provider.is_alive = True
            # It comes behind those that were alive before.
            del self._providers[provider.address]
            self._providers[provider.address] = provider
            self._choose_soon()
        elif not acknowledged and (provider.missed >= MISSED_CHECKS or not provider.is_alive):
            self._forget(provider)

    def _forget(self, provider: _Provider) -> None:
        """Drops a provider that is gone; searches for another one are due at once."""
        del self._providers[provider.address]
        if not provider.is_alive:
            return
        self._component.counters.count("peer_client.lost", str(provider.address))
        peers = self._peers()
        for other in list(self._providers.values()):
            if other.is_alive and other.address not in peers:  # when last probed
                other.is_alive = False
                self._probe(other)
        self._interval, self._next_search = CHECK_INTERVAL, 0.0
        self._choose()

    # ---- choice -----------------------------------------------------------------------------

    def _choose_soon(self) -> None:
        if not self._choice.is_set:
            self._choice.set(COLLECTING_TIME, self._choose)

    def _choose(self) -> None:
        self._choice.cancel()
        alive = [provider for provider in self._providers.values() if provider.is_alive]
        for search in self._searches.values():
            search.choose(alive)


class PeerFinder(Host):
    """A component that finds other components by their services."""

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Calls `on_found` once with each component that provides the service of a URN."""
        with self.loop.lock:
            self.part(DiscoveryClient).discover(urn, on_found)

    def find_peers(
        self, search: PeerSearch, on_change: Callable[[Sequence[JausAddress]], None]
    ) -> None:
        """Searches for components by their services until this component stops.

        Discovery reports the providers of the services. One becomes a peer when its transport
        acknowledges a message, and is dropped when three in a row stay unacknowledged. A peer is
        kept while it is alive, also when a nearer one appears.

        Args:
            on_change: Called with all peers, in order, whenever they change; empty when all are
                gone.
        """
        with self.loop.lock:
            self.part(PeerClient).find(search, on_change)
