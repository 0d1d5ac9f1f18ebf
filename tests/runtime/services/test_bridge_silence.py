"""What connections of bridges do when their source is silent."""

import pytest

from jausml.runtime import Guard, Shape
from jausml.runtime.base.quirks import Quirk
from jausml.runtime.bridge.reports.states import StopReason
from jausml.runtime.messages import CreateEvent, Event, QueryTime, ReportTime, SetTime

from .bridge_support import CORE, OTHER, OWN, PEER, command, minutes, report, safe


def test_safe_value_once_then_recovery(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(silence_timeout=1.0, safe_value=safe))
    setting.say(*[5.0] * 30, every=0.1)
    assert peer.take() == [minutes(5)] * 30
    world.run(0.85)
    assert peer.take() == []  # the timeout counts from the last message
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    setting.say(6.0)
    assert not connection.is_silent
    assert peer.take() == [minutes(6)]
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    assert connection.statistics.safe_values == 2


def test_peer_that_was_away_gets_the_safe_value_when_it_is_ready(world, setting):
    received = []
    connection = setting.open(
        command(silence_timeout=1.0, safe_value=safe, control=Guard.READY, peers=[PEER, OTHER])
    )
    world.run(2.0)
    assert connection.statistics.safe_values == 0
    for address in (PEER, OTHER):
        tested = world.component(str(address), services=CORE)
        tested.handle(
            SetTime, lambda message, _, to=address: received.append((to, message)), when=Guard.READY
        )
        tested.start()
        world.run(10.0)
    # The peer that came first does not get it again when the other one comes.
    assert received == [(PEER, minutes(0)), (OTHER, minutes(0))]


def cut(world):
    """Loses all commands on their way to the peer from now on; returns what ends that."""
    before = world.lost
    world.lost = lambda _source, _destination, code: code == SetTime.CODE
    return lambda: setattr(world, "lost", before)


def sent_stops(world):
    return sum(code == SetTime.CODE for *_, code in world.log)


def test_a_stop_that_is_lost_is_sent_again_until_it_arrives(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    setting.say(5.0)
    assert peer.take() == [minutes(5)]
    restore = cut(world)
    world.run(5.0)
    restore()
    world.run(3.0)
    assert peer.take() == [minutes(0)]
    world.run(10.0)
    assert peer.take() == []


def test_a_stop_is_not_sent_after_what_the_source_says_next(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    setting.say(5.0)
    restore = cut(world)
    world.run(1.5)
    restore()
    setting.say(*[6.0] * 30, every=0.1)
    assert minutes(0) not in peer.take()


def test_a_stop_is_not_repeated_for_a_peer_that_acknowledges_nothing(world, setting):
    world.probe(str(PEER))
    world.quirks.learn(PEER, Quirk.NO_ACKNOWLEDGEMENTS, "tested")
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    cut(world)
    world.run(10.0)
    assert sent_stops(world) == 1


def test_a_stop_is_not_repeated_when_the_bridge_has_ended(world, setting):
    world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    cut(world)
    world.run(2.5)
    setting.bridge.close()
    before = sent_stops(world)
    world.run(10.0)
    assert sent_stops(world) == before


def test_a_stop_is_not_repeated_for_a_peer_that_obeys_no_more(world, setting):
    tested = world.component(str(PEER), services=CORE)
    tested.handle(SetTime, lambda *_: None, when=Guard.READY)
    tested.start()
    setting.open(command(silence_timeout=1.0, safe_value=safe, control=Guard.READY))
    world.run(0.5)
    setting.say(5.0)
    cut(world)
    world.run(2.0)
    assert sent_stops(world) > 3
    tested.stop()  # which takes control away
    world.run(1.0)
    gone = sent_stops(world)
    world.run(30.0)
    assert sent_stops(world) == gone


def test_silence_timeout_is_a_parameter(world, setting):
    peer = world.probe(str(PEER))
    setting.ros.parameters["drive.silence_timeout"] = 5.0
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(4.9)
    assert peer.take() == []
    world.run(0.2)
    assert peer.take() == [minutes(0)]


def test_failing_safe_value_is_counted(world, setting):
    def broken():
        raise ValueError("?")

    connection = setting.open(command(silence_timeout=1.0, safe_value=broken))
    world.run(2.0)
    assert setting.drops(connection) == {"translation_failed": 1}


def halt(world, seconds):
    """Lets time pass in which nothing runs, as in a process that was stopped."""
    world.time += seconds
    world.settle()


def reported(value):
    return ReportTime(time_stamp=ReportTime.TimeStamp(minutes=value))


def events(peer):
    return [message.report_message for message in peer.take() if isinstance(message, Event)]


@pytest.mark.parametrize("empty", [None, ReportTime])
def test_after_a_halt_no_old_report_is_sent_as_if_it_were_new(world, setting, empty):
    """Timers of events may run before that of the silence: they judge the age themselves."""
    peer = world.probe(str(PEER))
    connection = setting.open(report("heard", freshness=1.0, empty=empty), services=CORE)
    setting.say(7.0)
    query = QueryTime(presence_vector=1).encode()
    create = CreateEvent(event_type=0, requested_periodic_rate=20.0, query_message=query)
    peer.send(create, OWN)
    world.run(0.5)
    known = events(peer)
    assert len(known) > 5
    assert set(known) == {reported(7).encode()}
    halt(world, 5.0)
    world.run(0.5)
    assert set(events(peer)) == ({empty().encode()} if empty else set())
    assert connection.stopped is StopReason.SILENCE
    setting.say(8.0, every=0.2)
    assert events(peer)[-1] == reported(8).encode()


def test_after_a_halt_no_command_passes_that_waited_for_its_pace(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=2.0, safe_value=safe, shape=Shape(max_rate=1.0)))
    setting.say(5.0, 6.0)
    halt(world, 5.0)
    assert peer.take() == [minutes(5), minutes(0)]
