"""Sender: from packets to datagrams on the network."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from ...base.settings import Endpoint
from ..address_book import AddressBook, Doubt
from ..packets.carrier import Carrier
from ..packets.packet import AckNak, Broadcast

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...base.loop import Loop
    from ..packets.packet import Packet
    from .shared_port import SharedPort


class Sender(Carrier[Endpoint]):
    """Sends each packet where its destination is, from any thread."""

    def __init__(self, loop: Loop, port: SharedPort, book: AddressBook) -> None:
        """Prepare to send.

        Args:
            loop: Its clock and counters are used.
            port: Sockets to send from.
            book: Where components are.
        """
        self._loop = loop
        self._port = port
        self._book = book
        self._socket_lock = threading.Lock()

    def close(self) -> None:
        """Close the sockets when no other thread is sending."""
        with self._socket_lock:
            self._port.close()

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

    def answer(self, packet: Packet, origin: Endpoint) -> None:
        """Send a packet back to the endpoint that one came from."""
        self.put(packet.encode(), origin)

    def suspect(self, destination: JausAddress) -> None:
        """Search for a destination that fails to acknowledge, from its next packet on."""
        self._book.suspect(destination)

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
