"""Address book: where components are, learnt from every datagram or configured."""

from __future__ import annotations

import math
import socket
import sys
from collections import OrderedDict
from enum import Enum, auto
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.address import JausAddress
    from ..base.counters import Counters
    from ..base.settings import Endpoint

SOURCE_REFUSED = "transport.source_refused"
"""Packets in the name of a component that is heard from elsewhere."""

_MAX_LEARNT = 1024
_NOWHERE: Endpoint = ("", 0)
_LONG_AGO = -sys.float_info.max
_SEARCH_INTERVAL = 1.0


class Doubt(Enum):
    """What a sender does about the age of an address."""

    NONE = auto()
    """Nothing: the component was heard lately, or was asked a moment ago."""
    ASK = auto()
    """Ask for an acknowledgement, which tells whether the address is still right."""
    SEARCH = auto()
    """Look for the component by multicast as well: it did not answer."""


class Entry:
    """Where a component is, when it was heard there last, and when it was asked whether it is.

    Attributes:
        endpoint: Where it is; nowhere once it is forgotten.
        heard: When it was heard last; never while it is suspected to be elsewhere.
        asked: When it was asked last, in doubt.
        spoke: When it was heard last before it was suspected.
    """

    __slots__ = ("asked", "endpoint", "heard", "spoke")

    def __init__(self, endpoint: Endpoint, heard: float) -> None:
        self.endpoint = endpoint
        self.heard = heard
        self.asked = -math.inf
        self.spoke = -math.inf


class AddressBook:
    """UDP endpoints of components (AS5669A: the address of the newest datagram counts).

    A learnt endpoint replaces a configured one, since it is where the component is now. An
    endpoint from which nothing came for ``lifetime`` seconds is kept but doubted, so that a
    component that restarted on another port or host is found again.

    By that, whoever sends in the name of a component takes its traffic over. Fixed endpoints are
    learnt anew only after such a silence, and others do not push them out while they are heard.

    Attributes:
        lifetime: Seconds of silence after which an endpoint is doubted.
        learnt: Components that were heard, the one silent longest first.
    """

    def __init__(self, lifetime: float, counters: Counters, *, fixed: bool = False) -> None:
        """Start empty.

        Args:
            lifetime: Seconds of silence after which an endpoint is doubted.
            counters: Where changed and refused endpoints are counted.
            fixed: Whether an endpoint stands for as long as the component is heard from it.
        """
        self.lifetime = lifetime
        self._fixed = fixed
        self._counters = counters
        self._configured: dict[JausAddress, Entry] = {}
        self.learnt: OrderedDict[int, Entry] = OrderedDict()

    def __len__(self) -> int:
        """Return how many components were learnt."""
        return len(self.learnt)

    def configure(self, entries: Mapping[JausAddress, Endpoint]) -> None:
        """Add configured endpoints; host names are resolved here, once.

        A name that cannot be resolved is counted as ``transport.unresolved_host`` and left out: the
        component can still be found by multicast.
        """
        for address, endpoint in resolve(entries, self._counters).items():
            self._configured[address] = Entry(endpoint, -math.inf)

    def find(self, address: JausAddress) -> Endpoint | None:
        """Return the endpoint of a component, if known."""
        entry = self.learnt.get(address) or self._configured.get(address)
        return None if entry is None else entry.endpoint

    def learn(self, address: JausAddress, endpoint: Endpoint, now: float) -> bool:
        """Note that a component was heard from an endpoint; return whether it may be heard there.

        What is refused is counted, as ``transport.source_refused``.
        """
        entry = self.learnt.get(address)
        if entry is None:
            if len(self.learnt) >= _MAX_LEARNT and not self._forget(now):
                self._counters.count(SOURCE_REFUSED, f"{address} at {endpoint}: too many others")
                return False
            entry = self.learnt[address] = Entry(self.find(address) or endpoint, now)
        elif self.refuses(address, entry, endpoint, now):
            return False
        else:
            self.learnt.move_to_end(address)
            entry.heard = now
        if entry.endpoint != endpoint:
            self._counters.count(
                "transport.address_changed", f"{address} from {entry.endpoint} to {endpoint}"
            )
            entry.endpoint = endpoint
        return True

    def refuses(self, address: JausAddress, entry: Entry, endpoint: Endpoint, now: float) -> bool:
        """Return whether a component may not be heard from an endpoint; it is counted then.

        Args:
            address: The component.
            entry: Its entry.
            endpoint: Where something came from.
            now: Time in seconds.
        """
        if entry.endpoint == endpoint or not self._stands(entry, now):
            return False
        detail = f"{address} at {endpoint}: it is heard from {entry.endpoint}"
        self._counters.count(SOURCE_REFUSED, detail)
        return True

    def _stands(self, entry: Entry, now: float) -> bool:
        """Return whether an endpoint is fixed, and nobody else can have it yet."""
        return self._fixed and now - max(entry.heard, entry.spoke) < self.lifetime

    def _forget(self, now: float) -> bool:
        """Make room by the component that is silent longest; return whether that may be."""
        forgotten = next(iter(self.learnt))
        entry = self.learnt[forgotten]
        if self._stands(entry, now):
            return False
        del self.learnt[forgotten]
        entry.endpoint = _NOWHERE
        self._counters.count("transport.address_book_full", f"forgot {forgotten}")
        return True

    def suspect(self, address: JausAddress) -> None:
        """Doubt an endpoint at once, because the component failed to acknowledge."""
        entry = self.learnt.get(address) or self._configured.get(address)
        if entry is not None:
            entry.spoke = max(entry.spoke, entry.heard)
            entry.heard = -math.inf
            entry.asked = max(entry.asked, _LONG_AGO)

    def doubt(self, address: JausAddress, now: float) -> Doubt:
        """Return what to do about the age of a known endpoint when sending to it."""
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
    """Return entries with IPv4 addresses for host names.

    A name that cannot be resolved is counted as ``transport.unresolved_host`` and left out.
    """
    resolved: dict[JausAddress, Endpoint] = {}
    for address, (host, port) in entries.items():
        try:
            resolved[address] = (socket.gethostbyname(host), port)
        except OSError as error:
            counters.count("transport.unresolved_host", f"{address} at {host}: {error}")
    return resolved
