"""Packets on their way out: messages cut into numbered packets, and lanes that they wait in."""

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
_MOST_PAIRS = 4096
MOST_SMALL_FRAGMENTS = 40  # packets of a message from which on they are larger than wished for

FIRST_WINDOW = 8
"""Packets of a large message that are under way at once to a peer of which nothing is known."""


class Packetizer:
    """Numbers packets and cuts large messages; callable from any thread.

    Each destination gets consecutive numbers of each source, whatever is sent to others, so that
    it can tell what was lost on the way to it. All wildcards together are one destination, and so
    are those that come when there are 4,096 others: strangers must not fill the memory.

    Packets are larger than wished for where a message would take more than 40 of them, since
    Junior and the JAUS Tool Set hold no more than 50 of an unfinished message.
    """

    def __init__(self, fragment_size: int, draw: Callable[[int], int] | None = None) -> None:
        """Starts with no numbers used.

        Args:
            fragment_size: Payload of one packet in bytes that is not to be exceeded without need.
            draw: Returns a random number from 0 to below its argument; by default that
                of the process.
        """
        self._draw = random.randrange if draw is None else draw
        self._fragment_size = fragment_size
        self._numbers: dict[tuple[int, int], _Numbers] = {}
        self.counting: Callable[[int], Iterator[int]] = count
        """Makes what counts from a number on, in steps of the interpreter; its representation is
        that of `itertools.count`."""

    def refusal(self, destination: JausAddress, size: int) -> str:
        """Returns the counter of what forbids to send so many bytes, if anything does."""
        if destination.is_wildcard:
            # Peers do not reassemble broadcasts (Junior refuses to send them).
            return "transport.broadcast_too_large" if size > MAX_FRAGMENT_SIZE else ""
        if not destination.is_concrete:
            return "transport.bad_destination"
        if size > MAX_FRAGMENT_SIZE * _MAX_FRAGMENTS:
            return "transport.message_too_large"
        return ""

    def count(self, destination: JausAddress, size: int) -> int:
        """Returns how many packets a message of so many bytes takes."""
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
        needed = -(-size // MOST_SMALL_FRAGMENTS)
        return max(self._fragment_size, min(MAX_FRAGMENT_SIZE, needed))

    def reserve(self, source: JausAddress, destination: JausAddress, amount: int) -> int:
        """Takes consecutive sequence numbers of a pair and returns the first."""
        numbers = self.numbers(source, destination)
        while True:
            taken = list(islice(numbers, amount))
            if taken[-1] - taken[0] == amount - 1:  # no other thread took one between
                return taken[0] & 0xFFFF

    def numbers(self, source: JausAddress, destination: JausAddress) -> Iterator[int]:
        """Returns the sequence numbers of a pair, to be taken modulo 65536 one by one.

        Each is taken in one step of the interpreter, which needs no lock.
        """
        pair = source, 0 if destination.is_wildcard else destination
        known = self._numbers.get(pair)
        if known is None and len(self._numbers) >= _MOST_PAIRS:
            pair = source, 0
            known = self._numbers.get(pair)
        if known is None:
            # A restarted sender must not repeat numbers that peers remember as seen.
            first = self._draw(0x10000)
            # Another thread may have been first: then its numbers count.
            known = self._numbers.setdefault(pair, _Numbers(first, self.counting(first)))
        return known.following

    def next_number(self, source: JausAddress, destination: JausAddress) -> int:
        """Returns the number that the next packet of a pair will have, and does not take it."""
        self.numbers(source, destination)
        # Pairs beyond the limit are counted with the wildcards.
        known = self._numbers.get((source, destination)) or self._numbers[source, 0]
        return known.first + known.used & 0xFFFF

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
        """How many are taken. A count tells where it is by its representation alone."""
        return int(repr(self.following)[len("count(") : -1]) - self.first


_SINGLES_UNDER_WAY = 32


@dataclass(slots=True, eq=False)
class Message:
    """A message whose packets are sent, each until it is acknowledged."""

    packets: list[Packet]
    on_result: OnResult | None  # told once whether all packets were acknowledged
    # Whether its packets go as many at once as the receiver takes; others one after the other, as
    # Junior sends them.
    is_best_effort: bool = False
    is_urgent: bool = False  # whether it is sent at once, however much is under way
    is_repeated: bool = False  # whether a packet of it had to be repeated
    latest: float = math.inf  # time until which it is worth to begin with it
    sent: int = 0
    under_way: int = 0  # how many of these are not acknowledged yet
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


Key = tuple[int, int, int]
"""Who sends a packet, to whom (0 is any wildcard: they are numbered together), and its number."""


def key_of(packet: Packet) -> Key:
    """Returns what a packet is known by."""
    destination = packet.destination
    return packet.source, 0 if destination.is_wildcard else destination, packet.sequence


@dataclass(slots=True, eq=False)
class Flight:
    """A packet under way."""

    message: Message
    packet: Packet
    key: Key
    since: float
    due: float
    repetitions: int = 0
    is_answered: bool = False


class Lane:
    """Acknowledged messages to one destination, in an order that any receiver can take.

    Messages of several packets go one after the other: receivers keep few packets of unfinished
    messages (Junior and the components of the JAUS Tool Set 50, of all messages together), and
    packets of several messages by turns would push each other out. Messages of one packet pass
    between them; of these only so many are under way as a small receive buffer holds, and those of
    high priority and stops besides.

    How many packets of a large message the receiver takes at once is learnt: twice as many after
    each message of which it lost none, and from the first loss on half as many for good. To look
    again would cost a message at each try, since a lost packet waits for its time-out.
    """

    __slots__ = ("_large", "_singles", "_singles_under_way", "_widest", "_window", "heard")

    def __init__(self) -> None:
        self.heard = -math.inf
        self._large: deque[Message] = deque()
        self._singles: deque[Message] = deque()
        self._singles_under_way = 0
        self._window = FIRST_WINDOW
        self._widest = MOST_SMALL_FRAGMENTS

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits and nothing is under way."""
        return not (self._large or self._singles or self._singles_under_way)

    @property
    def waits(self) -> bool:
        """Whether there is something whose turn may come."""
        return bool(self._large or self._singles)

    @property
    def has_large(self) -> bool:
        """Whether a message of several packets is under way."""
        return bool(self._large)

    def add(self, message: Message) -> None:
        """Lets a message wait for its turn, which may be now."""
        if message.is_large:
            self._large.append(message)
        elif message.is_urgent:
            self._singles.appendleft(message)
        else:
            self._singles.append(message)

    def ready(self) -> list[tuple[Message, Packet]]:
        """Returns the packets whose turn it is; they are under way from now on."""
        ready: list[tuple[Message, Packet]] = []
        singles = self._singles
        # Urgent ones stand in front, and wait for nobody.
        while singles and (self._singles_under_way < _SINGLES_UNDER_WAY or singles[0].is_urgent):
            self._singles_under_way += 1
            ready.append(_next_of(singles.popleft()))
        if self._large:
            first = self._large[0]
            window = self._window if first.is_best_effort else 1
            while first.under_way < window and first.sent < len(first.packets):
                ready.append(_next_of(first))
        return ready

    def arrived(self, message: Message) -> None:
        """Learns from a message that is done; packets fewer than the window say nothing."""
        if not message.is_best_effort or len(message.packets) < self._window:
            return
        if message.is_repeated:
            self._widest = max(FIRST_WINDOW, self._window // 2)
        self._window = min(2 * self._window, self._widest)

    def give_up_late(self, now: float) -> list[Message]:
        """Forgets the messages whose turn would be now, but which is too late, and returns them."""
        late: list[Message] = []
        while self._large and not self._large[0].sent and self._large[0].latest < now:
            late.append(self._large.popleft())
        return late

    def remove(self, message: Message) -> None:
        """Forgets a message, since it is done, given up or withdrawn."""
        if message.is_large:
            self._large.remove(message)
        elif message.sent:
            self._singles_under_way -= 1
        else:
            self._singles.remove(message)

    @property
    def waiting(self) -> list[Message]:
        """The messages of which nothing was sent yet."""
        return [*self._singles, *[message for message in self._large if not message.sent]]


def _next_of(message: Message) -> tuple[Message, Packet]:
    packet = message.packets[message.sent]
    message.sent += 1
    message.under_way += 1
    return message, packet
