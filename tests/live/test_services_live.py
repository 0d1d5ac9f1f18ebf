"""Calls of ROS services across a generated bridge, both ways: answered, refused, lost, late."""

from __future__ import annotations

import threading
from functools import partial
from pathlib import Path

import pytest
from ports import free_domain, free_port

pytest.importorskip("rclpy")


from .bridge_support import Process, RosPeer, generate, wait_for

pytestmark = [
    pytest.mark.live,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

FOLDER = Path(__file__).resolve().parent


@pytest.fixture(scope="module")
def path():
    return generate(FOLDER / "services.ros2jaus")


class System:
    """The bridge, a lamp, an operator, and a node of the test."""

    def __init__(self, path, logs):
        from rclpy.qos import QoSProfile
        from std_srvs.srv import SetBool, Trigger

        self.path, self.logs, self.port = path, logs, free_port()
        self.processes = []
        self.ros = RosPeer()
        self.bridge = self.start("-m", "front.main")
        create = partial(self.ros.node.create_client, qos_profile=QoSProfile(depth=100))
        self.clients = {
            "read": create(Trigger, "/read_lamp"),
            "switch": create(SetBool, "/switch_lamp"),
            "shine": create(Trigger, "/shine"),
        }

    def start(self, *arguments):
        line = [*arguments, "--jaus-port", str(self.port)]
        log = self.logs / f"{len(self.processes)}.log"
        process = Process(line, self.path, log, stdin=True)
        self.processes.append(process)
        return process

    def lamp(self, mode="answer"):
        process = self.start(str(FOLDER / "lamp.py"))
        process.tell(mode)
        wait_for(lambda: process.of_kind("mode"), "lamp")
        return process

    def mode(self, lamp, mode):
        lamp.tell(mode)
        wait_for(lambda: lamp.of_kind("mode")[-1]["mode"] == mode, mode)

    def send(self, name, **members):
        """Sends a request; returns the future of its response."""
        client = self.clients[name]
        wait_for(client.service_is_ready, f"service {name}")
        return client.call_async(client.srv_type.Request(**members))

    def call(self, name, **members):
        future = self.send(name, **members)
        wait_for(future.done, f"response of {name}")
        return future.result()

    def switched(self, **members):
        """Switches the lamp until the bridge controls it."""
        answers = []

        def switch():
            answers.append(self.call("switch", **members))
            return "no peer obeys" not in answers[-1].message

        wait_for(switch, "control of the lamp")
        return answers[-1]

    def operator(self):
        """Returns an operator that controls the bridge."""
        process = self.start(str(FOLDER / "lamp_operator.py"))
        process.tell("take")
        wait_for(lambda: "READY" in states(process), "control of the bridge")
        return process

    def serve(self, handler):
        """Serves what the bridge calls."""
        from rclpy.callback_groups import ReentrantCallbackGroup
        from std_srvs.srv import SetBool

        made = self.ros.node.create_service(
            SetBool, "/lamp/switch", handler, callback_group=ReentrantCallbackGroup()
        )
        self.ros.executor.wake()
        wait_for(lambda: self.value("switch_robot", "service is") == "there", "discovery")
        return made

    def status(self, connection):
        """Returns the latest diagnostics of a connection."""
        from diagnostic_msgs.msg import DiagnosticArray

        found = self.ros.listen(DiagnosticArray, "/diagnostics")
        for array in reversed(list(found)):
            for status in array.status:
                if status.name.endswith(connection):
                    return status
        return None

    def value(self, connection, key):
        status = self.status(connection)
        values = {each.key: each.value for each in status.values} if status is not None else {}
        return values.get(key)

    def close(self):
        for process in self.processes:
            process.close()
        self.ros.close()
        logs = "".join(each.log.read_text(encoding="utf-8") for each in self.processes)
        assert "Traceback" not in logs, logs


def states(process):
    return [fact["state"] for fact in process.of_kind("control")]


@pytest.fixture
def system(path, tmp_path):
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        environment.setenv("ROS_DOMAIN_ID", free_domain())
        made = System(path, tmp_path)
        yield made
        made.close()


def test_a_query_is_a_service(system):
    system.lamp()
    assert system.call("read").message == "dark"
    assert system.switched(data=True).success
    answer = system.call("read")
    assert (answer.success, answer.message) == (True, "lit")
    wait_for(lambda: system.value("read", "calls answered") == "2", "diagnostics")


def test_a_command_is_confirmed_or_refused(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    system.mode(lamp, "refuse")
    answer = system.call("switch", data=False)
    assert not answer.success
    assert "RejectLamp with the code 7" in answer.message
    assert [each["brightness"] for each in lamp.of_kind("set")] == [100, 0]
    wait_for(lambda: system.value("switch", "failed: rejected") == "1", "diagnostics")


def test_a_command_needs_control(system):
    answer = system.call("switch", data=True)
    assert not answer.success
    assert "no peer obeys" in answer.message
    assert "100.1.2" in answer.message
    wait_for(lambda: system.value("switch", "failed: not_ready") == "1", "diagnostics")
    assert system.status("switch").message == "no peer obeys"


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


def test_a_late_answer_is_not_that_of_the_next_call(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    system.mode(lamp, "late")
    first = system.call("switch", data=True)
    second = system.call("switch", data=False)  # which the lamp refuses, and was taken for done
    assert (first.success, second.success) == (False, False)
    assert [each["brightness"] for each in lamp.of_kind("set")] == [100, 100, 0]
    system.mode(lamp, "refuse")
    assert "with the code 7" in system.call("switch", data=True).message


def test_a_command_is_sent_once(system):
    lamp = system.lamp()
    assert system.switched(data=True).success
    system.mode(lamp, "silent")
    assert not system.call("switch", data=False).success
    assert len(lamp.of_kind("set")) == 2


def test_calls_are_under_way_together(system):
    system.lamp()
    assert system.call("read").success
    futures = [system.send("read") for _ in range(20)]
    wait_for(lambda: all(each.done() for each in futures), "20 responses")
    assert {each.result().message for each in futures} == {"dark"}


def test_more_calls_than_are_carried_are_refused(system):
    system.lamp("silent")
    futures = [system.send("read") for _ in range(80)]
    wait_for(lambda: all(each.done() for each in futures), "80 responses")
    reasons = [each.result().message for each in futures]
    assert not any(each.result().success for each in futures)
    refused = sum("64 calls are under way" in each for each in reasons)
    timed_out = sum("did not answer" in each for each in reasons)
    unsent = sum("was not asked" in each for each in reasons)
    assert refused
    assert refused + timed_out + unsent == 80
    # No more are said to be unanswered than there were questions, each repeated twice.
    assert 0 < timed_out <= len(system.processes[1].of_kind("query"))


def test_a_response_that_cannot_tell_of_failures_is_none(system):
    lamp = system.lamp("silent")
    future = system.send("shine")
    wait_for(lambda: system.value("shine", "failed: timed_out") == "1", "diagnostics")
    assert not future.done()
    system.mode(lamp, "answer")
    assert system.call("shine").message == "dark"


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
        response.success = request.data
        return response

    service = system.serve(handler)
    operator = system.operator()
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("confirm"), "confirmation")
    operator.tell("set 0")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    assert taken == [True, False]
    operator.tell("set 7")  # no counterpart in the table
    wait_for(lambda: len(operator.of_kind("reject")) == 2, "rejection")
    assert taken == [True, False]
    system.ros.node.destroy_service(service)


def test_a_service_that_is_absent_is_a_rejection(system):
    operator = system.operator()
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("reject"), "rejection")
    wait_for(lambda: system.value("switch_robot", "failed: no_service") == "1", "diagnostics")
    assert system.status("switch_robot").message == "nobody serves lamp/switch"


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
