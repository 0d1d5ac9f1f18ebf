"""What a loop says of the time in which it did not turn."""

from __future__ import annotations

import os
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.connections.ages import Backlog
from jausml.runtime.bridge.reports.diagnostics import TOO_OLD, Statistics

if TYPE_CHECKING:
    from collections.abc import Callable

STILL = 0.3


@pytest.fixture
def loop():
    with Loop() as made:
        yield made


def turn(loop: Loop, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        loop.run_once(0.01)


def test_who_asked_is_told_before_what_waited_is_served(loop: Loop) -> None:
    told: list[object] = []
    own, other = os.pipe()

    def read() -> None:
        loop.standstill.look()
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


def test_a_callback_that_takes_long_is_a_standstill_too(loop: Loop) -> None:
    told: list[float] = []
    loop.standstill.watch(STILL / 3, told.append)
    turn(loop, 0.1)
    loop.call_soon(lambda: time.sleep(STILL))
    turn(loop, 2 * STILL)
    assert len(told) == 1
    assert told[0] >= STILL


def test_only_those_are_told_whose_time_has_passed(loop: Loop) -> None:
    told: list[str] = []
    short = loop.standstill.watch(STILL / 3, lambda _: told.append("short"))
    loop.standstill.watch(100.0, lambda _: told.append("long"))
    loop.standstill.watch(0.0, lambda _: told.append("never"))
    turn(loop, 0.1)
    time.sleep(STILL)
    turn(loop, 0.1)
    assert told == ["short"]
    short.change(0.0)
    time.sleep(STILL)
    turn(loop, 0.1)
    short.change(STILL / 3)
    turn(loop, 0.1)
    short.cancel()
    time.sleep(STILL)
    turn(loop, 0.1)
    assert told == ["short"]


def test_commands_that_may_have_waited_too_long_are_refused_until_all_was_served(
    loop: Loop, monkeypatch: pytest.MonkeyPatch
) -> None:
    obeyed: list[bytes] = []
    refused: list[str] = []
    watched: list[Callable[..., None]] = []

    def watch(_limit: float, *told: Callable[..., None]) -> SimpleNamespace:
        watched.extend(told)
        return SimpleNamespace(cancel=watched.clear)

    ends: Any = SimpleNamespace(loop=loop, clock=loop)
    monkeypatch.setattr(loop, "standstill", SimpleNamespace(watch=watch))
    counts = Statistics()
    backlog = Backlog(counts, lambda name, _: refused.append(name), lambda _: None)
    backlog.open(ends, 1.0, lambda: None)
    take = backlog.before(lambda data, _: obeyed.append(data))
    began, caught_up = watched
    for still in (0.9, 1.1):
        began(still)
        take(b"waited", None)
    caught_up()
    take(b"fresh", None)
    assert obeyed == [b"waited", b"fresh"]
    assert (refused, counts.arrivals) == ([TOO_OLD], 1)
    backlog.close()
    assert not backlog.is_there
