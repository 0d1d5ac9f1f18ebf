"""Exchanges: a message to a component, and the one that answers it.

Messages of JAUS do not say which question they answer. So those of one component that may have the
same answer wait for each other.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from ..transports.packets.packet import Priority

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.address import JausAddress
    from ..base.loop import Timer
    from ..services.host import Host
    from ..wire.message import Message

ATTEMPTS = 3
"""How often a query is sent in the time that its answer has."""


class Exchange:
    """A message that waits for its answer; made by `Exchanges.ask`."""

    def __init__(
        self,
        payload: bytes,
        answers: Sequence[type[Message]],
        end: Callable[[bytes | None], None],
        *,
        repeat: float | None,
        priority: Priority,
    ) -> None:
        """Use `Exchanges.ask` instead."""
        self.payload = payload
        self.codes = frozenset(each.CODE for each in answers)
        self.end = end
        self.repeat = repeat
        self.priority = priority
        self.is_sent = False
        self.is_over = False
        self.timers: list[Timer] = []


class Exchanges:
    """The exchanges of one component. All of it runs on the loop, or with its lock."""

    def __init__(self, component: Host) -> None:
        """Begins without any.

        Args:
            component: The component that asks.
        """
        self._component = component
        self._open: dict[JausAddress, list[Exchange]] = defaultdict(list)
        self._heard: set[type[Message]] = set()

    def listen(self, answers: Sequence[type[Message]]) -> None:
        """Begins to listen to messages that answer."""
        for each in answers:
            if each not in self._heard:
                self._heard.add(each)
                self._component.on_payload(each, self._answered)

    def ask(
        self,
        target: JausAddress,
        payload: bytes,
        answers: Sequence[type[Message]],
        end: Callable[[bytes | None], None],
        *,
        timeout: float,
        is_query: bool,
        priority: Priority = Priority.STANDARD,
    ) -> Callable[[], None]:
        """Sends a message and waits for the answer.

        A query is repeated, since it does no harm twice; what commands is acknowledged by the
        transport of the target, and so takes effect once.

        Args:
            target: The component that is asked.
            payload: The message.
            answers: The messages that may answer, to which `listen` listens.
            end: Is given the answer, or None when there was none in time.
            timeout: Seconds until then, with the time for which the message waits for others.
            is_query: Whether the message is a query.
            priority: Priority of the message (AS5669A).

        Returns:
            What ends the exchange without an answer; `end` is not called then.
        """
        repeat = timeout / ATTEMPTS if is_query else None
        asked = Exchange(payload, answers, end, repeat=repeat, priority=priority)
        self._open[target].append(asked)
        loop = self._component.loop
        asked.timers.append(loop.call_later(timeout, lambda: self._finish(target, asked, None)))
        self._go_on(target)

        def forget() -> None:
            self._forget(target, asked)

        return forget

    def _go_on(self, target: JausAddress) -> None:
        """Sends what waits for no other exchange, in the order in which it was asked for."""
        busy: set[int] = set()
        for each in list(self._open.get(target, ())):
            if not each.is_sent and busy.isdisjoint(each.codes):
                each.is_sent = True
                self._send(target, each)
            busy |= each.codes

    def _send(self, target: JausAddress, asked: Exchange) -> None:
        component = self._component
        component.transport.send(
            component.address,
            target,
            asked.payload,
            priority=asked.priority,
            acknowledge=asked.repeat is None,
        )
        if asked.repeat is not None:
            again = component.loop.call_later(asked.repeat, lambda: self._send(target, asked))
            asked.timers.append(again)

    def _answered(self, payload: bytes, sender: JausAddress) -> None:
        code = payload[0] | payload[1] << 8
        for each in self._open.get(sender, ()):
            if each.is_sent and code in each.codes:
                self._finish(sender, each, payload)
                return

    def _finish(self, target: JausAddress, asked: Exchange, payload: bytes | None) -> None:
        if self._forget(target, asked):
            asked.end(payload)

    def _forget(self, target: JausAddress, asked: Exchange) -> bool:
        """Ends an exchange, and lets those that wait for it go on; False when it has ended."""
        if asked.is_over:
            return False
        asked.is_over = True
        for timer in asked.timers:
            timer.cancel()
        waiting = self._open[target]
        waiting.remove(asked)
        if waiting:
            self._component.loop.call_soon(lambda: self._go_on(target))
        else:
            del self._open[target]
        return True
