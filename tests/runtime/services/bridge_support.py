"""A bridge in a small world, with a ROS side that keeps what it is given."""

import struct
from dataclasses import dataclass, field
from typing import ClassVar

from jausml.runtime import ComponentSettings, Guard
from jausml.runtime.base.address import JausAddress
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.connections.events_to_ros import EventToTopics
from jausml.runtime.bridge.connections.queries_to_ros import QueryToTopics
from jausml.runtime.bridge.connections.to_jaus import TopicsToMessage
from jausml.runtime.bridge.connections.to_reports import TopicsToReport
from jausml.runtime.bridge.connections.to_ros import MessageToTopics
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.bridge.ends.topics import Topic, TopicCounts
from jausml.runtime.bridge.light_message import LightMessage
from jausml.runtime.bridge.reports.diagnostics import ConnectionStatus
from jausml.runtime.conversions import Time
from jausml.runtime.messages import (
    QueryEventTimeout,
    QueryTime,
    ReportEventTimeout,
    ReportTime,
    SetTime,
)
from jausml.runtime.wire.message import DecodeError

from .state_tables import V1_1, core_services

PEER = JausAddress(1, 1, 1)
OTHER = JausAddress(1, 1, 2)
OWN = JausAddress(1, 1, 9)
CORE = core_services(V1_1, "Transport", "Events", "AccessControl", "Management")
NAN, INFINITE = float("nan"), float("inf")

_CDR = struct.Struct("<4sd")
LEVELS = ("ok", "warning", "error", "stale")
_HEADER = b"\0\1\0\0"


class Serialized(LightMessage):
    """What the classes of this ROS have in common: one number."""

    LAYOUT: ClassVar = {"data": "double"}

    @classmethod
    def from_cdr(cls, data):
        try:
            header, number = _CDR.unpack(data)
        except struct.error as error:
            raise DecodeError(cls.__name__, str(error)) from error
        assert header == _HEADER
        return cls(number)

    def to_cdr(self):
        (number,) = vars(self).values()
        return _CDR.pack(_HEADER, number)


@dataclass
class Number(Serialized):
    """A light class."""

    TYPE = "test_msgs/msg/Number"

    data: float = 0.0


@dataclass
class RosNumber:
    """The class of ROS for the same type."""

    data: float = 0.0

    @classmethod
    def get_fields_and_field_types(cls):
        return Number.LAYOUT


class RosNumberCodec:
    """What makes objects of the class of ROS."""

    @staticmethod
    def decode(data):
        return RosNumber(Number.from_cdr(data).data)

    @staticmethod
    def encode(message):
        if not isinstance(message, RosNumber):
            raise TypeError(f"RosNumber expected, not {message!r}")
        return Number(message.data).to_cdr()


@dataclass
class Publisher:
    """Keeps what is published; somebody subscribes unless a test says otherwise."""

    ros: object
    published: list = field(default_factory=list)
    matched: int = 1
    unmatched: int = 0

    def publish(self, data):
        if self.ros.fails:
            raise RuntimeError("the middleware refuses")
        self.published.append(Number.from_cdr(data))


def read_diagnostics(data):
    """Yields the statuses of a serialized array."""
    place = 4

    def number():
        nonlocal place
        place += -place % 4
        (value,) = struct.unpack_from("<I", data, place)
        place += 4
        return value

    def text():
        nonlocal place
        size = number()
        place += size
        assert data[place - 1] == 0
        return data[place - size : place - 1].decode()

    assert data[:4] == _HEADER
    number(), number(), text()
    for _ in range(number()):
        level = LEVELS[data[place]]
        place += 1
        node, _, name = text().partition(": ")
        assert node == Ros.name
        message, hardware_id = text(), text()
        pairs = tuple((text(), text()) for _ in range(number()))
        yield ConnectionStatus(name, level, message, hardware_id, pairs)
    assert place == len(data)


class RosClient:
    """A client of a service that the ROS side has while `answers` names it."""

    def __init__(self, ros, name):
        self._ros, self._name = ros, name

    def is_ready(self):
        return self._name in self._ros.answers

    def call(self, request, answered):
        answered(self._ros.answers[self._name](request))
        return lambda: None


class Ros:
    """The ROS side: what was made on it, in order, and what was published.

    Attributes:
        deliver: By topic, what gives the bridge a message.
        take: By topic, what gives the bridge a serialized message and its stamp.
        served: By name, what takes the requests of a service.
        answers: By name, what answers the requests to a service; others are absent.
        is_simulated: Whether time is simulated; `say_time` says it then.
    """

    name = "/fleet/bridge"
    is_simulated = False

    def __init__(self):
        self.made: list[tuple[str, str]] = []
        self.published: dict[str, list[Number]] = {}
        self.publishers = {}
        self.greeters = {}
        self.counts = {}
        self.deliver = {}
        self.take = {}
        self.statuses = []
        self.parameters = {}
        self.changed = {}
        self.declared = []
        self.found_faults = {}
        self.served = {}
        self.answers = {}
        self.fails = False

    def attach(self, loop):
        assert not self.made
        self.loop = loop

    def now(self):
        return Time(1_780_000_000, 0)

    def parameter(self, parameter, changed=None):
        assert parameter.description
        limits = parameter.limits
        assert limits is None or limits[0] <= parameter.default <= limits[1]
        self.declared.append(parameter)
        self.changed[parameter.name] = changed
        return self.parameters.get(parameter.name, parameter.default)

    def check_parameters(self):
        """What tests give is what bridges take."""

    def follow_clock(self, take):
        assert self.is_simulated
        self._follow = take

    def say_time(self, seconds):
        with self.loop.lock:
            self._follow(seconds)

    def faults(self, topic, *, publishes, alone=False):  # noqa: ARG002
        return self.found_faults.get((topic.name, publishes), [])

    def codec(self, _ros_type):
        return RosNumberCodec

    def publisher(self, _ros_type, topic, greet=None):
        self.greeters[topic.name] = greet
        self.made.append(("publisher", topic.name))
        found = self.published.setdefault(topic.name, [])
        made = self.publishers[topic.name] = Publisher(self, found)
        return made

    def subscribe(self, _ros_type, topic, take):
        self.made.append(("subscription", topic.name))
        self.deliver[topic.name] = lambda message: self._take(take, message.to_cdr(), 0)
        self.take[topic.name] = lambda data, stamp=0: self._take(take, data, stamp)
        counts = self.counts[topic.name] = TopicCounts()
        return counts

    def part(self, _load):
        return self

    def serve(self, service, handle):
        self.made.append(("service", service.name))
        self.served[service.name] = handle

    def client(self, service):
        self.made.append(("client", service.name))
        return RosClient(self, service.name)

    def call(self, name, request, reply):
        """Calls a service that the bridge serves."""
        with self.loop.lock:
            self.served[name](request, reply)

    def _take(self, take, data, stamp):
        with self.loop.lock:
            take(data, stamp)

    def publish_diagnostics(self, data):
        statuses = read_diagnostics(data)
        self.statuses.append({status.name: status for status in statuses})

    def numbers(self, topic):
        return [message.data for message in self.published[topic]]


@dataclass
class Setting:
    """A bridge in a world, opened."""

    world: object
    ros: Ros = field(default_factory=Ros)
    bridge: Bridge | None = None

    def open(self, *connections, services=(), ward=None, **settings):
        self.bridge = Bridge(
            BridgeSettings(
                "bridge",
                OWN,
                services=services,
                component=ComponentSettings(register_services=False, **settings),
            )
        )
        self.bridge.ward = ward
        self.bridge.connections = list(connections)
        self.bridge.open(self.ros, self.world)
        self.world.settle()
        return connections[0]

    def say(self, *numbers, every=None):
        """Delivers numbers on their topic, and lets a time pass after each if one is named."""
        for number in numbers:
            self.ros.deliver["numbers"](Number(float(number)))
            if every is not None:
                self.world.run(every)

    def drops(self, connection):
        return connection.statistics.drops

    def judged(self, name):
        """The level and the message of the last status of that name."""
        status = self.ros.statuses[-1][name]
        return status.level, status.message


def peer_component(world, address=PEER, **settings):
    return world.started(str(address), services=CORE, **settings)


def minutes_to_number(report):
    return Number(float(report.timeout))


def number_to_time(source):
    return SetTime(time_stamp=SetTime.TimeStamp(minutes=int(source.data)))


def number_to_report(source):
    return ReportTime(time_stamp=ReportTime.TimeStamp(minutes=int(source.data)))


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


def query(name="timeout", **options):
    """A connection that asks its peer, PEER unless others are named, again and again."""
    options.setdefault("peers", [PEER])
    return QueryToTopics(
        name,
        minutes_to_number,
        message=ReportEventTimeout,
        type=Number,
        query=QueryEventTimeout(),
        topics=[Topic(name)],
        **options,
    )


def report(name="served", translate=None, **options):
    """A connection that reports a time, which a number of a topic gives."""
    options.setdefault("topics", [Topic("numbers")])
    return TopicsToReport(
        name,
        translate or number_to_report,
        message=ReportTime,
        type=Number,
        query=QueryTime,
        **options,
    )


def message_connection(
    translate=lambda message: Number(float(message.time_stamp.minutes)), **options
):
    options.setdefault("is_command", options.get("when", Guard.ANY) is not Guard.ANY)
    return MessageToTopics(
        "times", translate, message=SetTime, type=Number, topics=[Topic("times")], **options
    )


def obeyed(*translate, **options):
    """A connection of commands that are obeyed in Ready, and stop by -1."""
    options.setdefault("when", Guard.READY)
    return message_connection(*translate, safe_value=lambda: Number(-1.0), **options)


def stopping(**options):
    """A connection that stops its peer after a second of silence."""
    options = {"silence_timeout": 1.0, "safe_value": safe, "is_command": True, **options}
    return command(**options)


def minutes(value):
    return SetTime(time_stamp=SetTime.TimeStamp(minutes=value))


def raising(error):
    def translate(_source):
        raise error

    return translate


def safe():
    return minutes(0)


def values(status):
    return dict(status.values)
