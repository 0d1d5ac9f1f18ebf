"""A generated bridge between real JAUS components and real ROS nodes, in both directions."""

from pathlib import Path

import needs
import pytest
from ports import free_domain

needs.ask("rclpy")

from . import bridge_support
from .bridge_support import Repeater, generate, wait_for

pytestmark = pytest.mark.live

FOLDER = Path(__file__).resolve().parent
VEHICLE, OPERATOR = str(FOLDER / "bridge_vehicle.py"), str(FOLDER / "bridge_operator.py")


@pytest.fixture(scope="module")
def path():
    return generate()


@pytest.fixture(scope="module")
def system(path, tmp_path_factory):
    with System(path, tmp_path_factory.mktemp("logs")) as started:
        started.trailer = started.start(VEHICLE, "--address", "10.1.2")
        yield started


class System(bridge_support.System):
    """The bridge and the vehicle."""

    def __init__(self, path, logs, bridge=("-m", "loop_bridge.main")):
        super().__init__(path, logs)
        self.bridge = self.start(*bridge)
        self.vehicle = self.start(VEHICLE, "--address", "10.1.1")


def efforts(vehicle, since=0):
    return vehicle.of_kind("effort")[since:]


def commands(vehicle):
    """Efforts that came from the topic; the safe value has no rotational effort."""
    return [effort for effort in efforts(vehicle) if effort["rotational"] is not None]


def twist(linear=0.0, angular=0.0):
    from geometry_msgs.msg import Twist

    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


def test_event_to_topics(system):
    from nav_msgs.msg import Odometry
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Float64

    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    odometry = system.ros.listen(Odometry, "odometry", best_effort)
    copy = system.ros.listen(Odometry, "odometry_copy")
    speed = system.ros.listen(Float64, "speed")
    wait_for(lambda: len(odometry) > 3 and len(copy) > 3 and len(speed) > 3, "velocity")
    linear, angular = odometry[-1].twist.twist.linear, odometry[-1].twist.twist.angular
    assert linear.x == pytest.approx(2.0, abs=1e-6)
    assert linear.y == pytest.approx(-0.5, abs=1e-6)  # right in JAUS is minus left in ROS
    assert angular.z == pytest.approx(-0.25, abs=1e-3)  # a right turn
    assert odometry[-1].header.frame_id == copy[-1].header.frame_id == "odom"
    assert speed[-1].data == pytest.approx(2.0, abs=1e-6)


def test_query_to_topics(system):
    from geometry_msgs.msg import PoseStamped

    pose = system.ros.listen(PoseStamped, "pose")
    wait_for(lambda: len(pose) > 2, "pose")
    position, orientation = pose[-1].pose.position, pose[-1].pose.orientation
    assert (position.x, position.y) == pytest.approx((1.0, -2.0), abs=1e-4)
    # Yaw 1 rad to the right is a turn by -1 rad about the z axis of ROS.
    assert orientation.z == pytest.approx(-0.4794, abs=1e-3)
    assert orientation.w == pytest.approx(0.8776, abs=1e-3)
    assert pose[-1].header.stamp.sec > 0


def test_topic_to_commands_under_control(system):
    from geometry_msgs.msg import Twist

    publisher = system.ros.publisher(Twist, "cmd_vel", 1)
    with Repeater(publisher, twist(3.0, 0.25)):
        for peer in (system.vehicle, system.trailer):
            command = wait_for(lambda peer=peer: commands(peer), "command")[-1]
            assert peer.of_kind("ready")  # control was acquired and the component resumed
            assert command["linear"] == pytest.approx(30.0, abs=0.01)
            assert command["rotational"] == pytest.approx(-25.0, abs=0.01)
            assert command["sender"] == "10.1.9"


def test_fan_out_costs_nothing_on_the_other_side(system):
    from nav_msgs.msg import Odometry

    # Two connections and three topics of one report: the vehicle reports once for all of them.
    odometry = system.ros.listen(Odometry, "odometry_copy")
    wait_for(lambda: odometry, "odometry")
    before, reports = len(odometry), len(system.vehicle.of_kind("report"))
    wait_for(lambda: len(odometry) >= before + 20, "odometry")
    assert len(system.vehicle.of_kind("report")) - reports < 30
    # Two vehicles that obey one topic: one subscription.
    assert system.ros.node.count_subscribers("cmd_vel") == 1


def test_query_selects_the_fields_that_are_used(system):
    wait_for(lambda: system.vehicle.of_kind("report"), "report")
    # Velocity_X, Velocity_Y, YawRate, TimeStamp.
    assert {fact["presence"] for fact in system.vehicle.of_kind("report")} == {0x0143}


def test_silent_topic_becomes_the_safe_value(system):
    from geometry_msgs.msg import Twist

    publisher = system.ros.publisher(Twist, "cmd_vel", 1)
    with Repeater(publisher, twist(1.0, 0.5)):
        wait_for(lambda: commands(system.vehicle), "command")
    wait_for(lambda: efforts(system.vehicle)[-1]["rotational"] is None, "safe value")
    last = efforts(system.vehicle)[-1]
    assert last["linear"] == pytest.approx(0.0, abs=0.01)
    count = len(efforts(system.vehicle))
    with Repeater(publisher, twist(2.0, 0.5)):
        recovered = wait_for(lambda: efforts(system.vehicle, count), "command after silence")
    # Exactly one safe value was sent: what follows it is the recovered command.
    assert recovered[0]["linear"] == pytest.approx(20.0, abs=0.01)


def test_diagnostics_name_each_connection(system):
    from diagnostic_msgs.msg import DiagnosticArray

    arrays = system.ros.listen(DiagnosticArray, "/diagnostics")
    wait_for(lambda: len(arrays) > 2, "diagnostics")
    statuses = {status.name.rpartition(": ")[2]: status for status in arrays[-1].status}
    accounts = [status for status in statuses if status.startswith("account of ")]
    assert {"account of 10.1.1", "account of 10.1.2"} <= set(accounts)
    counts = {value.key: value.value for value in statuses["account of 10.1.1"].values}
    assert int(counts["came"]) > 0
    assert int(counts["sent to it"]) > 0
    assert [status for status in statuses if status not in accounts] == [
        *("odometry", "speed", "pose", "drive", "cruise", "estimate"),
        *("jaus state", "guardian"),
    ]
    assert statuses["guardian"].message == "watches 2 connections, 0 goals"
    odometry = {value.key: value.value for value in statuses["odometry"].values}
    assert float(odometry["declared rate (Hz)"]) == 20.0
    assert int(odometry["messages passed"]) > 0
    assert odometry["peer 10.1.1"] == "confirmed"
    assert odometry["translation"] in ("light classes", "ROS classes", "compiled")
    assert not [key for key in odometry if key.startswith("in the bridge")]
    drive = {value.key: value.value for value in statuses["drive"].values}
    assert drive["peer 10.1.1"] == drive["peer 10.1.2"] == "ready"
    assert statuses["cruise"].level == b"\x03"  # nobody commands: stale


def call(system, service, name, request):
    """The answer of a service of the bridge's node."""
    return system.ros.call(service, f"/loop_bridge/{name}", request)


def test_latency_is_measured_on_a_running_bridge(system):
    from diagnostic_msgs.msg import DiagnosticArray

    def measure(wanted):
        assert system.ros.set_parameter("/loop_bridge", "latency", wanted).successful

    def latency():
        """Keys of the latest status of each connection."""
        return {
            status.name.rpartition(": ")[2]: {
                key.key for key in status.values if key.key.endswith((" p50 (us)", " max (us)"))
            }
            for status in arrays[-1].status
        }

    arrays = system.ros.listen(DiagnosticArray, "/diagnostics")
    wait_for(lambda: arrays, "diagnostics")
    assert not any(latency().values())
    measure(wanted=True)
    expected = {"in the bridge p50 (us)", "in the bridge max (us)"}
    wait_for(lambda: expected <= latency()["odometry"], "latency")
    measure(wanted=False)
    wait_for(lambda: not any(latency().values()), "end of the measurement")


def test_parameters_have_descriptors(system):
    from rcl_interfaces.srv import DescribeParameters, ListParameters

    names = call(system, ListParameters, "list_parameters", ListParameters.Request()).result.names
    assert {"odometry.rate", "speed.rate", "pose.rate", "diagnostics_frequency"} <= set(names)
    request = DescribeParameters.Request(names=["odometry.rate", "jaus_id"])
    answer = call(system, DescribeParameters, "describe_parameters", request)
    descriptor, fixed = answer.descriptors
    assert (descriptor.read_only, fixed.read_only) == (False, True)
    assert "odometry" in descriptor.description
    assert descriptor.floating_point_range[0].to_value == 1092.0


def test_command_to_topic_from_the_controller_alone(system):
    from geometry_msgs.msg import TwistStamped

    cruise = system.ros.listen(TwistStamped, "cruise")
    operator = system.start(OPERATOR)
    wait_for(lambda: cruise and cruise[-1].twist.linear.x > 0, "cruise speed")
    assert cruise[-1].twist.linear.x == pytest.approx(1.5, abs=1e-6)
    assert cruise[-1].header.stamp.sec > 0
    # The operator leaves in good order: control is released and the topic becomes safe.
    assert operator.stop() == 0
    wait_for(lambda: cruise[-1].twist.linear.x == 0.0, "safe cruise speed")
    operator = system.start(OPERATOR)
    wait_for(lambda: cruise[-1].twist.linear.x > 0, "cruise speed of the new operator")
    # And when it dies without a word.
    operator.kill()
    wait_for(lambda: cruise[-1].twist.linear.x == 0.0, "safe cruise speed after a crash")


def odometry_of(x, y):
    from nav_msgs.msg import Odometry

    message = Odometry()
    message.header.stamp.sec = 1_780_000_000  # 2026-05-28, 20:26:40 UTC
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.pose.pose.orientation.z = message.pose.pose.orientation.w = 0.5**0.5
    return message


def test_topic_to_report(system):
    from nav_msgs.msg import Odometry

    operator = system.start(OPERATOR)
    publisher = system.ros.publisher(Odometry, "estimate")
    with Repeater(publisher, odometry_of(3.0, 4.0)):
        event = wait_for(lambda: operator.of_kind("event"), "event of the estimate")[-1]
        wait_for(lambda: operator.of_kind("answer"), "answer to the query")
    assert event["x"] == pytest.approx(3.0, abs=1e-4)
    assert event["y"] == pytest.approx(-4.0, abs=1e-4)
    assert event["yaw"] == pytest.approx(-1.5708, abs=1e-3)  # a left turn
    assert event["day"] == 28
    # Out of range: the message is dropped and counted, the report stays.
    with Repeater(publisher, odometry_of(2e5, 0.0)):
        wait_for(lambda: counted(system, "estimate", "dropped: out_of_range"), "counted drop")
    assert operator.of_kind("event")[-1]["x"] == pytest.approx(3.0, abs=1e-4)
    # Another field has another policy: the report goes out without it.
    with Repeater(publisher, odometry_of(5.0, float("nan"))):
        wait_for(lambda: operator.of_kind("event")[-1]["y"] is None, "report without Y")
    assert operator.of_kind("event")[-1]["x"] == pytest.approx(5.0, abs=1e-4)
    wait_for(lambda: counted(system, "estimate", "out of range: drop_field Y"), "count")
    assert operator.stop() == 0


def test_a_value_whose_policy_is_error(system):
    from geometry_msgs.msg import Twist

    publisher = system.ros.publisher(Twist, "cmd_vel", 1)
    with Repeater(publisher, twist(1.0, 0.5)):
        wait_for(lambda: commands(system.vehicle), "command")
    with Repeater(publisher, twist(11.0, 0.5)):
        wait_for(lambda: system.ros.status("drive").level == b"\x02", "status ERROR")
        # The topic is not silent, but nothing of it is of use.
        wait_for(lambda: efforts(system.vehicle)[-1]["rotational"] is None, "safe value")
    name = "out of range: error PropulsiveLinearEffortX"
    wait_for(lambda: counted(system, "drive", name), "count")


def counted(system, connection, name):
    return int(system.ros.values(connection).get(name, 0))


@pytest.mark.slow
def test_killed_vehicle_recovers(system):
    """Last but one: the vehicle is a new process afterwards."""
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    odometry = system.ros.listen(Odometry, "odometry_copy")
    wait_for(lambda: odometry, "odometry")
    system.vehicle.kill()
    wait_for(lambda: odometry[-1].child_frame_id == "lost", "safe value")
    seen = len(odometry)
    publisher = system.ros.publisher(Twist, "cmd_vel", 1)
    system.vehicle = system.start(VEHICLE, "--address", "10.1.1")
    with Repeater(publisher, twist(4.0)):
        wait_for(lambda: len(odometry) > seen + 3, "odometry of the new process")
        wait_for(lambda: commands(system.vehicle), "command to the new process")
    assert odometry[-1].child_frame_id == ""
    assert odometry[-1].twist.twist.linear.x == pytest.approx(2.0, abs=1e-6)
    assert commands(system.vehicle)[-1]["linear"] == pytest.approx(40.0, abs=0.01)


@pytest.mark.slow
def test_clean_shutdown(system):
    """Last: the bridge ends, which may run for this test alone."""
    wait_for(lambda: " runs as " in system.bridge.log.read_text(), "bridge that runs")
    assert system.bridge.stop() == 0


@pytest.mark.slow
def test_overrides_choose_their_classes(path, tmp_path, monkeypatch):
    """A bridge of mixed forms: what is not overridden stays as generated."""
    from diagnostic_msgs.msg import DiagnosticArray
    from geometry_msgs.msg import PoseStamped, Twist
    from nav_msgs.msg import Odometry
    from std_msgs.msg import Float64

    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with System(path, tmp_path, (str(FOLDER / "mixed_bridge.py"),)) as mixed:
        odometry = mixed.ros.listen(Odometry, "odometry_copy")
        speed, pose = mixed.ros.listen(Float64, "speed"), mixed.ros.listen(PoseStamped, "pose")
        arrays = mixed.ros.listen(DiagnosticArray, "/diagnostics")
        wait_for(lambda: odometry and speed and pose, "messages")
        assert (odometry[-1].child_frame_id, odometry[-1].header.frame_id) == ("mixed", "odom")
        assert odometry[-1].twist.twist.linear.x == pytest.approx(102.0, abs=1e-6)
        assert speed[-1].data == pytest.approx(102.0, abs=1e-6)
        assert pose[-1].pose.position.x == pytest.approx(1.0, abs=1e-4)
        publisher = mixed.ros.publisher(Twist, "cmd_vel", 1)
        with Repeater(publisher, twist(3.0, 0.25)):
            command = wait_for(lambda: commands(mixed.vehicle), "command")[-1]
        assert command["linear"] == pytest.approx(-30.0, abs=0.01)
        wait_for(lambda: arrays, "diagnostics")
        forms = {
            status.name.rpartition(": ")[2]: value.value
            for status in arrays[-1].status
            for value in status.values
            if value.key == "translation"
        }
        assert forms.pop("odometry") == forms.pop("drive") == "ROS classes"
        assert forms.pop("speed") == "light classes"
        assert set(forms) == {"pose", "cruise", "estimate"}
        assert "ROS classes" not in forms.values()
