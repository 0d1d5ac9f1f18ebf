"""Address book: where components are, learnt or configured, and from whom packets are taken."""

from __future__ import annotations

import ipaddress
import math
import socket
import sys
from collections import Counter, OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum, auto

from ..base.address import JausAddress, address_of
from ..base.counters import Counters
from ..base.settings import Endpoint, TransportSettings


@dataclass(slots=True, eq=False)
class Claim:
    """What a component without proof has sent and got, at the one endpoint that it claims."""

    host: str
    received: int = 0
    sent: int = 0
    wrong: int = 0
    questions: int = 0
    number: int | None = None  # what it is to acknowledge; None while it has not been asked
    asked: float = -math.inf
    asker: JausAddress | None = None
    held: list[bytes] = field(default_factory=list)


SOURCE_REFUSED = "transport.source_refused"
"""Packets in the name of a component that is heard from elsewhere."""

MAX_PEERS = 1024  # components that are remembered besides those that have a place of their own
_PROOF_LIFE = 60.0
_NOWHERE: Endpoint = ("", 0)
_LONG_AGO = -sys.float_info.max
_SEARCH_INTERVAL = 1.0


class Doubt(Enum):
    """What a sender does about the age of an address."""

    NONE = auto()  # nothing: the component was heard lately, or was asked a moment ago
    ASK = auto()  # ask for an acknowledgement, which tells whether the address is still right
    SEARCH = auto()  # look for the component by multicast as well: it did not answer


@dataclass(slots=True, eq=False)
class Entry:
    """Where a component is, when it was heard there last, and when it was asked whether it is."""

    endpoint: Endpoint  # where it is; nowhere once it is forgotten
    heard: float  # when it was heard last; never while it is suspected to be elsewhere
    asked: float = -math.inf  # when it was asked last, in doubt
    # When it was heard last before it was suspected, or proved where it is.
    spoke: float = -math.inf
    # What is owed while it has not proved where it is. It counts as never heard as long, so that
    # nothing goes to it beyond its credit.
    claim: Claim | None = None

    @property
    def latest(self) -> float:
        """When it was heard last, whatever is thought of it."""
        return max(self.heard, self.spoke)


class AddressBook:
    """UDP endpoints of components (AS5669A: the address of the newest datagram counts).

    A learnt endpoint replaces a configured one, since it is where the component is now. An endpoint
    from which nothing came for ``lifetime`` seconds is kept but doubted, so that a component that
    restarted on another port or host is found again.

    By that, whoever sends in the name of a component takes its traffic over. Fixed endpoints are
    learnt anew only after such a silence.

    Places are lent. When all are taken, a component that has not proved where it is gives way to
    the next one, and after those one of the host that has most; configured components and those in
    control have places of their own. So nobody is locked out, whatever others send.
    """

    def __init__(
        self,
        lifetime: float,
        counters: Counters,
        *,
        fixed: bool = False,
        places: int = MAX_PEERS,
        trusts: Callable[[Endpoint], bool] = lambda _endpoint: True,
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        """Knows nobody yet.

        An endpoint that is trusted needs no proof; changes of places, and doubts, are told.
        """
        self.lifetime = lifetime
        self._fixed = fixed
        self._places = places
        self._trusts = trusts
        self._changed = changed
        self._claims: dict[str, OrderedDict[JausAddress, Entry]] = {}
        self._kept: dict[JausAddress, JausAddress] = {}
        self._counters = counters
        self._configured: dict[JausAddress, Entry] = {}
        self.learnt: OrderedDict[int, Entry] = OrderedDict()  # the one silent longest first

    def configure(self, entries: Mapping[JausAddress, Endpoint]) -> None:
        """Adds configured endpoints; host names are resolved here, once.

        A name that cannot be resolved is counted as ``transport.unresolved_host`` and left out: the
        component can still be found by multicast.
        """
        for address, endpoint in resolve(entries, self._counters).items():
            self._configured[address] = Entry(endpoint, -math.inf)

    def find(self, address: JausAddress) -> Endpoint | None:
        """Returns the endpoint of a component, if known."""
        entry = self.learnt.get(address) or self._configured.get(address)
        return None if entry is None else entry.endpoint

    def learn(self, address: JausAddress, endpoint: Endpoint, now: float) -> bool:
        """Notes that a component was heard from an endpoint; returns whether it may be heard there.

        What is refused is counted, as ``transport.source_refused``.
        """
        entry = self.learnt.get(address)
        if entry is None:
            self._make_room()
            entry = self.learnt[address] = Entry(self.find(address) or endpoint, now)
            self._judge(address, entry, endpoint)
        elif self.refuses(address, entry, endpoint, now):
            return False
        else:
            self.learnt.move_to_end(address)
            if entry.endpoint != endpoint or now - entry.latest > _PROOF_LIFE:
                self._judge(address, entry, endpoint)
        if entry.claim is None:
            entry.heard = now
        else:
            entry.spoke = now
        if entry.endpoint != endpoint:
            self._counters.count(
                "transport.address_changed", f"{address} from {entry.endpoint} to {endpoint}"
            )
            entry.endpoint = endpoint
            self._changed()
        return True

    def prove(self, address: JausAddress, entry: Entry, now: float) -> None:
        """Believes that a component is where it says."""
        self._drop_claim(address, entry)
        entry.heard = now

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        """Gives the controller of an owner a place of its own, instead of the one before."""
        if address is None:
            self._kept.pop(owner, None)
        else:
            self._kept[owner] = address

    def is_kept(self, address: JausAddress) -> bool:
        """Returns whether a component has a place of its own: it is configured or in control."""
        return address in self._configured or address in self._kept.values()

    def _judge(self, address: JausAddress, entry: Entry, endpoint: Endpoint) -> None:
        """Decides whether a component must prove that it is at an endpoint."""
        self._drop_claim(address, entry)
        configured = self._configured.get(address)
        is_stated = configured is not None and configured.endpoint == endpoint
        if not is_stated and not self._trusts(endpoint):
            entry.claim = Claim(endpoint[0])
            entry.heard = -math.inf
            self._changed()
            self._claims.setdefault(endpoint[0], OrderedDict())[address] = entry

    def _drop_claim(self, address: JausAddress, entry: Entry) -> None:
        if entry.claim is None:
            return
        host = entry.claim.host
        entry.claim = None
        of_host = self._claims[host]
        del of_host[address]
        if not of_host:
            del self._claims[host]

    def refuses(self, address: JausAddress, entry: Entry, endpoint: Endpoint, now: float) -> bool:
        """Returns whether a component may not be heard from an endpoint; it is counted then."""
        if entry.endpoint == endpoint or not self._stands(entry, now):
            return False
        detail = f"{address} at {endpoint}: it is heard from {entry.endpoint}"
        self._counters.count(SOURCE_REFUSED, detail)
        return True

    def _stands(self, entry: Entry, now: float) -> bool:
        """Returns whether an endpoint is fixed, and nobody else can have it yet."""
        return self._fixed and entry.claim is None and now - entry.latest < self.lifetime

    def _make_room(self) -> None:
        """Lets a component give way when all places are taken."""
        if len(self.learnt) < self._places:
            return
        own = {*self._configured, *self._kept.values()}
        if len(self.learnt) - sum(address in self.learnt for address in own) < self._places:
            return
        forgotten = self._claimant(own) or self._silent_longest(own)
        entry = self.learnt.pop(forgotten)
        self._drop_claim(forgotten, entry)
        entry.endpoint = _NOWHERE
        self._changed()
        self._counters.count("transport.address_book_full", f"forgot {forgotten}")

    def _claimant(self, own: set[JausAddress]) -> JausAddress | None:
        """Returns the oldest claim of the host that has most; None where nobody has any."""
        for of_host in sorted(self._claims.values(), key=len, reverse=True):
            for address in of_host:
                if address not in own:
                    return address
        return None

    def _silent_longest(self, own: set[JausAddress]) -> JausAddress:
        """Returns who is silent longest of the host that has most places."""
        others = [address for address in self.learnt if address not in own]
        sizes = Counter(self.learnt[other].endpoint[0] for other in others)
        largest = max(sizes.values())
        return address_of(
            next(other for other in others if sizes[self.learnt[other].endpoint[0]] == largest)
        )

    def suspect(self, address: JausAddress, since: float) -> None:
        """Doubts an endpoint at once, because the component failed to acknowledge.

        Who was heard after the first packet without acknowledgement is there still.
        """
        entry = self.learnt.get(address) or self._configured.get(address)
        if entry is not None and entry.heard < since:
            entry.spoke = entry.latest
            entry.heard = -math.inf
            self._changed()
            entry.asked = max(entry.asked, _LONG_AGO)

    def doubt(self, address: JausAddress, now: float) -> Doubt:
        """Returns what to do about the age of a known endpoint when sending to it."""
        entry = self.learnt.get(address) or self._configured.get(address)
        if entry is None or now - entry.heard < self.lifetime:
            return Doubt.NONE
        if entry.asked <= entry.heard:
            entry.asked = now
            return Doubt.ASK
        if now - entry.asked < _SEARCH_INTERVAL:
            return Doubt.NONE
        entry.asked = now
        return Doubt.SEARCH


def resolve(
    entries: Mapping[JausAddress, Endpoint], counters: Counters
) -> dict[JausAddress, Endpoint]:
    """Returns entries with IPv4 addresses for host names.

    A name that cannot be resolved is counted as ``transport.unresolved_host`` and left out.
    """
    resolved: dict[JausAddress, Endpoint] = {}
    for address, (host, port) in entries.items():
        try:
            resolved[address] = (socket.gethostbyname(host), port)
        except OSError as error:
            counters.count("transport.unresolved_host", f"{address} at {host}: {error}")
    return resolved


NOT_ALLOWED = "transport.source_not_allowed"  # packets of hosts that are not allowed


class AllowedHosts:
    """The hosts that the settings name; any host when they name none.

    JAUS has no authentication: whoever reaches the port is heard (AS5669A). An IPv4 address can be
    forged too: this keeps out who is there by mistake, or cannot send in the name of another.

    Processes of the same host are always allowed: they share its port, and pass packets on to each
    other (docs/adr/0006).
    """

    def __init__(self, settings: TransportSettings, counters: Counters) -> None:
        self._counters = counters
        named = (*settings.allowed_hosts, settings.interface) if settings.allowed_hosts else ()
        networks = [ipaddress.IPv4Network(host) for host in named]
        self._networks = [
            (int(network.netmask), int(network.network_address)) for network in networks
        ]

    def admits(self, endpoint: Endpoint) -> bool:
        """Returns whether packets of an endpoint are taken; it is counted if they are not."""
        if not self._networks:
            return True
        host = int.from_bytes(socket.inet_aton(endpoint[0]), "big")
        if any(host & mask == network for mask, network in self._networks):
            return True
        self._counters.count(NOT_ALLOWED, f"{endpoint[0]}:{endpoint[1]}")
        return False
