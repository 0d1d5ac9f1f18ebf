"""The JAUS network of a virtual world: datagrams from one process to the others."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import partial
from struct import Struct
from typing import TYPE_CHECKING, TypeAlias

from ..base.address import JausAddress, address_of
from ..base.settings import JUDP_GROUP, JUDP_PORT
from ..transports.packets.packet import parse_datagram
from ..transports.udp.datagrams import DatagramTransport
from .link import Link, Way

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

    from ..base.loop import Loop
    from ..base.settings import Endpoint, TransportSettings

Counts: TypeAlias = Counter[tuple[JausAddress, JausAddress]]
"""Datagrams by source and destination of what is in them."""

_ENDS = Struct("<II")
_ENDS_OFFSET = 5
_GROUP: Endpoint = (JUDP_GROUP, JUDP_PORT)


class Network:
    """Processes of a world, and the ways between them.

    A datagram passes the way out of its sender, and then the way into each receiver. One that goes
    to the group and is lost on the way out is lost for all.
    """

    def __init__(self, loop: Loop, random: Random, watch: Callable[[str, bytes], None]) -> None:
        self._loop = loop
        self._random = random
        self._watch = watch
        self._stations: dict[Endpoint, VirtualTransport] = {}
        self._made = 0

    def transport(
        self, settings: TransportSettings, out: Link, into: Link, draw: Callable[[int], int]
    ) -> VirtualTransport:
        """Return the transport of one more process, open.

        Args:
            draw: Returns a random number from 0 to below its argument, for sequence numbers.
        """
        self._made += 1
        number = self._made
        endpoint = (f"10.{number >> 16}.{number >> 8 & 255}.{number & 255}", JUDP_PORT)
        ways = (Way(self._loop, self._random, out), Way(self._loop, self._random, into))
        made = VirtualTransport(settings, self._loop, Station(self, endpoint, *ways), draw)
        made.open()
        return made

    def join(self, transport: VirtualTransport, endpoint: Endpoint) -> None:
        """Let a process be reached."""
        self._stations[endpoint] = transport

    def leave(self, endpoint: Endpoint) -> None:
        """Let a process be reached no more."""
        self._stations.pop(endpoint, None)

    def close(self) -> None:
        """Close all transports."""
        for each in list(self._stations.values()):
            each.close()

    def send(self, datagram: bytes, station: Station, to: Endpoint) -> None:
        """Let a datagram leave a process."""
        key = _ends(datagram)
        station.sent[key] += 1
        if not station.out.carry(partial(self._cross, datagram, station, to)):
            station.lost[key] += 1

    def _cross(self, datagram: bytes, station: Station, to: Endpoint) -> None:
        origin = station.endpoint
        if to == _GROUP:
            for receiver in [each for at, each in self._stations.items() if at != origin]:
                self._enter(datagram, origin, receiver)
        elif to in self._stations:
            self._enter(datagram, origin, self._stations[to])
        else:
            station.lost[_ends(datagram)] += 1

    def _enter(self, datagram: bytes, origin: Endpoint, receiver: VirtualTransport) -> None:
        station = receiver.station
        arrive = partial(self._arrive, datagram, origin, receiver)
        if station.into.link.is_plain and not station.into.is_cut:
            arrive()
        elif not station.into.carry(arrive):
            station.lost[_ends(datagram)] += 1

    def _arrive(self, datagram: bytes, origin: Endpoint, receiver: VirtualTransport) -> None:
        station = receiver.station
        if station.into.is_cut or station.unicast is None:
            station.lost[_ends(datagram)] += 1
            return
        station.received[_ends(datagram)] += 1
        self._watch(f"{origin[0]} to {station.endpoint[0]}", datagram)
        receiver.receive_datagram(datagram, origin)


class Station:
    """Where a process is on the network: the port that it sends from, and its two ways.

    Attributes:
        lost: Datagrams that got lost on one of its ways, or went to where nobody is.
    """

    group: Endpoint = _GROUP

    def __init__(self, network: Network, endpoint: Endpoint, out: Way, into: Way) -> None:
        self.endpoint = endpoint
        self.out = out
        self.into = into
        self.unicast: Station | None = None
        self.sent: Counts = Counter()
        self.received: Counts = Counter()
        self.lost: Counts = Counter()
        self._network = network

    def open(self, transport: VirtualTransport) -> None:
        """Join the network."""
        self.unicast = self
        self._network.join(transport, self.endpoint)

    def close(self) -> None:
        """Leave the network."""
        self.unicast = None
        self._network.leave(self.endpoint)

    def sendto(self, datagram: bytes, endpoint: Endpoint, /) -> int:
        """Send a datagram."""
        self._network.send(datagram, self, endpoint)
        return len(datagram)


class VirtualTransport(DatagramTransport):
    """Components of one process on the network of a virtual world; see ``VirtualWorld.transport``.

    What JUDP does with packets is done here as well, on the bytes of its datagrams: numbers,
    acknowledgements and repetitions, fragments, the search for who is where.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        station: Station,
        draw: Callable[[int], int],
    ) -> None:
        """Prepare a transport; ``VirtualWorld.transport`` makes it and opens it."""
        # There are no strangers in a world, so that nobody has to prove where it is.
        super().__init__(replace(settings, amplification_limit=0), loop, station, draw)
        self.station = station

    def open(self) -> None:
        """Join the network."""
        self._book.configure(self._settings.address_book)
        self.station.open(self)

    def close(self) -> None:
        """Leave the network; messages that wait for acknowledgement are reported as lost."""
        with self.loop.lock:
            self._sender.close()
            self._messenger.close()

    def receive_datagram(self, data: bytes, sender: Endpoint) -> None:
        """Take a datagram; never raises."""
        for packet in parse_datagram(data, self.counters):
            if not self._take_packet(packet, sender):
                self.counters.add("transport.not_for_us")

    @property
    def endpoint(self) -> Endpoint:
        """Where this process is reached."""
        return self.station.endpoint

    # ------------------------------------------------------------------ the network

    @property
    def out(self) -> Link:
        """What the way out of this process does; it may be changed at any time."""
        return self.station.out.link

    @out.setter
    def out(self, link: Link) -> None:
        self.station.out.link = link

    @property
    def into(self) -> Link:
        """What the way to this process does; it may be changed at any time."""
        return self.station.into.link

    @into.setter
    def into(self, link: Link) -> None:
        self.station.into.link = link

    def cut(self) -> None:
        """Let nothing pass in either direction; what is under way to this process is lost too."""
        self.station.out.is_cut = self.station.into.is_cut = True

    def restore(self) -> None:
        """Let all pass again as the links say."""
        self.station.out.is_cut = self.station.into.is_cut = False

    @property
    def sent(self) -> Counts:
        """Datagrams that this process has sent, by source and destination."""
        return self.station.sent

    @property
    def received(self) -> Counts:
        """Datagrams that have reached this process, by source and destination."""
        return self.station.received

    @property
    def lost(self) -> Counts:
        """Datagrams that got lost on the ways of this process, by source and destination.

        One that went to where nobody is any more is lost too.
        """
        return self.station.lost


def _ends(datagram: bytes) -> tuple[JausAddress, JausAddress]:
    destination, source = _ENDS.unpack_from(datagram, _ENDS_OFFSET)
    return address_of(source), address_of(destination)
