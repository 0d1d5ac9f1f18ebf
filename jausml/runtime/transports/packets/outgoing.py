"""Outgoing packets: cutting and numbering of messages, and the queues to each destination."""

from __future__ import annotations

import math
import random
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import count, islice
from typing import NamedTuple

from ...base.address import JausAddress, address_of
from ...base.settings import MAX_FRAGMENT_SIZE
from ..delivery import OnResult
from .packet import AckNak, Broadcast, DataFlags, Packet, Priority

_MAX_FRAGMENTS = 32768
_MAX_PAIRS = 4096
MAX_SMALL_FRAGMENTS = 40  # packets of a message, beyond which larger packets are used
FIRST_WINDOW = 8  # packets of a large message that are under way at once to a new peer
_SINGLES_UNDER_WAY = 32  # messages of one packet that are under way at once


class Packetizer:
    """Numbers packets and cuts large messages; callable from any thread.

    Each pair of source and destination has consecutive numbers, so that the destination can count
    lost packets. All wildcards are one destination, together with those beyond 4,096, since
    strangers must not fill the memory.

    A message that would take more than 40 packets is cut into larger ones, since Junior and the
    JAUS Tool Set keep at most 50 packets of an unfinished message.
    """

    def __init__(self, fragment_size: int, draw: Callable[[int], int] | None = None) -> None:
        """Starts with no numbers used.

        Args:
            fragment_size: Greatest payload of a packet in bytes, unless larger ones are needed.
            draw: Returns a random number from 0 to below its argument; by default that
                of the process.
        """
        self._draw = random.randrange if draw is None else draw
        self._fragment_size = fragment_size
        self._numbers: dict[tuple[int, int], _Numbers] = {}
        # Makes an iterator of numbers, atomic in its steps, and with the repr of `itertools.count`.
        self.counting: Callable[[int], Iterator[int]] = count

    def refusal(self, destination: JausAddress, size: int) -> str:
        """Returns the counter for a message that cannot be sent; empty if it can."""
        if destination.is_wildcard:
            # Peers do not reassemble broadcasts; Junior does not send long ones either.
            return "transport.broadcast_too_large" if size > MAX_FRAGMENT_SIZE else ""
        if not destination.is_concrete:
            return "transport.bad_destination"
        if size > MAX_FRAGMENT_SIZE * _MAX_FRAGMENTS:
            return "transport.message_too_large"
        return ""

    def count(self, destination: JausAddress, size: int) -> int:
        """Returns the number of packets for a message of so many bytes."""
        if size <= self._fragment_size:
            return 1
        return -(-size // self._step(destination, size))

    def packets(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: AckNak,
    ) -> list[Packet]:
        """Returns the packets of a message with their sequence numbers."""
        step, count = self._step(destination, len(payload)), self.count(destination, len(payload))
        first, none = self.reserve(source, destination, count), Broadcast.NONE
        places = [DataFlags.SINGLE]
        if count > 1:
            places = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (count - 2), DataFlags.LAST]
        numbers, starts = range(first, first + count), range(0, len(payload), step)
        return [
            Packet(
                destination,
                source,
                payload[start : start + step],
                number & 0xFFFF,
                priority,
                none,
                acknowledge,
                place,
            )
            for number, start, place in zip(numbers, starts, places, strict=True)
        ]

    def _step(self, destination: JausAddress, size: int) -> int:
        if size <= self._fragment_size:
            return self._fragment_size
        if destination.is_wildcard:
            return MAX_FRAGMENT_SIZE
        needed = -(-size // MAX_SMALL_FRAGMENTS)
        return max(self._fragment_size, min(MAX_FRAGMENT_SIZE, needed))

    def reserve(self, source: JausAddress, destination: JausAddress, amount: int) -> int:
        """Reserves consecutive sequence numbers of a pair, and returns the first."""
        numbers = self.numbers(source, destination)
        while True:
            reserved = list(islice(numbers, amount))
            if reserved[-1] - reserved[0] == amount - 1:  # without one of another thread between
                return reserved[0] & 0xFFFF

    def numbers(self, source: JausAddress, destination: JausAddress) -> Iterator[int]:
        """Returns the iterator of sequence numbers of a pair, to be used modulo 65536.

        Its steps are atomic, and need no lock.
        """
        pair = source, 0 if destination.is_wildcard else destination
        counter = self._numbers.get(pair)
        if counter is None and len(self._numbers) >= _MAX_PAIRS:
            pair = source, 0
            counter = self._numbers.get(pair)
        if counter is None:
            # Random, as peers may remember the numbers of an earlier process.
            first = self._draw(0x10000)
            # Another thread may have been first.
            counter = self._numbers.setdefault(pair, _Numbers(first, self.counting(first)))
        return counter.following

    def next_number(self, source: JausAddress, destination: JausAddress) -> int:
        """Returns the number of the next packet of a pair, without reserving it."""
        self.numbers(source, destination)
        counter = self._numbers.get((source, destination)) or self._numbers[source, 0]
        return counter.first + counter.used & 0xFFFF

    def sent(self, source: JausAddress) -> dict[JausAddress, int]:
        """Returns how many packets a component has sent to each destination but wildcards."""
        return {
            address_of(destination): numbers.used
            for (sender, destination), numbers in list(self._numbers.items())
            if sender == source and destination
        }


class _Numbers(NamedTuple):
    first: int
    following: Iterator[int]

    @property
    def used(self) -> int:
        """Number of used numbers, which only the repr of `itertools.count` tells."""
        return int(repr(self.following)[len("count(") : -1]) - self.first


@dataclass(slots=True, eq=False)
class Message:
    """A message whose packets are repeated until each is acknowledged."""

    packets: list[Packet]
    on_result: OnResult | None  # called once with whether all packets were acknowledged
    # Whether as many packets as the receiver takes are under way at once; otherwise one, as Junior.
    is_best_effort: bool = False
    is_urgent: bool = False  # whether it is sent at once, whatever is under way
    is_repeated: bool = False  # whether one of its packets had to be repeated
    latest: float = math.inf  # time after which it is not sent any more
    sent: int = 0  # packets
    under_way: int = 0  # sent packets that are not acknowledged yet
    size: int = field(init=False)
    is_large: bool = field(init=False)

    def __post_init__(self) -> None:
        self.size = sum([len(packet.payload) for packet in self.packets])
        self.is_large = len(self.packets) > 1
        self.is_urgent = self.is_urgent or self.packets[0].priority > Priority.STANDARD

    @property
    def is_done(self) -> bool:
        """Whether all packets are acknowledged."""
        return self.under_way == 0 and self.sent == len(self.packets)


Key = tuple[int, int, int]  # source, destination (0 for wildcards) and number of a packet


def key_of(packet: Packet) -> Key:
    """Returns the key of a packet, by which its acknowledgement is matched."""
    destination = packet.destination
    return packet.source, 0 if destination.is_wildcard else destination, packet.sequence


@dataclass(slots=True, eq=False)
class Flight:
    """A packet under way: first sent at `since`, to be repeated at `due`."""

    message: Message
    packet: Packet
    key: Key
    since: float
    due: float
    repetitions: int = 0
    is_answered: bool = False


class Lane:
    """Queue of acknowledged messages to one destination.

    Large messages are sent one after the other, since receivers keep few packets of unfinished
    messages (Junior and the components of the JAUS Tool Set 50 for all messages). Messages of one
    packet are sent in between; only so many of these are under way as a small receive buffer holds,
    besides stops and those of high priority.

    The window, the number of packets of a large message under way at once, is learnt: it doubles
    after each message without loss, and is halved for good at the first loss.
    """

    __slots__ = ("_large", "_singles", "_singles_under_way", "_widest", "_window", "heard")

    def __init__(self) -> None:
        self.heard = -math.inf
        self._large: deque[Message] = deque()
        self._singles: deque[Message] = deque()
        self._singles_under_way = 0
        self._window = FIRST_WINDOW
        self._widest = MAX_SMALL_FRAGMENTS

    @property
    def is_empty(self) -> bool:
        """Whether no message waits or is under way."""
        return not (self._large or self._singles or self._singles_under_way)

    @property
    def waits(self) -> bool:
        """Whether there are messages with packets to send."""
        return bool(self._large or self._singles)

    @property
    def has_large(self) -> bool:
        """Whether a large message waits or is under way."""
        return bool(self._large)

    def add(self, message: Message) -> None:
        """Adds a message; an urgent one is first."""
        if message.is_large:
            self._large.append(message)
        elif message.is_urgent:
            self._singles.appendleft(message)
        else:
            self._singles.append(message)

    def ready(self) -> list[tuple[Message, Packet]]:
        """Returns the packets to be sent now, which are under way then."""
        ready: list[tuple[Message, Packet]] = []
        singles = self._singles
        # Urgent messages are first, and do not wait.
        while singles and (self._singles_under_way < _SINGLES_UNDER_WAY or singles[0].is_urgent):
            self._singles_under_way += 1
            ready.append(_next_of(singles.popleft()))
        if self._large:
            first = self._large[0]
            window = self._window if first.is_best_effort else 1
            while first.under_way < window and first.sent < len(first.packets):
                ready.append(_next_of(first))
        return ready

    def widen(self, message: Message) -> None:
        """Adapts the window after a message that has filled it is acknowledged."""
        if not message.is_best_effort or len(message.packets) < self._window:
            return
        if message.is_repeated:
            self._widest = max(FIRST_WINDOW, self._window // 2)
        self._window = min(2 * self._window, self._widest)

    def give_up_late(self, now: float) -> list[Message]:
        """Removes large messages that are next but too late, and returns them."""
        late: list[Message] = []
        while self._large and not self._large[0].sent and self._large[0].latest < now:
            late.append(self._large.popleft())
        return late

    def remove(self, message: Message) -> None:
        """Removes a message that is acknowledged, given up or withdrawn."""
        if message.is_large:
            self._large.remove(message)
        elif message.sent:
            self._singles_under_way -= 1
        else:
            self._singles.remove(message)

    @property
    def waiting(self) -> list[Message]:
        """The messages of which no packet was sent yet."""
        return [*self._singles, *[message for message in self._large if not message.sent]]


def _next_of(message: Message) -> tuple[Message, Packet]:
    packet = message.packets[message.sent]
    message.sent += 1
    message.under_way += 1
    return message, packet
