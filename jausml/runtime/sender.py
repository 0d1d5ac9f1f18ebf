"""From messages to packets on the network."""

from __future__ import annotations

import random
import threading
from typing import TYPE_CHECKING

from .address_book import AddressBook, Doubt
from .packet import AckNak, Broadcast, DataFlags, Packet

if TYPE_CHECKING:
    from .address import JausAddress
    from .loop import Loop
    from .packet import Priority
    from .settings import Endpoint, TransportSettings
    from .shared_port import SharedPort

_MAX_FRAGMENTS = 32768


class Sender:
    """Numbers packets and sends each where its destination is, from any thread."""

    def __init__(
        self, settings: TransportSettings, loop: Loop, port: SharedPort, book: AddressBook
    ) -> None:
        """Prepare to send.

        Args:
            settings: Size of fragments.
            loop: Its clock and counters are used.
            port: Sockets to send from.
            book: Where components are.
        """
        self._fragment_size = settings.fragment_size
        self._loop = loop
        self._port = port
        self._book = book
        self._sequences: dict[JausAddress, int] = {}
        self._sequence_lock = threading.Lock()
        self._socket_lock = threading.Lock()

    def close(self) -> None:
        """Close the sockets when no other thread is sending."""
        with self._socket_lock:
            self._port.close()

    def refusal(self, destination: JausAddress, size: int) -> str:
        """Return the counter of what forbids to send so many bytes, if anything does."""
        if destination.is_wildcard:
            # Peers do not reassemble broadcasts (Junior refuses to send them).
            return "judp.broadcast_too_large" if size > self._fragment_size else ""
        if not destination.is_concrete:
            return "judp.bad_destination"
        if size > self._fragment_size * _MAX_FRAGMENTS:
            return "judp.message_too_large"
        return ""

    def packets(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: AckNak,
    ) -> list[Packet]:
        """Return the packets of a message with their sequence numbers."""
        step, none = self._fragment_size, Broadcast.NONE
        if len(payload) <= step:
            number = self.reserve(source, 1)
            return [Packet(destination, source, payload, number, priority, none, acknowledge)]
        parts = [payload[start : start + step] for start in range(0, len(payload), step)]
        flags = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (len(parts) - 2), DataFlags.LAST]
        first = self.reserve(source, len(parts))
        return [
            Packet(
                destination,
                source,
                part,
                first + index & 0xFFFF,
                priority,
                none,
                acknowledge,
                flag,
            )
            for index, (part, flag) in enumerate(zip(parts, flags, strict=True))
        ]

    def transmit(self, packet: Packet) -> bool:
        """Put a packet on the network, where its destination is or may be."""
        destination = packet.destination
        if destination.is_wildcard:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
            return self.put(packet.encode(), self._port.group)
        endpoint = self._book.find(destination)
        doubt = Doubt.SEARCH
        if endpoint is not None:
            doubt = self._book.doubt(destination, self._loop.now())
        if doubt is Doubt.NONE and endpoint is not None:
            return self.put(packet.encode(), endpoint)
        packet = packet._replace(acknowledge=AckNak.REQUESTED)
        sent = endpoint is not None and self.put(packet.encode(), endpoint)
        if doubt is Doubt.SEARCH:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
            sent = self.put(packet.encode(), self._port.group) or sent
        return sent

    def put(self, datagram: bytes, endpoint: Endpoint) -> bool:
        """Send a datagram from the unicast socket; return whether the system took it."""
        try:
            with self._socket_lock:
                if self._port.unicast is None:
                    raise OSError("the transport is not open")
                self._port.unicast.sendto(datagram, endpoint)
        except OSError as error:
            self._loop.counters.count("judp.send_failed", f"{endpoint}: {error}")
            return False
        self._loop.counters.add("judp.sent")
        return True

    def reserve(self, source: JausAddress, count: int) -> int:
        """Take consecutive sequence numbers of a source and return the first."""
        with self._sequence_lock:
            first = self._sequences.get(source)
            if first is None:
                # A restarted sender must not repeat numbers that peers remember as seen.
                first = random.randrange(0x10000)
            self._sequences[source] = first + count & 0xFFFF
        return first
