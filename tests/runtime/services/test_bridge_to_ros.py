"""Connections of bridges that carry JAUS messages to ROS topics."""

import pytest

from jausml.runtime import Component, Guard, Status
from jausml.runtime.bridge.connections.events_to_ros import EventToTopics
from jausml.runtime.bridge.connections.to_ros import MessageToTopics
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.conversions import ConversionError
from jausml.runtime.messages import (
    Event,
    QueryTime,
    ReleaseControl,
    ReportTime,
    RequestControl,
    Resume,
)

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
    query,
)


def test_connections_of_one_report_share_one_event(world, setting):
    peer_component(world)
    setting.open(event("a", rate=10.0), event("b", rate=10.0))
    world.run(1.0)
    events = world.count(Event.CODE)
    assert 9 <= events <= 12
    assert len(setting.ros.numbers("a")) == len(setting.ros.numbers("b")) >= 9


def test_everything_is_made_before_the_first_message(setting):
    """Whatever the component sends or hears comes after publishers and subscriptions."""
    made_at_start = []
    original = Component.start

    def start(component):
        made_at_start.extend(setting.ros.made)
        original(component)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Component, "start", start)
        setting.open(event(rate=1.0, topics=[Topic("a")]), command())
    assert made_at_start == [("publisher", "a"), ("subscription", "numbers")]


def test_query_of_an_absent_peer_goes_on(world, setting):
    connection = setting.open(query(rate=5.0))
    world.run(2.0)
    peer_component(world)
    world.run(1.0)
    assert connection.statistics.passed >= 4


@pytest.mark.parametrize("when", [Guard.ANY, Guard.READY])
def test_connections_of_one_message_take_those_of_their_peers_alone(world, setting, when):
    """Two sensors of one kind: neither is a stranger, and somebody else is one, once."""
    first = message_connection(peers=[PEER], when=when, is_command=False)
    second = message_connection(peers=[OTHER], when=when, is_command=False)
    setting.open(first, second, services=CORE)
    sensors = [world.probe(str(address)) for address in (PEER, OTHER)]
    for number, sensor in enumerate((*sensors, world.probe("5.1.1"))):
        sensor.send(RequestControl(authority_code=100 + number), OWN)
        sensor.send(Resume(), OWN)
        sensor.send(minutes(number), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [0.0, 1.0]
    assert [connection.statistics.passed for connection in (first, second)] == [1, 1]
    assert setting.drops(first) == {"unexpected_source": 1}
    assert setting.drops(second) == {}


@pytest.mark.parametrize("is_command", [True, False])
def test_commands_of_anybody_are_passed_on_in_their_order(world, setting, is_command):
    setting.open(message_connection(is_command=is_command))
    sender = world.probe("5.1.1")
    for number in (10, 12, 11, 13):
        world.arrival.number = number
        sender.tell(OWN, minutes(number))
    expected = [10.0, 12.0, 13.0] if is_command else [10.0, 12.0, 11.0, 13.0]
    assert setting.ros.numbers("times") == expected
    assert world.counters.drops().get("component.out_of_order", 0) == is_command


def test_command_needs_control_and_losing_it_is_safe_at_once(world, setting):
    connection = setting.open(obeyed(silence_timeout=30.0), services=CORE)
    operator = world.probe("5.1.1")
    operator.send(minutes(1), OWN)  # not obeyed: no control
    operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(2))
    assert setting.ros.numbers("times") == [-1.0, 2.0]
    operator.tell(OWN, ReleaseControl())
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    assert connection.is_silent
    operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(3))
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 3.0]
    assert not connection.is_silent
    world.run(60.0, step=0.5)
    # One silence, one safe value.
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 3.0, -1.0]


@pytest.mark.parametrize("guard", [Guard.READY, Guard.CONTROLLED, lambda _message: Guard.READY])
@pytest.mark.parametrize("timeout", [0.0, 30.0])
def test_take_over_in_ready_is_safe_at_once(world, setting, guard, timeout):
    """The bridge stays in Ready for another; the former controller's command must not stand."""
    connection = setting.open(
        obeyed(when=guard, silence_timeout=timeout), services=CORE, control_timeout=60
    )
    former, rival = world.probe("5.1.1"), world.probe("6.1.1")
    former.tell(OWN, RequestControl(authority_code=127), Resume(), minutes(2))
    rival.tell(OWN, RequestControl(authority_code=200))
    assert setting.bridge.component.status is Status.READY
    assert setting.bridge.component.controller == rival.address
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    former.send(minutes(3), OWN)
    rival.tell(OWN, minutes(4))
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 4.0]
    assert not connection.is_silent


def test_guard_may_depend_on_the_message(world, setting):
    """A limit passes the guard in Standby, is no command, and does not end a silence."""

    def current(source):
        if source.time_stamp.minutes:
            raise ConversionError("a limit, not the current command")
        return Number(5.0)

    connection = setting.open(
        obeyed(
            translate=current,
            when=lambda message: Guard.CONTROLLED if message.time_stamp.minutes else Guard.READY,
        ),
        services=CORE,
    )
    operator = world.probe("5.1.1")
    operator.tell(OWN, RequestControl(authority_code=200), minutes(0), minutes(7))
    assert setting.ros.numbers("times") == [-1.0]
    assert setting.drops(connection) == {"no_counterpart": 1}
    assert setting.bridge.component.counters.drops()["component.command_refused"] == 1
    operator.tell(OWN, Resume(), minutes(0), ReleaseControl())
    assert setting.ros.numbers("times") == [-1.0, 5.0, -1.0]
    operator.tell(OWN, RequestControl(authority_code=200), minutes(7))
    assert connection.is_silent
    assert setting.ros.numbers("times") == [-1.0, 5.0, -1.0]


def reported(value):
    return ReportTime(time_stamp=ReportTime.TimeStamp(minutes=value))


def reported_number(report):
    return Number(float(report.time_stamp.minutes))


def asking_for_time():
    return EventToTopics(
        "time",
        reported_number,
        message=ReportTime,
        type=Number,
        query=QueryTime(presence_vector=1),
        topics=[Topic("time")],
        peers=[PEER],
        rate=1.0,
    )


def test_reports_that_a_peer_sends_unasked_are_named(world, setting):
    peer = world.probe(str(PEER), strict=False)
    connection = setting.open(asking_for_time())
    peer.send(reported(5), OWN)
    world.probe(str(OTHER), strict=False).tell(OWN, reported(6))
    assert setting.ros.numbers("time") == []
    assert setting.drops(connection) == {"unasked": 1}
    # What others send is unknown, as before.
    assert world.counters.snapshot()["component.unknown_message"] == 1
    status = connection.status()
    assert status.level == "warning"
    assert status.message == (
        f"{PEER} sends ReportTime unasked, and time asks for events;"
        " exchange: message takes what comes unasked"
    )


def test_a_report_that_another_connection_takes_is_not_called_unasked(world, setting):
    peer = world.probe(str(PEER), strict=False)
    asking = asking_for_time()
    taking = MessageToTopics(
        "taking", reported_number, message=ReportTime, type=Number, topics=[Topic("taken")]
    )
    setting.open(asking, taking)
    peer.tell(OWN, reported(5))
    assert setting.ros.numbers("taken") == [5.0]
    assert setting.drops(asking) == {}


def test_what_becomes_of_each_message_is_told_and_adds_up(world, setting, caplog):
    """Each way on which a command can end: none is passed over, in the last line too."""
    caplog.set_level("INFO")
    connection = setting.open(obeyed(rate_cap=5.0, peers=[PEER, OTHER]), services=CORE)
    robber, pilot, stranger = (world.probe(address) for address in (str(OTHER), str(PEER), "5.1.1"))
    pilot.send(RequestControl(authority_code=100), OWN)
    pilot.send(Resume(), OWN)
    for number in range(20):
        pilot.send(minutes(number), OWN)  # most of them too many for a moment
    robber.send(minutes(50), OWN)
    stranger.send(minutes(51), OWN)
    pilot.send_bytes(minutes(1).encode()[:3], OWN)
    world.settle()
    told = dict(connection.close_account())
    dropped = {name: n for name, n in told.items() if name.startswith("dropped: ")}
    assert "dropped: over_rate" in dropped
    assert told["messages taken"] == told["messages passed"] + sum(dropped.values()) == 21
    assert told["not taken: refused"] == 1  # of the stranger the connection knows nothing
    setting.bridge.close()
    lines = [
        message
        for message in caplog.messages
        if message.startswith(f"account of {connection.name}: ")
    ]
    assert len(lines) == 1
    assert "messages taken 21; messages passed" in lines[0]
    assert "not taken: refused 1" in lines[0]
