"""Sends packets as datagrams, and only few to an address that has not proved to be the true one.

A datagram says where it comes from, and anybody can forge that. So an endpoint gets no more than a
few bytes for each byte from it, until it has acknowledged a number that it could not guess; RFC
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

PROVED = "transport.address_proved"  # components that have acknowledged a question
HELD = "transport.unproved_held"  # datagrams that wait for the proof of their destination

DROPPED = "transport.unproved_dropped"
"""Datagrams to a component without proof that nothing was left for."""

NEVER = "transport.never_acknowledges"  # questions to a component that has left many unanswered

_QUESTION = b"\x02\x42"
"""ReportHeartbeatPulse (AS5710): asks for an acknowledgement, and for nothing else."""

# With the version byte in front.
_QUESTION_SIZE = 1 + EMPTY_MESSAGE_SIZE + len(_QUESTION)
_INTERVAL_S = 0.1
# Wrong answers after which another number is drawn, as somebody may be guessing.
_MOST_WRONG = 8
_MOST_HELD = 4
_MANY_QUESTIONS = 10


class Prover:
    """Asks for the proofs of one process, and keeps what goes to an endpoint within its credit."""

    def __init__(
        self, book: AddressBook, loop: Loop, limit: int, put: Callable[[bytes, Endpoint], bool]
    ) -> None:
        """Sends to an endpoint without proof at most `limit` bytes for each byte from it."""
        self._book = book
        self._loop = loop
        self._limit = limit
        self._put = put
        # Of the system: these numbers must not follow from others that a stranger has seen.
        self._draw = SystemRandom().randrange
        self._lock = threading.Lock()
        self.listeners: list[Callable[[JausAddress], None]] = []

    def heard(self, entry: Entry, packet: Packet, asker: JausAddress | None) -> None:
        """Notes that a packet came without proof; who is meant here, if anybody, asks for one."""
        claim = entry.claim
        if claim is None:
            return
        with self._lock:
            claim.received += EMPTY_MESSAGE_SIZE + len(packet.payload)
            if claim.asker is None:
                claim.asker = asker
        self._ask(packet.source, entry, claim)

    def send(self, destination: JausAddress, entry: Entry, datagram: bytes) -> bool:
        """Sends a datagram to a component without proof, or keeps it; tells whether it may go."""
        claim = entry.claim
        if claim is None:
            # Proved since the caller looked.
            return self._put(datagram, entry.endpoint)
        with self._lock:
            # A question must still fit in, or nothing could ever prove the place.
            may_go = self._take(claim, len(datagram), kept=_QUESTION_SIZE)
            is_held = not may_go and len(claim.held) < _MOST_HELD
            if is_held:
                claim.held.append(datagram)
        if may_go:
            return self._put(datagram, entry.endpoint)
        self._loop.counters.add(HELD if is_held else DROPPED)
        self._ask(destination, entry, claim)
        return is_held

    def acknowledged(self, by: int, number: int) -> bool:
        """Takes an acknowledgement that no packet waits for; tells whether it is a proof."""
        entry = self._book.learnt.get(by)
        claim = None if entry is None else entry.claim
        if entry is None or claim is None or claim.number is None:
            return False
        if claim.number != number:
            claim.wrong += 1
            if claim.wrong >= _MOST_WRONG:
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
        """Asks a component, unless it was asked a moment ago or its credit is used up."""
        now = self._loop.now()
        with self._lock:
            if (
                claim.asker is None
                or now - claim.asked < _INTERVAL_S
                or not self._take(claim, _QUESTION_SIZE)
            ):
                return
            # The same number each time: a late answer to an earlier question is a proof too.
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

    def _take(self, claim: Claim, size: int, *, kept: int = 0) -> bool:
        """Takes bytes from the credit of a claim, of which some stay; tells whether they fit."""
        if claim.sent + size + kept > self._limit * claim.received:
            return False
        claim.sent += size
        return True


class Exit(Protocol):
    """What datagrams leave through: a socket, as a rule."""

    def sendto(self, datagram: bytes, endpoint: Endpoint, /) -> int:
        """Sends a datagram; raises OSError when it cannot go."""


class Port(Protocol):
    """What a sender needs of a port; ``SharedPort`` is that of a host."""

    @property
    def unicast(self) -> Exit | None:
        """What datagrams leave through, while the port is open."""

    @property
    def group(self) -> Endpoint:
        """Where datagrams go that are for everybody."""

    def close(self) -> None:
        """Sends no more."""


class Sender(Carrier[Endpoint]):
    """Sends each packet where its destination is, from any thread."""

    def __init__(self, loop: Loop, port: Port, book: AddressBook, limit: int = 0) -> None:
        self._loop = loop
        self._port = port
        self._book = book
        self.prover = Prover(book, loop, limit, self.put)
        self._socket_lock = threading.Lock()
        self._sent = loop.counters.tally("judp.sent")

    def close(self) -> None:
        """Closes the sockets when no other thread is sending."""
        with self._socket_lock:
            self._port.close()

    def transmit(self, packet: Packet) -> bool:
        """Puts a packet on the network, where its destination is or may be."""
        destination = packet.destination
        entry = self._book.learnt.get(destination)
        # Heard lately means proved as well: without proof it counts as never heard.
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
        # The acknowledgement tells where it is.
        packet = packet._replace(acknowledge=AckNak.REQUESTED)
        sent = endpoint is not None and self.put(packet.encode(), endpoint)
        # To everybody besides the known place: it may have moved.
        if doubt is Doubt.SEARCH:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
            sent = self.put(packet.encode(), self._port.group) or sent
        return sent

    def answer(self, packet: Packet, origin: Endpoint) -> None:
        """Sends a packet back to the endpoint that one came from."""
        entry = self._book.learnt.get(packet.destination)
        # An answer is bounded too: the question may have come in a forged name.
        if entry is not None and entry.claim is not None:
            self.prover.send(packet.destination, entry, packet.encode())
        else:
            self.put(packet.encode(), origin)

    def heard(self, destination: JausAddress) -> float:
        """Returns when a destination was heard last, whatever it said."""
        entry = self._book.learnt.get(destination)
        return -math.inf if entry is None else entry.latest

    def suspect(self, destination: JausAddress, since: float) -> None:
        """Searches for a destination that fails to acknowledge, from its next packet on."""
        self._book.suspect(destination, since)

    def put(self, datagram: bytes, endpoint: Endpoint) -> bool:
        """Sends a datagram from the unicast socket; returns whether the system took it."""
        try:
            # `close` waits for it: a closed descriptor may be that of another file a moment later.
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
        """Returns how a core sends single packets that need no acknowledgement."""
        learnt, counters = self._book.learnt, self._loop.counters

        def place() -> tuple[int, Endpoint, float] | None:
            entry, sock = learnt.get(destination), self._port.unicast
            # The port of a virtual world has no descriptor to lend.
            if not isinstance(sock, socket.socket) or entry is None:
                return None
            is_elsewhere = entry.claim is not None or destination in inbox.receivers
            return None if is_elsewhere else (sock.fileno(), entry.endpoint, entry.heard)

        def note(datagrams: int, error: int) -> None:
            self._sent.count += datagrams
            if error:
                entry = learnt.get(destination)
                where = "" if entry is None else entry.endpoint
                counters.count("judp.send_failed", f"{where}: {os.strerror(error)}")

        lifetime = self._book.lifetime
        return Outlet(source, destination, priority, longest, lifetime, numbers, place, note)
