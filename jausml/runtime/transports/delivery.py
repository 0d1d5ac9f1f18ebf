"""Interfaces of transports: delivery of messages, their order, and carriers of packets."""

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
    """The message that is being delivered."""

    number: int | None = None  # sequence number; None if ordered by the transport, or to a wildcard
    wants_acknowledgement: bool = False  # if so, it may be repeated and come late
    origin: object = None  # such as an endpoint, which differs between processes


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


# Takes the payload of a message for one component, and its sender. A payload is a little-endian
# 16-bit message code and a body. Called on the thread of the loop, with its lock.
Take = Callable[[bytes, "JausAddress"], None]
# Called with whether a message was sent or acknowledged; on the thread of the loop, with its lock.
OnResult = Callable[[bool], None]


def report(loop: Loop, on_result: OnResult | None, *, success: bool) -> None:
    """Calls `on_result`, if there is one, in the next turn of the loop."""
    if on_result is not None:
        loop.call_soon(partial(on_result, success))


LATEST = 2.0  # seconds by which a message may be late; later lower numbers are of a new process
FARTHEST = 1024  # newer messages of its source that may have come before a late one
_MAX_SOURCES = 256


def _is_before(number: int, other: int) -> bool:
    """Returns whether a number is that of an earlier message; numbers wrap after 65535."""
    return 0 < other - number & 0xFFFF <= FARTHEST


class _Latest(NamedTuple):
    """The latest message of a source."""

    number: int
    time: float
    origin: object
    acknowledged: int | None  # number of the latest that requests acknowledgement, while it is near

    def followed_by(self, number: int, time: float, origin: object) -> _Latest:
        """Returns the state after a message without a request for acknowledgement."""
        is_near = self.acknowledged is not None and _is_before(self.acknowledged, number)
        return _Latest(number, time, origin, self.acknowledged if is_near else None)


class Ordering:
    """Detects messages of one kind that come after a newer one of the same source.

    Sequence numbers count per source (AS5669A), and begin anew in each process. A process has an
    origin of its own, so that the messages of a restarted operator unit are not late.
    """

    def __init__(self, arrival: Arrival, clock: Callable[[], float]) -> None:
        self._arrival = arrival
        self._clock = clock
        self._latest: dict[JausAddress, _Latest] = {}

    def is_late(self, sender: JausAddress) -> bool:
        """Returns whether the present message of a sender is late; remembers it if not.

        A message with a request for acknowledgement may be a repeated stop, which is only late
        after a newer one of the same kind. Every message that was sent before a stop and comes
        after it is late, as it must not undo the stop.
        """
        number, origin = self._arrival.number, self._arrival.origin
        is_acknowledged = self._arrival.wants_acknowledgement
        if number is None:
            return False
        now = self._clock()
        latest = self._latest.get(sender)
        if latest is None:
            if len(self._latest) >= _MAX_SOURCES:
                self._latest.clear()
            latest = _Latest(number, now, origin, None)
        elif (
            _is_before(number, latest.number)
            and now - latest.time < LATEST
            and latest.origin == origin
        ):
            newest = latest.acknowledged
            if not is_acknowledged or (newest is not None and _is_before(number, newest)):
                return True
            self._latest[sender] = latest._replace(acknowledged=number)
            return False
        latest = latest.followed_by(number, now, origin)
        self._latest[sender] = latest._replace(acknowledged=number) if is_acknowledged else latest
        return False

    def ordered_path(self, path: FastPath, sender: JausAddress) -> FastPath:
        """Returns a fast path that remembers the latest message of a sender.

        Its messages have the origin of the latest one, and request no acknowledgement.
        """
        passed, states = path.passed, self._latest
        before = states.get(sender, _Latest(0, 0.0, None, None))

        def remember(payload: bytes, number: int, time: float, unknown: int) -> None:
            latest = states.get(sender, before)
            states[sender] = latest.followed_by(number, time, before.origin)
            passed(payload, number, time, unknown)

        def latest() -> tuple[int, float] | None:
            return states[sender][:2] if sender in states else None

        return replace(path, passed=remember, latest=latest)


Origin = TypeVar("Origin")  # of a packet, to which answers go: an endpoint, a connection, a socket


class Carrier(ABC, Generic[Origin]):
    """Puts packets on a network; callable from any thread."""

    @abstractmethod
    def transmit(self, packet: Packet) -> bool:
        """Sends a packet; returns whether that succeeded."""

    @abstractmethod
    def answer(self, packet: Packet, origin: Origin) -> None:
        """Sends a packet to the origin of another one."""

    def heard(self, destination: JausAddress) -> float:  # noqa: ARG002
        """Returns the time of the last packet of a destination by the loop's clock, or -inf."""
        return -math.inf

    def suspect(self, destination: JausAddress, since: float) -> None:
        """Doubts the endpoint of a destination that has acknowledged nothing since a time."""


class ReliableCarrier(Carrier[Origin]):
    """Puts packets on a network that repeats lost ones itself, and reports results."""

    @abstractmethod
    def transmit_all(self, packets: list[Packet], on_result: OnResult | None) -> None:
        """Sends the packets of a message, and reports whether that succeeded."""

    def transmit(self, packet: Packet) -> bool:
        """Sends a packet without a result; returns True."""
        self.transmit_all([packet], None)
        return True
