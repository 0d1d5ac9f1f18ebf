"""Garbage of a bridge is collected at quiet moments."""

import gc
import socket
import weakref

import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.process import LONGEST_DELAY, PERIOD, QuietCollection, without_collection


class Knot:
    """Garbage that only a collection finds."""

    def __init__(self) -> None:
        self.self = self


@pytest.fixture
def loop(clock):
    with Loop(clock) as made, without_collection():
        yield made


def dropped() -> weakref.ref[Knot]:
    return weakref.ref(Knot())


def test_garbage_goes_at_the_next_quiet_moment(loop, clock):
    QuietCollection(loop).start()
    for _ in range(2):
        knot = dropped()
        assert loop.run_once(0) == 0
        assert knot() is not None
        clock.time += PERIOD
        assert loop.run_once(0) == 1
        assert knot() is None


def test_what_waits_to_be_served_goes_first_but_not_for_ever(loop, clock):
    near, far = socket.socketpair()
    with near, far:
        loop.register(near, lambda: None)
        far.sendall(b"x")
        QuietCollection(loop).start()
        knot = dropped()
        clock.time += PERIOD
        loop.run_once(0)
        assert knot() is not None
        clock.time += LONGEST_DELAY
        loop.run_once(0)
        assert knot() is None
        loop.unregister(near)


def test_what_was_there_at_the_start_is_set_aside_until_the_end():
    assert gc.isenabled()
    with Loop() as made:
        with without_collection():
            assert not gc.isenabled()
            QuietCollection(made).start()
            assert gc.get_freeze_count() > 0
        assert gc.isenabled()
        assert gc.get_freeze_count() == 0
