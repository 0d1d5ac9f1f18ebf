"""Control and events over real sockets whose datagrams get lost, on a clock that the test turns."""

from itertools import pairwise

import pytest
from lossy_network import OPERATOR, STEP, VEHICLE, LossyNetwork
from sweeps import sweep

from jausml.runtime import ControlState, Status
from jausml.runtime.messages import QueryStatus, ReportStatus, SetTime

pytestmark = pytest.mark.ports

COMMAND = SetTime(time_stamp=SetTime.TimeStamp(minutes=7))
STEPS_EACH = 4  # a command every 20 ms


def drive(network, seconds):
    """Sends 50 commands a second while the session is ready; returns how many there were."""
    session = network.operator.control(VEHICLE, authority=127)
    count = 0
    for number in range(round(seconds / STEP)):
        network.run(STEP)
        if number % STEPS_EACH == 0 and session.state is ControlState.READY:
            network.operator.send(COMMAND, VEHICLE)
            count += 1
    network.settle()
    return count


def wait_for_ready(network, session, seconds):
    start = network.time
    while session.state is not ControlState.READY:
        assert network.time < start + seconds
        network.run(STEP)
    return network.time - start


@pytest.mark.parametrize("share", [0.05, 0.2, 0.3, 0.4])
@pytest.mark.parametrize("seed", sweep(range(4), every=4))
def test_loss_costs_little_more_than_what_is_lost(share, seed):
    with LossyNetwork(share, 100 * seed, control_timeout=2) as network:
        drive(network, 20.0)
        left = 20.0 / (STEP * STEPS_EACH) * (1.0 - share)
        assert len(network.obeyed) >= 0.9 * left
        times = [1000.0, *network.obeyed, network.time]
        assert max(b - a for a, b in pairwise(times)) < 2.0


@pytest.mark.parametrize("seed", sweep(range(5), every=5))
def test_a_fifth_of_all_datagrams_lost_costs_no_control(seed):
    with LossyNetwork(0.2, 100 * seed, control_timeout=2) as network:
        sent = drive(network, 20.0)
        assert network.longest_gap() < 1.0
        assert "access_control.timed_out" not in network.loop.counters.snapshot()
        # Of a thousand commands two hundred are lost on their way, and few are not sent.
        assert sent > 900
        assert len(network.obeyed) > 700
        gaps = [b - a for a, b in zip(network.obeyed, network.obeyed[1:], strict=False)]
        assert max(gaps) < 1.0


@pytest.mark.parametrize("acknowledge", [False, True])
def test_a_late_command_is_not_obeyed_after_a_newer_one(acknowledge):
    with LossyNetwork(0.0, 1) as network:
        session = network.operator.control(VEHICLE, authority=127)
        wait_for_ready(network, session, 1.0)
        network.delay(0.3)
        for number in range(200):
            stamp = SetTime.TimeStamp(minutes=number % 60, seconds=number // 60)
            network.operator.send(SetTime(time_stamp=stamp), VEHICLE, acknowledge=acknowledge)
            network.run(STEP)
            if number % 10 == 0:  # what else listens changes nothing
                network.vehicle.on_message(SetTime, lambda *_: None)
        network.delay(0.0)
        network.run(1.0)
        order = [60 * time.seconds + time.minutes for time in network.times]
        late = network.loop.counters.snapshot().get("component.out_of_order", 0)
        assert order == sorted(order)
        assert late > 20
        assert len(order) + late >= 199


@pytest.mark.parametrize("seed", sweep(range(3), every=3))
def test_two_fifths_lost_are_survived(seed):
    with LossyNetwork(0.4, 100 * seed, control_timeout=2) as network:
        sent = drive(network, 20.0)
        assert network.longest_gap() < 4.0
        assert sent > 700
        assert len(network.obeyed) > 400
        network.lose(0.0)
        network.run(1.5)
        assert network.vehicle.controller == OPERATOR
        assert network.vehicle.status is Status.READY


def test_a_lost_release_does_not_end_the_control_that_follows():
    """It is repeated until it is acknowledged, and the repetition must not come after a request."""
    with LossyNetwork(0.0, 1) as network:
        session = network.operator.control(VEHICLE, authority=127)
        wait_for_ready(network, session, 1.0)
        network.lose(1.0)
        session.release()
        network.run(0.05)
        network.lose(0.0)
        states = []
        network.operator.control(VEHICLE, authority=127, on_change=states.append)
        network.run(2.0)
        assert states == [ControlState.CONTROLLED, ControlState.READY]
        assert network.vehicle.controller == OPERATOR


def test_new_clients_are_ready_within_a_second():
    times = []
    for seed in range(12):
        with LossyNetwork(0.2, 1000 + seed, control_timeout=2) as network:
            session = network.operator.control(VEHICLE, authority=127)
            times.append(wait_for_ready(network, session, 10.0))
    assert max(times) < 1.0
    assert sorted(times)[6] < 0.3


def test_a_link_that_was_cut_is_taken_up_again_soon():
    with LossyNetwork(0.0, 1, control_timeout=2) as network:
        session = network.operator.control(VEHICLE, authority=127)
        wait_for_ready(network, session, 1.0)
        network.lose(1.0)
        network.run(3.0)
        assert session.state is ControlState.SEEKING
        assert network.vehicle.controller is None
        network.run(30.0)
        network.lose(0.2)
        assert wait_for_ready(network, session, 7.0) < 6.0


def test_a_silent_vehicle_is_not_flooded():
    with LossyNetwork(0.0, 1) as network:
        network.vehicle.stop()
        network.operator.control(VEHICLE, authority=127)
        network.operator.subscribe(VEHICLE, QueryStatus(), ReportStatus, lambda *_: None, rate=1.0)
        network.run(20.0)
        before = network.loop.counters.snapshot()["judp.sent"]
        network.run(60.0)
        # Each 5 s a CreateEvent and a RequestControl, that with three repetitions.
        assert network.loop.counters.snapshot()["judp.sent"] - before < 120


@pytest.mark.parametrize("seed", sweep(range(4), every=4))
def test_events_are_created_again_while_their_provider_is_heard(seed):
    """A provider that was restarted is heard by one event; the other one must not wait for long."""
    with LossyNetwork(0.2, 300 + seed) as network:
        reports = []
        operator = network.operator
        operator.subscribe(
            VEHICLE, QueryStatus(), ReportStatus, lambda *_: reports.append(network.time), rate=10.0
        )
        network.run(3.0)
        assert len(reports) > 10
        network.restart_vehicle()
        start = network.time
        network.run(6.0)
        after = [report for report in reports if report > start]
        assert after[0] < start + 3.0
        assert len(after) > 15
