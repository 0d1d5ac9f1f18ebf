"""JUDP (AS5669A) without sockets, for a real or virtual network of datagrams."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

from ...base.address import JausAddress
from ...base.fast_path import with_fast_path
from ...base.loop import Loop
from ...base.settings import Endpoint, TransportSettings
from ..address_book import AddressBook, Entry
from ..delivery import Take
from ..packets.messenger import Messenger
from ..packets.packet import AckNak, Packet, Priority
from ..transport import Transport
from .sender import Port, Sender

LOOPBACK = "127."  # prefix of addresses within this host
_TIME_TO_ANSWER = 2.0  # seconds for an answer to the first message after a silence


class DatagramTransport(Transport):
    """Sends and receives packets as datagrams (AS5669A, JUDP).

    A message to a wildcard goes to the multicast group and to the matching components of this
    process, except its sender. A message to a component of this process does not use the network.
    One to an unknown destination is multicast with a request for acknowledgement, as by Junior;
    the acknowledgement tells the endpoint. Packets that cannot be used are counted.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        port: Port,
        draw: Callable[[int], int] | None = None,
    ) -> None:
        super().__init__(settings, loop)
        self.address_book = AddressBook(
            settings.address_lifetime,
            self.counters,
            fixed=settings.fixed_sources,
            places=settings.max_peers,
            trusts=self._trusts,
            changed=loop.revision.changed,
        )
        self._sender = Sender(loop, port, self.address_book, settings.amplification_limit)
        self._messenger = Messenger(settings, loop, self._sender, self.quirks, draw)
        self.inbox = self._messenger.inbox
        self.arrival = self.inbox.arrival
        self.inbox.proves = self._sender.prover.acknowledged

    def sender(
        self, source: JausAddress, destination: JausAddress, priority: Priority = Priority.STANDARD
    ) -> Callable[[bytes], None]:
        """Returns a function that sends payloads; see ``Transport.sender``."""
        messenger = self._messenger

        def send(payload: bytes) -> None:
            messenger.send(source, destination, payload, priority, False, None)  # noqa: FBT003

        # The compiled core of a bridge only sends from one component to another.
        if not (source.is_concrete and destination.is_concrete):
            return send
        outlet = partial(
            self._sender.outlet,
            source,
            destination,
            priority,
            messenger.packetizer.numbers(source, destination),
            self._settings.fragment_size,
            self.inbox,
        )
        return with_fast_path(send, outlet)

    def count_by(self, counting: Callable[[int], Iterator[int]]) -> None:
        """Sets the function that makes iterators of numbers; called before the first sender."""
        self._messenger.packetizer.counting = counting

    def is_unheard(self, address: JausAddress) -> bool:
        """Returns whether a component would have been heard; see ``Transport.is_unheard``."""
        with self.loop.lock:
            if address in self.inbox.receivers:
                return False
            entry = self.address_book.learnt.get(address)
            longest_silence = self.address_book.lifetime + _TIME_TO_ANSWER
            if entry is None:
                return True
            # `heard` is -inf without proof.
            heard = entry.heard if entry.claim is None else entry.heard_in_doubt
            return self.loop.now() - heard > longest_silence

    def is_proved(self, address: JausAddress) -> bool:
        """Returns whether a component has proved its endpoint; see ``Transport.is_proved``."""
        entry = self.address_book.learnt.get(address)
        return entry is None or entry.claim is None

    def place_of(self, address: JausAddress) -> tuple[str, str]:
        """Returns host and endpoint of a component; see ``Transport.place_of``."""
        endpoint = self.address_book.find(address)
        return ("", "") if endpoint is None else (endpoint[0], f"{endpoint[0]}:{endpoint[1]}")

    def is_kept(self, address: JausAddress) -> bool:
        """Returns whether a component is always kept; see ``Transport.is_kept``."""
        return self.address_book.is_kept(address)

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        """Keeps a controller; see ``Transport.keep_place``."""
        self.address_book.keep_place(owner, address)

    def when_proved(self, listener: Callable[[JausAddress], None]) -> None:
        """Adds a listener for proofs; see ``Transport.when_proved``."""
        self._sender.prover.listeners.append(listener)

    def silence_of(self, address: JausAddress) -> float:
        """Returns the seconds since the last packet; see ``Transport.silence_of``."""
        entry = self.address_book.learnt.get(address)
        return math.inf if entry is None else self.loop.now() - entry.latest

    def _trusts(self, endpoint: Endpoint) -> bool:
        """Returns whether an endpoint needs no proof, like those of this host.

        The kernel drops datagrams from outside with an address of this host.
        """
        settings = self._settings
        return (
            not settings.amplification_limit
            or endpoint[0] == settings.interface
            or endpoint[0].startswith(LOOPBACK)
        )

    def _attach(self, address: JausAddress, take: Take) -> None:
        self.inbox.attach(address, take)

    def _messenger_of(self, source: JausAddress) -> Messenger[Endpoint]:
        del source  # one messenger for all components
        return self._messenger

    def _take_packet(self, packet: Packet, sender: Endpoint) -> bool:
        """Takes a packet; returns False if it is for no component of this process."""
        # Before its endpoint is learnt.
        if self.inbox.refuses(packet, sender):
            return True
        now = self.loop.now()
        if not self.address_book.learn(packet.source, sender, now):
            return True
        entry = self.address_book.learnt[packet.source]
        if entry.claim is not None:
            return self._take_unproved(packet, sender, entry, now)
        return self.inbox.take(packet, sender, now)

    def _take_unproved(self, packet: Packet, sender: Endpoint, entry: Entry, now: float) -> bool:
        """Takes a packet of a component without proof of its endpoint; it may be the proof."""
        asker = next((address for address, _ in self.inbox.receivers_of(packet)), None)
        is_answer = packet.acknowledge >= AckNak.NAK
        # Before `heard`: an acknowledgement may be the proof, and save a question.
        is_taken = is_answer and self.inbox.take(packet, sender, now)
        self._sender.prover.heard(entry, packet, asker)
        # After `heard`: its bytes are the credit for our answers.
        return is_taken if is_answer else self.inbox.take(packet, sender, now)
