"""Calls of ROS services that a bridge serves: each is answered, and never told that all is well."""

import json

import pytest

from jausml.runtime import Guard
from jausml.runtime.bridge.calls.calls import MAX_CALLS
from jausml.runtime.bridge.calls.services import JausToRosService, RosServiceToJaus
from jausml.runtime.bridge.ends.topics import RosService
from jausml.runtime.bridge.light_message import LightMessage
from jausml.runtime.messages import (
    QueryStatus,
    RejectControl,
    RejectEventRequest,
    ReportStatus,
    ReportTimeout,
    SetEmergency,
    SetTime,
)

from .bridge_support import CORE, OWN, PEER, minutes


class Request(LightMessage):
    """A request without members."""

    TYPE = "test_srvs/srv/Trigger_Request"

    def to_cdr(self):
        return b""


class Response(LightMessage):
    """A response that tells whether all went well."""

    TYPE = "test_srvs/srv/Trigger_Response"

    def __init__(self):
        self.success = False
        self.message = ""

    def to_cdr(self):
        return json.dumps([self.success, self.message]).encode()

    @classmethod
    def from_cdr(cls, data):
        made = cls()
        made.success, made.message = json.loads(data)
        return made


class Client:
    """A ROS client.

    Attributes:
        told: What each call was answered with: success and reason.
    """

    def __init__(self, setting):
        self._ros = setting.ros
        self.told = []

    def call(self):
        self._ros.call("ask", b"", lambda data: self.told.append(tuple(json.loads(data))))


@pytest.fixture
def client(setting):
    return Client(setting)


def connection(asks=None, answer=ReportStatus, *, tells=True, **options):
    words = {"success": "success", "reason": "message"} if tells else {}
    return RosServiceToJaus(
        "ask",
        service=RosService("ask", "test_srvs/srv/Trigger", Request, Response, **words),
        request=asks or QueryStatus(),
        response=answer,
        peers=[PEER],
        timeout=1.5,
        **options,
    )


def command(**options):
    return connection(minutes(5), ReportStatus, is_command=True, **options)


def answer(world, setting, message):
    world.send(PEER, setting.bridge.component.address, message.encode())
    world.settle()


@pytest.fixture
def peer(world):
    return world.probe(str(PEER), strict=False)


@pytest.mark.usefixtures("peer")
class TestServedCalls:
    def test_answer(self, world, setting, client):
        served = setting.open(connection())
        client.call()
        world.settle()
        assert client.told == []
        answer(world, setting, ReportStatus())
        assert client.told == [(True, "")]
        world.run(5.0, step=0.1)
        assert client.told == [(True, "")]
        assert (served.statistics.arrivals, served.statistics.passed) == (1, 1)
        assert setting.drops(served) == {}

    def test_rejection(self, world, setting, client):
        served = setting.open(command(rejections=[RejectControl]))
        client.call()
        answer(world, setting, RejectControl())
        ((good, reason),) = client.told
        assert not good
        assert reason.startswith(f"{PEER} answered RejectControl")
        assert setting.drops(served) == {"rejected": 1}

    def test_rejection_that_cannot_be_read(self, world, setting, client):
        served = setting.open(command(rejections=[RejectControl]))
        client.call()
        world.send(PEER, OWN, RejectControl().encode()[:2])
        world.settle()
        assert client.told == [(False, f"{PEER} answered RejectControl")]
        assert setting.drops(served) == {"rejected": 1}

    def test_timeout(self, world, setting, client):
        served = setting.open(connection())
        client.call()
        world.run(1.6, step=0.05)
        assert client.told == [(False, f"{PEER} did not answer within 1.5 s")]
        answer(world, setting, ReportStatus())
        assert len(client.told) == 1
        assert setting.drops(served) == {"timed_out": 1}

    def test_command_is_sent_once(self, world, setting, client):
        setting.open(command())
        client.call()
        world.run(1.6, step=0.05)
        assert world.count(SetTime.CODE) == 1
        assert client.told[0][0] is False

    def test_response_that_cannot_tell_is_not_sent(self, world, setting, client):
        served = setting.open(connection(tells=False))
        client.call()
        world.run(1.6, step=0.05)
        assert client.told == []
        assert setting.drops(served) == {"timed_out": 1}
        assert world.counters.snapshot()["bridge.ask.unanswered"] == 1

    def test_inactive_bridge_ends_calls_and_takes_none(self, world, setting, client):
        served = setting.open(connection())
        client.call()
        setting.bridge.set_active(False)
        client.call()
        assert [good for good, _ in client.told] == [False, False]
        assert all(reason for _, reason in client.told)
        assert setting.drops(served) == {"ended": 1, "not_ready": 1}
        setting.bridge.set_active(True)
        client.call()
        answer(world, setting, ReportStatus())
        assert client.told[2:] == [(True, "")]

    def test_too_many_calls(self, setting, client):
        served = setting.open(connection())
        for _ in range(MAX_CALLS + 1):
            client.call()
        assert client.told == [(False, f"{MAX_CALLS} calls are under way")]
        assert setting.drops(served) == {"too_many_calls": 1}

    def test_end_of_the_bridge_ends_calls(self, setting, client):
        setting.open(connection())
        client.call()
        setting.bridge.close()
        assert [good for good, _ in client.told] == [False]


def test_peer_that_does_not_obey(world, setting, client):
    served = setting.open(command(control=Guard.READY))
    client.call()
    world.settle()
    ((good, reason),) = client.told
    assert not good
    assert reason.startswith(f"no peer obeys ({PEER}: ")
    assert setting.drops(served) == {"not_ready": 1}
    assert world.count(SetTime.CODE) == 0


def test_emergency_ends_commands(world, setting, client):
    served = setting.open(command(), services=CORE)
    client.call()
    world.probe("5.1.1").tell(OWN, SetEmergency(emergency_code=1))
    client.call()
    assert [good for good, _ in client.told] == [False, False]
    assert setting.drops(served) == {"ended": 1, "not_ready": 1}
    assert world.count(SetTime.CODE) == 1


def test_emergency_lets_queries_be(world, setting, client):
    world.probe(str(PEER), strict=False)
    setting.open(connection(), services=CORE)
    client.call()
    world.probe("5.1.1").tell(OWN, SetEmergency(emergency_code=1))
    answer(world, setting, ReportStatus())
    assert client.told == [(True, "")]


def asked_of_ros(rejection, **options):
    """A call of a JAUS component that a service of ROS answers."""
    service = RosService(
        "ask", "test_srvs/srv/Trigger", Request, Response, success="success", reason="message"
    )
    return JausToRosService(
        "ask",
        service=service,
        request=SetTime,
        response=ReportTimeout,
        rejections=[rejection],
        timeout=1.5,
        **options,
    )


def test_a_rejection_says_why_in_its_text(world, setting):
    setting.open(asked_of_ros(RejectEventRequest, reason=("error_message", 12)))
    caller = world.probe(str(PEER))
    (told,) = caller.ask(minutes(5), OWN)
    assert told.error_message == "nobody serve"
    setting.ros.answers["ask"] = lambda _request: '[false, "too hot: 90 \N{DEGREE SIGN}C"]'.encode()
    (told,) = caller.ask(minutes(6), OWN)
    assert told.error_message == "too hot: 90 "


def test_a_service_that_is_absent_is_told_and_found_when_it_comes(world, setting):
    """A JAUS component calls a service of ROS: it is rejected, and never left without a word."""
    asked = setting.open(asked_of_ros(RejectControl))
    caller = world.probe(str(PEER))
    (told,) = caller.ask(minutes(5), OWN)
    assert isinstance(told, RejectControl)
    assert setting.drops(asked) == {"no_service": 1}
    assert "nobody serves ask" in asked.status().message
    setting.ros.answers["ask"] = lambda _request: b'[true, ""]'
    (told,) = caller.ask(minutes(6), OWN)
    assert isinstance(told, ReportTimeout)
    setting.ros.answers["ask"] = lambda _request: b'[false, "too hot"]'
    (told,) = caller.ask(minutes(7), OWN)
    assert isinstance(told, RejectControl)
    assert setting.drops(asked) == {"no_service": 1, "rejected": 1}
    assert asked.statistics.passed == 1


def test_a_call_that_cannot_be_sent_is_rejected_once(world, setting):
    asked = setting.open(asked_of_ros(RejectControl))

    def fail(_request):
        raise RuntimeError("the middleware refuses")

    setting.ros.answers["ask"] = fail
    caller = world.probe(str(PEER))
    (told,) = caller.ask(minutes(5), OWN)
    assert isinstance(told, RejectControl)
    world.run(2.0)
    assert caller.take() == []
    assert setting.drops(asked) == {"answer_not_delivered": 1}
