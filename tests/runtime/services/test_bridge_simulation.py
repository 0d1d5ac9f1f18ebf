"""Bridges beside a simulation: what belongs to it keeps its time, what belongs to JAUS does not."""

import pytest

from jausml.runtime.bridge.ends.simulation import CLOCK_TIMEOUT
from jausml.runtime.bridge.reports.states import StopReason
from jausml.runtime.messages import CreateEvent, Event, QueryEventTimeout, QueryTime

from .bridge_support import (
    CORE,
    OTHER,
    OWN,
    PEER,
    command,
    event,
    minutes,
    peer_component,
    query,
    report,
    safe,
)


class Simulation:
    """A simulation that runs beside a world, at a ratio to its time."""

    def __init__(self, world, ros):
        self.world, self.ros = world, ros
        self.time = 100.0
        ros.is_simulated = True

    def run(self, seconds, ratio=1.0, step=0.01):
        """Lets real time pass; None for the ratio says nothing on /clock."""
        for _ in range(round(seconds / step)):
            if ratio is not None:
                self.time += ratio * step
                self.ros.say_time(self.time)
            self.world.run(step, step)


@pytest.fixture
def simulation(world, setting):
    return Simulation(world, setting.ros)


@pytest.mark.parametrize("ratio", [0.5, 5.0])
def test_silence_is_that_of_the_simulation(world, setting, simulation, ratio):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    simulation.run(0.1, ratio)
    setting.say(5.0)
    simulation.run(0.9 / ratio, ratio)
    assert peer.take() == [minutes(5)]
    simulation.run(0.2 / ratio, ratio)
    assert peer.take() == [minutes(0)]


def test_a_pause_is_no_silence_but_a_lost_clock_stops(world, setting, simulation):
    peer = world.probe(str(PEER))
    connection = setting.open(command(silence_timeout=1.0, safe_value=safe))
    simulation.run(0.1)
    setting.say(5.0)
    simulation.run(20.0, 0.0)
    assert peer.take() == [minutes(5)]
    assert setting.ros.statuses[-1]["simulated time"].level == "ok"
    simulation.run(CLOCK_TIMEOUT - 0.1, None)
    assert peer.take() == []
    simulation.run(0.2, None)
    assert peer.take() == [minutes(0)]
    assert connection.stopped is StopReason.CLOCK
    simulation.run(10.0, None)
    assert peer.take() == []
    assert setting.judged("simulated time") == ("stale", "nobody says the time on /clock")
    setting.say(6.0)
    assert peer.take() == [minutes(6)]


def test_a_lost_clock_stops_commands_that_may_be_silent_for_ever(world, setting, simulation):
    peer = world.probe(str(PEER))
    connection = setting.open(command(is_command=True, safe_value=safe))
    simulation.run(0.1)
    setting.say(5.0)
    peer.take()
    simulation.run(CLOCK_TIMEOUT + 0.1, None)
    assert peer.take() == [minutes(0)]
    assert connection.stopped is StopReason.CLOCK


def test_a_clock_that_nobody_speaks_on_is_told(world, setting):
    setting.ros.is_simulated = True
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(5.0)
    assert setting.judged("simulated time") == ("stale", "nothing was heard on /clock yet")


def test_a_jump_back_is_counted_and_ends_nothing(world, setting, simulation):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    simulation.run(0.1)
    setting.say(5.0)
    simulation.time = 0.0
    simulation.run(0.8)
    assert peer.take() == [minutes(5)]
    simulation.run(0.5)
    assert peer.take() == [minutes(0)]
    assert world.counters.snapshot()["bridge.clock_jumped"] == 1


@pytest.mark.parametrize("ratio", [0.5, 2.0])
def test_reports_are_served_at_the_pace_of_the_simulation(world, setting, simulation, ratio):
    setting.open(report(), services=CORE)
    client = world.probe(str(OTHER))
    simulation.run(0.1)
    setting.say(5.0)
    client.tell(
        OWN,
        CreateEvent(
            request_id=1,
            event_type=CreateEvent.EventType.PERIODIC_SC,
            requested_periodic_rate=10.0,
            query_message=QueryTime(presence_vector=1).encode(),
        ),
    )
    client.take()
    simulation.run(4.0, ratio)
    events = client.take(Event)
    assert len(events) == pytest.approx(40 * ratio, abs=1)


def test_queries_are_sent_at_the_pace_of_the_simulation(world, setting, simulation):
    peer = world.probe(str(PEER))
    setting.open(query(rate=10.0))
    peer.take()
    simulation.run(4.0, 0.5)
    queries = peer.take(QueryEventTimeout)
    assert len(queries) == pytest.approx(20, abs=1)


@pytest.mark.parametrize("ratio", [0.5, 3.0])
def test_events_are_asked_for_at_the_rate_that_the_simulation_needs(
    world, setting, simulation, ratio
):
    peer_component(world)
    connection = setting.open(event(rate=10.0))
    simulation.run(3.0)
    before = connection.statistics.passed
    simulation.run(5.0, ratio)
    start = connection.statistics.passed
    simulation.run(10.0, ratio)
    passed = connection.statistics.passed - start
    assert passed == pytest.approx(100 * ratio, rel=0.15)
    assert before == pytest.approx(30, abs=4)
    assert connection.status().message != "slower than declared"
