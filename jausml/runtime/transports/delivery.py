"""Messages as transports hand them over, their order, and what carries their packets."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from typing import Generic, NamedTuple, TypeVar

from ..base.address import JausAddress
from ..base.fast_path import FastPath
from ..base.loop import Loop
from .packets.packet import Packet

MESSAGE_CODE_SIZE = 2  # bytes of the message code with which every payload begins


@dataclass(slots=True)
class Arrival:
    """The message that is being handed over."""

    # Its sequence number, by which later ones of its source can be told from earlier ones; None
    # where the transport keeps the order, and for what goes to a wildcard.
    number: int | None = None
    is_sure: bool = False  # whether it asks for acknowledgement; its repetition rightly comes late
    # Where it came from, such as an endpoint; another process is heard from elsewhere.
    origin: object = None


class Double(NamedTuple):
    """Another component that was heard with the address of one of this process."""

    address: JausAddress
    place: str
    first_heard: datetime
    last_heard: float  # by the clock of the loop

    def __str__(self) -> str:
        since = f"{self.first_heard:%Y-%m-%d %H:%M:%S} UTC"
        return (
            f"another component has your id: {self.address} at {self.place} (first heard {since})"
        )


Take = Callable[[bytes, "JausAddress"], None]
"""Takes the payload of a message for one component and who sent it.

A payload is a little-endian 16-bit message code and a body. Runs on the loop's thread and holds the
loop's lock.
"""

OnResult = Callable[[bool], None]
"""Told whether a message went out; runs on the loop's thread and holds the loop's lock."""


def report(loop: Loop, on_result: OnResult | None, *, success: bool) -> None:
    """Tells a result in the next round of the loop."""
    if on_result is not None:
        loop.call_soon(partial(on_result, success))


LATEST = 2.0
"""Seconds by which a message may be late; a lower number after them is that of a new process."""

FARTHEST = 1024  # messages of its source that may have come before a late one
_MOST_SOURCES = 256


def _is_before(number: int, other: int) -> bool:
    """Whether a number is that of an earlier message; numbers begin again after 65535."""
    return 0 < other - number & 0xFFFF <= FARTHEST


class _Latest(NamedTuple):
    number: int
    at: float
    origin: object
    sure: int | None  # of the latest that asks for acknowledgement, while that can be compared

    def followed_by(self, number: int, at: float, origin: object) -> _Latest:
        """Returns what is known when a message without acknowledgement came."""
        is_near = self.sure is not None and _is_before(self.sure, number)
        return _Latest(number, at, origin, self.sure if is_near else None)


class Ordering:
    """Tells which messages of one kind are older than one of the same source that came before.

    Sequence numbers count per source (AS5669A), and anew in each process, which is heard from a
    socket of its own: an operator who commands again at once is not late by the numbers of the
    process before.
    """

    def __init__(self, arrival: Arrival, clock: Callable[[], float]) -> None:
        self._arrival = arrival
        self._clock = clock
        self._latest: dict[JausAddress, _Latest] = {}

    def is_late(self, sender: JausAddress) -> bool:
        """Returns whether the present message of a sender is late; remembers it if it is not.

        One that asks for acknowledgement may be a stop that is repeated, so others do not make it
        late. A newer one of its own kind does. What was sent before a stop, with acknowledgement or
        without, and comes after it is late: it must not undo the stop.
        """
        number, origin, is_sure = self._arrival.number, self._arrival.origin, self._arrival.is_sure
        if number is None:
            return False
        now = self._clock()
        latest = self._latest.get(sender)
        if latest is None:
            if len(self._latest) >= _MOST_SOURCES:
                self._latest.clear()
            latest = _Latest(number, now, origin, None)
        elif (
            _is_before(number, latest.number)
            and now - latest.at < LATEST
            and latest.origin == origin
        ):
            if not is_sure or (latest.sure is not None and _is_before(number, latest.sure)):
                return True
            self._latest[sender] = latest._replace(sure=number)
            return False
        latest = latest.followed_by(number, now, origin)
        self._latest[sender] = latest._replace(sure=number) if is_sure else latest
        return False

    def minded(self, path: FastPath, sender: JausAddress) -> FastPath:
        """Returns a fast path on which the messages of a sender keep their order.

        What takes it comes from where the latest message came from, and asks for no
        acknowledgement.
        """
        passed, known = path.passed, self._latest
        before = known.get(sender, _Latest(0, 0.0, None, None))

        def note(payload: bytes, number: int, at: float, unknown: int) -> None:
            latest = known.get(sender, before)
            known[sender] = latest.followed_by(number, at, before.origin)
            passed(payload, number, at, unknown)

        def latest() -> tuple[int, float] | None:
            return known[sender][:2] if sender in known else None

        return replace(path, passed=note, latest=latest)


Origin = TypeVar("Origin")
"""Where a packet came from and answers to it go: an endpoint, a connection, a socket."""


class Carrier(ABC, Generic[Origin]):
    """Puts packets on a network; callable from any thread."""

    @abstractmethod
    def transmit(self, packet: Packet) -> bool:
        """Puts a packet on the network; returns whether that worked."""

    @abstractmethod
    def answer(self, packet: Packet, origin: Origin) -> None:
        """Sends a packet back to where one came from."""

    def heard(self, destination: JausAddress) -> float:  # noqa: ARG002
        """Returns when a destination was heard last, on the loop's clock; never if nobody knows."""
        return -math.inf

    def suspect(self, destination: JausAddress, since: float) -> None:
        """Learns before the last repetition that a destination has acknowledged nothing lately."""


class ReliableCarrier(Carrier[Origin]):
    """Puts packets on a network that repeats by itself what gets lost, and reports what it sent."""

    @abstractmethod
    def transmit_all(self, packets: list[Packet], on_result: OnResult | None) -> None:
        """Sends the packets of a message, and reports whether that worked."""

    def transmit(self, packet: Packet) -> bool:
        """Sends a packet whose result nobody asks for."""
        self.transmit_all([packet], None)
        return True
