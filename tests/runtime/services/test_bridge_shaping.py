"""Which messages of a connection pass: by number, pace and age."""

import itertools
import logging
import struct
import time
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.semantics.connections import limits
from jausml.runtime import Guard, Shape
from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.connections.shaping import Shaping, jaus_age, ros_age
from jausml.runtime.bridge.connections.to_reports import TopicsToReport
from jausml.runtime.bridge.ends import parameters
from jausml.runtime.bridge.ends.topics import Qos, Topic
from jausml.runtime.bridge.reports.diagnostics import Statistics
from jausml.runtime.conversions import Time, time_to_timestamp
from jausml.runtime.messages import QueryEventTimeout, ReportEventTimeout, SetTime

from .bridge_support import (
    OWN,
    PEER,
    Number,
    Ros,
    command,
    event,
    message_connection,
    minutes,
    peer_component,
    safe,
    stopping,
    values,
)


def sent(peer):
    return [message.time_stamp.minutes for message in peer.take()]


# ------------------------------------------------------------------ pace


def test_of_what_comes_too_fast_the_newest_passes_in_its_time(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(shape=Shape(max_rate=2.0)))
    setting.say(1, 2, 3)
    assert sent(peer) == [1]
    world.run(0.49)
    assert sent(peer) == []
    world.run(0.02)
    assert sent(peer) == [3]
    world.run(5.0)
    assert sent(peer) == []
    setting.say(4)
    assert sent(peer) == [4]
    counts = connection.statistics
    assert (counts.arrivals, counts.passed, counts.thinned, counts.drops) == (4, 3, 1, {})


def test_reports_and_topics_have_a_pace_too(world, setting):
    report = TopicsToReport(
        "heard",
        lambda source: ReportEventTimeout(timeout=int(source.data)),
        query=QueryEventTimeout,
        message=ReportEventTimeout,
        type=Number,
        topics=[Topic("numbers")],
        shape=Shape(max_rate=1.0),
    )
    times = message_connection(shape=Shape(max_rate=1.0))
    setting.open(report, times)
    probe = world.probe(str(PEER))
    setting.say(5, 6, 7)
    for value in (1, 2, 3):
        probe.send(minutes(value), OWN)
    world.settle()
    assert report.statistics.passed == 1
    assert setting.ros.numbers("times") == [1.0]
    world.run(1.01)
    assert report.statistics.passed == 2
    assert setting.ros.numbers("times") == [1.0, 3.0]
    assert report._report.value == ReportEventTimeout(timeout=7).encode()


def test_whoever_must_not_be_heard_takes_no_place(world, setting):
    setting.open(message_connection(shape=Shape(max_rate=1.0), peers=[PEER]))
    stranger, probe = world.probe("1.1.77"), world.probe(str(PEER))
    stranger.send(minutes(9), OWN)
    probe.tell(OWN, minutes(1))
    assert setting.ros.numbers("times") == [1.0]


# ------------------------------------------------------------------ number


def test_every_third_passes(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(shape=Shape(decimation=3)))
    setting.say(*range(8))
    assert sent(peer) == [0, 3, 6]
    assert connection.statistics.thinned == 5


# ------------------------------------------------------------------ age


def stamped(time):
    """A message that tells its time."""
    sent = time_to_timestamp(time)
    fields = (sent.milliseconds, sent.seconds, sent.minutes, sent.hour, sent.day)
    return SetTime(time_stamp=SetTime.TimeStamp(*fields))


def test_commands_that_are_late_do_not_pass_and_the_stop_stands(world, setting, caplog):
    peer = world.probe(str(PEER))
    connection = setting.open(stopping(shape=Shape(age_limit=0.5)))
    assert sent(peer) == [0]
    take = setting.ros.take["numbers"]
    late = time.time_ns() - 10 * 10**9
    with caplog.at_level(logging.WARNING):
        take(Number(5.0).to_cdr(), late)
        world.settle()
    assert connection.is_silent
    assert connection.statistics.drops == {"too_old": 1}
    assert "too_old" in caplog.text
    take(Number(6.0).to_cdr(), time.time_ns())
    world.run(0.9)
    take(Number(7.0).to_cdr(), late)
    world.run(0.2)
    assert sent(peer) == [6, 0]
    assert connection.is_silent


def test_age_by_a_stamp_goes_before_that_of_the_publication():
    class Stamped(Number):
        LAYOUT: ClassVar = {"header": "std_msgs/Header", "data": "double"}

    ros = Ros()
    ros.now = lambda: Time(100, 500_000_000)
    age = ros_age(Stamped, ros, time.time_ns)
    little = b"\0\1\0\0" + struct.pack("<iI", 98, 0)
    big = b"\0\0\0\0" + struct.pack(">iI", 101, 0)
    unfilled = b"\0\1\0\0" + bytes(8)
    assert age(little, 1) == 2.5
    assert age(big, 1) == -0.5
    assert age(unfilled, time.time_ns() - 60 * 10**9) == pytest.approx(60, abs=30)
    assert age(unfilled, 0) is age(b"\0\1", 0) is None
    assert ros_age(Number, ros, time.time_ns)(little, 0) is None


def test_age_of_jaus_messages():
    ros = Ros()
    age = jaus_age(SetTime, ros.now)
    now = ros.now()
    assert age(stamped(Time(now.sec - 3, 500_000_000)).encode(), PEER) == 2.5
    assert age(SetTime().encode(), PEER) is None
    assert age(b"", PEER) is None
    assert (
        jaus_age(ReportEventTimeout, ros.now)(ReportEventTimeout(timeout=1).encode(), PEER) is None
    )


def test_what_waits_longer_than_it_may_is_too_old(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(shape=Shape(max_rate=1.0, age_limit=0.5)))
    setting.say(1, 2)
    world.run(2.0)
    assert sent(peer) == [1]
    assert connection.statistics.drops == {"too_old": 1}


# ------------------------------------------------------------------ stops


def test_a_stop_neither_waits_nor_is_followed_by_what_waited(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(stopping(shape=Shape(max_rate=0.2)))
    setting.say(5, 6)
    world.run(10.0)
    assert sent(peer) == [0, 5, 0]
    assert connection.statistics.thinned == 1


def test_the_first_message_after_a_stop_passes(world, setting):
    peer = world.probe(str(PEER))
    setting.open(stopping(shape=Shape(decimation=3)))
    setting.say(5, 6)
    world.run(2.0)
    setting.say(7)
    assert sent(peer) == [0, 5, 0, 7]


def test_a_source_that_is_thinned_is_not_silent(world, setting):
    peer = world.probe(str(PEER))
    setting.open(stopping(shape=Shape(max_rate=0.2)))
    setting.say(*[5] * 60, every=0.1)
    assert sent(peer) == [0, 5, 5]


def test_a_source_that_says_nothing_usable_is_silent_for_all_its_messages(world, setting):
    peer = world.probe(str(PEER))
    setting.open(
        stopping(translate=lambda source: minutes(int(1 / source.data)), shape=Shape(decimation=3))
    )
    setting.say(1)
    setting.say(*[0] * 20, every=0.1)
    assert sent(peer) == [0, 1, 0]


def test_nothing_that_waited_passes_after_the_end(world, setting):
    peer = world.probe(str(PEER))
    setting.open(
        command(shape=Shape(max_rate=1.0), safe_value=safe, is_command=True, control=Guard.ANY)
    )
    setting.say(5, 6)
    setting.bridge.close()
    world.run(3.0)
    assert sent(peer) == [0, 5, 0]


def test_the_state_of_a_latched_topic_waits_while_the_bridge_is_inactive(world, setting):
    peer = world.probe(str(PEER))
    connection = command(shape=Shape(max_rate=1.0))
    connection._topics = (Topic("numbers", Qos(durability="transient_local")),)
    setting.open(connection)
    setting.say(5, 6)
    setting.bridge.set_active(False)
    world.run(3.0)
    assert sent(peer) == [5]
    setting.bridge.set_active(True)
    assert sent(peer) == [6]


# ------------------------------------------------------------------ parameters


def test_nothing_stands_before_a_connection_that_shapes_nothing(setting):
    connection = setting.open(command())
    assert connection.is_direct
    setting.ros.changed["drive.max_rate"](2.0)
    assert not connection.is_direct
    setting.ros.changed["drive.max_rate"](0.0)
    assert connection.is_direct


def test_parameters_shape_while_the_bridge_runs(world, setting):
    peer = world.probe(str(PEER))
    setting.ros.parameters["drive.decimation"] = 2
    setting.open(command())
    setting.say(1, 2, 3)
    assert sent(peer) == [1, 3]
    changed = setting.ros.changed
    changed["drive.decimation"](1)
    changed["drive.max_rate"](0.1)
    setting.say(4, 5)
    assert sent(peer) == []
    changed["drive.max_rate"](1.0)
    world.run(1.01)
    assert sent(peer) == [5]
    setting.say(6)
    world.run(0.5)
    setting.say(7)
    assert sent(peer) == []
    changed["drive.max_rate"](0.0)
    assert sent(peer) == [7]  # at once, before what comes now
    setting.say(8)
    assert sent(peer) == [8]
    changed["drive.age_limit"](1.0)
    setting.ros.take["numbers"](Number(9.0).to_cdr(), time.time_ns() - 60 * 10**9)
    assert sent(peer) == []


def test_a_pace_that_is_none_is_refused():
    check = parameters.MAX_RATE.check
    check(0.0)
    check(0.001)
    with pytest.raises(ValueError, match=r"0\.0001 Hz is neither 0 nor 0\.001 Hz or more"):
        check(0.0001)


def test_limits_are_those_of_the_rules():
    assert parameters.RATE.limits == (limits.LEAST_RATE, limits.MAXIMUM_RATE)
    assert parameters.FRESHNESS.limits == (limits.SHORTEST_TIME, limits.LONGEST_FRESHNESS)
    assert parameters.TIMEOUT.limits == (limits.SHORTEST_TIME, limits.LONGEST_TIME)
    assert parameters.DECIMATION.limits == (1, limits.GREATEST_DECIMATION)
    assert parameters.LEAST_MAX_RATE == limits.LEAST_PACE
    assert parameters.GREATEST_SPEED == limits.GREATEST_SPEED
    for parameter in (parameters.SILENCE_TIMEOUT, parameters.AGE_LIMIT):
        assert parameter.limits == (0.0, limits.LONGEST_TIME)
    for parameter in (parameters.MAX_RATE, parameters.RATE_CAP):
        with pytest.raises(ValueError, match="neither 0 nor"):
            parameter.of(limits.LEAST_PACE / 2, "x").converted(limits.LEAST_PACE / 2)


def test_latency_is_measured_behind_the_shaping(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(shape=Shape(max_rate=1.0)))
    setting.ros.changed["drive.latency"](True)
    setting.say(1, 2)
    world.run(1.01)
    assert sent(peer) == [1, 2]
    assert dict(connection._latency.describe())["in the bridge p50 (us)"]


def test_the_pace_is_that_of_a_simulation(world, setting):
    setting.ros.is_simulated = True
    peer = world.probe(str(PEER))
    setting.open(command(shape=Shape(max_rate=1.0)))
    setting.ros.say_time(50.0)
    setting.say(1, 2)
    world.run(2.9)
    assert sent(peer) == [1]
    setting.ros.say_time(50.9)
    assert sent(peer) == []
    setting.ros.say_time(51.0)
    assert sent(peer) == [2]


def test_age_is_that_of_a_simulation(world, setting):
    """A pause of the simulation makes nothing old, and what it passes over at once does."""
    ros, start = setting.ros, setting.ros.now().sec
    ros.is_simulated, clock = True, [50.0]
    ros.now = lambda: Time(start + int(clock[0]), 0)
    connection = setting.open(message_connection(shape=Shape(age_limit=1.5)))
    ros.say_time(clock[0])
    sender = world.probe(str(PEER))
    message = stamped(ros.now())
    sender.send(message, OWN)
    world.run(5.0, step=0.1)
    sender.tell(OWN, message)
    assert connection.statistics.passed == 2
    clock[0] += 2.0
    ros.say_time(clock[0])
    sender.tell(OWN, message)
    assert connection.statistics.passed == 2
    assert connection.statistics.drops == {"too_old": 1}


# ------------------------------------------------------------------ what is told


def test_what_is_thinned_is_told_and_no_loss(world, setting, caplog):
    peer_component(world)
    setting.open(event(rate=20.0, shape=Shape(max_rate=2.0)))
    with caplog.at_level(logging.WARNING):
        world.run(4.5)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("ok", "running")
    assert int(values(status)["thinned"]) > 50
    assert float(values(status)["rate (Hz)"]) == pytest.approx(20, abs=3)
    assert 7 <= len(setting.ros.numbers("timeout")) <= 10
    assert "thinned" not in caplog.text
    setting.bridge.close()
    assert world.counters.snapshot()["bridge.timeout.thinned"] > 50


# ------------------------------------------------------------------ properties


class Clock:
    """Time that a test turns; nothing else happens in this loop."""

    def __init__(self):
        self.time = 0.0
        self.loop = Loop(clock=lambda: self.time)


@given(
    st.lists(st.floats(0.0, 2.0), max_size=40),
    st.sampled_from([0.0, 0.5, 1.0, 3.0]),
    st.integers(1, 4),
)
def test_pace_order_and_last_word(gaps, max_rate, decimation):
    clock, counts, passed = Clock(), Statistics(), []

    class OneBridge(Bridge):
        loop = clock.loop

        def __init__(self):
            self.ros, self.clock = Ros(), clock.loop

    def way(data, _origin):
        passed.append((clock.time, int(data)))
        counts.arrivals += 1
        counts.heard = clock.time

    shaping = Shaping(Shape(max_rate, decimation), counts, lambda *_: None)
    shaping.open("any", OneBridge(), lambda *_: None, way, lambda: None, lambda: None)
    take = way if shaping.is_plain else shaping.take
    with clock.loop:
        for number, gap in enumerate(gaps):
            target = clock.time + gap
            while clock.time < target:
                clock.time = min(clock.time + 0.01, target)
                clock.loop.run_once(0)
            take(b"%d" % number, None)
        for _ in range(300):
            clock.time += 0.01
            clock.loop.run_once(0)
    numbers = [number for _, number in passed]
    assert numbers == sorted(set(numbers))
    assert {number % decimation for number in numbers} <= {0}
    assert counts.arrivals == len(gaps)
    assert counts.thinned == len(gaps) - len(passed)
    if gaps:
        assert numbers[-1] == (len(gaps) - 1) // decimation * decimation
    times = [moment for moment, _ in passed]
    if max_rate:
        assert all(b - a >= 1 / max_rate - 1e-9 for a, b in itertools.pairwise(times))
