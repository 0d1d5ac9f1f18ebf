"""`jausml new bridge --from-graph`: a bridge for what runs in ROS."""

from threading import Condition
from types import SimpleNamespace

import needs
import pytest
from click.testing import CliRunner
from generated import model_of
from nav2 import nav2
from ports import free_domain
from ros_nodes import SpinningNode

needs.ask("rclpy")

from jausml.cli import main
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.live.ros.node import QuietNode
from jausml.live.ros.running import Hearing, ParameterReader, RosEndpoint, RunningTopic

from .bridge_support import wait_for

pytestmark = pytest.mark.live


@pytest.fixture
def vehicle(monkeypatch):
    """A node: it hears a command, and publishes odometry, a grid that is kept, and a text.

    It also has an arm, whose joints it names, serves a service and calls one.
    """
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import OccupancyGrid, Odometry
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import JointState
    from std_msgs.msg import String
    from std_srvs.srv import SetBool, Trigger

    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with SpinningNode("wheels", "car") as spinning:
        node = spinning.node
        node.create_subscription(Twist, "cmd_vel", print, 1)
        odometry = node.create_publisher(Odometry, "odom", QoSProfile(depth=5))
        kept = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        grid = node.create_publisher(OccupancyGrid, "grid", kept)
        node.create_publisher(String, "chatter", 10)
        node.create_subscription(JointState, "arm/cmd", print, 1)
        joints = node.create_publisher(JointState, "joint_states", 1)
        state = JointState(name=["shoulder", "elbow"], position=[0.1, 0.2])

        def publish():  # all of it: what is silent is waited for, in each command
            joints.publish(state)
            odometry.publish(Odometry())
            grid.publish(OccupancyGrid())

        node.create_timer(0.2, publish)
        node.create_service(Trigger, "drop_weight", lambda _, answer: answer)
        node.create_client(SetBool, "lamp")
        yield


def run(*words):
    """Runs a verb, which must not fail; returns what click says of it."""
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0, done.output
    return done


def new(*words, file="car.ros2jaus"):
    """Makes a bridge of what runs."""
    return run("new", "bridge", "face", "--from-graph", "--for", "60", "--model", file, *words)


@pytest.mark.slow
@pytest.mark.usefixtures("vehicle")
def test_it_lists_what_runs_and_proposes_a_bridge(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = new("--yes", "--hold", "car/arm/cmd=the arm has brakes that hold it")
    assert "/car/cmd_vel  geometry_msgs/msg/Twist  from nobody to /car/wheels" in done.output
    assert "/car/odom  nav_msgs/msg/Odometry  from /car/wheels to nobody" in done.output
    assert "/car/drop_weight  std_srvs/srv/Trigger  served by /car/wheels" in done.output
    assert "get_parameters" not in done.output
    for told in (
        "no ready map carries std_msgs/String of car/chatter for a vehicle; "
        "next: jausml new map car_chatter MESSAGE std_msgs/String",
        "service car/drop_weight: no type says which JAUS message asks; "
        "next: jausml new service-connection car/drop_weight:std_srvs/Trigger MESSAGE",
        "service car/lamp: no type says which JAUS message asks; "
        "next: jausml new service-connection car/lamp:std_srvs/SetBool MESSAGE --side operator",
    ):
        assert f"left out: {told}\n" in done.output
    model = model_of(tmp_path / "car.ros2jaus")
    [made] = model.instances(bridge.Bridge, library=False)
    # Relative names, which a namespace of the bridge would move.
    found = {}
    for connection in made.bridgeConnections:
        (topic,) = connection.topics
        qos = (topic.qos.reliability.name, topic.qos.durability.name)
        found[topic.name] = (name_of(connection.map), connection.direction.name, *qos)
    assert found == {
        "car/arm/cmd": ("car_arm_cmd_set_joint_positions", "jausToRos", "reliable", "volatile"),
        "car/joint_states": (
            "car_joint_states_joint_positions",
            "rosToJaus",
            "reliable",
            "volatile",
        ),
        "car/cmd_vel": ("velocity_command", "jausToRos", "reliable", "volatile"),
        "car/grid": ("cost_map", "rosToJaus", "reliable", "transient_local"),
        "car/odom": ("local_pose", "rosToJaus", "reliable", "volatile"),
    }
    for used in made.maps:
        (joints,) = (assignment.names for assignment in used.toRos if hasattr(assignment, "names"))
        assert list(joints) == ["shoulder", "elbow"]
    run("validate", "car.ros2jaus", "--strict")
    other = new("/car/odom:velocity_state", file="other.ros2jaus")
    assert "velocity_state: reported as ReportVelocityState" in other.output
    further = ("new", "connection", "--from-graph", "--for", "60", "--model", "car.ros2jaus")
    run(*further, "/car/odom:velocity_state")
    text = (tmp_path / "car.ros2jaus").read_text("utf-8")
    (tmp_path / "car.ros2jaus").write_text(text.replace("address:", "namespace: car\naddress:"))
    assert "odom: ROS -> JAUS, local_pose_enu" in run(*further, "/car/odom:local_pose_enu").output
    model = model_of(tmp_path / "car.ros2jaus")
    [made] = model.instances(bridge.Bridge, library=False)
    topics = [connection.topics[0].name for connection in made.bridgeConnections]
    assert topics[-2:] == ["car/odom", "odom"]


@pytest.fixture
def surveyor(monkeypatch):
    """A node that serves an action of Nav2, and nothing that a ready map carries."""
    monkeypatch.syspath_prepend(nav2())
    from nav2_msgs.action import FollowWaypoints
    from rclpy.action import ActionServer

    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    silent = SpinningNode("surveyor", "car")
    server = ActionServer(silent.node, FollowWaypoints, "survey", print)
    yield
    server.destroy()
    silent.close()


@pytest.mark.slow
@pytest.mark.usefixtures("surveyor")
def test_it_says_how_an_action_is_carried(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = new()
    assert "/car/survey  nav2_msgs/action/FollowWaypoints  served by /car/surveyor" in done.output
    command = "new action-connection car/survey:nav2_msgs/FollowWaypoints"
    assert f"; next: jausml {command}\n" in done.output
    run(*command.split(), "--model", "car.ros2jaus")
    done = run("validate", "car.ros2jaus")
    # The goal has members that no list has: whether their defaults will do, a person decides.
    assert "defaults are sent in number_of_loops, goal_index" in done.stdout
    assert "\n1 warning in" in f"\n{done.stderr}"


DESCRIPTION = """<robot name="crane">
  <joint name="mast" type="fixed"/>
  <joint name="swing" type="revolute"><axis xyz="0 0 1"/></joint>
  <joint type='prismatic' name='lift'/>
  <transmission name="t"><joint name="swing"/></transmission>
</robot>
"""


@pytest.fixture
def crane(monkeypatch):
    """A node with frames of its own, parameters, a stamped command, and a topic nobody can read."""
    from geometry_msgs.msg import TwistStamped
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu, Temperature

    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with SpinningNode("base", "crane") as spinning:
        node = spinning.node
        for name, value in {
            "robot_description": DESCRIPTION,
            "odom_frame_id": "unused",
            "map_frame": "site",
            "cmd_vel_timeout": 0.5,
            "linear.x.max_velocity": 1.5,
            "publish_rate": 50.0,
            "wheel_separation": 0.8,
            "enable_odom_tf": True,
            "use_sim_time_of_day": "noon",
        }.items():
            node.declare_parameter(name, value)
        odometry = node.create_publisher(Odometry, "odom", 5)
        moved = Odometry(child_frame_id="crane/chassis")
        moved.header.frame_id = "crane/odom"
        node.create_timer(0.2, lambda: odometry.publish(moved))
        imu = node.create_publisher(Imu, "imu", 5)
        node.create_timer(0.2, lambda: imu.publish(b"\0\1\0\0of another definition"))
        motor = node.create_publisher(Temperature, "motor", 5)
        warm = Temperature()
        warm.header.frame_id = "crane/motor"
        node.create_timer(0.2, lambda: motor.publish(warm))
        node.create_subscription(TwistStamped, "cmd_vel", print, 1)
        yield


@pytest.mark.slow
@pytest.mark.usefixtures("crane")
@pytest.mark.parametrize("file", ["car.ros2jaus", "car.xmi"])
def test_names_of_frames_go_into_maps_and_parameters_are_shown(tmp_path, monkeypatch, file):
    monkeypatch.chdir(tmp_path)
    done = new("--yes", file=file)
    told = done.stdout.splitlines()
    assert "/crane/odom names the frame crane/odom and the child frame crane/chassis" in told
    left = "no ready map carries sensor_msgs/Temperature of crane/motor for a vehicle; next: "
    begun = "jausml new map crane_motor MESSAGE sensor_msgs/Temperature --to-ros "
    assert f"left out: {left}{begun}'header.frame_id=\"crane/motor\"'\n" in done.stderr
    assert "/crane/imu was silent: what its messages name is not known" in told
    shown = {
        line.removeprefix("/crane/base has ").partition(":")[0]: line
        for line in told
        if line.startswith("/crane/base has ")
    }
    assert set(shown) == {
        "cmd_vel_timeout 0.5",
        "linear.x.max_velocity 1.5",
        "map_frame site",
        "odom_frame_id unused",
        "publish_rate 50.0",
        "robot_description",
        "wheel_separation 0.8",
    }
    assert "--joints TOPIC=swing,lift states them" in shown["robot_description"]
    assert "silenceTimeout of the connection is yours to decide" in shown["cmd_vel_timeout 0.5"]
    (line,) = (line for line in told if line.startswith("crane/cmd_vel: JAUS -> ROS"))
    assert line.endswith("; the frame base_link is crane/chassis")
    model = model_of(tmp_path / file)
    [made] = model.instances(bridge.Bridge, library=False)
    frames = {
        assignment.target: assignment.value
        for used in made.maps
        for assignment in used.toRos
        if isinstance(assignment, bridge.ConstantAssignment)
    }
    assert frames["header.frame_id"] == "crane/chassis"
    # What concerns safety is left to a person.
    assert not any(bridge_connection.silenceTimeout for bridge_connection in made.bridgeConnections)
    assert not made.quantities
    run("validate", file, "--strict")


def test_a_header_of_a_robot_maker_names_no_frames(monkeypatch):
    fields = {"header": "unitree_api/RequestHeader"}
    kind = SimpleNamespace(get_fields_and_field_types=lambda: fields)
    monkeypatch.setattr("jausml.live.ros.running.message_class", lambda _: kind)
    publishers = (RosEndpoint("/sport", "reliable", "volatile"),)
    topic = RunningTopic("/api/sport/request", ("unitree_api/msg/Request",), publishers, ())
    assert not Hearing(None, [topic], Condition()).silent


def test_a_question_without_an_answer_is_asked_again(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    quiet = QuietNode("question").open()
    # It takes the first question, and goes before it answers.
    deaf = SpinningNode("wheels", "car")
    reader = ParameterReader(quiet.node, ["/car/wheels"], "wheel_base".__eq__, Condition())
    quiet.spin()

    def is_read():
        reader.ask()
        return not reader.unread

    with pytest.raises(AssertionError):
        wait_for(is_read, "answer", seconds=2.0)
    deaf.close()
    with SpinningNode("wheels", "car") as spinning:
        spinning.node.declare_parameter("wheel_base", 1.5)
        wait_for(is_read, "answer")
    quiet.close()
    assert reader.found == {"/car/wheels": {"wheel_base": 1.5}}
