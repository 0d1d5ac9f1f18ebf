"""Exchanges: sends a message to a component, and finds the one that answers it.

Messages of JAUS do not say which question they answer. So those of one component that may have the
same answer wait for each other. One that ends without its answer is not forgotten then: each
message that was sent owes an answer, which may be late. Nothing for which that could be taken is
sent before it has come, or a stated time has passed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from enum import Enum
from functools import partial

from ..base.address import JausAddress
from ..base.loop import Timer
from ..services.host import Host
from ..transports.packets.packet import Priority
from ..wire.message import Message

ATTEMPTS = 3  # how often a query is sent in the time that its answer has
LATEST = 5  # how late an answer may be, in time-outs of its exchange


class Unanswered(Enum):
    """Why there is no answer."""

    SILENT = "did not answer"  # the message was sent, and none came in time
    UNSENT = "was not asked"  # those that went before left no time; nothing was sent


class Exchange:
    """A message that waits for its turn, then for its answer; made by `Exchanges.ask`."""

    def __init__(
        self,
        payload: bytes,
        answers: Sequence[type[Message]],
        end: Callable[[bytes | Unanswered], None],
        *,
        # Seconds for which it waits for its turn, and then for its answer.
        timeout: float,
        is_query: bool,
        priority: Priority,
    ) -> None:
        """Use `Exchanges.ask` instead."""
        self.payload = payload
        self.codes = frozenset(answer.CODE for answer in answers)
        self.end = end
        self.timeout = timeout
        self.is_query = is_query
        self.priority = priority
        self.owed = 0  # answers that may come, one for each time that it was sent
        self.is_over = False  # whether it has ended; what is owed may come still
        # Until when the same question waits then, and others do, by the clock of the loop.
        self.same_until = self.others_until = 0.0
        self.timers: list[Timer] = []

    @property
    def is_waiting(self) -> bool:
        """Whether it was not sent yet."""
        return not (self.owed or self.is_over)

    def asks_the_same(self, other: Exchange) -> bool:
        """Tells whether any answer to one is as good for the other."""
        is_same = self.payload == other.payload and self.codes == other.codes
        return is_same and self.is_query and other.is_query

    def lets(self, following: Exchange, now: float) -> bool:
        """Tells whether no answer that is owed to this one can be taken for that of another."""
        if self.codes.isdisjoint(following.codes):
            return True
        until = self.same_until if self.asks_the_same(following) else self.others_until
        return self.is_over and now >= until

    def close(self, now: float, ending: bytes | Unanswered | None) -> None:
        """Ends it.

        Who has answered in time soon answers a repeated query too. Who was silent may come late;
        the same question is asked again earlier, for a late answer is one to it as well.
        """
        self.is_over = True
        self.same_until = now + (self.timeout if ending is Unanswered.SILENT else 0.0)
        late = self.timeout * (1 if isinstance(ending, bytes) else LATEST)
        self.others_until = max(self.others_until, now + late)

    def take_over(self, former: Exchange) -> None:
        """Has what is owed to the same question, asked before, owed to this one."""
        self.owed += former.owed
        self.others_until = max(self.others_until, former.others_until)

    def stop_timers(self) -> None:
        """Waits for nothing any more."""
        for timer in self.timers:
            timer.cancel()
        self.timers.clear()


class Exchanges:
    """The exchanges of one component. All of it runs on the loop, or with its lock."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._known: dict[JausAddress, list[Exchange]] = defaultdict(list)
        self._heard: set[type[Message]] = set()

    def listen(self, answers: Sequence[type[Message]]) -> None:
        """Begins to listen to messages that answer."""
        for answer in answers:
            if answer not in self._heard:
                self._heard.add(answer)
                self._component.on_payload(answer, self._answered)

    def ask(
        self,
        target: JausAddress,
        payload: bytes,
        answers: Sequence[type[Message]],
        end: Callable[[bytes | Unanswered], None],
        *,
        timeout: float,
        is_query: bool,
        priority: Priority = Priority.STANDARD,
    ) -> Callable[[], None]:
        """Sends a message when its turn has come, and waits for the answer.

        A query is repeated, since it does no harm twice; what commands is acknowledged by the
        transport of the target, and so takes effect once.

        Args:
            end: Is given the answer, or why there is none.
            timeout: Seconds for which it waits for its turn at most, and then for its answer.

        Returns:
            What ends the exchange without an answer; `end` is not called then.
        """
        asked = Exchange(
            payload, answers, end, timeout=timeout, is_query=is_query, priority=priority
        )
        self._known[target].append(asked)
        # The time for its turn; that for its answer begins when it is sent.
        self._end_in(timeout, target, asked, Unanswered.UNSENT)
        self._go_on(target)

        def forget() -> None:
            self._close(target, asked, None)

        return forget

    def _go_on(self, target: JausAddress) -> None:
        """Sends what may be sent, in the order in which it was asked for."""
        now = self._component.loop.now()
        former: list[Exchange] = []
        # A copy, as what is taken over is dropped meanwhile.
        for exchange in tuple(self._known.get(target, ())):
            if exchange.is_waiting and all(one.lets(exchange, now) for one in former):
                exchange.stop_timers()
                for one in former:
                    if one.asks_the_same(exchange):
                        exchange.take_over(one)
                        self._drop(target, one)
                self._send(target, exchange)
                self._end_in(exchange.timeout, target, exchange, Unanswered.SILENT)
            # Also one that waits on: nobody is overtaken by a later one with the same answer.
            former.append(exchange)

    def _send(self, target: JausAddress, asked: Exchange) -> None:
        component = self._component
        asked.owed += 1
        component.transport.send(
            component.address,
            target,
            asked.payload,
            priority=asked.priority,
            acknowledge=not asked.is_query,
        )
        if asked.is_query:
            again = partial(self._send, target, asked)
            asked.timers.append(component.loop.call_later(asked.timeout / ATTEMPTS, again))

    def _end_in(self, delay: float, target: JausAddress, asked: Exchange, why: Unanswered) -> None:
        end = partial(self._finish, target, asked, why)
        asked.timers.append(self._component.loop.call_later(delay, end))

    def _answered(self, payload: bytes, sender: JausAddress) -> None:
        """Takes an answer for the one that has waited for it the longest."""
        code = payload[0] | payload[1] << 8
        for exchange in self._known.get(sender, ()):
            if exchange.owed and code in exchange.codes:
                exchange.owed -= 1
                if not exchange.is_query:
                    # The answer proves that the command has arrived: it is not repeated.
                    self._component.transport.answered(
                        self._component.address, sender, exchange.payload
                    )
                if exchange.is_over:
                    self._note_late(sender, exchange)
                else:
                    self._finish(sender, exchange, payload)
                return

    def _note_late(self, sender: JausAddress, asked: Exchange) -> None:
        """Lets others go on when nothing is owed any more."""
        self._component.counters.add("exchanges.late_answer")
        if not asked.owed:
            self._drop(sender, asked)
            self._component.loop.call_soon(partial(self._go_on, sender))

    def _finish(self, target: JausAddress, asked: Exchange, ending: bytes | Unanswered) -> None:
        if self._close(target, asked, ending):
            asked.end(ending)

    def _close(
        self, target: JausAddress, asked: Exchange, ending: bytes | Unanswered | None
    ) -> bool:
        """Ends an exchange, and lets those that wait for it go on; False when it has ended."""
        if asked.is_over:
            return False
        loop, transport = self._component.loop, self._component.transport
        asked.stop_timers()
        if asked.owed and not asked.is_query and not isinstance(ending, bytes):
            # Whoever asked is told that it failed: it must not be executed later.
            transport.withdraw(self._component.address, target, asked.payload)
        asked.close(loop.now(), ending)
        go_on = partial(self._go_on, target)
        if asked.owed:
            lapse = partial(self._lapse, target, asked)
            asked.timers.append(loop.call_at(asked.same_until, go_on))
            asked.timers.append(loop.call_at(asked.others_until, lapse))
        else:
            self._drop(target, asked)
        loop.call_soon(go_on)
        return True

    def _lapse(self, target: JausAddress, asked: Exchange) -> None:
        """Waits no longer for what is owed."""
        self._drop(target, asked)
        self._go_on(target)

    def _drop(self, target: JausAddress, asked: Exchange) -> None:
        asked.stop_timers()
        known = self._known[target]
        known.remove(asked)
        if not known:
            del self._known[target]
