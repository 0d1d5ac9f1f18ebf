"""Transport by datagrams, wherever they go."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ..address_book import AddressBook
from ..packets.messenger import Messenger
from ..packets.packet import Packet, Priority
from ..transport import Transport
from .sender import Sender

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...base.loop import Loop
    from ...base.settings import Endpoint, TransportSettings
    from ..delivery import OnResult, Receive, Take
    from ..packets.inbox import Inbox
    from .sender import Port

_MAX_PREPARED = 1024

_TIME_TO_ANSWER = 2.0
"""Seconds that a component has to answer the first message after a silence."""


class DatagramTransport(Transport):
    """What JUDP does with packets (AS5669A), without the sockets.

    Destinations with a wildcard go to the multicast group and to the matching components of this
    process, except the sender. A component of this process is reached without the network. An
    unknown destination is multicast with a request for acknowledgement, as Junior does; the
    acknowledgement teaches its endpoint. Whatever arrives and cannot be used is counted.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        port: Port,
        draw: Callable[[int], int] | None = None,
    ) -> None:
        """Prepare a transport; ``open`` puts it on the network.

        Args:
            settings: Peers, time-outs and limits.
            loop: Loop on which messages are received; its counters are used.
            port: Where datagrams leave.
            draw: Returns a random number from 0 to below its argument, for sequence numbers;
                by default that of the process.
        """
        super().__init__(settings, loop)
        self._book = AddressBook(
            settings.address_lifetime, self.counters, fixed=settings.fixed_sources
        )
        self._sender = Sender(loop, port, self._book)
        self._messenger = Messenger(settings, loop, self._sender, draw)
        self.arrival = self._messenger.inbox.arrival
        self._inbox = self._messenger.inbox
        self._prepared: dict[tuple[int, int, int], Callable[[bytes], None]] = {}

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: OnResult | None = None,
    ) -> None:
        """Send one message; see ``Transport.send``. Senders are prepared for the usual ways."""
        if acknowledge or on_result is not None:
            self._messenger.send(source, destination, payload, priority, acknowledge, on_result)
            return
        send = self._prepared.get((source, destination, priority))
        if send is None:
            if len(self._prepared) >= _MAX_PREPARED:
                self._prepared.clear()
            send = self.sender(source, destination, priority)
            self._prepared[source, destination, priority] = send
        send(payload)

    def sender(
        self,
        source: JausAddress,
        destination: JausAddress,
        priority: Priority = Priority.STANDARD,
    ) -> Callable[[bytes], None]:
        """Return what sends one payload after the other; see ``Transport.sender``."""
        messenger = self._messenger

        def send(payload: bytes) -> None:
            messenger.send(source, destination, payload, priority, False, None)  # noqa: FBT003

        if not (source.is_concrete and destination.is_concrete):
            return send
        return self._sender.prepare(
            source,
            destination,
            priority,
            messenger.packetizer.numbers(source),
            self._settings.fragment_size,
            self._inbox,
            partial(messenger.cut, source, destination),
            send,
        )

    @property
    def inbox(self) -> Inbox[Endpoint]:
        """What receives for the components of this process."""
        return self._inbox

    @property
    def address_book(self) -> AddressBook:
        """Where components are."""
        return self._book

    def is_unheard(self, address: JausAddress) -> bool:
        """Return whether a component is silent that was asked; see ``Transport.is_unheard``."""
        with self.loop.lock:
            if address in self._messenger.inbox.receivers:
                return False
            entry = self._book.learnt.get(address)
            longest = self._book.lifetime + _TIME_TO_ANSWER
            return entry is None or self.loop.now() - entry.heard > longest

    def _attach(self, address: JausAddress, receive: Receive, take: Take | None) -> None:
        self._inbox.attach(address, receive, take)

    def _detach(self, address: JausAddress) -> None:
        self._inbox.detach(address)

    def _messenger_of(self, source: JausAddress) -> Messenger[Endpoint]:
        del source  # one for all components
        return self._messenger

    def _take_packet(self, packet: Packet, sender: Endpoint) -> bool:
        """Take a packet that has arrived; return False when it is for nobody of this process."""
        if self._inbox.refuses(packet, sender):
            return True
        now = self.loop.now()
        if not self._book.learn(packet.source, sender, now):
            return True
        return self._inbox.take(packet, sender, now)
