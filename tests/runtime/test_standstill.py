"""What a loop says of the time in which it did not turn."""

import os
import time
from types import SimpleNamespace
from typing import Any

import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.connections.shaping import Backlog
from jausml.runtime.bridge.reports.diagnostics import TOO_OLD, Statistics
from jausml.runtime.virtual import VirtualWorld

STILL = 0.3


@pytest.fixture
def loop():
    with Loop() as made:
        yield made


def turn(loop: Loop, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        loop.run_once(0.01)


def test_who_asked_is_told_before_what_waited_is_served(loop):
    told: list[object] = []
    own, other = os.pipe()

    def read() -> None:
        loop.standstill.check()
        told.append(os.read(own, 1))

    loop.register(own, read)
    loop.standstill.watch(STILL / 3, told.append, lambda: told.append("caught up"))
    turn(loop, 0.1)
    os.write(other, b"x")
    time.sleep(STILL)
    turn(loop, 0.5)
    loop.unregister(own)
    os.close(own)
    os.close(other)
    still, *rest = told
    assert isinstance(still, float)
    assert still >= STILL
    assert rest == [b"x", "caught up"]


def test_a_callback_that_takes_long_is_a_standstill_too(loop):
    told: list[float] = []
    loop.standstill.watch(STILL / 3, told.append)
    turn(loop, 0.1)
    loop.call_soon(lambda: time.sleep(STILL))
    turn(loop, 2 * STILL)
    # A busy computer may hold up the test itself, for less than that.
    assert len([seconds for seconds in told if seconds >= STILL]) == 1


def test_only_those_are_told_whose_time_has_passed(loop):
    told: set[str] = set()
    short = loop.standstill.watch(STILL / 3, lambda _: told.add("short"))
    loop.standstill.watch(100.0, lambda _: told.add("long"))
    loop.standstill.watch(0.0, lambda _: told.add("never"))
    turn(loop, 0.1)
    time.sleep(STILL)
    turn(loop, 0.1)
    assert told == {"short"}
    short.change(0.0)
    told.clear()
    time.sleep(STILL)
    turn(loop, 0.1)
    short.change(STILL / 3)
    assert not told
    turn(loop, 0.1)
    short.cancel()
    told.clear()
    time.sleep(STILL)
    turn(loop, 0.1)
    assert not told


class Late:
    """A backlog on virtual time, and what became of the messages that it was given."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, limit: float) -> None:
        self.world = VirtualWorld()
        self.obeyed: list[bytes] = []
        self.refused: list[str] = []
        self.changes: list[bool] = []
        self.watched: list[Any] = []
        loop = self.world.loop
        monkeypatch.setattr(loop, "standstill", self)
        self.counts = Statistics()
        self.backlog = Backlog(self.counts, self._drop, lambda origin: origin)
        ends: Any = SimpleNamespace(loop=loop, clock=loop)
        self.backlog.open(ends, limit, lambda: self.changes.append(self.backlog.is_active))

    def take(self, data: bytes, origin: Any) -> None:
        if self.backlog.admits(origin):
            self.obeyed.append(data)

    def watch(self, *told: Any) -> SimpleNamespace:
        """Stands for what notices standstills, which virtual time has none of."""
        self.watched = [*told]
        return SimpleNamespace(cancel=self.watched.clear, change=self.watched.append)

    def _drop(self, name: str, _text: str) -> None:
        self.refused.append(name)


@pytest.fixture
def late(monkeypatch):
    return Late(monkeypatch, 1.0)


def test_commands_that_may_have_waited_too_long_are_refused_until_all_was_served(late):
    limit, began, caught_up = late.watched
    assert limit == 1.0
    late.world.run_for(3)
    for still in (0.9, 1.1):
        began(still)
        late.take(b"waited", None)
    caught_up()
    late.take(b"fresh", None)
    assert late.obeyed == [b"waited", b"fresh"]
    assert (late.refused, late.counts.arrivals) == ([TOO_OLD], 1)
    assert late.counts.last_arrival == 3
    late.backlog.close()
    assert not late.backlog.is_active
    assert not late.watched


def test_a_command_whose_age_is_known_is_judged_by_it_alone(late):
    _, began, caught_up = late.watched
    began(5.0)
    for age in (0.4, 1.0, 1.1):
        late.take(b"%.1f" % age, age)
    caught_up()
    late.take(b"repeated by its writer", 3.0)
    assert late.obeyed == [b"0.4", b"1.0"]
    assert late.refused == [TOO_OLD] * 2


def test_what_comes_late_is_looked_for_as_long_as_writers_repeat(late):
    _, began, _ = late.watched
    began(1.5)
    late.world.run_for(3)
    began(2.0)
    late.world.run_for(4.9)
    assert late.changes == [True, True]
    late.world.run_for(0.2)
    assert late.changes == [True, True, False]


def test_the_time_that_a_command_may_wait_changes_at_once(late):
    _, began, _ = late.watched
    began(1.5)
    late.take(b"before", None)
    for limit in (2.0, 0.0, 1.0):
        late.backlog.change(limit)
        late.take(b"%.0f" % limit, None)
    assert late.watched[3:] == [2.0, 0.0, 1.0]
    assert late.obeyed == [b"2", b"0"]
    assert late.refused == [TOO_OLD] * 2
