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

from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport
from jausml.runtime.services.completion import Completion
from jausml.runtime.services.definitions import Guard, ServiceIdentity, Status
from jausml.runtime.services.element_list import ListElement, chain

from .bridge_support import Process, RosPeer, free_port, generate, wait_for

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
    made = generate(tmp_path_factory.mktemp("lists"), FOLDER / "waypoint_lists.ros2jaus")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        patch.setenv("ROS_DOMAIN_ID", str(10 + os.getpid() % 90))
        for each in [*made, nav2]:
            patch.syspath_prepend(each)
        yield [*made, nav2]


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


def pass_by(system, operator, *uids):
    """Has the robot go from one element to the next ones, and after the last to the end.

    Feedback and result of a ROS action are not in order with each other: each is waited for.
    """
    for uid in (*uids, 0):
        order(system, "next")
        operator.wait_active(uid)


def wait_goal(system, number=1):
    wait_for(lambda: len(facts(system, "goal")) >= number, f"goal {number}", PATIENCE)
    return facts(system, "goal")[number - 1]


# ---------------------------------------------------------------------- JAUS list -> ROS action


def test_a_list_is_followed_to_its_end(system, operator):
    operator.give(1, 2, 3)
    operator.execute()
    goal = wait_goal(system)
    assert (goal["x"], goal["frame"], goal["loops"]) == ([1.0, 2.0, 3.0], "odom", 0)
    operator.wait_active(1)
    pass_by(system, operator, 2, 3)
    wait_for(lambda: operator.ends, "end of the command", PATIENCE)
    assert operator.seen == [0, 1, 2, 3, 0]
    assert operator.ends == [True]


def test_execution_begins_at_the_named_element(system, operator):
    operator.give(1, 2, 3)
    operator.execute(2)
    assert wait_goal(system)["x"] == [2.0, 3.0]
    operator.wait_active(2)
    pass_by(system, operator, 3)
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
    pass_by(system, operator, 3, 4)
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

    ended = len(operator.ends)

    def goes_on():
        nonlocal ended
        if len(operator.ends) == ended:  # once more when nobody was found yet
            operator.execute()
            ended += 1
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


# ---------------------------------------------------------------------- ROS action -> JAUS list

SERVICES = tuple(
    ServiceIdentity(f"urn:jaus:jss:{name}", major, minor)
    for name, major, minor in (
        ("core:Transport", 1, 1),
        ("core:Events", 1, 1),
        ("core:AccessControl", 1, 1),
        ("core:Management", 1, 1),
        ("core:ListManager", 1, 1),
        ("mobility:LocalWaypointListDriver", 1, 0),
    )
)


class Vehicle(JausComponent):
    """A list driver of JAUS; the test says which element is active."""

    def __init__(self, transport):
        super().__init__(transport, ROBOT, name="vehicle", services=SERVICES)
        from robot import messages

        self.messages = messages
        self.active = 0
        self.executed: list[tuple[int | None, float]] = []
        self.completion = Completion()
        self.handle(messages.ExecuteList, self._execute, when=Guard.READY)
        self.provide(messages.QueryActiveElement, messages.ReportActiveElement, self._report)
        self.start()

    def _execute(self, message, _sender):
        self.executed.append((message.element_uid, round(message.speed, 2)))
        self.completion = Completion()
        return self.completion

    def _report(self, _query, _sender):
        return self.messages.ReportActiveElement(element_uid=self.active)

    def reach(self, at):
        """Makes an element active, by its place in the list; None ends the execution."""
        with self.loop.lock:
            self.active = 0 if at is None else [each.uid for each in self.elements][at]
            self.report_changed(self.messages.ReportActiveElement)

    @property
    def xs(self):
        """The x of the waypoints in the list."""
        decode = self.messages.SetLocalWaypoint.decode
        return [round(decode(each.data).x, 1) for each in self.elements]

    def begun(self, number=1):
        """Waits until so many lists were to be executed."""
        wait_for(lambda: len(self.executed) >= number, f"ExecuteList {number}", PATIENCE)


class Client:
    """A ROS client of the station's action."""

    def __init__(self, peer):
        from nav2_msgs.action import NavigateThroughPoses
        from rclpy.action import ActionClient

        self.type = NavigateThroughPoses
        name = "station/navigate_through_poses"
        self.handle = ActionClient(peer.node, NavigateThroughPoses, name)
        wait_for(self.handle.server_is_ready, "the action", PATIENCE)

    def send(self, *xs):
        """Sends a goal with these x; returns it when it was answered."""
        return Goal(self, xs)

    def send_accepted(self, *xs):
        """Sends a goal until it is accepted: the station must control its peer first."""
        goals = []

        def accepted():
            goals.append(self.send(*xs))
            return goals[-1].handle.accepted

        wait_for(accepted, "acceptance", PATIENCE)
        return goals[-1]


class Goal:
    """A goal of the client: its feedback, and its result."""

    def __init__(self, client, xs):
        from geometry_msgs.msg import PoseStamped

        message = client.type.Goal()
        for x in xs:
            pose = PoseStamped()
            pose.pose.position.x = float(x)
            message.poses.append(pose)
        self.feedback: list[int] = []
        answer = client.handle.send_goal_async(message, self._progress)
        wait_for(answer.done, "answer to the goal", PATIENCE)
        self.handle = answer.result()
        self.result = self.handle.get_result_async() if self.handle.accepted else None

    def _progress(self, message):
        self.feedback.append(message.feedback.number_of_poses_remaining)

    def wait_feedback(self, *numbers):
        wait_for(lambda: self.feedback == list(numbers), f"feedback {numbers}", PATIENCE)

    def ended(self):
        """Waits for the result; returns status and reason."""
        wait_for(self.result.done, "result", PATIENCE)
        response = self.result.result()
        return response.status, response.result.error_msg


SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


@pytest.fixture
def peer(packages):
    """A node of the test, which finds nav2_msgs."""
    del packages
    made = RosPeer()
    yield made
    made.close()


@pytest.fixture
def client(system, peer):
    """A client of the station, which runs."""
    system.start_bridge("station")
    return Client(peer)


@pytest.fixture
def vehicle(system, client):
    """A vehicle that the station controls, whose action has a client."""
    del client  # it starts the station
    with running_transport(TransportSettings(port=system.port)) as transport:
        made = Vehicle(transport)
        wait_for(lambda: made.status is Status.READY, "resumption", PATIENCE)
        yield made
        if made.running:
            made.stop()


def test_a_goal_is_executed_to_its_end(vehicle, client):
    goal = client.send_accepted(1, 2, 3)
    vehicle.begun()
    assert vehicle.xs == [1.0, 2.0, 3.0]
    first = next(iter(vehicle.elements)).uid
    assert vehicle.executed == [(first, 1.5)]
    for at in range(3):
        vehicle.reach(at)
        goal.wait_feedback(*range(3, 2 - at, -1))
    vehicle.reach(None)
    assert goal.ended() == (SUCCEEDED, "")


def test_a_canceled_goal_stops_the_vehicle(vehicle, client):
    goal = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(2)
    goal.handle.cancel_goal_async()
    assert goal.ended() == (CANCELED, "canceled")
    assert vehicle.executed[1:] == [(None, 0.0)]
    assert not len(vehicle.elements)


def test_another_goal_takes_the_place_of_the_first(vehicle, client):
    first = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    first.wait_feedback(2)
    second = client.send_accepted(5, 6, 7)
    status, reason = first.ended()
    assert (status, "another goal" in reason) == (ABORTED, True)
    vehicle.begun(2)
    assert vehicle.xs == [5.0, 6.0, 7.0]
    vehicle.reach(2)
    second.wait_feedback(1)
    vehicle.reach(None)
    assert second.ended() == (SUCCEEDED, "")


def test_a_vehicle_that_stops_on_the_way_aborts_the_goal(vehicle, client):
    goal = client.send_accepted(1, 2, 3)
    vehicle.begun()
    vehicle.reach(1)
    goal.wait_feedback(2)
    vehicle.reach(None)
    status, reason = goal.ended()
    assert (status, "element 2 of 3" in reason) == (ABORTED, True)


def test_a_failure_at_the_last_element_aborts_the_goal(vehicle, client):
    goal = client.send_accepted(1)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(1)
    vehicle.completion.fail()
    assert goal.ended()[0] == ABORTED


def test_goals_that_cannot_be_executed_are_refused(system, vehicle, client):
    wait_for(lambda: client.send(1).handle.accepted, "acceptance", PATIENCE)
    assert not client.send().handle.accepted
    assert not client.send(1, 1e9).handle.accepted  # beyond what SetLocalWaypoint can say
    assert not client.send(*range(1025)).handle.accepted
    log = system.log_of("station")
    for reason in ("empty_goal", "out_of_range", "too_long"):
        assert reason in log
    with vehicle.loop.lock:
        vehicle.stop()
    wait_for(lambda: not client.send(1).handle.accepted, "refusal without a peer", PATIENCE)


def test_lost_control_aborts_the_goal(vehicle, client):
    goal = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(2)
    vehicle.set_emergency(ROBOT)
    status, reason = goal.ended()
    assert (status, bool(reason)) == (ABORTED, True)


def test_a_station_that_ends_stops_the_vehicle(system, vehicle, client):
    goal = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(2)
    assert system.processes["station"].stop() == 0
    assert goal.ended() == (ABORTED, "the bridge ends")
    wait_for(lambda: (None, 0.0) in vehicle.executed, "stop", PATIENCE)


def test_a_peer_that_dies_aborts_the_goal(system, client):
    system.start_ros_robot()
    system.start_bridge("robot")
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    goal = client.send_accepted(1, 2)
    assert wait_goal(system)["x"] == [1.0, 2.0]
    goal.wait_feedback(2)
    system.processes["robot"].kill()
    status, reason = goal.ended()
    assert (status, str(ROBOT) in reason) == (ABORTED, True)


def test_a_goal_goes_through_two_bridges(system, client):
    system.start_ros_robot()
    system.start_bridge("robot")
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    goal = client.send_accepted(1, 2, 3)
    assert wait_goal(system)["x"] == [1.0, 2.0, 3.0]
    for remaining in (3, 2, 1):
        goal.wait_feedback(*range(3, remaining - 1, -1))
        order(system, "next")
    assert goal.ended() == (SUCCEEDED, "")
    other = client.send_accepted(4)
    wait_goal(system, 2)
    other.wait_feedback(1)
    order(system, "abort")
    assert other.ended()[0] == ABORTED


# ---------------------------------------------------------------------- managed nodes


def change(peer, *transitions):
    """Has the robot's bridge make transitions of a managed node."""
    from lifecycle_msgs.srv import ChangeState

    client = peer.node.create_client(ChangeState, "/robot/robot/change_state")
    wait_for(client.service_is_ready, "service of the node", PATIENCE)
    for each in transitions:
        request = ChangeState.Request()
        request.transition.label = each
        answer = client.call_async(request)
        wait_for(answer.done, each, PATIENCE)
        assert answer.result().success, each


def test_lists_go_on_after_another_configuration(system, operator, peer):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    change(peer, "deactivate")
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    change(peer, "cleanup", "configure", "activate")
    wait_for(lambda: operator.session.state is ControlState.READY, "control", PATIENCE)
    operator.give(3, 4)
    operator.execute()
    assert wait_goal(system, 2)["x"] == [3.0, 4.0]
