"""Lane: which packets may be under way to one destination, and which wait."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

from .packet import Priority

if TYPE_CHECKING:
    from ..delivery import OnResult
    from .packet import Packet

_SINGLES_UNDER_WAY = 32


class Message:
    """A message whose packets are sent, each until it is acknowledged.

    Attributes:
        on_result: Told once whether all packets were acknowledged.
        latest: Time until which it is worth to begin with it.
        is_urgent: Whether it is sent at once, however much is under way.
        under_way: How many of these are not acknowledged yet.
    """

    __slots__ = (
        "is_large",
        "is_urgent",
        "latest",
        "on_result",
        "packets",
        "sent",
        "size",
        "under_way",
        "window",
    )

    def __init__(self, packets: list[Packet], on_result: OnResult | None, window: int) -> None:
        self.packets = packets
        self.on_result = on_result
        self.window = window
        self.latest = math.inf
        self.size = sum([len(packet.payload) for packet in packets])
        self.is_large = len(packets) > 1
        self.is_urgent = packets[0].priority > Priority.STANDARD
        self.sent = 0
        self.under_way = 0

    @property
    def is_done(self) -> bool:
        """Whether all packets are acknowledged."""
        return self.under_way == 0 and self.sent == len(self.packets)


class Lane:
    """Acknowledged messages to one destination, in an order that any receiver can take.

    Messages of several packets go one after the other: receivers keep few packets of unfinished
    messages (Junior and the components of the JAUS Tool Set 50, of all messages together), and
    packets of several messages by turns would push each other out. Messages of one packet pass
    between them; of these only so many are under way as a small receive buffer holds, and those of
    high priority besides.
    """

    __slots__ = ("_large", "_singles", "_singles_under_way", "heard")

    def __init__(self) -> None:
        self.heard = -math.inf
        self._large: deque[Message] = deque()
        self._singles: deque[Message] = deque()
        self._singles_under_way = 0

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
        """Let a message wait for its turn, which may be now."""
        if message.is_large:
            self._large.append(message)
        elif message.is_urgent:
            self._singles.appendleft(message)
        else:
            self._singles.append(message)

    def ready(self) -> list[tuple[Message, Packet]]:
        """Return the packets whose turn it is; they are under way from now on."""
        ready: list[tuple[Message, Packet]] = []
        singles = self._singles
        while singles and (self._singles_under_way < _SINGLES_UNDER_WAY or singles[0].is_urgent):
            self._singles_under_way += 1
            ready.append(_next_of(singles.popleft()))
        if self._large:
            first = self._large[0]
            while first.under_way < first.window and first.sent < len(first.packets):
                ready.append(_next_of(first))
        return ready

    def give_up_late(self, now: float) -> list[Message]:
        """Forget the messages whose turn would be now, but which is too late, and return them."""
        late: list[Message] = []
        while self._large and not self._large[0].sent and self._large[0].latest < now:
            late.append(self._large.popleft())
        return late

    def remove(self, message: Message) -> None:
        """Forget a message that is under way, since it is done or given up."""
        if message.is_large:
            self._large.popleft()
        else:
            self._singles_under_way -= 1

    def give_up_waiting(self) -> list[Message]:
        """Forget the messages of which nothing was sent yet, and return them."""
        waiting = [*self._singles, *[each for each in self._large if not each.sent]]
        self._singles.clear()
        self._large = deque(each for each in self._large if each.sent)
        return waiting


def _next_of(message: Message) -> tuple[Message, Packet]:
    packet = message.packets[message.sent]
    message.sent += 1
    message.under_way += 1
    return message, packet
