"""Sticks: a command that a page repeats while a person holds a joystick, and its stop.

One stick is held at a time. Each command renews its lease; when the lease or the stick ends, the
stop is sent until it is acknowledged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from threading import Condition, Lock, RLock, Thread
from typing import Any

from jausml.live.messages import MessageEntry
from jausml.live.operating.guarding import UnitGuardian
from jausml.live.operating.journal import Journal
from jausml.live.operating.knowledge import DeclaredStop
from jausml.live.operating.stops import Stops, deliver
from jausml.live.operating.watching import WatchedSystem
from jausml.live.peers.query_client import Refused
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.standstill import steady
from jausml.runtime.wire.message import Message

_MAX_WAIT = 0.25  # seconds between two readings of the steady clock


class Lease:
    """A permission that ends some seconds after its last renewal."""

    def __init__(self, seconds: float, expired: Callable[[], None]) -> None:
        """Begins the lease (`expired`: is called once, on another thread, unless renewed)."""
        self.seconds = seconds
        self._expired = expired
        self._due = steady() + seconds
        self._is_over = False
        self._news = Condition()
        Thread(target=self._run, name="lease", daemon=True).start()

    def renew(self) -> bool:
        """Renews the lease; returns False when it has ended, or is due to."""
        with self._news:
            now = steady()
            if self._is_over or now >= self._due:
                return False
            self._due = now + self.seconds
            return True

    def end(self) -> None:
        """Ends the lease without a call of `expired`."""
        with self._news:
            self._is_over = True
            self._news.notify()

    def _run(self) -> None:
        with self._news:
            while not self._is_over and (left := self._due - steady()) > 0:
                # The lease counts the time of a suspended computer, and a wait does not.
                self._news.wait(min(left, _MAX_WAIT))
            if self._is_over:
                return
            self._is_over = True
        self._expired()


class Stick:
    """A repeated command; its end sends the stop.

    After the stop, further commands of the stick are refused.
    """

    def __init__(
        self,
        seconds: float,
        send: Callable[[Message], None],
        stop: Callable[[], None],
        ended: Callable[[str], None],
    ) -> None:
        """Begins without a command.

        Args:
            seconds: Seconds for which one command holds.
            send: Sends a command.
            stop: Sends the stop.
            ended: Is called with the reason of the end, on any thread.
        """
        self._send, self._stop, self._ended = send, stop, ended
        self._lock = RLock()
        self._is_over = False
        self._lease = Lease(seconds, self._expired)

    def move(self, message: Message) -> None:
        """Sends a command, and renews the lease (`Refused`: it has ended)."""
        with self._lock:
            if not self._lease.renew():
                raise Refused("the stick was released, or its page was silent too long")
            self._send(message)

    def end(self, why: str) -> None:
        """Sends the stop, unless it was sent before."""
        with self._lock:
            if self._is_over:
                return
            self._is_over = True
            self._lease.end()
            self._stop()
        self._ended(why)

    def _expired(self) -> None:
        self.end(f"the page said nothing for {self._lease.seconds:g} s")


# Reasons for the end of a stick that raise no alarm.
RELEASED, STOPPED, GIVEN_UP = "released", "stop", "control is given up"


@dataclass(frozen=True)
class HeldStick:
    """The stick that is held, with the component and message of its command."""

    number: int
    target: JausAddress
    entry: MessageEntry
    stick: Stick


class Sticks:
    """The stick that is held, if there is one; any thread may call it.

    Attributes:
        guardian: Sends the stop of the stick if this process cannot; None before it runs.
    """

    def __init__(self, system: WatchedSystem, journal: Journal, stops: Stops) -> None:
        """Begins without a stick."""
        self.held: HeldStick | None = None
        self.guardian: UnitGuardian | None = None
        self._system, self._journal, self._stops = system, journal, stops
        self._count = 0
        self._latest: dict[JausAddress, int] = {}
        self._lock = Lock()

    def stop_of(self, target: JausAddress, entry: MessageEntry) -> DeclaredStop:
        """Returns the declared stop of a command (`Refused`: there is none)."""
        return self._stops.of(str(target), entry)

    def begin(self, name: str, target: JausAddress, entry: MessageEntry) -> tuple[int, float]:
        """Begins a stick; returns its number, and the seconds for which a command holds."""
        operator, stop = self._system.operator, self.stop_of(target, entry)
        if not operator.controls(target):
            raise Refused(f"{target} is not controlled by us")
        stopping = operator.message(entry, stop.fields)
        with self._lock:
            if self.held is not None:
                raise Refused(f"the stick of {self.held.target} is held")
            self._count += 1
            number = self._latest[target] = self._count
            stick = Stick(
                stop.timeout,
                lambda message: operator.send(target, message),
                lambda: self._deliver(number, target, stopping),
                lambda why: self._ended(number, target, entry.name, why),
            )
            self.held = HeldStick(number, target, entry, stick)
            if self.guardian is not None:
                self.guardian.hold(target, stopping, stop.timeout)
        self._journal.note(name, f"holds the stick: {entry.name} to {target}")
        return number, stop.timeout

    def move(self, number: int, fields: dict[str, Any]) -> None:
        """Sends the command of a stick with new values of fields."""
        held = self._held(number)
        held.stick.move(self._system.operator.message(held.entry, fields))

    def release(self, number: int) -> None:
        """Ends a stick that the person released."""
        self._held(number).stick.end(RELEASED)

    def end(self, why: str, target: JausAddress | None = None) -> None:
        """Ends the held stick, whose component must be `target` unless that is None."""
        held = self.held
        if held is not None and target in (None, held.target):
            held.stick.end(why)

    def _held(self, number: int) -> HeldStick:
        held = self.held
        if held is None or held.number != number:
            raise Refused("the stick is released, and its stop was sent")
        return held

    def _ended(self, number: int, target: JausAddress, name: str, why: str) -> None:
        with self._lock:
            if self.held is not None and self.held.number == number:
                self.held = None
                if self.guardian is not None:
                    self.guardian.let_go()
        self._journal.note("unit", f"sent the stop of {name} to {target}: {why}")
        if why not in (RELEASED, STOPPED, GIVEN_UP):
            self._alarm(target, f"stopped: {why}")

    def _alarm(self, target: JausAddress, text: str) -> None:
        named = self._system.name_of(target)
        self._journal.alarm(named, text, f"stick of {named}")

    def _deliver(self, number: int, target: JausAddress, message: Message) -> None:
        """Sends a stop until it is acknowledged, or the component has a newer stick."""
        operator = self._system.running
        if operator is None:
            return

        def is_wanted() -> bool:
            return self._latest[target] == number

        def ended(is_acknowledged: bool) -> None:  # noqa: FBT001
            if not is_acknowledged and is_wanted():
                self._alarm(target, "the stop was never acknowledged")

        deliver(operator, target, message, is_wanted, ended)
