"""Calls of ROS services across a generated bridge, both ways: answered, refused, lost, late."""

import threading

import needs
import pytest
from ports import free_domain

needs.ask("rclpy")

from .bridge_support import generate, wait_for
from .lamp_system import MODEL, System, states

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def path():
    return generate(MODEL)


@pytest.fixture
def system(path, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with System(path, tmp_path) as made:
        yield made


def test_calls_of_services_are_queries_and_commands_and_not_too_many(system):
    # Nobody can be controlled yet.
    answer = system.call("switch", data=True)
    assert not answer.success
    assert "no peer obeys" in answer.message
    assert "100.1.2" in answer.message
    wait_for(lambda: system.value("switch", "failed: not_ready") == "1", "diagnostics")
    assert system.ros.status("switch").message == "no peer obeys"
    # A query is a service.
    lamp = system.lamp()
    assert system.call("read").message == "dark"
    assert system.switched(data=True).success
    answer = system.call("read")
    assert (answer.success, answer.message) == (True, "lit")
    wait_for(lambda: system.value("read", "calls answered") == "2", "diagnostics")
    futures = [system.send("read") for _ in range(20)]  # under way together
    wait_for(lambda: all(future.done() for future in futures), "20 responses")
    assert {future.result().message for future in futures} == {"lit"}
    # A command is sent once, and confirmed or refused.
    system.mode(lamp, "refuse")
    answer = system.call("switch", data=False)
    assert not answer.success
    assert "RejectLamp with the code 7" in answer.message
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 0]
    wait_for(lambda: system.value("switch", "failed: rejected") == "1", "diagnostics")
    system.mode(lamp, "silent")
    assert not system.call("switch", data=True).success
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 0, 100]  # sent once
    refuses_more_calls_than_are_carried(system, lamp)


def refuses_more_calls_than_are_carried(system, lamp):
    """Sees that of calls that a silent lamp has not answered only so many are under way."""
    known = len(lamp.of_kind("query"))
    futures = [system.send("read") for _ in range(80)]
    wait_for(lambda: all(future.done() for future in futures), "80 responses")
    reasons = [future.result().message for future in futures]
    assert not any(future.result().success for future in futures)
    refused = sum("64 calls are under way" in reason for reason in reasons)
    timed_out = sum("did not answer" in reason for reason in reasons)
    unsent = sum("was not asked" in reason for reason in reasons)
    assert refused
    assert refused + timed_out + unsent == 80
    # No more are said to be unanswered than there were questions, each repeated twice.
    assert 0 < timed_out <= len(lamp.of_kind("query")) - known


@pytest.mark.slow
def test_a_peer_that_is_late_or_silent_and_a_bridge_that_ends(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    # A late answer is not that of the next call.
    system.mode(lamp, "late")
    first = system.call("switch", data=True)
    second = system.call("switch", data=False)  # which the lamp refuses, and was taken for done
    assert (first.success, second.success) == (False, False)
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 100, 0]
    system.mode(lamp, "refuse")
    assert "with the code 7" in system.call("switch", data=True).message
    # A response that cannot tell of failures is none.
    system.mode(lamp, "silent")
    future = system.send("shine")
    wait_for(lambda: system.value("shine", "failed: timed_out") == "1", "diagnostics")
    assert not future.done()
    system.mode(lamp, "answer")
    assert system.call("shine").message == "lit"
    # Who is gone times out, and may come back.
    lamp.kill()
    answer = system.call("read")
    assert not answer.success
    assert "did not answer within 1 s" in answer.message
    wait_for(lambda: system.value("read", "failed: timed_out") == "1", "diagnostics")
    lamp = system.lamp()
    assert system.call("read").success
    # Until the bridge has noticed that the new lamp does not know it, a command has no answer.
    wait_for(lambda: system.switched(data=True).success, "control of the new lamp")
    # The end of the bridge ends calls.
    system.mode(lamp, "silent")
    known = len(lamp.of_kind("query"))
    future = system.send("read")
    wait_for(lambda: len(lamp.of_kind("query")) > known, "query")
    assert system.bridge.stop() == 0
    wait_for(future.done, "response")
    assert future.result().message == "the bridge ends"


class Lamp:
    """A service of the robot, which waits for an event if there is one."""

    def __init__(self, *, go_on=None):
        self.taken, self.begun, self.go_on = [], threading.Event(), go_on

    def __call__(self, request, response):
        self.taken.append(request.data)
        self.begun.set()
        if self.go_on is not None:
            self.go_on.wait(20.0)
        response.success, response.message = request.data, "the bulb is hot"
        return response


def rejected(operator, times):
    wait_for(lambda: len(operator.of_kind("reject")) == times, "rejection")


def test_a_message_of_the_controller_calls_a_service(system):
    operator = system.operator()
    operator.tell("set 100")  # there is none
    rejected(operator, 1)
    wait_for(lambda: system.value("switch_robot", "failed: no_service") == "1", "diagnostics")
    assert system.ros.status("switch_robot").message == "nobody serves lamp/switch"
    lamp = Lamp()
    service = system.serve(lamp)
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("confirm"), "confirmation")
    operator.tell("set 0")
    rejected(operator, 2)
    assert lamp.taken == [True, False]
    assert operator.of_kind("reject")[1]["reason"] == "the bulb is hot"
    operator.tell("set 7")  # no counterpart in the table
    rejected(operator, 3)
    assert lamp.taken == [True, False]
    # Who does not control the bridge is not heard.
    operator.tell("release")
    wait_for(lambda: operator.of_kind("released"), "release")
    operator.tell("set 100")
    ready = states(operator).count("READY")
    operator.tell("take")
    wait_for(lambda: states(operator).count("READY") > ready, "control again")
    operator.tell("set 0")
    rejected(operator, 4)
    assert lamp.taken == [True, False, False]
    system.ros.node.destroy_service(service)


@pytest.mark.slow
def test_a_service_that_hangs_is_a_rejection_and_lost_control_ends_its_call(system):
    lamp = Lamp(go_on=threading.Event())
    system.serve(lamp)
    operator = system.operator()
    operator.tell("set 100")
    rejected(operator, 1)
    wait_for(lambda: system.value("switch_robot", "failed: timed_out") == "1", "diagnostics")
    lamp.go_on.set()
    lamp.begun.clear()
    lamp.go_on.clear()
    operator.tell("set 100")
    assert lamp.begun.wait(20.0)
    operator.tell("release")
    rejected(operator, 2)
    lamp.go_on.set()
    wait_for(lambda: system.value("switch_robot", "failed: ended") == "1", "diagnostics")
    assert not operator.of_kind("confirm")
