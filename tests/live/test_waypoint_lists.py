"""Lists of JAUS and actions of ROS: real processes, real action servers and clients of rclpy.

The robot is told by the test when it has reached a waypoint, so everything happens in an order.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy")

from type_support import CannotBuildError, built
from workspaces import packages_of

from jausml.generation import render
from jausml.generators.bridge.target import TARGET as BRIDGE
from jausml.generators.messages.target import TARGET as MESSAGES
from jausml.generators.runtime.target import TARGET as RUNTIME
from jausml.model import read_models
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport
from jausml.runtime.services.element_list import ListElement, chain
from jausml.text.notation import NOTATIONS

from .bridge_support import Process, free_port, wait_for

pytestmark = [
    pytest.mark.live,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

FOLDER = Path(__file__).resolve().parent
ROBOT, STATION = JausAddress(10, 1, 1), JausAddress(10, 1, 2)
OPERATOR = JausAddress(10, 1, 9)
TYPES = (
    "msg/MissedWaypoint.msg",
    "action/FollowWaypoints.action",
    "action/NavigateThroughPoses.action",
)
PATIENCE = 60.0


@pytest.fixture(scope="session")
def nav2():
    """The module path of nav2_msgs."""
    try:
        return str(built("nav2_msgs", TYPES))
    except CannotBuildError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def packages(tmp_path_factory, nav2):
    """The module path of the generated bridges, of their messages, and of nav2_msgs."""
    folder = tmp_path_factory.mktemp("lists")
    model = read_models([FOLDER / "waypoint_lists.ros2jaus"], notations=NOTATIONS).model
    for artifact in render(model, [BRIDGE, MESSAGES, RUNTIME]):
        path = folder / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        patch.setenv("ROS_DOMAIN_ID", str(10 + os.getpid() % 90))
        for each in [*packages_of(folder), nav2]:
            patch.syspath_prepend(each)
        yield [*packages_of(folder), nav2]


class Operator(JausComponent):
    """Controls the robot and gives it lists."""

    def __init__(self, transport, address=OPERATOR, authority=200):
        super().__init__(transport, address, name="operator", services=())
        from robot import messages

        self.messages = messages
        self.session = self.control(ROBOT, authority=authority)
        self.seen: list[int] = []  # what the active element was, in order
        self.ends: list[bool] = []
        self.refusals: list[int | None] = []
        self.subscribe(
            ROBOT, messages.QueryActiveElement(), messages.ReportActiveElement, self._active
        )
        self.start()

    def _active(self, report, _sender):
        if self.seen[-1:] != [report.element_uid]:  # an event that is renewed says it again
            self.seen.append(report.element_uid)

    def ready(self):
        wait_for(lambda: self.session.state is ControlState.READY, "control", PATIENCE)
        wait_for(lambda: self.seen == [0], "event of the active element", PATIENCE)

    def waypoint(self, x):
        return self.messages.SetLocalWaypoint(x=float(x), y=0.0).encode()

    def set(self, elements):
        """Sets a list and waits for the answer; True when it was confirmed."""
        answers = []
        with self.loop.lock:
            self.set_list(
                ROBOT,
                elements,
                on_done=lambda: answers.append(True),
                on_refused=lambda code: (self.refusals.append(code), answers.append(False)),
            )
        wait_for(lambda: answers, "answer to the list", PATIENCE)
        return answers[0]

    def append(self, element):
        """Sends one SetElement, which changes the list that is there."""
        record = core.SetElement.ElementRec(
            element.uid,
            element.previous_uid,
            element.next_uid,
            core.SetElement.ElementData(element.data_format, element.data),
        )
        self.send(core.SetElement(element_list=[record]), ROBOT, acknowledge=True)

    def give(self, *xs, first=1):
        """Sets a list of waypoints with these x."""
        contents = [(uid, self.waypoint(x), 0) for uid, x in enumerate(xs, first)]
        assert self.set(chain(contents))

    def execute(self, uid: int | None = 0, speed: float = 1.0):
        """Sends ExecuteList as a command whose end is told."""
        message = self.messages.ExecuteList(speed=speed, element_uid=uid)
        with self.loop.lock:
            self.command(ROBOT, message, on_done=self.ends.append, max_duration=3600)

    def wait_active(self, uid):
        wait_for(lambda: self.seen[-1] == uid, f"active element {uid}", PATIENCE)


class System:
    """The processes and components of one test."""

    def __init__(self, folder, packages):
        self.folder = folder
        self.packages = packages
        self.port = free_port()
        self.processes: dict[str, Process] = {}

    def _start(self, name, arguments, **more):
        process = Process(arguments, self.packages, self.folder / f"{name}.log", **more)
        self.processes[name] = process
        return process

    def start_bridge(self, name):
        line = ["--jaus-port", str(self.port)]
        return self._start(name, ["-m", f"{name}.main", *line])

    def start_ros_robot(self):
        robot = self._start("ros", [str(FOLDER / "list_robot.py")], stdin=True)
        wait_for(lambda: robot.of_kind("ready"), "the robot", PATIENCE)
        return robot

    def log_of(self, name):
        return self.processes[name].log.read_text(errors="replace")

    def close(self):
        for process in self.processes.values():
            process.close()


@pytest.fixture
def system(tmp_path, packages):
    made = System(tmp_path, packages)
    yield made
    for name in made.processes:
        sys.stderr.write(f"--- {name}\n{made.log_of(name)}\n")
    made.close()


@pytest.fixture
def operator(system):
    """An operator in control of the robot's bridge, whose action server is there."""
    system.start_ros_robot()
    system.start_bridge("robot")
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    settings = TransportSettings(port=system.port)
    with running_transport(settings) as transport:
        made = Operator(transport)
        made.ready()
        yield made
        made.stop()


def facts(system, *kinds):
    return system.processes["ros"].of_kind(*kinds)


def order(system, *words):
    for word in words:
        system.processes["ros"].tell(word)


def wait_goal(system, number=1):
    wait_for(lambda: len(facts(system, "goal")) >= number, f"goal {number}", PATIENCE)
    return facts(system, "goal")[number - 1]


# ---------------------------------------------------------------------- JAUS list -> ROS action


def test_a_list_is_followed_to_its_end(system, operator):
    operator.give(1, 2, 3)
    operator.execute()
    goal = wait_goal(system)
    assert (goal["x"], goal["frame"], goal["loops"]) == ([1.0, 2.0, 3.0], "odom", 0)
    for uid in (1, 2, 3):
        operator.wait_active(uid)
        order(system, "next")
    operator.wait_active(0)
    wait_for(lambda: operator.ends, "end of the command", PATIENCE)
    assert operator.seen == [0, 1, 2, 3, 0]
    assert operator.ends == [True]


def test_execution_begins_at_the_named_element(system, operator):
    operator.give(1, 2, 3)
    operator.execute(2)
    assert wait_goal(system)["x"] == [2.0, 3.0]
    operator.wait_active(2)
    order(system, "next", "next")
    operator.wait_active(0)
    assert operator.seen == [0, 2, 3, 0]


def test_an_abort_is_told_though_the_last_element_was_active(system, operator):
    operator.give(1)
    operator.execute()
    operator.wait_active(1)
    wait_goal(system)
    order(system, "abort")
    operator.wait_active(0)
    wait_for(lambda: operator.ends == [False], "the failure", PATIENCE)
    assert "the wheels came off" in system.log_of("robot")


def test_a_refused_goal_ends_the_list(system, operator):
    order(system, "refuse")
    wait_for(lambda: facts(system, "refuse"), "refusal", PATIENCE)
    operator.give(1, 2)
    operator.execute()
    wait_for(lambda: operator.ends == [False], "the failure", PATIENCE)
    operator.wait_active(0)
    order(system, "accept")
    wait_for(lambda: facts(system, "accept"), "acceptance", PATIENCE)
    operator.execute()
    assert wait_goal(system)["x"] == [1.0, 2.0]


def test_another_list_takes_the_place_of_the_first(system, operator):
    operator.give(1, 2, 3)
    operator.execute()
    wait_goal(system)
    order(system, "next")
    operator.wait_active(2)
    operator.execute(1)
    assert wait_goal(system, 2)["x"] == [1.0, 2.0, 3.0]
    kinds = [fact["kind"] for fact in facts(system, "goal", "canceled")]
    assert kinds == ["goal", "canceled", "goal"]
    order(system, "next", "next", "next")
    operator.wait_active(0)
    wait_for(lambda: operator.ends == [True], "end", PATIENCE)


def test_a_changed_list_is_followed_from_the_active_element(system, operator):
    operator.give(1, 2, 3)
    operator.execute()
    wait_goal(system)
    order(system, "next")
    operator.wait_active(2)
    operator.append(ListElement(4, 3, 0, operator.waypoint(7)))
    assert wait_goal(system, 2)["x"] == [2.0, 3.0, 7.0]
    order(system, "next", "next", "next")
    operator.wait_active(0)
    assert operator.seen == [0, 1, 2, 3, 4, 0]


def test_deleting_the_list_stops_the_robot(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    with operator.loop.lock:
        operator.delete_elements(ROBOT, [65535])
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    operator.wait_active(0)
    assert operator.ends == [False]


def test_speed_zero_holds_and_another_speed_goes_on(system, operator):
    operator.give(1, 2, 3)
    operator.execute()
    wait_goal(system)
    order(system, "next")
    operator.wait_active(2)
    operator.execute(None, 0.0)
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    assert operator.seen[-1] == 2
    operator.execute(None, 0.5)
    assert wait_goal(system, 2)["x"] == [2.0, 3.0]


def test_a_robot_without_its_controller_stands(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    with operator.loop.lock:
        operator.session.release()
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    operator.wait_active(0)
    wait_for(lambda: "the goal is canceled" in system.log_of("robot"), "log", PATIENCE)


def test_an_operator_that_dies_stops_the_robot(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    operator.transport.detach(operator.address)  # nobody renews control any more
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


def test_emergency_stops_the_robot(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    operator.set_emergency(ROBOT)
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


def test_a_bridge_that_ends_stops_the_robot(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    assert system.processes["robot"].stop() == 0
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_an_action_server_that_dies_is_noticed(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    system.processes["ros"].kill()
    # ROS takes a participant for dead when it has said nothing for its lease, 20 s.
    wait_for(lambda: operator.seen[-1] == 0, "end of the list", 90.0)
    assert operator.ends == [False]
    assert "gone" in system.log_of("robot")
    operator.execute()
    wait_for(lambda: len(operator.ends) == 2, "second failure", PATIENCE)
    system.start_ros_robot()

    def goes_on():
        operator.execute()
        return facts(system, "goal")

    wait_for(goes_on, "goal of the new server", 60.0)


def test_hostile_lists_are_refused(system, operator):
    wrong = operator.messages.ExecuteList(speed=1.0).encode()
    assert not operator.set(chain([(1, wrong, 0)]))
    assert not operator.set(chain([(1, operator.waypoint(1)[:5], 0)]))
    assert not operator.set(chain([(1, b"\x01", 0)]))
    assert not operator.set(chain([(1, operator.waypoint(1), 1)]))
    assert operator.refusals == [4, 4, 4, 4]
    operator.execute()  # of an empty list
    wait_for(lambda: operator.ends == [False], "refusal", PATIENCE)
    operator.give(1, 2)
    operator.execute(7)
    wait_for(lambda: operator.ends == [False, False], "refusal", PATIENCE)
    assert operator.seen == [0]
    assert not facts(system, "goal")


def test_a_long_list_is_followed(system, operator):
    count = 255
    operator.give(*range(1, count + 1))
    operator.execute()
    assert wait_goal(system)["x"] == [float(each) for each in range(1, count + 1)]


def test_a_circular_list_goes_round(system, operator):
    contents = [(uid, operator.waypoint(uid), 0) for uid in (1, 2)]
    assert operator.set(chain(contents, circular=True))
    operator.execute(2)
    assert wait_goal(system)["x"] == [2.0]
    order(system, "next")
    assert wait_goal(system, 2)["x"] == [1.0, 2.0]
    order(system, "next", "next")
    assert wait_goal(system, 3)["x"] == [1.0, 2.0]
    assert 0 not in operator.seen[1:]
