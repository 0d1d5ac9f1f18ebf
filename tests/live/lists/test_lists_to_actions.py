"""Lists of JAUS become goals of ROS actions: real processes, a real action server of rclpy."""

import os
import signal

import needs
import pytest
from guardians import guardian_of

needs.ask("rclpy")

from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.services.list_elements import ListElement
from jausml.runtime.services.list_manager import chain

from ..bridge_support import wait_for
from .conftest import controlling, end, operator_of
from .list_system import PATIENCE, ROBOT, System, facts, order, pass_by, wait_goal

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def system(tmp_path_factory, packages):
    """One whose processes serve all tests that do not end them."""
    made = System(tmp_path_factory.mktemp("lists"), packages)
    yield made
    end(made)


@pytest.fixture
def operator(system):
    """An operator in control of the robot's bridge, whose action server is there."""
    system.begin()
    if system.processes:
        yield from controlling(system, "robot")
    else:
        system.start_ros_robot()
        yield from operator_of(system, "robot")


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


@pytest.fixture
def fresh(system):
    """Has processes that run already serve no further test."""
    system.lasts = False


@pytest.mark.slow
@pytest.mark.usefixtures("fresh")
def test_speed_and_waypoint_are_told_before_while_and_after_it_drives(system, operator):
    # No waypoint is told that nobody has set.
    assert (operator.asked_speed(), operator.asked_x()) == (0.0, None)
    operator.give(1, 2)
    assert (operator.asked_speed(), operator.asked_x()) == (0.0, 1.0)
    operator.execute(speed=1.5)
    wait_goal(system)
    operator.wait_active(1)
    assert (operator.asked_speed(), operator.asked_x()) == (1.5, 1.0)
    pass_by(system, operator, 2)
    wait_for(lambda: operator.ends, "end of the command", PATIENCE)
    assert (operator.asked_speed(), operator.asked_x()) == (0.0, 2.0)


@pytest.mark.slow
def test_an_abort_is_told_and_so_is_a_goal_that_is_refused(system, operator):
    operator.give(1)
    operator.execute()
    operator.wait_active(1)  # the last one
    wait_goal(system)
    order(system, "abort")
    operator.wait_active(0)
    wait_for(lambda: operator.ends == [False], "the failure", PATIENCE)
    assert "the wheels came off" in system.log_of("robot")
    order(system, "refuse")
    wait_for(lambda: facts(system, "refuse"), "refusal", PATIENCE)
    count = 255
    operator.give(*range(1, count + 1))
    operator.execute()
    wait_for(lambda: operator.ends == [False, False], "the failure", PATIENCE)
    operator.wait_active(0)
    order(system, "accept")
    wait_for(lambda: facts(system, "accept"), "acceptance", PATIENCE)
    operator.execute()
    assert wait_goal(system, 2)["x"] == [float(number) for number in range(1, count + 1)]


@pytest.mark.slow
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
    # The first command was replaced at its target by the second, which is the same.
    wait_for(lambda: operator.ends == [False, True], "end", PATIENCE)


@pytest.mark.slow
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


@pytest.mark.slow
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
    wait_for(lambda: operator.asked_speed() == 0.5, "the other speed", PATIENCE)


@pytest.mark.slow
def test_a_robot_without_its_controller_stands(system, operator):
    system.lasts = False
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    with operator.loop.lock:
        operator.session.release()
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    operator.wait_active(0)
    wait_for(lambda: "the goal is canceled" in system.log_of("robot"), "log", PATIENCE)


@pytest.mark.slow
def test_an_operator_that_dies_stops_the_robot(system, operator):
    system.lasts = False
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    operator.transport.close()  # nobody renews control any more
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


def test_emergency_stops_the_robot(system, operator):
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    operator.set_emergency(ROBOT)
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


@pytest.mark.slow
def test_a_bridge_that_ends_stops_the_robot(system, operator):
    system.lasts = False
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    assert system.processes["robot"].stop() == 0
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)


@pytest.mark.slow
@pytest.mark.usefixtures("announced_as_by_default")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_guardian_stops_the_robot_of_a_bridge_that_cannot(system, operator, number):
    system.lasts = False
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    robot = system.processes["robot"].popen
    robot.send_signal(number)
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    assert "1 goal" in system.log_of("robot")
    if number == signal.SIGSTOP:
        robot.send_signal(signal.SIGCONT)
        wait_for(lambda: is_over(system.log_of("robot")), "log", PATIENCE)
        # It goes on when it is told to, and is guarded again.
        operator.execute()
        assert wait_goal(system, 2)["x"] == [1.0, 2.0]


def is_over(log):
    """Whether a bridge that stood still has noticed: by the end of the goal, or by silence."""
    return "the goal is canceled" in log or "bridge.follow.lost" in log


@pytest.mark.slow
def test_a_bridge_that_starts_again_cancels_the_goal_of_its_former_life(system, operator):
    system.lasts = False
    operator.give(1, 2)
    operator.execute()
    wait_goal(system)
    bridge = system.processes["robot"]
    os.kill(guardian_of(bridge.popen.pid), signal.SIGKILL)
    bridge.kill()
    assert not facts(system, "canceled")
    system.start_bridge("robot")
    wait_for(lambda: facts(system, "canceled"), "cancellation", PATIENCE)
    assert "a goal of a former life is cancelled" in system.log_of("robot")
    # Its own goals are no former ones.
    operator.wait_active(0)
    wait_for(lambda: operator.session.state is ControlState.READY, "control", PATIENCE)
    operator.give(3)
    operator.execute()
    assert wait_goal(system, 2)["x"] == [3.0]


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_an_action_server_that_dies_is_noticed(system, operator):
    system.lasts = False
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


@pytest.mark.slow
def test_a_circular_list_goes_round(system, operator):
    contents = [(uid, operator.waypoint(uid), 0) for uid in (1, 2)]
    assert operator.set(chain(contents, circular=True))
    operator.execute(2)
    assert wait_goal(system)["x"] == [2.0]
    order(system, "next")
    assert wait_goal(system, 2)["x"] == [1.0, 2.0]
    order(system, "next", "next")
    assert wait_goal(system, 3)["x"] == [1.0, 2.0]
    assert operator.seen[:3] == [0, 2, 1]
    assert 0 not in operator.seen[1:]


def change(peer, *transitions):
    """Has the robot's bridge make transitions of a managed node."""
    from lifecycle_msgs.srv import ChangeState

    client = peer.node.create_client(ChangeState, "/robot/robot/change_state")
    wait_for(client.service_is_ready, "service of the node", PATIENCE)
    for transition in transitions:
        request = ChangeState.Request()
        request.transition.label = transition
        answer = client.call_async(request)
        wait_for(answer.done, transition, PATIENCE)
        assert answer.result().success, transition


@pytest.mark.slow
def test_lists_go_on_after_another_configuration(system, operator, peer):
    system.lasts = False
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
