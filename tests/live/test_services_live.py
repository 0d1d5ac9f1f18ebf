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


def test_a_query_is_a_service(system):
    system.lamp()
    assert system.call("read").message == "dark"
    assert system.switched(data=True).success
    answer = system.call("read")
    assert (answer.success, answer.message) == (True, "lit")
    wait_for(lambda: system.value("read", "calls answered") == "2", "diagnostics")
    futures = [system.send("read") for _ in range(20)]  # under way together
    wait_for(lambda: all(future.done() for future in futures), "20 responses")
    assert {future.result().message for future in futures} == {"lit"}


def test_a_command_is_sent_once_and_confirmed_or_refused(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    system.mode(lamp, "refuse")
    answer = system.call("switch", data=False)
    assert not answer.success
    assert "RejectLamp with the code 7" in answer.message
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 0]
    wait_for(lambda: system.value("switch", "failed: rejected") == "1", "diagnostics")
    system.mode(lamp, "silent")
    assert not system.call("switch", data=True).success
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 0, 100]  # sent once


def test_a_command_needs_control(system):
    answer = system.call("switch", data=True)
    assert not answer.success
    assert "no peer obeys" in answer.message
    assert "100.1.2" in answer.message
    wait_for(lambda: system.value("switch", "failed: not_ready") == "1", "diagnostics")
    assert system.ros.status("switch").message == "no peer obeys"


@pytest.mark.slow
def test_a_peer_that_is_silent_times_out_and_comes_back(system):
    lamp = system.lamp()
    assert system.call("read").success
    lamp.kill()
    answer = system.call("read")
    assert not answer.success
    assert "did not answer within 1 s" in answer.message
    wait_for(lambda: system.value("read", "failed: timed_out") == "1", "diagnostics")
    system.lamp()
    assert system.call("read").success
    # Until the bridge has noticed that the new lamp does not know it, a command has no answer.
    wait_for(lambda: system.switched(data=True).success, "control of the new lamp")


@pytest.mark.slow
def test_a_late_answer_is_not_that_of_the_next_call(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    system.mode(lamp, "late")
    first = system.call("switch", data=True)
    second = system.call("switch", data=False)  # which the lamp refuses, and was taken for done
    assert (first.success, second.success) == (False, False)
    assert [fact["brightness"] for fact in lamp.of_kind("set")] == [100, 100, 0]
    system.mode(lamp, "refuse")
    assert "with the code 7" in system.call("switch", data=True).message


def test_more_calls_than_are_carried_are_refused(system):
    system.lamp("silent")
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
    assert 0 < timed_out <= len(system.processes[1].of_kind("query"))


@pytest.mark.slow
def test_a_response_that_cannot_tell_of_failures_is_none(system):
    lamp = system.lamp("silent")
    future = system.send("shine")
    wait_for(lambda: system.value("shine", "failed: timed_out") == "1", "diagnostics")
    assert not future.done()
    system.mode(lamp, "answer")
    assert system.call("shine").message == "dark"


@pytest.mark.slow
def test_the_end_of_the_bridge_ends_calls(system):
    system.lamp("silent")
    future = system.send("read")
    wait_for(lambda: system.processes[1].of_kind("query"), "query")
    assert system.bridge.stop() == 0
    wait_for(future.done, "response")
    assert future.result().message == "the bridge ends"


def test_a_message_calls_a_service(system):
    taken = []

    def handler(request, response):
        taken.append(request.data)
        response.success, response.message = request.data, "the bulb is hot"
        return response

    service = system.serve(handler)
    operator = system.operator()
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("confirm"), "confirmation")
    operator.tell("set 0")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    assert taken == [True, False]
    assert operator.of_kind("reject")[0]["reason"] == "the bulb is hot"
    operator.tell("set 7")  # no counterpart in the table
    wait_for(lambda: len(operator.of_kind("reject")) == 2, "rejection")
    assert taken == [True, False]
    system.ros.node.destroy_service(service)


@pytest.mark.slow
def test_a_service_that_is_absent_is_a_rejection(system):
    operator = system.operator()
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    wait_for(lambda: system.value("switch_robot", "failed: no_service") == "1", "diagnostics")
    assert system.ros.status("switch_robot").message == "nobody serves lamp/switch"


@pytest.mark.slow
def test_a_service_that_hangs_is_a_rejection(system):
    go_on = threading.Event()

    def handler(_request, response):
        go_on.wait(20.0)
        return response

    system.serve(handler)
    operator = system.operator()
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    go_on.set()
    wait_for(lambda: system.value("switch_robot", "failed: timed_out") == "1", "diagnostics")
    assert not operator.of_kind("confirm")


def test_who_does_not_control_the_bridge_is_not_heard(system):
    taken = []

    def handler(request, response):
        taken.append(request.data)
        response.success = True
        return response

    system.serve(handler)
    operator = system.operator()
    operator.tell("release")
    wait_for(lambda: operator.of_kind("released"), "release")
    operator.tell("set 100")
    operator.tell("take")
    wait_for(lambda: states(operator).count("READY") > 1, "control again")
    operator.tell("set 0")
    wait_for(lambda: operator.of_kind("confirm"), "confirmation")
    assert taken == [False]


@pytest.mark.slow
def test_the_loss_of_control_ends_calls(system):
    begun, go_on = threading.Event(), threading.Event()

    def handler(_request, response):
        begun.set()
        go_on.wait(20.0)
        return response

    system.serve(handler)
    operator = system.operator()
    operator.tell("set 100")
    assert begun.wait(20.0)
    operator.tell("release")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    go_on.set()
    wait_for(lambda: system.value("switch_robot", "failed: ended") == "1", "diagnostics")
    assert not operator.of_kind("confirm")
