"""Sends packets as datagrams, and only few of them to an endpoint that is not proved.

The source address of a datagram can be forged. So an endpoint is only sent a few bytes for each
byte from it, until it has acknowledged a number that it could not guess (the proof); RFC
9000 (8.1) bounds the amplification of QUIC in this way. Any stack of AS5669A acknowledges.
"""

from __future__ import annotations

import math
import os
import socket
import threading
from collections.abc import Callable, Iterator
from random import SystemRandom
from typing import Protocol

from ...base.address import JausAddress, address_of
from ...base.fast_path import Outlet
from ...base.loop import Loop
from ...base.settings import Endpoint
from ..address_book import AddressBook, Claim, Doubt, Entry
from ..delivery import Carrier
from ..packets.inbox import Inbox
from ..packets.packet import EMPTY_MESSAGE_SIZE, AckNak, Broadcast, Packet, Priority

# Counters.
PROVED = "transport.address_proved"  # components that have acknowledged a question
HELD = "transport.unproved_held"  # datagrams that wait for the proof of their destination
DROPPED = "transport.unproved_dropped"  # datagrams beyond the credit of their destination
NEVER = "transport.never_acknowledges"  # questions to a component that has left many unanswered

_QUESTION = b"\x02\x42"  # ReportHeartbeatPulse (AS5710), which has no effect but to be acknowledged
_QUESTION_SIZE = 1 + EMPTY_MESSAGE_SIZE + len(_QUESTION)  # with the version byte
_INTERVAL_S = 0.1  # between two questions
_MAX_WRONG = 8  # wrong numbers after which another one is drawn, as they may be guesses
_MAX_HELD = 4
_MANY_QUESTIONS = 10


class Prover:
    """Requests proofs, and limits the bytes to each endpoint without one to its credit."""

    def __init__(
        self, book: AddressBook, loop: Loop, limit: int, put: Callable[[bytes, Endpoint], bool]
    ) -> None:
        """Sends to an endpoint without proof at most `limit` bytes for each byte from it."""
        self._book = book
        self._loop = loop
        self._limit = limit
        self._put = put
        # Of the system, as numbers must not be predictable from earlier ones.
        self._draw = SystemRandom().randrange
        self._lock = threading.Lock()
        self.listeners: list[Callable[[JausAddress], None]] = []

    def heard(self, entry: Entry, packet: Packet, asker: JausAddress | None) -> None:
        """Adds a packet to the credit of a component, and sends a question of `asker`."""
        claim = entry.claim
        if claim is None:
            return
        with self._lock:
            claim.received += EMPTY_MESSAGE_SIZE + len(packet.payload)
            if claim.asker is None:
                claim.asker = asker
        self._ask(packet.source, entry, claim)

    def send(self, destination: JausAddress, entry: Entry, datagram: bytes) -> bool:
        """Sends a datagram to a component without proof, or holds it; returns False if dropped."""
        claim = entry.claim
        if claim is None:
            # Proved meanwhile.
            return self._put(datagram, entry.endpoint)
        with self._lock:
            # A question must still fit, without which there is no proof.
            fits = self._spend(claim, len(datagram), reserve=_QUESTION_SIZE)
            is_held = not fits and len(claim.held) < _MAX_HELD
            if is_held:
                claim.held.append(datagram)
        if fits:
            return self._put(datagram, entry.endpoint)
        self._loop.counters.add(HELD if is_held else DROPPED)
        self._ask(destination, entry, claim)
        return is_held

    def acknowledged(self, by: int, number: int) -> bool:
        """Takes an acknowledgement without a waiting packet; returns whether it is a proof."""
        entry = self._book.learnt.get(by)
        claim = None if entry is None else entry.claim
        if entry is None or claim is None or claim.number is None:
            return False
        if claim.number != number:
            claim.wrong += 1
            if claim.wrong >= _MAX_WRONG:
                claim.number = None
            return False
        source = address_of(by)
        self._book.prove(source, entry, self._loop.now())
        self._loop.counters.add(PROVED)
        for datagram in claim.held:
            self._put(datagram, entry.endpoint)
        for listener in self.listeners:
            listener(source)
        return True

    def _ask(self, destination: JausAddress, entry: Entry, claim: Claim) -> None:
        """Sends a question, unless there was one lately or the credit is used up."""
        now = self._loop.now()
        with self._lock:
            if (
                claim.asker is None
                or now - claim.asked < _INTERVAL_S
                or not self._spend(claim, _QUESTION_SIZE)
            ):
                return
            # The same number each time, so that a late acknowledgement is a proof, too.
            if claim.number is None:
                claim.number, claim.wrong = self._draw(0x10000), 0
            claim.asked = now
            claim.questions += 1
        question = Packet(destination, claim.asker, _QUESTION, claim.number)
        self._put(question._replace(acknowledge=AckNak.REQUESTED).encode(), entry.endpoint)
        if claim.questions >= _MANY_QUESTIONS:
            place = f"{entry.endpoint[0]}:{entry.endpoint[1]}"
            self._loop.counters.count(
                NEVER, f"{destination} at {place}; state it as a peer (--jaus-peer) to trust it"
            )

    def _spend(self, claim: Claim, size: int, *, reserve: int = 0) -> bool:
        """Spends bytes of the credit, unless less than `reserve` would be left; returns whether."""
        if claim.sent + size + reserve > self._limit * claim.received:
            return False
        claim.sent += size
        return True


class DatagramSocket(Protocol):
    """A socket, or one of a virtual network."""

    def sendto(self, datagram: bytes, endpoint: Endpoint, /) -> int:
        """Sends a datagram; raises OSError."""


class Port(Protocol):
    """The attributes of a port that a sender needs; ``SharedPort`` is that of a host."""

    @property
    def unicast(self) -> DatagramSocket | None:
        """The socket to send from; None while the port is not open."""

    @property
    def group(self) -> Endpoint:
        """The endpoint of the multicast group."""

    def close(self) -> None:
        """Closes the sockets."""


class Sender(Carrier[Endpoint]):
    """Sends packets to the endpoints of their destinations; callable from any thread."""

    def __init__(self, loop: Loop, port: Port, book: AddressBook, limit: int = 0) -> None:
        self._loop = loop
        self._port = port
        self._book = book
        self.prover = Prover(book, loop, limit, self.put)
        self._socket_lock = threading.Lock()
        self._sent = loop.counters.tally("judp.sent")

    def close(self) -> None:
        """Closes the sockets while no other thread is sending."""
        with self._socket_lock:
            self._port.close()

    def transmit(self, packet: Packet) -> bool:
        """Sends a packet to the endpoint of its destination, or to the group to search for it."""
        destination = packet.destination
        entry = self._book.learnt.get(destination)
        # Heard lately, and so proved: `heard` is -inf without proof.
        if entry is not None and self._loop.now() - entry.heard < self._book.lifetime:
            return self.put(packet.encode(), entry.endpoint)
        if entry is not None and entry.claim is not None:
            return self.prover.send(destination, entry, packet.encode())
        if destination.is_wildcard:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
            return self.put(packet.encode(), self._port.group)
        endpoint = self._book.find(destination)
        doubt = Doubt.SEARCH
        if endpoint is not None:
            doubt = self._book.doubt(destination, self._loop.now())
        if doubt is Doubt.NONE and endpoint is not None:
            return self.put(packet.encode(), endpoint)
        # The acknowledgement will tell its endpoint.
        packet = packet._replace(acknowledge=AckNak.REQUESTED)
        sent = endpoint is not None and self.put(packet.encode(), endpoint)
        # Also to the group, as it may have moved.
        if doubt is Doubt.SEARCH:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
            sent = self.put(packet.encode(), self._port.group) or sent
        return sent

    def answer(self, packet: Packet, origin: Endpoint) -> None:
        """Sends a packet to the origin of another one."""
        entry = self._book.learnt.get(packet.destination)
        # Within its credit, as the source may be forged.
        if entry is not None and entry.claim is not None:
            self.prover.send(packet.destination, entry, packet.encode())
        else:
            self.put(packet.encode(), origin)

    def heard(self, destination: JausAddress) -> float:
        """Returns the time of the last packet of a destination, or -inf."""
        entry = self._book.learnt.get(destination)
        return -math.inf if entry is None else entry.latest

    def suspect(self, destination: JausAddress, since: float) -> None:
        """Doubts the endpoint of a destination that has acknowledged nothing since a time."""
        self._book.suspect(destination, since)

    def put(self, datagram: bytes, endpoint: Endpoint) -> bool:
        """Sends a datagram from the unicast socket; returns whether the system accepted it."""
        try:
            # Not during `close`, after which the descriptor may be that of another file.
            with self._socket_lock:
                if self._port.unicast is None:
                    raise OSError("the transport is not open")
                self._port.unicast.sendto(datagram, endpoint)
                self._sent.count += 1
        except OSError as error:
            self._loop.counters.count("judp.send_failed", f"{endpoint}: {error}")
            return False
        return True

    def outlet(
        self,
        source: JausAddress,
        destination: JausAddress,
        priority: Priority,
        numbers: Iterator[int],
        longest: int,
        inbox: Inbox[Endpoint],
    ) -> Outlet:
        """Returns the outlet by which the core sends single packets without acknowledgement."""
        learnt, counters = self._book.learnt, self._loop.counters

        def endpoint() -> tuple[int, Endpoint, float] | None:
            entry, sock = learnt.get(destination), self._port.unicast
            # The port of a virtual world has no descriptor.
            if not isinstance(sock, socket.socket) or entry is None:
                return None
            needs_python = entry.claim is not None or destination in inbox.receivers
            return None if needs_python else (sock.fileno(), entry.endpoint, entry.heard)

        def count(datagrams: int, error: int) -> None:
            self._sent.count += datagrams
            if error:
                entry = learnt.get(destination)
                target = "" if entry is None else entry.endpoint
                counters.count("judp.send_failed", f"{target}: {os.strerror(error)}")

        lifetime = self._book.lifetime
        return Outlet(source, destination, priority, longest, lifetime, numbers, endpoint, count)
