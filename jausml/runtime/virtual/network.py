"""The network of a virtual world: links that delay and lose datagrams."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from random import Random
from struct import Struct
from typing import TypeAlias

from ..base.address import JausAddress, address_of
from ..base.clocks import Alarm
from ..base.loop import Loop
from ..base.settings import JUDP_GROUP, JUDP_PORT, Endpoint, TransportSettings
from ..transports.packets.packet import parse_datagram
from ..transports.udp.datagrams import DatagramTransport

LONGEST_HOLD = 1.0  # seconds after which a held datagram goes on, if no other one overtakes it


@dataclass(frozen=True)
class Link:
    """Properties of a path for messages or datagrams, in one direction.

    Attributes:
        delay: Seconds of each.
        jitter: Longest additional delay in seconds, uniformly distributed. Later ones may
            overtake earlier ones; without jitter the order stays.
        exponential: Mean in seconds of a further, exponentially distributed delay.
        loss: Share that is lost, 0 to 1.
        burst: Mean number of losses in a row (Gilbert and Elliott); 0 makes losses independent.
        duplicate: Share that arrives twice, 0 to 1.
        reorder: Share that the next one overtakes, 0 to 1; without a next one it goes on after a
            second.

    Raises:
        ValueError: A value is out of its range, or the bursts are too short for the loss.
    """

    delay: float = 0.0
    jitter: float = 0.0
    exponential: float = 0.0
    loss: float = 0.0
    burst: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0

    def __post_init__(self) -> None:
        for name in ("delay", "jitter", "exponential"):
            if not 0 <= getattr(self, name) < float("inf"):
                raise ValueError(f"{name} is {getattr(self, name)}; it must be 0 s or more")
        for name in ("loss", "duplicate", "reorder"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it must lie in 0..1")
        if self.burst and not self.burst >= 1:
            raise ValueError(f"burst is {self.burst}; it is a number of packets, at least 1")
        # A burst begins with a probability of loss / (1 - loss) / burst, which is 1 at most.
        if self.burst and self.loss < 1 and self.loss > self.burst * (1 - self.loss):
            least = self.loss / (1 - self.loss)
            raise ValueError(f"a loss of {self.loss:g} takes bursts of at least {least:.3g}")

    @property
    def is_plain(self) -> bool:
        """Whether the path has no delay, loss or other effect."""
        return self == _PLAIN


_PLAIN = Link()


class Path:
    """A path with the properties of a link, and its state."""

    def __init__(self, loop: Loop, random: Random, link: Link) -> None:
        """Draws from `random` in the order of the calls of `carry`."""
        self.link = link  # may be set at any time
        self.is_cut = False
        self._loop = loop
        self._random = random
        self._is_losing = False
        self._held: list[Callable[[], None]] = []
        self._hold = Alarm(loop)

    def carry(self, arrive: Callable[[], None]) -> bool:
        """Has `arrive` called in later turns, once for each copy; returns False for a loss."""
        link = self.link
        # Draws only what the link needs: a plain one does not shift the draws of others.
        if self.is_cut or (link.loss and self._loses(link)):
            return False
        copies = 2 if link.duplicate and self._random.random() < link.duplicate else 1
        for _ in range(copies):
            if link.reorder and self._random.random() < link.reorder:
                self._hold_back(arrive)
            else:
                self._pass(arrive, link)
        return True

    def _loses(self, link: Link) -> bool:
        chance = self._random.random()
        if not link.burst or link.loss == 1:
            return chance < link.loss
        # Gilbert and Elliott: the chances of begin and end give the mean length and the loss.
        if self._is_losing:
            self._is_losing = chance >= 1 / link.burst
        else:
            self._is_losing = chance < link.loss / (1 - link.loss) / link.burst
        return self._is_losing

    def _pass(self, arrive: Callable[[], None], link: Link) -> None:
        self._send(arrive, link)
        # Those that it has overtaken follow.
        self._release()

    def _send(self, arrive: Callable[[], None], link: Link) -> None:
        delay = link.delay
        if link.jitter:
            delay += self._random.uniform(0.0, link.jitter)
        if link.exponential:
            delay += self._random.expovariate(1 / link.exponential)
        if delay:
            self._loop.call_later(delay, arrive)
        else:
            self._loop.call_soon(arrive)

    def _hold_back(self, arrive: Callable[[], None]) -> None:
        self._held.append(arrive)
        if not self._hold.is_set:
            self._hold.set(LONGEST_HOLD, self._release)

    def _release(self) -> None:
        """Sends those that were held back."""
        self._hold.cancel()
        held, self._held = self._held, []
        for arrive in held:
            self._send(arrive, self.link)


# Datagrams by source and destination of their first packet.
Counts: TypeAlias = Counter[tuple[JausAddress, JausAddress]]

_ENDS = Struct("<II")
_ENDS_OFFSET = 5
_GROUP: Endpoint = (JUDP_GROUP, JUDP_PORT)


class Network:
    """Processes of a world, and the paths between them.

    A datagram takes the path out of its sender, and then the path into each receiver. A multicast
    that is lost on the path out is lost for all.
    """

    def __init__(self, loop: Loop, random: Random, watch: Callable[[str, bytes], None]) -> None:
        self._loop = loop
        self._random = random
        self._watch = watch
        self._stations: dict[Endpoint, VirtualTransport] = {}
        self._count = 0

    def transport(
        self, settings: TransportSettings, out: Link, into: Link, draw: Callable[[int], int]
    ) -> VirtualTransport:
        """Returns the opened transport of a further process; `draw` gives its sequence numbers."""
        self._count += 1
        number = self._count
        endpoint = (f"10.{number >> 16}.{number >> 8 & 255}.{number & 255}", JUDP_PORT)
        paths = (Path(self._loop, self._random, out), Path(self._loop, self._random, into))
        transport = VirtualTransport(settings, self._loop, Station(self, endpoint, *paths), draw)
        transport.open()
        return transport

    def join(self, transport: VirtualTransport, endpoint: Endpoint) -> None:
        """Adds the transport at an endpoint."""
        self._stations[endpoint] = transport

    def leave(self, endpoint: Endpoint) -> None:
        """Removes the transport at an endpoint."""
        self._stations.pop(endpoint, None)

    def close(self) -> None:
        """Closes all transports."""
        for station in list(self._stations.values()):
            station.close()

    def send(self, datagram: bytes, station: Station, to: Endpoint) -> None:
        """Sends a datagram from a station to an endpoint or the group."""
        key = _ends(datagram)
        station.sent[key] += 1
        if not station.out.carry(partial(self._cross, datagram, station, to)):
            station.lost[key] += 1

    def _cross(self, datagram: bytes, station: Station, to: Endpoint) -> None:
        origin = station.endpoint
        if to == _GROUP:
            # A copy, as a receiver may leave the network at its arrival.
            for endpoint, receiver in tuple(self._stations.items()):
                if endpoint != origin:
                    self._enter(datagram, origin, receiver)
        elif to in self._stations:
            self._enter(datagram, origin, self._stations[to])
        else:
            station.lost[_ends(datagram)] += 1

    def _enter(self, datagram: bytes, origin: Endpoint, receiver: VirtualTransport) -> None:
        station = receiver.station
        arrive = partial(self._arrive, datagram, origin, receiver)
        if station.into.link.is_plain and not station.into.is_cut:
            # Without a further turn of the loop: the path out took one.
            arrive()
        elif not station.into.carry(arrive):
            station.lost[_ends(datagram)] += 1

    def _arrive(self, datagram: bytes, origin: Endpoint, receiver: VirtualTransport) -> None:
        station = receiver.station
        # Cut or closed before its arrival.
        if station.into.is_cut or station.unicast is None:
            station.lost[_ends(datagram)] += 1
            return
        station.received[_ends(datagram)] += 1
        self._watch(f"{origin[0]} to {station.endpoint[0]}", datagram)
        receiver.receive_datagram(datagram, origin)


class Station:
    """The endpoint of a process on the network, its two paths and its counts."""

    group: Endpoint = _GROUP

    def __init__(self, network: Network, endpoint: Endpoint, out: Path, into: Path) -> None:
        self.endpoint = endpoint
        self.out = out
        self.into = into
        self.unicast: Station | None = None
        self.sent: Counts = Counter()
        self.received: Counts = Counter()
        self.lost: Counts = Counter()  # on one of its paths, or at an unused endpoint
        self._network = network

    def open(self, transport: VirtualTransport) -> None:
        """Joins the network."""
        self.unicast = self
        self._network.join(transport, self.endpoint)

    def close(self) -> None:
        """Leaves the network."""
        self.unicast = None
        self._network.leave(self.endpoint)

    def sendto(self, datagram: bytes, endpoint: Endpoint, /) -> int:
        """Sends a datagram."""
        self._network.send(datagram, self, endpoint)
        return len(datagram)


class VirtualTransport(DatagramTransport):
    """Components of one process on the network of a virtual world; see ``VirtualWorld.transport``.

    It handles packets as JUDP does, on the bytes of datagrams: sequence numbers, acknowledgements
    and repetitions, fragments, discovery of endpoints.
    """

    def __init__(
        self, settings: TransportSettings, loop: Loop, station: Station, draw: Callable[[int], int]
    ) -> None:
        """Prepares a transport, which ``VirtualWorld.transport`` opens."""
        # Endpoints of a world are never forged, and need no proof.
        super().__init__(replace(settings, amplification_limit=0), loop, station, draw)
        self.station = station

    def open(self) -> None:
        """Joins the network."""
        self.address_book.configure(self._settings.address_book)
        self.station.open(self)

    def close(self) -> None:
        """Leaves the network; messages that wait for acknowledgement are reported as lost."""
        with self.loop.lock:
            self._sender.close()
            self._messenger.close()

    def receive_datagram(self, data: bytes, sender: Endpoint) -> None:
        """Takes a datagram; never raises."""
        for packet in parse_datagram(data, self.counters):
            if not self._take_packet(packet, sender):
                self.counters.add("transport.not_for_us")

    @property
    def endpoint(self) -> Endpoint:
        """The endpoint of this process."""
        return self.station.endpoint

    # ------------------------------------------------------------------ the network

    @property
    def out(self) -> Link:
        """The properties of the path out of this process; may be set at any time."""
        return self.station.out.link

    @out.setter
    def out(self, link: Link) -> None:
        self.station.out.link = link

    @property
    def into(self) -> Link:
        """The properties of the path into this process; may be set at any time."""
        return self.station.into.link

    @into.setter
    def into(self, link: Link) -> None:
        self.station.into.link = link

    def cut(self) -> None:
        """Loses all datagrams in both directions, also those under way to this process."""
        self.station.out.is_cut = self.station.into.is_cut = True

    def restore(self) -> None:
        """Ends `cut`."""
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
        """Datagrams lost on the paths of this process, by source and destination.

        Those to an unused endpoint are lost, too.
        """
        return self.station.lost


def _ends(datagram: bytes) -> tuple[JausAddress, JausAddress]:
    destination, source = _ENDS.unpack_from(datagram, _ENDS_OFFSET)
    return address_of(source), address_of(destination)
