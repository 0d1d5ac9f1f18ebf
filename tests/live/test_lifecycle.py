"""A bridge as a managed node: transitions by real services, and what JAUS and ROS see of each."""

import needs
import pytest
from ports import free_domain

needs.ask("rclpy")

from .bridge_support import Repeater, generate, wait_for
from .test_bridge_live import OPERATOR, System, call, efforts, twist

pytestmark = pytest.mark.live

MANUAL = ("-m", "loop_bridge.main", "--ros-args", "-p", "autostart:=false", "--")


@pytest.fixture(scope="module")
def path():
    return generate()


@pytest.fixture
def system(path, tmp_path, request, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    arguments = getattr(request, "param", ("-m", "loop_bridge.main"))
    with System(path, tmp_path, bridge=arguments) as started:
        yield started


def lifecycle(system):
    """The state that `ros2 lifecycle get` shows."""
    from lifecycle_msgs.srv import GetState

    return call(system, GetState, "get_state", GetState.Request()).current_state.label


def change(system, name):
    """Whether a transition succeeded, as `ros2 lifecycle set` asks for it."""
    from lifecycle_msgs.srv import ChangeState

    request = ChangeState.Request()
    request.transition.label = name
    return call(system, ChangeState, "change_state", request).success


def subscriptions(system):
    return system.ros.node.count_subscribers("cmd_vel")


def is_stopped(system):
    return efforts(system.vehicle)[-1]["rotational"] is None


@pytest.mark.slow
@pytest.mark.parametrize("system", [MANUAL], indirect=True)
def test_it_waits_for_its_manager(system):
    wait_for(lambda: lifecycle(system) == "unconfigured", "unconfigured state")
    assert subscriptions(system) == 0
    assert not change(system, "activate")
    assert change(system, "configure")
    assert lifecycle(system) == "inactive"
    wait_for(lambda: subscriptions(system) == 1, "subscription")
    wait_for(lambda: system.ros.values("jaus state")["node"] == "inactive", "status")
    assert not system.vehicle.of_kind("effort")
    assert change(system, "activate")
    drive(system)


def drive(system):
    """Sends commands until the vehicle drives."""
    from geometry_msgs.msg import Twist

    known = len(efforts(system.vehicle))
    with Repeater(system.ros.publisher(Twist, "cmd_vel", 1), twist(1.0, 0.5)):
        wait_for(lambda: len(efforts(system.vehicle)) > known and not is_stopped(system), "command")
        yield_to = len(efforts(system.vehicle))
        wait_for(lambda: len(efforts(system.vehicle)) > yield_to, "more commands")


@pytest.mark.slow
def test_it_becomes_active_by_itself_and_what_is_not_possible_then_ends_nothing(system):
    from lifecycle_msgs.srv import ChangeState
    from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
    from rcl_interfaces.srv import SetParameters, SetParametersAtomically

    wait_for(lambda: lifecycle(system) == "active", "active state")
    wait_for(lambda: system.ros.values("jaus state")["node"] == "active", "status")
    assert system.ros.values("jaus state") == {
        "node": "active",
        "jaus": "standby",
        "controller": "none",
    }
    for number in (1, 3, 2, 99):  # configure, activate, clean up, nothing that there is
        request = ChangeState.Request()
        request.transition.id = number
        assert not call(system, ChangeState, "change_state", request).success
    assert not change(system, "activate")
    assert not change(system, "no such transition")
    known = Parameter(
        name="latency", value=ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=False)
    )
    strange = Parameter(name="latency", value=ParameterValue(type=99))
    request = SetParameters.Request(parameters=[known, strange, known])
    results = call(system, SetParameters, "set_parameters", request).results
    assert [result.successful for result in results] == [True, False, False]
    assert "99" in results[1].reason
    request = SetParametersAtomically.Request(parameters=[known, strange])
    answer = call(system, SetParametersAtomically, "set_parameters_atomically", request)
    assert not answer.result.successful
    assert lifecycle(system) == "active"
    drive(system)
    assert system.bridge.stop() == 0
    assert "ros.request_refused" in system.bridge.log.read_text()
    assert "Traceback" not in system.bridge.log.read_text()


def test_inactive_stops_and_passes_nothing_either_way(system):
    from geometry_msgs.msg import Twist, TwistStamped
    from nav_msgs.msg import Odometry

    odometry = system.ros.listen(Odometry, "odometry_copy")
    cruise = system.ros.listen(TwistStamped, "cruise")
    operator = system.start(OPERATOR)
    wait_for(lambda: cruise and cruise[-1].twist.linear.x > 0, "command of the operator")
    wait_for(lambda: odometry, "odometry")
    with Repeater(system.ros.publisher(Twist, "cmd_vel", 1), twist(1.0, 0.5)):
        wait_for(lambda: efforts(system.vehicle) and not is_stopped(system), "command")
        assert change(system, "deactivate")
        wait_for(lambda: is_stopped(system), "stop of the vehicle")
        wait_for(lambda: cruise[-1].twist.linear.x == 0.0, "stop on the topic")
        wait_for(lambda: system.ros.values("jaus state")["node"] == "inactive", "status")
        assert system.ros.values("jaus state") == {
            "node": "inactive",
            "jaus": "standby",
            "controller": "none",
        }
        known, reports = len(efforts(system.vehicle)), len(odometry)
        wait_for(lambda: system.ros.status("drive").message == "the bridge is inactive", "reason")
        assert len(efforts(system.vehicle)) == known
        assert len(odometry) == reports
        # The operator goes on asking for control, and gets it when there is some to have.
        assert change(system, "activate")
        wait_for(lambda: not is_stopped(system), "command after activation")
        wait_for(lambda: len(odometry) > reports, "odometry after activation")
        wait_for(lambda: cruise[-1].twist.linear.x > 0, "command of the operator")
        wait_for(lambda: system.ros.values("jaus state")["jaus"] == "ready", "status")
        assert system.ros.values("jaus state")["controller"] != "none"
    assert operator.stop() == 0


@pytest.mark.slow
def test_cleanup_gives_all_back_until_it_is_configured_again_or_shut_down(system):
    for _ in range(2):
        wait_for(lambda: subscriptions(system) == 1, "subscription")
        drive(system)
        assert change(system, "deactivate")
        wait_for(lambda: is_stopped(system), "stop")
        assert change(system, "cleanup")
        assert lifecycle(system) == "unconfigured"
        wait_for(lambda: subscriptions(system) == 0, "end of the subscription")
        assert change(system, "configure")
        assert change(system, "activate")
        system.ros._publishers.clear()
    drive(system)
    assert change(system, "shutdown")  # which ends the process
    assert system.bridge.popen.wait(timeout=20) == 0
    wait_for(lambda: is_stopped(system), "stop")
    assert "Traceback" not in system.bridge.log.read_text()
