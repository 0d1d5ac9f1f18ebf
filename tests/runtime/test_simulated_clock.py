"""The clock of a simulation: steady, at rest with it, and timers that keep their time."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.ends.simulation import SEEK, SimulatedClock


@pytest.fixture
def loop(clock):
    with Loop(clock) as made:
        yield made


@pytest.fixture
def simulated(loop):
    return SimulatedClock(loop)


def run(simulated, clock, ratio, seconds, start, step=0.02):
    """Lets real time pass, in which the simulation says its time; returns where it is."""
    for _ in range(round(seconds / step)):
        clock.time += step
        start += ratio * step
        simulated.advance_to(start)
    return start


def test_it_stands_until_the_simulation_has_said_two_times(simulated):
    simulated.advance_to(500.0)
    assert simulated.now() == 0.0
    simulated.advance_to(500.25)
    assert simulated.now() == 0.25


@given(st.lists(st.floats(0.0, 1e9, allow_nan=False), min_size=1))
def test_it_never_goes_back_and_counts_what_passed(times):
    with Loop(lambda: 0.0) as loop:
        simulated, seen = SimulatedClock(loop), []
        for time in times:
            simulated.advance_to(time)
            seen.append(simulated.now())
        steps = [second - first for first, second in pairwise(times)]
        assert seen == sorted(seen)
        assert seen[-1] == pytest.approx(sum(step for step in steps if 0 <= step <= SEEK))
        assert simulated.seeks == sum(not 0 <= step <= SEEK for step in steps)


def test_timers_wait_for_the_simulation(simulated, clock):
    ran = []
    simulated.advance_to(10.0)
    simulated.call_later(1.0, lambda: ran.append(simulated.now()))
    simulated.call_later(0.5, lambda: ran.append("first"))
    simulated.call_later(0.7, lambda: ran.append("never")).cancel()
    clock.time += 100.0
    simulated.advance_to(10.4)
    assert ran == []
    simulated.advance_to(11.5)
    assert ran == ["first", 1.5]


def test_a_timer_keeps_what_remained_when_the_time_goes_back(simulated):
    ran = []
    simulated.advance_to(100.0)
    simulated.call_later(1.0, lambda: ran.append(True))
    simulated.advance_to(100.75)
    simulated.advance_to(0.0)
    simulated.advance_to(0.125)
    assert ran == []
    simulated.advance_to(0.25)
    assert ran == [True]
    assert simulated.seeks == 1


def test_a_timer_that_asks_for_another_does_not_run_it_at_once(simulated):
    ran = []

    def again():
        ran.append(simulated.now())
        simulated.call_later(0.0, again)

    simulated.call_later(0.0, again)
    simulated.advance_to(1.0)
    simulated.advance_to(2.0)
    assert ran == [0.0, 1.0]


def test_a_callback_that_fails_is_counted(simulated, loop):
    ran = []
    simulated.call_later(0.0, lambda: 1 / 0)
    simulated.call_later(0.0, lambda: ran.append(True))
    simulated.advance_to(1.0)
    assert ran == [True]
    assert loop.counters.snapshot()["clock.callback_failed"] == 1


@pytest.mark.parametrize("ratio", [0.5, 0.05, 5.0])
def test_the_ratio_is_measured(simulated, clock, ratio):
    told = []
    simulated.follow_ratio(lambda: told.append(simulated.ratio))
    place = run(simulated, clock, 1.0, 3.0, 0.0)
    assert told == []
    run(simulated, clock, ratio, 5.0, place)
    assert simulated.ratio == pytest.approx(ratio, rel=0.11)
    assert told == [simulated.ratio]


def test_a_pause_is_no_change_of_the_ratio(simulated, clock):
    told = []
    simulated.follow_ratio(lambda: told.append(simulated.ratio))
    place = run(simulated, clock, 1.0, 3.3, 0.0)
    place = run(simulated, clock, 0.0, 4.4, place)  # says the same time again and again
    place = run(simulated, clock, 1.0, 3.3, place)
    clock.time += 7.0  # says nothing
    run(simulated, clock, 1.0, 3.3, place)
    assert told == []
    assert simulated.ratio == 1.0
