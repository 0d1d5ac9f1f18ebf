"""Waypoints of JAUS become goals of a ROS action: real processes, a real action server of rclpy."""

from importlib import import_module

import needs
import pytest

needs.ask("rclpy")

from nav2 import nav2

from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport

from ..bridge_support import generate, wait_for
from .list_system import LIVE, OPERATOR, PATIENCE, ROBOT, facts, order, wait_goal

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def packages():
    """The module path of the generated bridge, of its messages, and of nav2_msgs."""
    made = [*generate(LIVE / "waypoint.ros2jaus"), nav2()]
    with pytest.MonkeyPatch.context() as patch:
        for path in made:
            patch.syspath_prepend(path)
        yield made


class Walking(JausComponent):
    """An operator who gives waypoints."""

    def __init__(self, transport):
        super().__init__(transport, OPERATOR, name="operator", services=())
        self.messages = import_module("walker.messages")
        self.session = self.control(ROBOT, authority=200)
        self.start()
        wait_for(lambda: self.session.state is ControlState.READY, "control", PATIENCE)

    def go(self, x):
        """Gives a waypoint."""
        message = self.messages.SetLocalWaypoint(x=float(x), y=0.0)
        self.send(message, ROBOT, acknowledge=True)

    def asked_x(self):
        """The x of the waypoint that the robot tells; None for no answer."""
        answers = []
        query = self.messages.QueryLocalWaypoint(presence_vector=0)
        with self.loop.lock:
            self.query(
                ROBOT,
                query,
                self.messages.ReportLocalWaypoint,
                lambda report, _: answers.append(round(report.x, 1)),
                on_failure=lambda: answers.append(None),
            )
        wait_for(lambda: answers, "answer", PATIENCE)
        return answers[0]


@pytest.fixture
def operator(system):
    """An operator in control of the bridge, whose action server is there."""
    system.start_ros_robot("pose")
    system.start_bridge("walker")
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    with running_transport(TransportSettings(port=system.port)) as transport:
        made = Walking(transport)
        yield made
        made.stop()


def canceled(system, count=1):
    wait_for(lambda: len(facts(system, "canceled")) == count, "cancellation", PATIENCE)


def test_a_waypoint_is_reached_and_another_one_takes_the_place_of_the_first(system, operator):
    assert operator.asked_x() is None
    operator.go(1)
    goal = wait_goal(system)
    assert (goal["x"], goal["frame"], operator.asked_x()) == ([1.0], "odom", 1.0)
    operator.go(2)
    assert wait_goal(system, 2)["x"] == [2.0]
    operator.go(2)  # which is the same
    assert operator.asked_x() == 2.0
    order(system, "next")
    wait_for(lambda: facts(system, "done"), "arrival", PATIENCE)
    operator.go(3)
    assert wait_goal(system, 3)["x"] == [3.0]
    kinds = [fact["kind"] for fact in facts(system, "goal", "canceled", "done")]
    assert kinds == ["goal", "canceled", "goal", "done", "goal"]
    with operator.loop.lock:
        operator.session.release()
    canceled(system, 2)
    wait_for(lambda: "the goal is canceled" in system.log_of("walker"), "log", PATIENCE)


@pytest.mark.slow
def test_an_operator_that_dies_stops_the_robot(system, operator):
    operator.go(1)
    wait_goal(system)
    operator.transport.close()  # nobody renews control any more
    canceled(system)


@pytest.mark.slow
def test_a_refusal_is_told_and_an_emergency_and_a_bridge_that_ends_stop_the_robot(system, operator):
    order(system, "refuse")
    wait_for(lambda: facts(system, "refuse"), "refusal", PATIENCE)
    operator.go(1)
    told = "the action server refused the goal"
    wait_for(lambda: told in system.log_of("walker"), "the failure", PATIENCE)
    order(system, "accept")
    wait_for(lambda: facts(system, "accept"), "acceptance", PATIENCE)
    operator.go(1)  # again, as nobody goes there
    assert wait_goal(system)["x"] == [1.0]
    operator.set_emergency(ROBOT)
    canceled(system)
    operator.clear_emergency(ROBOT)
    wait_for(lambda: operator.session.state is ControlState.READY, "control", PATIENCE)
    operator.go(2)
    wait_goal(system, 2)
    assert system.processes["walker"].stop() == 0
    canceled(system, 2)
