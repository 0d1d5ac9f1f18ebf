"""Address book: UDP endpoints of components, learnt or configured, and allowed hosts."""

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
    """Traffic with a component that has not proved yet that it is at its endpoint."""

    host: str
    received: int = 0  # bytes
    sent: int = 0  # bytes
    wrong: int = 0  # acknowledgements with a wrong number
    questions: int = 0  # packets sent for an acknowledgement
    number: int | None = None  # of the packet to be acknowledged; None before the first one
    asked: float = -math.inf
    asker: JausAddress | None = None
    held: list[bytes] = field(default_factory=list)  # datagrams that wait for the proof


SOURCE_REFUSED = "transport.source_refused"  # counter of packets of a component at another endpoint
MAX_PEERS = 1024  # components that are stored besides configured ones and those in control
_PROOF_LIFE = 60.0
_NOWHERE: Endpoint = ("", 0)
_LONG_AGO = -sys.float_info.max
_SEARCH_INTERVAL = 1.0


class Doubt(Enum):
    """What a sender does about an endpoint that may be out of date."""

    NONE = auto()  # nothing: the component was heard or asked lately
    ASK = auto()  # request an acknowledgement, which confirms the endpoint
    SEARCH = auto()  # also search for the component by multicast: it did not answer


@dataclass(slots=True, eq=False)
class Entry:
    """The endpoint of a component, and the times of its last packet and of the last question."""

    endpoint: Endpoint  # `_NOWHERE` once it is forgotten
    heard: float  # time of its last packet; -inf while the endpoint is suspected or not proved
    asked: float = -math.inf  # time of the last request for acknowledgement in doubt
    heard_in_doubt: float = -math.inf  # time of its last packet while `heard` is -inf
    claim: Claim | None = None  # while the component has not proved its endpoint

    @property
    def latest(self) -> float:
        """Time of its last packet, also while its endpoint is in doubt."""
        return max(self.heard, self.heard_in_doubt)


class AddressBook:
    """UDP endpoints of components (AS5669A: that of the newest datagram counts).

    A learnt endpoint replaces a configured one. An endpoint that was silent for ``lifetime``
    seconds is kept but doubted, so that a component is found again after a restart elsewhere.

    So a process that sends with the address of a component takes over its traffic. With ``fixed``,
    an endpoint is only replaced after such a silence.

    The number of places is limited. When all are taken, a component without proof of its endpoint
    is forgotten for a new one, or else one of the host with most components. Configured components
    and those in control are always kept. So no flood of packets locks other components out.
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
        """Stores no component yet.

        Args:
            trusts: Returns whether an endpoint needs no proof.
            changed: Called when an endpoint changes or is doubted.
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
        self.learnt: OrderedDict[int, Entry] = OrderedDict()  # by time of the last packet

    def configure(self, entries: Mapping[JausAddress, Endpoint]) -> None:
        """Adds configured endpoints; host names are resolved now, as by `resolve`."""
        for address, endpoint in resolve(entries, self._counters).items():
            self._configured[address] = Entry(endpoint, -math.inf)

    def find(self, address: JausAddress) -> Endpoint | None:
        """Returns the endpoint of a component; None if it is unknown."""
        entry = self.learnt.get(address) or self._configured.get(address)
        return None if entry is None else entry.endpoint

    def learn(self, address: JausAddress, endpoint: Endpoint, now: float) -> bool:
        """Learns the endpoint of a packet; returns False if the packet is refused and counted."""
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
            entry.heard_in_doubt = now
        if entry.endpoint != endpoint:
            self._counters.count(
                "transport.address_changed", f"{address} from {entry.endpoint} to {endpoint}"
            )
            entry.endpoint = endpoint
            self._changed()
        return True

    def prove(self, address: JausAddress, entry: Entry, now: float) -> None:
        """Accepts that a component has proved its endpoint."""
        self._drop_claim(address, entry)
        entry.heard = now

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        """Keeps the controller of an own component from now on, instead of the one before."""
        if address is None:
            self._kept.pop(owner, None)
        else:
            self._kept[owner] = address

    def is_kept(self, address: JausAddress) -> bool:
        """Returns whether a component is always kept: it is configured or in control."""
        return address in self._configured or address in self._kept.values()

    def _judge(self, address: JausAddress, entry: Entry, endpoint: Endpoint) -> None:
        """Decides whether a component must prove that it is at an endpoint."""
        self._drop_claim(address, entry)
        configured = self._configured.get(address)
        is_configured = configured is not None and configured.endpoint == endpoint
        if not is_configured and not self._trusts(endpoint):
            entry.claim = Claim(endpoint[0])
            entry.heard = -math.inf
            self._changed()
            self._claims.setdefault(endpoint[0], OrderedDict())[address] = entry

    def _drop_claim(self, address: JausAddress, entry: Entry) -> None:
        if entry.claim is None:
            return
        host = entry.claim.host
        entry.claim = None
        claims = self._claims[host]
        del claims[address]
        if not claims:
            del self._claims[host]

    def refuses(self, address: JausAddress, entry: Entry, endpoint: Endpoint, now: float) -> bool:
        """Returns whether a packet from another endpoint is refused, which is counted."""
        if entry.endpoint == endpoint or not self._is_fixed(entry, now):
            return False
        detail = f"{address} at {endpoint}: it is heard from {entry.endpoint}"
        self._counters.count(SOURCE_REFUSED, detail)
        return True

    def _is_fixed(self, entry: Entry, now: float) -> bool:
        """Returns whether an endpoint cannot be replaced yet."""
        return self._fixed and entry.claim is None and now - entry.latest < self.lifetime

    def _make_room(self) -> None:
        """Forgets a component if all places are taken."""
        if len(self.learnt) < self._places:
            return
        kept = {*self._configured, *self._kept.values()}
        if len(self.learnt) - sum(address in self.learnt for address in kept) < self._places:
            return
        forgotten = self._oldest_claimant(kept) or self._longest_silent(kept)
        entry = self.learnt.pop(forgotten)
        self._drop_claim(forgotten, entry)
        entry.endpoint = _NOWHERE
        self._changed()
        self._counters.count("transport.address_book_full", f"forgot {forgotten}")

    def _oldest_claimant(self, kept: set[JausAddress]) -> JausAddress | None:
        """Returns the oldest component without proof of the host with most; None without any."""
        for claims in sorted(self._claims.values(), key=len, reverse=True):
            for address in claims:
                if address not in kept:
                    return address
        return None

    def _longest_silent(self, kept: set[JausAddress]) -> JausAddress:
        """Returns the component of the host with most that has been silent longest."""
        hosts = {
            address: entry.endpoint[0]
            for address, entry in self.learnt.items()
            if address not in kept
        }
        sizes = Counter(hosts.values())
        largest = max(sizes.values())
        return address_of(next(address for address in hosts if sizes[hosts[address]] == largest))

    def suspect(self, address: JausAddress, since: float) -> None:
        """Doubts the endpoint of a component that failed to acknowledge a packet sent at `since`.

        A component that was heard after that time is not doubted.
        """
        entry = self.learnt.get(address) or self._configured.get(address)
        if entry is not None and entry.heard < since:
            entry.heard_in_doubt = entry.latest
            entry.heard = -math.inf
            self._changed()
            entry.asked = max(entry.asked, _LONG_AGO)

    def doubt(self, address: JausAddress, now: float) -> Doubt:
        """Returns what to do about a known endpoint before sending to it."""
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


NOT_ALLOWED = "transport.source_not_allowed"  # counter of packets of hosts that are not allowed


class AllowedHosts:
    """The hosts that the settings allow; all hosts if they name none.

    JAUS has no authentication (AS5669A), and an IPv4 address can be forged: this only keeps out
    hosts that send by mistake or cannot forge. Processes of the own host are always allowed, as
    they share its port and relay packets (docs/adr/0006).
    """

    def __init__(self, settings: TransportSettings, counters: Counters) -> None:
        self._counters = counters
        hosts = (*settings.allowed_hosts, settings.interface) if settings.allowed_hosts else ()
        networks = map(ipaddress.IPv4Network, hosts)
        self._networks = [(int(net.netmask), int(net.network_address)) for net in networks]

    def admits(self, endpoint: Endpoint) -> bool:
        """Returns whether packets of an endpoint are allowed; counts one that is not."""
        if not self._networks:
            return True
        host = int.from_bytes(socket.inet_aton(endpoint[0]), "big")
        if any(host & mask == network for mask, network in self._networks):
            return True
        self._counters.count(NOT_ALLOWED, f"{endpoint[0]}:{endpoint[1]}")
        return False
