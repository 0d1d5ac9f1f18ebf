"""Bridges that are inactive, and bridges that are opened again."""

import pytest

from jausml.runtime import Guard, Status
from jausml.runtime import messages as core
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.connections.shaping import Shape
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.bridge.ends.topics import Qos, Topic
from jausml.runtime.bridge.reports.states import StopReason

from .bridge_support import (
    CORE,
    OTHER,
    OWN,
    PEER,
    Number,
    command,
    event,
    message_connection,
    minutes,
    obeyed,
    peer_component,
    report,
    safe,
)


def test_a_command_stops_and_goes_on_with_the_next_message(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(safe_value=safe, is_command=True))
    peer.take()
    setting.say(5.0)
    setting.bridge.set_active(False)
    setting.say(6.0)
    assert peer.take() == [minutes(5), minutes(0)]
    assert connection.stopped is StopReason.INACTIVE
    assert setting.drops(connection) == {"inactive": 1}
    setting.bridge.set_active(True)
    assert peer.take() == []
    setting.say(7.0)
    assert peer.take() == [minutes(7)]
    assert setting.drops(connection) == {"inactive": 1}


def test_a_bridge_that_begins_inactive_begins_with_the_stop(world, setting):
    connection = message_connection(safe_value=lambda: Number(-1.0), is_command=True)
    bridge = setting.bridge = Bridge(BridgeSettings("bridge", OWN, services=CORE))
    bridge.connections = [connection]
    bridge.open(setting.ros, world, active=False)
    bridge.set_active(True)
    assert connection.stopped is StopReason.START
    greet = setting.ros.greeters["times"]
    greet()  # a subscriber that ROS finds later
    assert setting.ros.numbers("times") == [-1.0, -1.0]


@pytest.mark.parametrize("is_simulated", [False, True])
def test_subscribers_long_after_the_start_get_no_stop(world, setting, is_simulated):
    setting.ros.is_simulated = is_simulated
    connection = setting.open(message_connection(safe_value=lambda: Number(-1.0), is_command=True))
    assert setting.ros.numbers("times") == [-1.0]
    world.run(10.5)
    assert connection.stopped is StopReason.START
    setting.ros.greeters["times"]()
    assert setting.ros.numbers("times") == [-1.0]


def test_control_ends_and_is_not_to_be_had(world, setting):
    connection = setting.open(obeyed(is_command=True), services=CORE)
    operator = world.probe("5.1.1")
    operator.tell(OWN, core.RequestControl(authority_code=200), core.Resume(), minutes(2))
    operator.take()
    topic = setting.ros.numbers("times")
    assert topic == [-1.0, 2.0]
    setting.bridge.set_active(False)
    world.settle()
    (reject,) = operator.take(core.RejectControl)
    assert reject.response_code == core.RejectControl.ResponseCode.NOT_AVAILABLE
    operator.tell(OWN, core.RequestControl(authority_code=255), minutes(3))
    (answer,) = operator.take(core.ConfirmControl)
    assert answer.response_code == core.ConfirmControl.ResponseCode.NOT_AVAILABLE
    (status,) = operator.ask(core.QueryStatus(), OWN)
    assert status.status == core.ReportStatus.Status.STANDBY
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    setting.bridge.set_active(True)
    operator.tell(OWN, core.RequestControl(authority_code=200), core.Resume(), minutes(4))
    assert setting.ros.numbers("times")[-1] == 4.0
    assert connection.stopped is None


def test_what_stands_stands_for_the_latest_reason(world, setting):
    options = {"safe_value": safe, "is_command": True, "silence_timeout": 1.0}
    connection = setting.open(command(**options), services=CORE)
    setting.say(5.0, every=1.1)
    assert connection.stopped is StopReason.SILENCE
    world.probe("5.1.1").tell(OWN, core.SetEmergency(emergency_code=1))
    assert connection.stopped is StopReason.EMERGENCY


def test_an_emergency_is_one_while_inactive_too(world, setting):
    setting.open(command(safe_value=safe, is_command=True), services=CORE)
    setting.bridge.set_active(False)
    world.probe("5.1.1").tell(OWN, core.SetEmergency(emergency_code=1))
    assert setting.bridge.standing.halt is StopReason.EMERGENCY
    setting.bridge.set_active(True)
    peer = world.probe(str(PEER))
    setting.say(5.0)
    assert minutes(5) not in peer.take()


def test_a_parameter_lifts_the_emergency_of_somebody_who_is_gone(world, setting):
    setting.open(command(safe_value=safe, is_command=True), services=CORE)
    stranger = world.probe("66.1.1")
    stranger.tell(OWN, core.SetEmergency(emergency_code=1))
    (lift,) = [
        parameter for parameter in setting.ros.declared if parameter.name == "lift_emergency"
    ]
    for text, reason in (("66.1.1", "heard"), ("9.9.9", "no emergency"), ("operator", "operator")):
        with pytest.raises(ValueError, match=reason):
            lift.check(text)
    assert setting.bridge.standing.halt is StopReason.EMERGENCY
    world.run(10.1)
    lift.check("66.1.1")
    setting.ros.changed["lift_emergency"]("66.1.1")
    assert setting.bridge.component.status is Status.STANDBY
    assert setting.bridge.standing.halt is not StopReason.EMERGENCY


def test_a_bridge_that_begins_inactive_asks_for_control_when_it_is_active(world, setting):
    """It sends no release either, whose repetition would end what it has just been given."""
    peer = world.probe(str(PEER))
    bridge = setting.bridge = Bridge(BridgeSettings("bridge", OWN, services=CORE))
    bridge.connections = [command(is_command=True, control=Guard.READY)]
    bridge.open(setting.ros, world, active=False)
    assert not peer.take((core.RequestControl, core.ReleaseControl))
    bridge.set_active(True)
    (request,) = [message for message in peer.take() if not isinstance(message, core.QueryStatus)]
    assert isinstance(request, core.RequestControl)


def test_a_bridge_that_is_activated_in_emergency_asks_nobody_for_control(world, setting):
    setting.open(command(is_command=True, control=Guard.READY), services=CORE)
    peer = world.probe(str(PEER))
    setting.bridge.set_active(False)
    operator = world.probe("5.1.1")
    operator.tell(OWN, core.SetEmergency(emergency_code=1))
    peer.take()
    setting.bridge.set_active(True)
    world.run(1.0)
    assert not peer.take(core.RequestControl)
    operator.send(core.ClearEmergency(emergency_code=1), OWN)
    assert peer.take(core.RequestControl)


def test_reports_are_withdrawn(world, setting):
    setting.open(report(), services=CORE)
    probe = world.probe(str(OTHER))
    setting.say(3.0)
    assert len(probe.ask(core.QueryTime(presence_vector=1), OWN)) == 1
    setting.bridge.set_active(False)
    setting.say(4.0)
    assert probe.ask(core.QueryTime(presence_vector=1), OWN) == []
    setting.bridge.set_active(True)
    assert probe.ask(core.QueryTime(presence_vector=1), OWN) == []  # what was said meanwhile is old
    setting.say(5.0)
    (answer,) = probe.ask(core.QueryTime(presence_vector=1), OWN)
    assert answer.time_stamp.minutes == 5


def test_what_is_latched_passes_afterwards(world, setting):
    setting.open(
        report(topics=[Topic("numbers", Qos(durability="transient_local"))]), services=CORE
    )
    probe = world.probe(str(OTHER))
    setting.bridge.set_active(False)
    setting.say(3.0, 4.0)
    assert probe.ask(core.QueryTime(presence_vector=1), OWN) == []
    setting.bridge.set_active(True)
    (answer,) = probe.ask(core.QueryTime(presence_vector=1), OWN)
    assert answer.time_stamp.minutes == 4


@pytest.mark.parametrize(("rate", "passed"), [(None, 1), (10.0, 0)])
def test_a_change_passes_afterwards_and_a_periodic_report_is_old_then(world, setting, rate, passed):
    connection = setting.open(event(rate=rate))
    setting.bridge.set_active(False)
    for timeout in (6, 7):
        connection.take(core.ReportEventTimeout(timeout=timeout).encode(), PEER)
    assert connection.statistics.passed == 0
    setting.bridge.set_active(True)
    assert setting.ros.numbers("timeout") == [7.0] * passed
    world.run(1.0)
    assert connection.statistics.passed == passed
    setting.bridge.set_active(False)
    connection.take(core.ReportEventTimeout(timeout=8).encode(), PEER)
    setting.bridge.close()
    setting.ros.made.clear()
    setting.bridge.open(setting.ros, world)
    assert connection.statistics.passed == passed


def test_what_waits_for_its_time_does_not_pass_after_the_end(world, setting):
    peer_component(world)
    connection = setting.open(command(shape=Shape(max_rate=0.5), silence_timeout=1.0))
    for number in (1.0, 2.0):
        setting.ros.deliver["numbers"](Number(number))
    setting.bridge.close()
    world.run(5.0)
    assert world.count(core.SetTime.CODE) == 1
    assert (connection.statistics.passed, connection.statistics.thinned) == (1, 1)
    assert not connection.statistics.stops


def test_periodic_events_go_on(world, setting):
    peer_component(world)
    connection = setting.open(event(rate=10.0))
    setting.bridge.set_active(False)
    world.run(1.0)
    passed = connection.statistics.passed
    assert passed <= 1  # before
    setting.bridge.set_active(True)
    world.run(1.0)
    assert connection.statistics.passed >= passed + 9


def test_it_can_be_opened_again(world, setting):
    peer = peer_component(world)
    connections = (command(safe_value=safe, is_command=True), event(rate=10.0), report())
    setting.open(*connections, services=CORE)
    watched = world.probe("9.1.1")
    for number in (5.0, 6.0):
        world.run(1.0)
        setting.ros.deliver["numbers"](Number(number))
        world.run(1.0)
        assert connections[1].status().message == "running"
        assert connections[0].stopped is None
        assert len(watched.ask(core.QueryTime(presence_vector=1), OWN)) == 1
        setting.bridge.close()
        setting.bridge.close()
        world.settle()
        assert watched.ask(core.QueryTime(presence_vector=1), OWN) == []
        setting.ros.made.clear()
        setting.bridge.open(setting.ros, world)
    assert peer.running
    assert connections[0].statistics.passed == 2
