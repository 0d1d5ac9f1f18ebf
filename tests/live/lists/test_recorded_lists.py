"""Lists and goals are recorded, and what became of them is explained."""

import os

import needs
import pytest
from generated import model_of

needs.ask("rclpy")

from jausml.live.systems.explaining import explained

from ..bridge_support import ROOT, RosPeer, wait_for
from ..recorder import Recorder
from .conftest import operator_of
from .list_system import LIVE, PATIENCE, facts, order, wait_goal

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.ports]
MODEL = LIVE / "waypoint_lists.ros2jaus"
INTROSPECTION = ("--ros-args", "-p", "service_introspection:=contents", "--")


@pytest.fixture
def operator(system):
    system.start_ros_robot()
    yield from operator_of(system, "robot", *INTROSPECTION)


@pytest.fixture
def recorder(system, operator, packages, tmp_path):
    """A recorder that knows the types of the action too."""
    del operator  # whose bridge is to be heard
    (tmp_path / "share").symlink_to(ROOT / "tools" / "ros_definitions")
    path = os.pathsep.join([packages[-1], os.environ.get("PYTHONPATH", "")])
    with Recorder(
        tmp_path, MODEL, system.port, PYTHONPATH=path, AMENT_PREFIX_PATH=str(tmp_path)
    ) as made:
        yield made


@pytest.fixture
def listener(packages):
    """The diagnostics that came to another node."""
    from diagnostic_msgs.msg import DiagnosticArray

    del packages  # they set the domain
    peer = RosPeer()
    yield peer.listen(DiagnosticArray, "/diagnostics")
    peer.close()


def explanation(recorded, counter):
    (drop,) = [
        mark
        for mark in recorded.marks
        if mark.subject == ("/robot/robot", "follow") and mark.counter == counter
    ]
    model = model_of(MODEL, allow_outside=True)
    return explained(recorded, model, drop.subject, drop.time)


def test_a_goal_that_is_refused_and_one_that_is_aborted(system, operator, recorder, listener):
    # What was dropped is seen by what the counts were before.
    wait_for(lambda: list(listener), "diagnostics", PATIENCE)
    order(system, "refuse")
    wait_for(lambda: facts(system, "refuse"), "refusal", PATIENCE)
    operator.give(1, 2)
    operator.execute()
    wait_for(lambda: operator.ends == [False], "the failure", PATIENCE)
    order(system, "accept")
    wait_for(lambda: facts(system, "accept"), "acceptance", PATIENCE)
    operator.execute()
    wait_goal(system)
    order(system, "abort")
    wait_for(lambda: operator.ends == [False, False], "the failure", PATIENCE)
    wait_for(lambda: told(listener, "dropped: aborted"), "diagnostics", PATIENCE)
    recorded = recorder.end()
    refused, aborted = (explanation(recorded, outcome) for outcome in ("refused", "aborted"))
    assert any("of a goal, nobody wanted it" in sentence for sentence in refused.counter)
    assert any("gave it up" in sentence for sentence in aborted.counter)


def told(listener, key):
    """Whether diagnostics have had a value."""
    return any(
        value.key == key for array in listener for status in array.status for value in status.values
    )
