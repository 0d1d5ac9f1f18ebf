"""Deadlines: each is told when it is due, whatever else waits, and not after its wait ended."""

import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.clients.query import Deadlines


class World:
    """A loop with a clock of its own, and deadlines that note what is due and when."""

    def __init__(self):
        self.time = 0.0
        self.told = []
        self.on_due = lambda _item: None
        self.loop = Loop(clock=lambda: self.time)
        self.deadlines = Deadlines(self.loop, self._due)

    def _due(self, item):
        self.told.append((item, self.time))
        self.on_due(item)

    def run(self, until):
        """Turns the loop each tenth of a second."""
        while self.time < until:
            self.time = round(self.time + 0.1, 1)
            self.loop.run_once(0)


@pytest.fixture
def world():
    """The world."""
    made = World()
    yield made
    made.loop.stop()


def test_each_is_told_once_when_it_is_due(world):
    world.deadlines.add("a", 1.0)
    world.run(0.4)
    world.deadlines.add("b", 1.0)
    world.deadlines.add("c", 0.3)
    world.run(5.0)
    assert world.told == [("c", 0.7), ("a", 1.0), ("b", 1.4)]


def test_nothing_is_told_of_what_waits_no_longer(world):
    for name in "abc":
        world.deadlines.add(name, 1.0)
    world.deadlines.discard("a", 1.0)
    world.deadlines.discard("c", 1.0)
    world.deadlines.discard("c", 1.0)
    world.deadlines.discard("d", 7.0)
    world.run(2.0)
    assert world.told == [("b", 1.0)]


def test_what_comes_after_all_have_ended_is_told_too(world):
    world.deadlines.add("a", 1.0)
    world.deadlines.discard("a", 1.0)
    world.run(0.5)
    world.deadlines.add("b", 1.0)
    world.run(3.0)
    world.deadlines.add("c", 1.0)
    world.run(5.0)
    assert world.told == [("b", 1.5), ("c", 4.0)]


def test_one_that_is_due_may_end_the_wait_of_another(world):
    world.deadlines.add("a", 1.0)
    world.deadlines.add("b", 1.0)
    world.on_due = lambda _item: world.deadlines.discard("b", 1.0)
    world.run(3.0)
    assert world.told == [("a", 1.0)]


@pytest.mark.parametrize("delay", [1.0, 0.0])
def test_what_is_due_may_wait_again(world, delay):
    world.on_due = lambda item: len(world.told) < 3 and world.deadlines.add(item, delay)
    world.deadlines.add("a", delay)
    world.run(6.0)
    assert [item for item, _ in world.told] == ["a"] * 3
    assert len({when for _, when in world.told}) == 3


def test_an_error_keeps_nothing_from_its_deadline(world):
    def fail(item):
        if item == "a":
            raise ValueError(item)

    world.on_due = fail
    world.deadlines.add("a", 1.0)
    world.run(0.5)
    world.deadlines.add("b", 1.0)
    world.run(3.0)
    assert world.told == [("a", 1.0), ("b", 1.5)]
    assert world.loop.counters.drops() == {"loop.callback_failed": 1}
