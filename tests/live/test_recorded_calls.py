"""Calls of ROS services are recorded where the bridge publishes them, and failures explained."""

import needs
import pytest
from generated import model_of
from ports import free_domain

needs.ask("rclpy")

from jausml.live.systems.explaining import explained

from .bridge_support import generate, wait_for
from .lamp_system import MODEL, System
from .recorder import Recorder

pytestmark = [pytest.mark.live, pytest.mark.ports]
INTROSPECTION = ("--ros-args", "-p", "service_introspection:=contents", "--")


def provoke(system):
    """Has calls succeed, and fail in each way, one after the other."""
    lamp = system.lamp()
    assert system.call("read").success
    system.mode(lamp, "silent")
    assert "did not answer" in system.call("read").message
    counted(system, "read", "failed: timed_out")
    system.mode(lamp, "answer")
    assert system.switched(data=True).success
    system.mode(lamp, "refuse")
    assert "RejectLamp" in system.call("switch", data=False).message
    counted(system, "switch", "failed: rejected")
    operator = system.operator()
    operator.tell("set 100")  # nobody serves what it calls
    wait_for(lambda: len(operator.of_kind("reject")) == 1, "rejection")
    counted(system, "switch_robot", "failed: no_service")
    system.serve(switched)
    operator.tell("set 100")
    wait_for(lambda: operator.of_kind("confirm"), "confirmation")
    operator.tell("set 0")
    wait_for(lambda: len(operator.of_kind("reject")) == 2, "rejection")
    counted(system, "switch_robot", "failed: rejected")
    operator.tell("set 7")  # which has no counterpart
    wait_for(lambda: len(operator.of_kind("reject")) == 3, "rejection")
    counted(system, "switch_robot", "failed: not_translated")


def switched(request, response):
    response.success, response.message = request.data, "it is stuck"
    return response


def counted(system, connection, counter):
    wait_for(lambda: system.value(connection, counter) is not None, counter)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calls")
    with (
        System(generate(MODEL), folder, *INTROSPECTION) as system,
        Recorder(folder, MODEL, system.port) as recorder,
    ):
        for topic in ("/read_lamp", "/switch_lamp", "/lamp/switch"):
            name = f"{topic}/_service_event"
            wait_for(lambda name=name: system.ros.node.count_subscribers(name), name)
        provoke(system)
        return recorder.end()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("connection", "counter", "why"),
    [
        ("read", "timed_out", "no answer came in time"),
        ("switch", "rejected", "who was asked refused it"),
        ("switch_robot", "rejected", "who was asked refused it"),
        ("switch_robot", "no_service", "the ROS service was not there"),
        ("switch_robot", "not_translated", "a call could not be translated"),
    ],
)
def test_a_call_that_failed_is_explained_by_its_counter(recorded, connection, counter, why):
    model = model_of(MODEL, allow_outside=True)
    (drop,) = [
        mark
        for mark in recorded.marks
        if mark.subject == ("/front", connection) and mark.counter == counter
    ]
    found = explained(recorded, model, drop.subject, drop.time)
    assert found.counter[1] == f"A message is counted there because {why}."


def test_calls_are_published_from_when_the_parameter_is_set(system):
    from std_srvs.srv import Trigger

    def set_to(word):
        return system.ros.set_parameter("/front", "service_introspection", word)

    assert "everything is none of disabled, metadata, contents" in set_to("everything").reason
    system.lamp()
    assert system.call("read").success
    wait_for(lambda: system.value("read", "calls answered") == "1", "diagnostics")
    names = [name for name, _ in system.ros.node.get_topic_names_and_types()]
    assert "/diagnostics" in names
    assert not [name for name in names if name.endswith("_service_event")]
    assert set_to("metadata").successful
    events = system.ros.listen_to_publisher(Trigger.Event, "/read_lamp/_service_event")
    # The bridge may find this subscription later than the subscription finds the bridge.
    wait_for(lambda: system.call("read").success and len(events) >= 2, "events")
    wait_for(lambda: len(events) % 2 == 0, "the second of a pair")
    assert [event.info.event_type for event in events] == [1, 2] * (len(events) // 2)
    assert not [event for event in events if event.request or event.response]
    assert set_to("contents").successful
    wait_for(lambda: system.call("read").success and events[-1].response, "contents")
    assert events[-1].response[0].message == "dark"


@pytest.fixture
def system(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with System(generate(MODEL), tmp_path) as made:
        yield made
