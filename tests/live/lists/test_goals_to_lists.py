"""Goals of ROS actions become lists of JAUS: real processes, a real client of rclpy."""

from contextlib import suppress
from functools import partial

import needs
import pytest

needs.ask("rclpy")

from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport
from jausml.runtime.services.definitions import Completion, Guard, ServiceIdentity, Status

from ..bridge_support import RosPeer, wait_for
from .conftest import end
from .list_system import PATIENCE, ROBOT, System, facts, order, wait_goal

pytestmark = pytest.mark.live

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
            self.active = 0 if at is None else [element.uid for element in self.elements][at]
            self.report_changed(self.messages.ReportActiveElement)

    @property
    def xs(self):
        """The x of the waypoints in the list."""
        decode = self.messages.SetLocalWaypoint.decode
        return [round(decode(element.data).x, 1) for element in self.elements]

    def begun(self, number=1):
        """Waits until so many lists were to be executed."""
        wait_for(lambda: len(self.executed) >= number, f"ExecuteList {number}", PATIENCE)


class Client:
    """A ROS client of the station's action."""

    def __init__(self, peer):
        from nav2_msgs.action import NavigateThroughPoses
        from rclpy.action import ActionClient

        self.type = NavigateThroughPoses
        self.peer = peer
        name = "station/navigate_through_poses"
        self.handle = ActionClient(peer.node, NavigateThroughPoses, name)
        wait_for(self.handle.server_is_ready, "the action", PATIENCE)
        self._be_known()

    def _be_known(self):
        """Asks for the end of a goal that is none, until that is answered.

        Fast DDS loses an answer to a client that the server has not met yet. What takes answers to
        goals was announced before what takes this one.
        """
        from rclpy.action.client import ClientGoalHandle
        from unique_identifier_msgs.msg import UUID

        response = self.type.Impl.SendGoalService.Response()
        none = ClientGoalHandle(self.handle, UUID(uuid=[1] * 16), response)

        def answered():
            answer = self.peer.on_executor(partial(self.handle._cancel_goal_async, none))
            with suppress(AssertionError):
                wait_for(answer.done, "answer", 1)
            return answer.done()

        wait_for(answered, "answer of the action", PATIENCE)

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
        send = partial(client.handle.send_goal_async, message, self._progress)
        answer = client.peer.on_executor(send)
        wait_for(answer.done, "answer to the goal", PATIENCE)
        self.handle = answer.result()
        self.result = None
        if self.handle.accepted:
            self.result = client.peer.on_executor(self.handle.get_result_async)

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


@pytest.fixture(scope="module")
def whole(tmp_path_factory, packages):
    """A system and a node beside it, which serve all tests."""
    system, peer = System(tmp_path_factory.mktemp("goals"), packages), RosPeer()
    yield system, peer
    peer.close()
    end(system)


@pytest.fixture
def system(whole):
    system, _ = whole
    system.begin()
    return system


@pytest.fixture
def client(system, whole):
    """A client of the station, which runs."""
    if not system.processes:
        system.start_bridge("station")
    _, peer = whole
    made = Client(peer)
    yield made
    made.handle.destroy()


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


@pytest.mark.slow
def test_a_vehicle_that_stops_on_the_way_aborts_the_goal(vehicle, client):
    goal = client.send_accepted(1, 2, 3)
    vehicle.begun()
    vehicle.reach(1)
    goal.wait_feedback(2)
    vehicle.reach(None)
    status, reason = goal.ended()
    assert (status, "element 2 of 3" in reason) == (ABORTED, True)


@pytest.mark.slow
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


@pytest.mark.slow
def test_lost_control_aborts_the_goal(vehicle, client):
    goal = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(2)
    vehicle.set_emergency(ROBOT)
    status, reason = goal.ended()
    assert (status, bool(reason)) == (ABORTED, True)


@pytest.mark.slow
def test_a_station_that_ends_stops_the_vehicle(system, vehicle, client):
    system.lasts = False
    goal = client.send_accepted(1, 2)
    vehicle.begun()
    vehicle.reach(0)
    goal.wait_feedback(2)
    assert system.processes["station"].stop() == 0
    assert goal.ended() == (ABORTED, "the bridge ends")
    wait_for(lambda: (None, 0.0) in vehicle.executed, "stop", PATIENCE)


@pytest.mark.slow
def test_a_peer_that_dies_aborts_the_goal(system, client):
    system.lasts = False
    system.start_ros_robot()
    system.start_bridge("robot")
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    goal = client.send_accepted(1, 2)
    assert wait_goal(system)["x"] == [1.0, 2.0]
    goal.wait_feedback(2)
    system.processes["robot"].kill()
    status, reason = goal.ended()
    assert (status, str(ROBOT) in reason) == (ABORTED, True)


@pytest.mark.slow
def test_a_goal_goes_through_two_bridges(system, client):
    system.lasts = False
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


@pytest.mark.slow
def test_goals_are_missions_of_a_spooler(system, whole):
    system.lasts = False
    system.close()
    system.start_ros_robot()
    for name in ("spooler", "dispatcher"):
        system.start_bridge(name)
    client = Client(whole[1])
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    goal = client.send_accepted(1, 2, 3)
    assert wait_goal(system)["x"] == [1.0, 2.0, 3.0]
    for remaining in (3, 2, 1):
        goal.wait_feedback(*range(3, remaining - 1, -1))
        order(system, "next")
    assert goal.ended() == (SUCCEEDED, "")
    canceled = client.send_accepted(4, 5)
    assert wait_goal(system, 2)["x"] == [4.0, 5.0]
    canceled.wait_feedback(2)
    canceled.handle.cancel_goal_async()
    assert canceled.ended() == (CANCELED, "canceled")
    wait_for(lambda: facts(system, "canceled"), "standstill", PATIENCE)
    # The mission that is paused makes room for the next one.
    failed = client.send_accepted(6)
    assert wait_goal(system, 3)["x"] == [6.0]
    failed.wait_feedback(1)
    order(system, "abort")
    status, reason = failed.ended()
    assert (status, "ended the mission at 1 of 1" in reason) == (ABORTED, True)
