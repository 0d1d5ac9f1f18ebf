"""Exchanges: a message to a component, and the message that answers it.

Messages of JAUS do not say which query they answer. So exchanges with one target that may have the
same answer wait for each other. An exchange that ends without its answer is remembered, as the
answer may be late: no exchange that could take it for its own is sent before it has arrived, or
before a stated time has passed.
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

ATTEMPTS = 3  # how often a query is sent within its timeout
LATEST = 5  # how late an answer may be, in timeouts of its exchange


class Unanswered(Enum):
    """Why an exchange has no answer."""

    SILENT = "did not answer"  # the message was sent, and no answer came in time
    UNSENT = "was not asked"  # earlier exchanges took all the time; nothing was sent


class Exchange:
    """A message that waits for its turn, then for its answer; made by `Exchanges.ask`."""

    def __init__(
        self,
        payload: bytes,
        answers: Sequence[type[Message]],
        end: Callable[[bytes | Unanswered], None],
        *,
        # Seconds to wait for the turn, and again for the answer.
        timeout: float,
        is_query: bool,
        priority: Priority,
    ) -> None:
        self.payload = payload
        self.codes = frozenset(answer.CODE for answer in answers)
        self.end = end
        self.timeout = timeout
        self.is_query = is_query
        self.priority = priority
        self.owed = 0  # answers that may still come, one for each time that it was sent
        self.is_over = False  # whether it has ended; owed answers may still come
        # Loop times until which the same query waits after the end, and other messages wait.
        self.same_until = self.others_until = 0.0
        self.timers: list[Timer] = []

    @property
    def is_waiting(self) -> bool:
        """Whether the message was not sent yet."""
        return not (self.owed or self.is_over)

    def asks_the_same(self, other: Exchange) -> bool:
        """Returns whether any answer to one exchange is as good for the other."""
        is_same = self.payload == other.payload and self.codes == other.codes
        return is_same and self.is_query and other.is_query

    def permits(self, following: Exchange, now: float) -> bool:
        """Returns whether no answer owed to this exchange can be taken for that of another."""
        if self.codes.isdisjoint(following.codes):
            return True
        until = self.same_until if self.asks_the_same(following) else self.others_until
        return self.is_over and now >= until

    def close(self, now: float, ending: bytes | Unanswered | None) -> None:
        """Ends the exchange.

        After an answer, those to repetitions come soon; after silence, they may be late. The same
        query need not wait for as long, as a late answer is as good for it.
        """
        self.is_over = True
        self.same_until = now + (self.timeout if ending is Unanswered.SILENT else 0.0)
        lateness = self.timeout * (1 if isinstance(ending, bytes) else LATEST)
        self.others_until = max(self.others_until, now + lateness)

    def take_over(self, former: Exchange) -> None:
        """Takes over the owed answers of a former exchange with the same query."""
        self.owed += former.owed
        self.others_until = max(self.others_until, former.others_until)

    def stop_timers(self) -> None:
        """Cancels all timers."""
        for timer in self.timers:
            timer.cancel()
        self.timers.clear()


class Exchanges:
    """The exchanges of one component. All methods run on the loop, or with its lock."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._exchanges: dict[JausAddress, list[Exchange]] = defaultdict(list)
        self._answers: set[type[Message]] = set()

    def listen(self, answers: Sequence[type[Message]]) -> None:
        """Begins to receive these classes of answers."""
        for answer in answers:
            if answer not in self._answers:
                self._answers.add(answer)
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

        A query is repeated, since it does no harm twice; a command is acknowledged by the
        transport of the target, and so takes effect once.

        Args:
            end: Takes the encoded answer, or the reason why there is none.
            timeout: Seconds to wait for the turn, and again for the answer.

        Returns:
            A function that ends the exchange without a call of `end`.
        """
        exchange = Exchange(
            payload, answers, end, timeout=timeout, is_query=is_query, priority=priority
        )
        self._exchanges[target].append(exchange)
        # The time for its turn; that for its answer begins when the message is sent.
        self._end_in(timeout, target, exchange, Unanswered.UNSENT)
        self._go_on(target)

        def forget() -> None:
            self._close(target, exchange, None)

        return forget

    def _go_on(self, target: JausAddress) -> None:
        """Sends the waiting messages whose turn has come, in the order of their calls."""
        now = self._component.loop.now()
        former: list[Exchange] = []
        # A copy, as exchanges that are taken over are dropped meanwhile.
        for exchange in tuple(self._exchanges.get(target, ())):
            if exchange.is_waiting and all(earlier.permits(exchange, now) for earlier in former):
                exchange.stop_timers()
                for earlier in former:
                    if earlier.asks_the_same(exchange):
                        exchange.take_over(earlier)
                        self._drop(target, earlier)
                self._send(target, exchange)
                self._end_in(exchange.timeout, target, exchange, Unanswered.SILENT)
            # A waiting one as well: a later one with the same answer must not overtake it.
            former.append(exchange)

    def _send(self, target: JausAddress, exchange: Exchange) -> None:
        component = self._component
        exchange.owed += 1
        component.transport.send(
            component.address,
            target,
            exchange.payload,
            priority=exchange.priority,
            acknowledge=not exchange.is_query,
        )
        if exchange.is_query:
            repeat = partial(self._send, target, exchange)
            exchange.timers.append(component.loop.call_later(exchange.timeout / ATTEMPTS, repeat))

    def _end_in(
        self, delay: float, target: JausAddress, exchange: Exchange, why: Unanswered
    ) -> None:
        end = partial(self._finish, target, exchange, why)
        exchange.timers.append(self._component.loop.call_later(delay, end))

    def _answered(self, payload: bytes, sender: JausAddress) -> None:
        """Gives an answer to the exchange that has waited for it the longest."""
        code = payload[0] | payload[1] << 8
        for exchange in self._exchanges.get(sender, ()):
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

    def _note_late(self, sender: JausAddress, exchange: Exchange) -> None:
        """Counts a late answer; after the last one owed, waiting exchanges go on."""
        self._component.counters.add("exchanges.late_answer")
        if not exchange.owed:
            self._drop(sender, exchange)
            self._component.loop.call_soon(partial(self._go_on, sender))

    def _finish(self, target: JausAddress, exchange: Exchange, ending: bytes | Unanswered) -> None:
        if self._close(target, exchange, ending):
            exchange.end(ending)

    def _close(
        self, target: JausAddress, exchange: Exchange, ending: bytes | Unanswered | None
    ) -> bool:
        """Ends an exchange, and lets waiting ones go on; returns False if it had ended before."""
        if exchange.is_over:
            return False
        loop, transport = self._component.loop, self._component.transport
        exchange.stop_timers()
        if exchange.owed and not exchange.is_query and not isinstance(ending, bytes):
            # The caller takes the command for failed: it must not be executed later.
            transport.withdraw(self._component.address, target, exchange.payload)
        exchange.close(loop.now(), ending)
        go_on = partial(self._go_on, target)
        if exchange.owed:
            lapse = partial(self._lapse, target, exchange)
            exchange.timers.append(loop.call_at(exchange.same_until, go_on))
            exchange.timers.append(loop.call_at(exchange.others_until, lapse))
        else:
            self._drop(target, exchange)
        loop.call_soon(go_on)
        return True

    def _lapse(self, target: JausAddress, exchange: Exchange) -> None:
        """Stops waiting for owed answers."""
        self._drop(target, exchange)
        self._go_on(target)

    def _drop(self, target: JausAddress, exchange: Exchange) -> None:
        exchange.stop_timers()
        exchanges = self._exchanges[target]
        exchanges.remove(exchange)
        if not exchanges:
            del self._exchanges[target]
