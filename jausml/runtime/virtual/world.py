"""Virtual world: components and bridges by a simulated clock, as fast as the computer can run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime, timedelta, timezone
from random import Random
from typing import Any, TypeAlias

from ..base.clocks import HostClock
from ..base.counters import Counters
from ..base.loop import Loop, Timer
from ..base.settings import TransportSettings
from .graph import RosGraph
from .network import Link, Network, VirtualTransport
from .node import VirtualRosNode

# Takes the time in seconds, the path or topic of an arriving datagram or message, and its bytes.
Watch: TypeAlias = "Callable[[float, str, bytes], object]"

START = datetime(2026, 1, 1, tzinfo=timezone.utc)  # time of day at which worlds begin
MAX_AT_ONCE = 100_000  # turns of the loop at one time after which callbacks go round in circles

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
_NANO = 10**9


class VirtualWorld:
    """Components and bridges on one clock, which goes from event to event and never waits.

    The same seed gives the same bytes at the same times on any computer, as long as user code takes
    the time from its component or bridge, and random numbers from ``random`` or a seed of its own.
    All of it runs on the thread that calls ``run_for``.

    Attributes:
        random: Draws losses and delays, in the order of events.
    """

    def __init__(self, seed: int = 1, start: datetime = START) -> None:
        """Begins at 0 seconds.

        Args:
            start: Time of day at 0 seconds, with its time zone.

        Raises:
            ValueError: The start has no time zone.
        """
        if start.tzinfo is None:
            raise ValueError(f"start {start} has no time zone")
        self._now = 0.0
        self._is_running = False
        # An integer, as a float would round the nanoseconds.
        self._start = (start - _EPOCH) // timedelta(microseconds=1) * 1000
        self._seed = seed
        self._transports = 0
        self._watchers: list[Watch] = []
        self.random = Random(seed)
        # By its own clock, no callback is slow on any computer.
        self.loop = Loop(clock=self.now, wall=self._wall, stopwatch=self.now)
        self._network = Network(self.loop, self.random, self._notify)
        self.ros = RosGraph(self.loop, self.random, self._notify)

    def __enter__(self) -> VirtualWorld:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes network and loop; components and bridges should be stopped before."""
        self._network.close()
        self.loop.stop()

    # ------------------------------------------------------------------ processes and nodes

    def transport(
        self,
        out: Link | None = None,
        into: Link | None = None,
        settings: TransportSettings | None = None,
    ) -> VirtualTransport:
        """Returns the opened transport of a further process; settings of sockets have no effect."""
        self._transports += 1
        # Random numbers of its own: drawing packet numbers does not shift losses and delays.
        numbers = Random(f"{self._seed} {self._transports}")
        return self._network.transport(
            settings or TransportSettings(), out or Link(), into or Link(), numbers.randrange
        )

    def ros_node(
        self,
        name: str,
        parameters: Mapping[str, Any] | None = None,
        *,
        namespace: str = "",
        link: Link | None = None,
    ) -> VirtualRosNode:
        """Returns a node for a bridge in a namespace, e.g. `/fleet`; empty means the root."""
        full_name = f"/{namespace.strip('/')}/{name}" if namespace.strip("/") else f"/{name}"
        return VirtualRosNode(self.ros, full_name, parameters or {}, link or Link())

    def watch(self, take: Watch) -> None:
        """Calls `take` with each datagram and each ROS message that arrives from now on."""
        self._watchers.append(take)

    @property
    def counters(self) -> Counters:
        """The counters of the world."""
        return self.loop.counters

    # ------------------------------------------------------------------ time

    def now(self) -> float:
        """Returns the seconds since the world began."""
        return self._now

    def utc(self) -> datetime:
        """Returns the time of day in UTC."""
        return HostClock(self.loop).utc()

    def call_at(self, when: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback at a time in seconds."""
        return self.loop.call_at(when, callback)

    def call_later(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Runs a callback after a delay in seconds."""
        return self.loop.call_later(delay_s, callback)

    def run_for(self, seconds: float) -> None:
        """Advances the time, and runs all callbacks until then.

        Args:
            seconds: Virtual time to pass, at least 0.

        Raises:
            ValueError: The seconds are negative.
            RuntimeError: Callbacks go round in circles at one time; or the caller is a callback.
        """
        with self._running(seconds) as turns:
            end = self._now + seconds
            while self._step(end, turns):
                pass
            # Also without an event at the end.
            self._now = end

    def run_until(self, condition: Callable[[], object], limit: float) -> None:
        """Advances the time until a condition holds, which is checked after each turn.

        Args:
            limit: Longest time in seconds.

        Raises:
            TimeoutError: The condition does not hold by then.
            ValueError: The limit is below 0.
            RuntimeError: As with ``run_for``.
        """
        with self._running(limit) as turns:
            begun = self._now
            while not condition():
                if not self._step(begun + limit, turns):
                    self._now = begun + limit
                    raise TimeoutError(
                        f"what was waited for did not happen in {limit:g} s of virtual time"
                        f" (from {begun:g} s to {self._now:g} s)"
                    )

    @contextmanager
    def _running(self, seconds: float) -> Iterator[_Turns]:
        if not seconds >= 0:
            raise ValueError(f"time goes on, by 0 s or more; {seconds} is asked for")
        if self._is_running:
            raise RuntimeError("a callback cannot let time pass: use call_later or call_at")
        self._is_running = True
        try:
            yield _Turns()
        finally:
            self._is_running = False

    def _step(self, end: float, turns: _Turns) -> bool:
        """Advances to the next event and runs it; returns False if it is after the end."""
        due = self.loop.next_due()
        if due is None or due > end:
            return False
        if due > self._now:
            self._now = due
            turns.at_once = 0
        turns.at_once += 1
        if turns.at_once > MAX_AT_ONCE:
            raise RuntimeError(f"time stands still at {self._now:g} s: callbacks call each other")
        # Without a wait: only `_now` advances the time.
        self.loop.run_once(0)
        return True

    def _wall(self) -> int:
        return self._start + round(self._now * _NANO)

    def _notify(self, where: str, data: bytes) -> None:
        for watcher in self._watchers:
            watcher(self._now, where, data)


class _Turns:
    """The number of turns of the loop at the present time."""

    def __init__(self) -> None:
        self.at_once = 0
