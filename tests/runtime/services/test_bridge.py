"""Bridges between components of a small world and a ROS side that keeps what it is given."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import pytest

from jausml.runtime import ComponentSettings, Guard, JausComponent, ServiceIdentity, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.errors import AbsentFieldError, OutOfRangeError
from jausml.runtime.bridge.limits import Clamp, DropField, DropMessage, Error
from jausml.runtime.bridge.settings import BridgeSettings
from jausml.runtime.bridge.to_jaus import TopicsToMessage, TopicsToReport
from jausml.runtime.bridge.to_ros import EventToTopics, MessageToTopics, QueryToTopics
from jausml.runtime.bridge.topics import Topic, TopicCounts
from jausml.runtime.conversions import ConversionError, Time
from jausml.runtime.messages import (
    Event,
    QueryEventTimeout,
    QueryTime,
    ReleaseControl,
    ReportEventTimeout,
    ReportTime,
    RequestControl,
    Reset,
    Resume,
    SetTime,
)
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import EncodeError

if TYPE_CHECKING:
    from collections.abc import Callable

PEER = JausAddress(1, 1, 1)
OTHER = JausAddress(1, 1, 2)
OWN = JausAddress(1, 1, 9)
CORE = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)


@dataclass
class Number:
    """A ROS message."""

    data: float = 0.0


@dataclass
class RosPublisher:
    """A publisher of the ROS side."""

    publish_message: Callable[[Number], None]
    matched: int = 1
    unmatched: int = 0

    @property
    def publish(self):
        return self.publish_message


class Codec:
    """Messages are objects here, and so are their serialized forms."""

    def decode(self, data):
        return data

    def encode(self, message):
        return message


class Ros:
    """The ROS side: what was made on it, in order, and what was published."""

    def __init__(self):
        self.made: list[tuple[str, str]] = []
        self.published: dict[str, list[Number]] = {}
        self.deliver = {}
        self.statuses = []
        self.parameters = {}
        self.changed = {}
        self.found_faults = {}
        self.fails = False

    def now(self):
        return Time(1_780_000_000, 0)

    def parameter(self, parameter, changed=None):
        assert parameter.description
        limits = parameter.limits
        assert limits is None or limits[0] <= parameter.default <= limits[1]
        self.changed[parameter.name] = changed
        return self.parameters.get(parameter.name, parameter.default)

    def faults(self, topic, *, publishes):
        return self.found_faults.get((topic.name, publishes), [])

    def publisher(self, message_type, topic, _greet=None):
        self.made.append(("publisher", topic.name))
        found = self.published.setdefault(topic.name, [])

        def publish(message):
            if self.fails:
                raise RuntimeError("the middleware refuses")
            assert isinstance(message, message_type)
            found.append(message)

        return RosPublisher(publish)

    def codec(self, message_type):
        del message_type
        return Codec()

    def attach(self, loop):
        self.loop = loop

    def subscribe(self, message_type, topic, take):
        del message_type
        self.made.append(("subscription", topic.name))

        def deliver(message):
            with self.loop.lock:
                take(message, 0)

        self.deliver[topic.name] = deliver
        return TopicCounts()

    def publish_diagnostics(self, statuses):
        self.statuses.append({status.name: status for status in statuses})

    def numbers(self, topic):
        return [message.data for message in self.published[topic]]


@dataclass
class Setting:
    """A bridge in a world, opened."""

    world: object
    ros: Ros = field(default_factory=Ros)
    bridge: Bridge | None = None

    def open(self, *connections, services=(), **settings):
        self.bridge = Bridge(
            BridgeSettings(
                "bridge",
                OWN,
                services=services,
                component=ComponentSettings(register_services=False, **settings),
            )
        )
        self.bridge.connections = list(connections)
        self.bridge.open(self.ros, self.world)
        self.world.settle()
        return connections[0]

    def drops(self, connection):
        return connection.statistics.drops


@pytest.fixture
def setting(world):
    made = Setting(world)
    yield made
    if made.bridge is not None:
        made.bridge.close()


def peer_component(world, address=PEER, **settings):
    component = world.component(str(address), services=CORE, **settings)
    component.start()
    return component


def minutes_to_number(report):
    return Number(float(report.timeout))


def number_to_time(source):
    return SetTime(time_stamp=SetTime.TimeStamp(minutes=int(source.data)))


def command(name="drive", **options):
    options.setdefault("translate", number_to_time)
    options.setdefault("peers", [PEER])
    return TopicsToMessage(
        name,
        options.pop("translate"),
        message=SetTime,
        type=Number,
        topics=[Topic("numbers")],
        **options,
    )


def event(name="timeout", **options):
    options.setdefault("translate", minutes_to_number)
    options.setdefault("topics", [Topic(name)])
    options.setdefault("peers", [PEER])
    return EventToTopics(
        name,
        options.pop("translate"),
        message=ReportEventTimeout,
        type=Number,
        query=QueryEventTimeout(),
        **options,
    )


# ------------------------------------------------------------------ JAUS to ROS


def test_event_reaches_every_topic(world, setting):
    peer_component(world, event_timeout=3)
    setting.open(event(rate=10.0, topics=[Topic("a"), Topic("b")]))
    world.run(1.0)
    assert len(setting.ros.numbers("a")) >= 9
    assert set(setting.ros.numbers("a")) == {3.0}
    assert setting.ros.numbers("a") == setting.ros.numbers("b")


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
    original = JausComponent.start

    def start(component):
        made_at_start.extend(setting.ros.made)
        original(component)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(JausComponent, "start", start)
        setting.open(event(rate=1.0, topics=[Topic("a")]), command())
    assert made_at_start == [("publisher", "a"), ("subscription", "numbers")]


def test_rate_is_a_parameter(world, setting):
    peer_component(world)
    setting.ros.parameters["timeout.rate"] = 2.0
    connection = setting.open(event(rate=10.0))
    world.run(2.0)
    assert connection.declared_rate == 2.0
    assert 3 <= len(setting.ros.numbers("timeout")) <= 6


def test_query_asks_once_each_period(world, setting):
    peer_component(world, event_timeout=4)
    setting.open(
        QueryToTopics(
            "timeout",
            minutes_to_number,
            message=ReportEventTimeout,
            type=Number,
            query=QueryEventTimeout(),
            rate=5.0,
            peers=[PEER],
            topics=[Topic("timeout")],
        )
    )
    world.run(2.0)
    assert 10 <= world.count(QueryEventTimeout.CODE) <= 11
    assert setting.ros.numbers("timeout") == [4.0] * len(setting.ros.numbers("timeout"))
    assert len(setting.ros.numbers("timeout")) >= 10


def test_query_of_an_absent_peer_goes_on(world, setting):
    connection = setting.open(
        QueryToTopics(
            "timeout",
            minutes_to_number,
            message=ReportEventTimeout,
            type=Number,
            query=QueryEventTimeout(),
            rate=5.0,
            peers=[PEER],
            topics=[Topic("timeout")],
        )
    )
    world.run(2.0)
    peer_component(world)
    world.run(1.0)
    assert connection.statistics.passed >= 4


def message_connection(
    translate=lambda message: Number(float(message.time_stamp.minutes)), **options
):
    options.setdefault("is_command", options.get("when", Guard.ANY) is not Guard.ANY)
    return MessageToTopics(
        "times",
        translate,
        message=SetTime,
        type=Number,
        topics=[Topic("times")],
        **options,
    )


def minutes(value):
    return SetTime(time_stamp=SetTime.TimeStamp(minutes=value))


def test_message_from_anybody(world, setting):
    setting.open(message_connection())
    world.probe("5.1.1").send(minutes(7), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [7.0]


def test_message_from_a_stranger_is_counted(world, setting):
    connection = setting.open(message_connection(peers=[PEER]))
    world.probe("5.1.1").send(minutes(7), OWN)
    world.probe(str(PEER)).send(minutes(8), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [8.0]
    assert setting.drops(connection) == {"unexpected_source": 1}


def test_command_needs_control_and_losing_it_is_safe_at_once(world, setting):
    connection = setting.open(
        message_connection(when=Guard.READY, silence_timeout=30.0, safe_value=lambda: Number(-1.0)),
        services=CORE,
    )
    operator = world.probe("5.1.1")
    operator.send(minutes(1), OWN)  # not obeyed: no control
    operator.send(RequestControl(authority_code=200), OWN)
    operator.send(Resume(), OWN)
    operator.send(minutes(2), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 2.0]
    operator.send(ReleaseControl(), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    assert connection.is_silent
    operator.send(RequestControl(authority_code=200), OWN)
    operator.send(Resume(), OWN)
    operator.send(minutes(3), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 3.0]
    assert not connection.is_silent
    world.run(60.0, step=0.5)
    assert setting.ros.numbers("times") == [
        -1.0,
        2.0,
        -1.0,
        3.0,
        -1.0,
    ]  # one silence, one safe value


def test_losing_control_is_safe_without_a_timeout_too(world, setting):
    connection = setting.open(
        message_connection(when=Guard.READY, safe_value=lambda: Number(-1.0)), services=CORE
    )
    operator = world.probe("5.1.1")
    for message in (RequestControl(authority_code=200), Resume(), minutes(2), ReleaseControl()):
        operator.send(message, OWN)
    world.run(60.0, step=0.5)
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    for message in (RequestControl(authority_code=200), Resume(), minutes(3)):
        operator.send(message, OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 3.0]
    assert not connection.is_silent


@pytest.mark.parametrize("guard", [Guard.READY, Guard.CONTROLLED, lambda _message: Guard.READY])
@pytest.mark.parametrize("timeout", [0.0, 30.0])
def test_take_over_in_ready_is_safe_at_once(world, setting, guard, timeout):
    """The bridge stays in Ready for another; the former controller's command must not stand."""
    connection = setting.open(
        message_connection(when=guard, silence_timeout=timeout, safe_value=lambda: Number(-1.0)),
        services=CORE,
        control_timeout=60,
    )
    former, rival = world.probe("5.1.1"), world.probe("6.1.1")
    for message in (RequestControl(authority_code=127), Resume(), minutes(2)):
        former.send(message, OWN)
    world.settle()
    rival.send(RequestControl(authority_code=200), OWN)
    world.settle()
    assert setting.bridge.component.status is Status.READY
    assert setting.bridge.component.controller == rival.address
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]
    former.send(minutes(3), OWN)
    rival.send(minutes(4), OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0, 4.0]
    assert not connection.is_silent


def test_lapse_of_control_in_ready_is_safe_once(world, setting):
    setting.open(
        message_connection(when=Guard.READY, safe_value=lambda: Number(-1.0)),
        services=CORE,
        control_timeout=2,
    )
    operator = world.probe("5.1.1")
    for message in (RequestControl(authority_code=127), Resume(), minutes(2)):
        operator.send(message, OWN)
    world.run(1.9)
    assert setting.ros.numbers("times") == [-1.0, 2.0]
    world.run(0.2)
    assert setting.ros.numbers("times") == [-1.0, 2.0, -1.0]


def test_guard_may_depend_on_the_message(world, setting):
    """A limit passes the guard in Standby, is no command, and does not end a silence."""

    def current(source):
        if source.time_stamp.minutes:
            raise ConversionError("a limit, not the current command")
        return Number(5.0)

    connection = setting.open(
        message_connection(
            translate=current,
            when=lambda message: Guard.CONTROLLED if message.time_stamp.minutes else Guard.READY,
            safe_value=lambda: Number(-1.0),
        ),
        services=CORE,
    )
    operator = world.probe("5.1.1")
    for message in (RequestControl(authority_code=200), minutes(0), minutes(7)):
        operator.send(message, OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0]
    assert setting.drops(connection) == {"no_counterpart": 1}
    assert setting.bridge.component.counters.drops()["component.command_refused"] == 1
    for message in (Resume(), minutes(0), ReleaseControl()):
        operator.send(message, OWN)
    world.settle()
    assert setting.ros.numbers("times") == [-1.0, 5.0, -1.0]
    operator.send(RequestControl(authority_code=200), OWN)
    operator.send(minutes(7), OWN)
    world.settle()
    assert connection.is_silent
    assert setting.ros.numbers("times") == [-1.0, 5.0, -1.0]


# ------------------------------------------------------------------ ROS to JAUS


def test_one_translation_serves_every_peer(world, setting):
    encoded = []

    class Counted(SetTime):
        def encode(self):
            encoded.append(self)
            return super().encode()

    def translate(source):
        return Counted(time_stamp=SetTime.TimeStamp(minutes=int(source.data)))

    peers = [world.probe(str(PEER)), world.probe(str(OTHER))]
    connection = setting.open(command(translate=translate, peers=[PEER, OTHER]))
    setting.ros.deliver["numbers"](Number(5.0))
    assert [peer.take() for peer in peers] == [[minutes(5)], [minutes(5)]]
    assert len(encoded) == 1
    assert setting.ros.made == [("subscription", "numbers")]
    assert connection.statistics.passed == 1


def test_priority_and_acknowledgement(world, setting):
    sent = []
    send = world.send

    def spy(source, destination, payload, **options):
        sent.append((int.from_bytes(payload[:2], "little"), options))
        send(source, destination, payload, **options)

    world.send = spy
    setting.open(command(priority=Priority.SAFETY_CRITICAL, acknowledge=True))
    setting.ros.deliver["numbers"](Number(5.0))
    options = dict(sent)[SetTime.CODE]
    assert options == {"priority": Priority.SAFETY_CRITICAL, "acknowledge": True}


def test_connections_of_one_topic_share_one_subscription(world, setting):
    peers = world.probe(str(PEER)), world.probe(str(OTHER))
    setting.open(command("a"), command("b", peers=[OTHER]))
    assert setting.ros.made == [("subscription", "numbers")]
    setting.ros.deliver["numbers"](Number(5.0))
    assert [len(peer.take()) for peer in peers] == [1, 1]


def test_command_waits_for_ready(world, setting):
    connection = setting.open(command(control=Guard.READY))
    setting.ros.deliver["numbers"](Number(1.0))
    assert setting.drops(connection) == {"not_ready": 1}
    received = []
    tested = world.component(str(PEER), services=CORE)
    tested.handle(SetTime, lambda message, _: received.append(message), when=Guard.READY)
    tested.start()
    world.run(10.0)
    setting.ros.deliver["numbers"](Number(2.0))
    world.settle()
    assert received == [minutes(2)]
    assert setting.drops(connection) == {"not_ready": 1}


def test_controlled_is_enough_where_nobody_can_resume(world, setting):
    services = tuple(s for s in CORE if "Management" not in s.urn)
    received = []
    tested = world.component(str(PEER), services=services)
    tested.handle(SetTime, lambda message, _: received.append(message), when=Guard.CONTROLLED)
    tested.start()
    setting.open(command(control=Guard.CONTROLLED))
    world.run(2.0)
    setting.ros.deliver["numbers"](Number(2.0))
    world.settle()
    assert received == [minutes(2)]
    assert world.count(Resume.CODE) == 0


def test_report_is_served_to_queries_and_events(world, setting):
    setting.open(
        TopicsToReport(
            "time",
            lambda source: ReportTime(time_stamp=ReportTime.TimeStamp(minutes=int(source.data))),
            message=ReportTime,
            type=Number,
            query=QueryTime,
            topics=[Topic("numbers")],
        ),
        services=CORE,
    )
    watched = []
    client = world.component("7.1.1", services=())
    client.start()
    client.subscribe(
        OWN, QueryTime(presence_vector=1), ReportTime, lambda report, _: watched.append(report)
    )
    probe = world.probe("8.1.1")
    assert probe.ask(QueryTime(presence_vector=1), OWN) == []  # nothing yet
    world.run(1.0)
    setting.ros.deliver["numbers"](Number(3.0))
    (report,) = probe.ask(QueryTime(presence_vector=1), OWN)
    assert report.time_stamp.minutes == 3
    setting.ros.deliver["numbers"](Number(4.0))
    world.run(1.0)
    assert [each.time_stamp.minutes for each in watched] == [3, 4]


def test_connections_may_feed_one_report(world, setting):
    def feed(name):
        return TopicsToReport(
            name,
            lambda source: ReportTime(time_stamp=ReportTime.TimeStamp(minutes=int(source.data))),
            message=ReportTime,
            type=Number,
            query=QueryTime,
            topics=[Topic(name)],
        )

    setting.open(feed("a"), feed("b"), services=CORE)
    probe = world.probe("8.1.1")
    for topic, value in (("a", 1.0), ("b", 2.0), ("a", 3.0)):
        setting.ros.deliver[topic](Number(value))
        (report,) = probe.ask(QueryTime(presence_vector=1), OWN)
        assert report.time_stamp.minutes == value


# ------------------------------------------------------------------ what is lost


def raising(error):
    def translate(_source):
        raise error

    return translate


@pytest.mark.parametrize(
    ("translate", "reason"),
    [
        (lambda _source: None, "filtered"),
        (raising(AbsentFieldError("X")), "absent_field"),
        (raising(ConversionError("no length")), "no_counterpart"),
        (raising(EncodeError("x", "too long")), "not_encodable"),
        (raising(ZeroDivisionError()), "translation_failed"),
        (lambda _source: minutes(77), "not_encodable"),
    ],
)
def test_every_drop_has_a_name(world, setting, translate, reason):
    connection = setting.open(command(translate=translate))
    setting.ros.deliver["numbers"](Number(1.0))
    assert setting.drops(connection) == {reason: 1}
    assert world.counters.snapshot()[f"bridge.drive.{reason}"] == 1
    assert connection.statistics.passed == 0
    assert world.count(SetTime.CODE) == 0


def test_middleware_that_refuses_does_not_end_the_loop(world, setting):
    peer_component(world)
    connection = setting.open(event(rate=10.0))
    setting.ros.fails = True
    world.run(0.5)
    setting.ros.fails = False
    world.run(0.5)
    assert setting.drops(connection)["translation_failed"] >= 4
    assert len(setting.ros.numbers("timeout")) >= 4


NAN, INFINITE = float("nan"), float("inf")
FITTING = [
    (lambda limit: limit("F", 2.0, -1.0, 2.0), 2.0),
    # A tyre angle of 0.5297 rad is full effort, but for the last bits of the factor.
    (lambda limit: limit("F", 0.5297 * 188.786105342647, -100.0, 100.0), 100.0),
    (lambda limit: limit("F", -1e-13, 0.0, 100.0), 0.0),
    (lambda limit: limit.integer("F", 2.6, 0, 3), 3),
    (lambda limit: limit.integer("F", 255.4, 0, 255), 255),
    (lambda limit: limit.integer("F", -1e-17, 0, 255), 0),
    (lambda limit: limit.integer("F", 2**64 - 1, 0, 2**64 - 1), 2**64 - 1),
    (lambda limit: limit.integer("F", -(2.0**63), -(2**63), 2**63 - 1), -(2**63)),
    (lambda limit: limit.listed("F", 4.2, ((0, 1), (4, 5))), 4),
    (lambda limit: limit.finite("F", 1e300), 1e300),
    (lambda limit: limit.single("F", 3e38), 3e38),
    (lambda limit: limit.text("F", "caf\xe9", 0, 4), "caf\xe9"),
    (lambda limit: limit.octets("F", b"abc", 3, 3), b"abc"),
]
# With the nearest legal value, None where nothing is nearest.
OUTSIDE = [
    (lambda limit: limit("F", 2.1, -1.0, 2.0), 2.0),
    (lambda limit: limit("F", 2.0000001, -1.0, 2.0), 2.0),
    (lambda limit: limit("F", 10**400, -1.0, 2.0), 2.0),
    (lambda limit: limit.integer("F", 255.5, 0, 255), 255),
    (lambda limit: limit.integer("F", 2.0**64, 0, 2**64 - 1), 2**64 - 1),
    (lambda limit: limit.integer("F", 10**400, 0, 255), 255),
    (lambda limit: limit.finite("F", -INFINITE), None),
    (lambda limit: limit("F", -INFINITE, -1.0, 2.0), -1.0),
    (lambda limit: limit("F", NAN, -1.0, 2.0), None),
    (lambda limit: limit.integer("F", INFINITE, 0, 255), 255),
    (lambda limit: limit.integer("F", -3.2, 0, 255), 0),
    (lambda limit: limit.integer("F", NAN, 0, 255), None),
    (lambda limit: limit.listed("F", 2, ((0, 1), (4, 5))), None),
    (lambda limit: limit.listed("F", NAN, ((0, 1),)), None),
    (lambda limit: limit.listed("F", INFINITE, ((0, 1),)), None),
    (lambda limit: limit.finite("F", NAN), None),
    (lambda limit: limit.finite("F", INFINITE), None),
    (lambda limit: limit.single("F", 1e39), 3.4028234663852886e38),
    (lambda limit: limit.single("F", NAN), None),
    (lambda limit: limit.single("F", INFINITE), None),
    (lambda limit: limit.single("F", -INFINITE), None),
    (lambda limit: limit.text("F", "abcde", 0, 4), None),
    (lambda limit: limit.text("F", "\u20ac", 0, 4), None),
    (lambda limit: limit.octets("F", b"ab", 3, 3), None),
]


@pytest.mark.parametrize("policy", [Clamp, DropField, DropMessage, Error])
@pytest.mark.parametrize(("use", "expected"), FITTING)
def test_what_fits_passes_every_policy(policy, use, expected):
    counted = []
    result = use(policy(lambda *what: counted.append(what)))
    assert (result, type(result)) == (expected, type(expected))
    assert counted == []


@pytest.mark.parametrize(("use", "nearest"), OUTSIDE)
def test_what_does_not_fit_is_never_a_wrong_number(use, nearest):
    counted = []

    def count(policy, field, reason):
        assert reason
        counted.append((policy, field))

    if nearest is None:
        with pytest.raises(OutOfRangeError, match="F: ") as caught:
            use(Clamp(count))
        assert (caught.value.policy, caught.value.field) == ("not_clampable", "F")
    else:
        assert use(Clamp(count)) == nearest
        assert counted.pop() == ("clamp", "F")
    assert use(DropField(count)) is None
    assert counted == [("drop_field", "F")]
    for policy, name in ((DropMessage, "drop_message"), (Error, "error")):
        with pytest.raises(OutOfRangeError) as caught:
            use(policy(count))
        assert (caught.value.policy, caught.value.field) == (name, "F")
    assert len(counted) == 1


def limited(policy):
    """A command whose minutes and seconds have a limit each; the seconds are always clamped."""

    def translate(source):
        stamp = ReportTime.TimeStamp(minutes=1, seconds=connection.clamp.integer("S", 70.0, 0, 59))
        authority = getattr(connection, policy).integer("M", source.data, 0, 59)
        return SetTime(time_stamp=stamp) if authority is not None else minutes(0)

    connection = command(translate=translate)
    return connection


@pytest.mark.parametrize(
    ("policy", "value", "passed", "counted", "level"),
    [
        ("clamp", 60.0, 1, "clamp", "warning"),
        ("clamp", NAN, 0, "not_clampable", "warning"),
        ("drop_field", 60.0, 1, "drop_field", "warning"),
        ("drop_field", NAN, 1, "drop_field", "warning"),
        ("drop_message", 60.0, 0, "drop_message", "warning"),
        ("error", 60.0, 0, "error", "error"),
    ],
)
def test_counters_name_field_and_policy(
    world, setting, caplog, policy, value, passed, counted, level
):
    connection = setting.open(limited(policy))
    setting.ros.deliver["numbers"](Number(1.0))
    connection.status()
    caplog.clear()
    setting.ros.deliver["numbers"](Number(value))
    counts = world.counters.snapshot()
    assert counts[f"bridge.drive.out_of_range.{counted}.M"] == 1
    assert counts["bridge.drive.out_of_range.clamp.S"] == 2
    assert connection.statistics.passed == 1 + passed
    assert world.count(SetTime.CODE) == 1 + passed
    assert setting.drops(connection) == ({} if passed else {"out_of_range": 1})
    world.run(0.1)
    status = connection.status()
    assert status.level == level
    assert (f"out of range: {counted} M", "1") in status.values
    records = [record for record in caplog.records if "out_of_range" in record.message]
    names = {"drop_field": [], "error": ["ERROR"]}.get(counted, ["WARNING"])
    assert [record.levelname for record in records] == names
    world.run(0.1)
    assert connection.status().level == "ok"  # a matter of the past


def test_errors_do_not_flood_the_log(world, setting, caplog):
    setting.open(limited("error"))
    for _ in range(100):
        setting.ros.deliver["numbers"](Number(60.0))
    assert len([record for record in caplog.records if record.levelname == "ERROR"]) == 1
    assert world.counters.snapshot()["bridge.drive.out_of_range.error.M"] == 100


def test_a_source_of_unusable_values_is_silent(world, setting):
    peer = world.probe(str(PEER))

    def translate(source):
        return minutes(connection.drop_message.integer("M", source.data, 0, 59))

    connection = setting.open(command(translate=translate, silence_timeout=1.0, safe_value=safe))
    for _ in range(30):
        setting.ros.deliver["numbers"](Number(NAN))
        world.run(0.1)
    assert peer.take() == [minutes(0)]
    assert connection.is_silent
    setting.ros.deliver["numbers"](Number(5.0))
    assert peer.take() == [minutes(5)]


# ------------------------------------------------------------------ silence


def safe():
    return minutes(0)


def test_safe_value_once_then_recovery(world, setting):
    peer = world.probe(str(PEER))
    connection = setting.open(command(silence_timeout=1.0, safe_value=safe))
    for _ in range(30):
        setting.ros.deliver["numbers"](Number(5.0))
        world.run(0.1)
    assert peer.take() == [minutes(5)] * 30
    world.run(0.85)
    assert peer.take() == []  # the timeout counts from the last message
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    setting.ros.deliver["numbers"](Number(6.0))
    assert not connection.is_silent
    assert peer.take() == [minutes(6)]
    world.run(5.0)
    assert peer.take() == [minutes(0)]
    assert connection.statistics.safe_values == 2


def test_source_that_never_spoke_is_silent(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(1.1)
    assert peer.take() == [minutes(0)]


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
            SetTime,
            lambda message, _, to=address: received.append((to, message)),
            when=Guard.READY,
        )
        tested.start()
        world.run(10.0)
    # The peer that came first does not get it again when the other one comes.
    assert received == [(PEER, minutes(0)), (OTHER, minutes(0))]


def test_silence_timeout_is_a_parameter(world, setting):
    peer = world.probe(str(PEER))
    setting.ros.parameters["drive.silence_timeout"] = 5.0
    setting.open(command(silence_timeout=1.0, safe_value=safe))
    world.run(4.9)
    assert peer.take() == []
    world.run(0.2)
    assert peer.take() == [minutes(0)]


def test_silence_without_safe_value_is_only_told(world, setting):
    connection = setting.open(event(rate=1.0, silence_timeout=1.0))
    world.run(2.0)
    assert connection.is_silent
    assert setting.ros.numbers("timeout") == []


def test_failing_safe_value_is_counted(world, setting):
    def broken():
        raise ValueError("?")

    connection = setting.open(command(silence_timeout=1.0, safe_value=broken))
    world.run(2.0)
    assert setting.drops(connection) == {"translation_failed": 1}


# ------------------------------------------------------------------ diagnostics


def values(status):
    return dict(status.values)


def test_diagnostics_judge_each_connection(world, setting):
    peer_component(world)
    setting.open(event(rate=10.0, silence_timeout=0.5), command(control=Guard.READY))
    world.run(0.05)
    world.run(3.0)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("ok", "running")
    assert float(values(status)["rate (Hz)"]) == pytest.approx(10.0, abs=1.5)
    assert values(status)["declared rate (Hz)"] == "10.00"
    assert values(status)["peer 1.1.1"] == "confirmed"
    assert float(values(status)["handling longest (us)"]) > 0
    drive = setting.ros.statuses[-1]["drive"]
    assert (drive.level, drive.message) == ("stale", "no message yet")
    assert values(drive)["peer 1.1.1"] == "ready"
    world.lost = lambda source, *_: source == PEER
    world.run(2.0)
    assert setting.ros.statuses[-1]["timeout"].message == "the source is silent"
    setting.ros.deliver["numbers"](Number(99.0))
    world.run(1.0)
    drive = setting.ros.statuses[-1]["drive"]
    assert (drive.level, drive.message) == ("warning", "messages are dropped")
    assert any(key.startswith("dropped: ") for key in values(drive))


def test_diagnostics_count_the_reasons_of_stops(world, setting):
    setting.open(
        message_connection(when=Guard.READY, safe_value=lambda: Number(-1.0)), services=CORE
    )
    operator = world.probe("5.1.1")
    for message in (ReleaseControl(), ReleaseControl(), Reset()):
        for command in (RequestControl(authority_code=200), Resume(), minutes(2), message):
            operator.send(command, OWN)
        world.run(1.1)
    told = values(setting.ros.statuses[-1]["times"])
    assert {key: value for key, value in told.items() if key.startswith("stopped: ")} == {
        "stopped: no message yet": "1",
        "stopped: control was released or lapsed": "2",
        "stopped: the bridge is reset": "1",
    }


def test_diagnostics_tell_what_becomes_of_a_command_without_its_source(world, setting):
    setting.open(
        command("drive", is_command=True, safe_value=safe),
        command("goal", is_command=True, hold_reason="a goal stands until the next one"),
        event(),
    )
    world.run(1.1)
    told = {
        name: values(status).get("when lost") for name, status in setting.ros.statuses[-1].items()
    }
    assert told == {
        "drive": "the stop is sent",
        "goal": "the last message stands (a goal stands until the next one)",
        "timeout": None,
    }


def test_slow_source_is_told(world, setting):
    peer_component(world, event_rate_max=2.0)
    setting.open(event(rate=10.0))
    world.run(4.0)
    assert setting.ros.statuses[-1]["timeout"].message == "slower than declared"


def test_diagnostics_keep_their_frequency(world, setting):
    setting.ros.parameters["diagnostics_frequency"] = 5.0
    setting.open(event(rate=1.0))
    world.run(2.0)
    assert 9 <= len(setting.ros.statuses) <= 11


@pytest.mark.parametrize(("frequency", "expected"), [(20.0, 4), (0.5, 2)])
def test_diagnostics_come_once_a_second_at_most(world, setting, frequency, expected):
    bridge = setting.bridge = Bridge(BridgeSettings("bridge", OWN, frequency=frequency))
    bridge.open(setting.ros, world)
    world.run(4.1)
    assert len(setting.ros.statuses) == expected


def test_clock_before_and_after_opening(setting):
    bridge = Bridge(BridgeSettings("bridge", OWN))
    assert bridge.now().sec > 1_700_000_000
    setting.open(command())
    assert setting.bridge.now() == setting.ros.now()
