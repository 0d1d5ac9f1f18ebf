"""Proof of addresses: nobody makes a process send much to where nobody has asked for it.

A datagram says where it comes from, and anybody can forge that. So an endpoint gets no more than a
few bytes for each byte from it, until it has acknowledged a number that it could not guess; RFC
9000 (8.1) bounds the amplification of QUIC in this way. Any stack of AS5669A acknowledges.
"""

from __future__ import annotations

import threading
from random import SystemRandom
from typing import TYPE_CHECKING

from ..base.address import address_of
from .packets.packet import EMPTY_MESSAGE_SIZE, AckNak, Packet

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Loop
    from ..base.settings import Endpoint
    from .address_book import AddressBook, Claim, Entry

PROVED = "transport.address_proved"
"""Components that have acknowledged a question."""

HELD = "transport.unproved_held"
"""Datagrams that wait for the proof of their destination."""

DROPPED = "transport.unproved_dropped"
"""Datagrams to a component without proof that nothing was left for."""

NEVER = "transport.never_acknowledges"
"""Questions to a component that has left many unanswered."""

_QUESTION = b"\x02\x42"
"""ReportHeartbeatPulse (AS5710): asks for an acknowledgement, and for nothing else."""

_QUESTION_SIZE = 1 + EMPTY_MESSAGE_SIZE + len(_QUESTION)
_INTERVAL_S = 0.1
_MOST_WRONG = 8
_MOST_HELD = 4
_MANY_QUESTIONS = 10


class Prover:
    """Asks for the proofs of one process, and keeps what goes to an endpoint within its credit."""

    def __init__(
        self,
        book: AddressBook,
        loop: Loop,
        limit: int,
        put: Callable[[bytes, Endpoint], bool],
    ) -> None:
        """Begin without claims.

        Args:
            limit: Bytes that go to an endpoint without proof for each byte from it.
        """
        self._book = book
        self._loop = loop
        self._limit = limit
        self._put = put
        self._draw = SystemRandom().randrange
        self._lock = threading.Lock()
        self.listeners: list[Callable[[JausAddress], None]] = []

    def heard(self, entry: Entry, packet: Packet, asker: JausAddress | None) -> None:
        """Note that a packet came from a component without proof, and ask for one.

        Args:
            asker: Component of this process that can ask; None where none is meant.
        """
        claim = entry.claim
        if claim is None:
            return
        with self._lock:
            claim.received += EMPTY_MESSAGE_SIZE + len(packet.payload)
            if claim.asker is None:
                claim.asker = asker
        self._ask(packet.source, entry, claim)

    def send(self, destination: JausAddress, entry: Entry, datagram: bytes) -> bool:
        """Send a datagram to a component without proof, or let it wait; tell whether it may go."""
        claim = entry.claim
        if claim is None:
            return self._put(datagram, entry.endpoint)
        with self._lock:
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
        """Take an acknowledgement that no packet waits for; tell whether it is a proof."""
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
        """Ask a component, unless it was asked a moment ago or its credit is used up."""
        now = self._loop.now()
        with self._lock:
            if (
                claim.asker is None
                or now - claim.asked < _INTERVAL_S
                or not self._take(claim, _QUESTION_SIZE)
            ):
                return
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
        """Take bytes from the credit of a claim, of which some are kept; tell whether they fit."""
        if claim.sent + size + kept > self._limit * claim.received:
            return False
        claim.sent += size
        return True
