"""Messenger: sends and receives messages as packets for any transport."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Generic

from ...base.address import JausAddress, address_of
from ...base.counters import LOGGER
from ...base.loop import Loop
from ...base.quirks import Quirk, Quirks
from ...base.settings import MAX_FRAGMENT_SIZE, TransportSettings
from ..delivery import MESSAGE_CODE_SIZE, Carrier, OnResult, Origin, ReliableCarrier, report
from .duplicates import Account
from .inbox import Inbox
from .outbox import Outbox, Outcome
from .outgoing import Packetizer
from .packet import AckNak, Broadcast, DataFlags, Packet, Priority

AT_ONCE = 10  # packets that a receiver takes in one burst
PER_SECOND = 8000  # packets that a receiver takes in a second
HELD_BY_PEERS = 50  # packets of an unfinished message that Junior and the JAUS Tool Set keep
OFTEN_ANEW = 2  # restarts of the numbers of a peer after which that is logged as a quirk
_MAX_DESTINATIONS = 256


@dataclass
class PeerTraffic:
    """Packets between a component of this process and a peer, without acknowledgements.

    Attributes:
        sent: Packets to the peer.
        outcome: Messages to the peer that were acknowledged or not.
        account: Packets of the peer; the lost ones are an upper bound unless the peer has a
            sequence of numbers for each destination, as components of jausml do.
    """

    own: JausAddress
    peer: JausAddress
    sent: int = 0
    outcome: Outcome = field(default_factory=Outcome)
    account: Account = field(default_factory=Account)


class Bursts:
    """Decides whether a large message can be sent in one burst, without acknowledgements.

    A node manager of Junior takes 10 datagrams each millisecond, and its receive buffer holds about
    20 of full size; further ones are lost.
    """

    def __init__(self) -> None:
        self._levels: dict[JausAddress, tuple[float, float]] = {}

    def fits(self, destination: JausAddress, count: int, now: float) -> bool:
        """Returns whether a destination can take packets now, and then counts them as sent."""
        level, since = self._levels.get(destination, (0.0, now))
        # The receiver has taken some packets meanwhile.
        level = max(0.0, level - (now - since) * PER_SECOND) + count
        if level > AT_ONCE:
            return False
        if len(self._levels) >= _MAX_DESTINATIONS:
            self._levels.clear()
        self._levels[destination] = level, now
        return True


class Messenger(Generic[Origin]):
    """Sends and receives the messages of the components of one process.

    A message of more packets than a receiver can take in one burst is sent with requests for
    acknowledgement in any case, since it is useless without one of its packets.

    Messages to components of this process do not use the network. The transport gives received
    packets to ``inbox``.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        carrier: Carrier[Origin],
        quirks: Quirks,
        draw: Callable[[int], int] | None = None,
    ) -> None:
        """Starts without components and messages.

        Args:
            carrier: Puts packets on the network. Unless it is reliable, packets are repeated until
                they are acknowledged.
            draw: Returns a random number from 0 to below its argument, for the first sequence
                number; by default that of the process.
        """
        self._loop = loop
        self._transmit = carrier.transmit
        self.packetizer = Packetizer(settings.fragment_size, draw)
        self._longest = settings.fragment_size
        self._bursts = Bursts()
        self._quirks = quirks
        self.outbox = Outbox(settings, loop, carrier, quirks)
        self._has_warned = False
        self._is_reliable = isinstance(carrier, ReliableCarrier)
        self._send_all = (
            carrier.transmit_all if isinstance(carrier, ReliableCarrier) else self._send_burst
        )
        self.inbox: Inbox[Origin] = Inbox(settings, loop, self.outbox.acknowledged, carrier, quirks)

    def close(self) -> None:
        """Reports messages that wait for acknowledgement as lost."""
        self.inbox.close()
        self.outbox.close()

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: bool,  # noqa: FBT001 - one caller
        on_result: OnResult | None,
        supersedes: bool = False,  # noqa: FBT001, FBT002 - as above
    ) -> None:
        """Sends one message; see ``Transport.send``."""
        if not source.is_concrete:
            raise ValueError(f"{source} does not name one component")
        if len(payload) < MESSAGE_CODE_SIZE:
            raise ValueError("a payload begins with a message code of two bytes")
        # A copy, as the caller may change a bytearray later.
        payload = bytes(payload)
        is_here = destination in self.inbox.receivers
        # Nearly all messages.
        if len(payload) <= self._longest and destination.is_concrete and not is_here:
            asks, count = acknowledge and not self._is_reliable, 1
            number = next(self.packetizer.numbers(source, destination)) & 0xFFFF
            wanted = AckNak.REQUESTED if asks else AckNak.NONE
            none, single = Broadcast.NONE, DataFlags.SINGLE
            packets = [Packet(destination, source, payload, number, priority, none, wanted, single)]
        elif refusal := self.packetizer.refusal(destination, len(payload)):
            detail = f"{len(payload)} bytes from {source} to {destination} are not sent"
            if destination.is_wildcard:
                detail += f"; a broadcast goes in one packet, of {MAX_FRAGMENT_SIZE} bytes at most"
            self._loop.counters.count(refusal, detail)
            report(self._loop, on_result, success=False)
            return
        elif is_here:
            number = self.packetizer.reserve(source, destination, 1)
            self._send_here(Packet(destination, source, payload, number, priority), on_result)
            return
        else:
            count = self.packetizer.count(destination, len(payload))
            asks = not self._is_reliable and (acknowledge or not self._can_take(destination, count))
            wanted = AckNak.REQUESTED if asks else AckNak.NONE
            packets = self.packetizer.packets(source, destination, payload, priority, wanted)
            if destination.is_wildcard and self.inbox.receivers_of(packets[0]):
                self._send_here(packets[0], on_result)
                # Reported once: components of this process get it for certain.
                on_result = None
        if asks:
            self.outbox.send(packets, on_result, best_effort=not acknowledge, supersedes=supersedes)
        else:
            self._send_all(packets, on_result)
        if count > HELD_BY_PEERS:
            self._warn_of_size(packets[0], count)

    def traffic(self) -> list[PeerTraffic]:
        """Returns the traffic of each pair of own component and peer; the last heard peer is last.

        To be called with the lock of the loop.
        """
        traffic_by_pair: dict[tuple[JausAddress, JausAddress], PeerTraffic] = {}
        for own in self.inbox.receivers:
            for peer, sent in self.packetizer.sent(own).items():
                if peer not in self.inbox.receivers:
                    traffic_by_pair[own, peer] = PeerTraffic(own, peer, sent)
        # A copy, as other threads send meanwhile.
        for (source, destination), outcome in list(self.outbox.outcomes.items()):
            pair = address_of(source), address_of(destination)
            if pair in traffic_by_pair:
                traffic_by_pair[pair].outcome = outcome
        for peer, own, account in self.inbox.duplicates.accounts():
            if account.restarts >= OFTEN_ANEW:
                self._quirks.learn(peer, Quirk.NUMBERS_ANEW, f"{account.restarts} times so far")
            # Removed and added again, so that the last heard peer is last.
            traffic = traffic_by_pair.pop((own, peer), None) or PeerTraffic(own, peer)
            traffic.account = account
            traffic_by_pair[own, peer] = traffic
        return list(traffic_by_pair.values())

    def _send_here(self, packet: Packet, on_result: OnResult | None) -> None:
        """Delivers to components of this process, in the next turn of the loop."""
        self._loop.call_soon(partial(self._deliver_here, packet, on_result))

    def _deliver_here(self, packet: Packet, on_result: OnResult | None) -> None:
        receivers = self.inbox.receivers_of(packet)
        self.inbox.deliver(packet, receivers)
        report(self._loop, on_result, success=bool(receivers))

    def _can_take(self, destination: JausAddress, count: int) -> bool:
        """Returns whether a destination can take so many packets in one burst."""
        if count == 1:
            return True
        # It has to wait for a large message under way, which only acknowledged messages can.
        if self.outbox.has_large(destination):
            return False
        return self._bursts.fits(destination, count, self._loop.now())

    def _send_burst(self, packets: list[Packet], on_result: OnResult | None) -> None:
        sent = [self._transmit(packet) for packet in packets]
        report(self._loop, on_result, success=all(sent))

    def _warn_of_size(self, packet: Packet, count: int) -> None:
        if not self._has_warned:
            self._has_warned = True
            LOGGER.warning(
                "a message to %s takes %d packets; Junior and the JAUS Tool Set hold %d of an "
                "unfinished message and lose it, though they acknowledge each (said once)",
                packet.destination,
                count,
                HELD_BY_PEERS,
            )
