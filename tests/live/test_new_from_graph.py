"""`jausml new bridge --from-graph`: a bridge for what runs in ROS."""

from __future__ import annotations

import pytest
from click.testing import CliRunner
from ports import free_domain

pytest.importorskip("rclpy")

from jausml.cli import main
from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.text.notation import NOTATIONS

pytestmark = [
    pytest.mark.live,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]


@pytest.fixture
def vehicle(monkeypatch):
    """A node: it hears a command, and publishes odometry, a grid that is kept, and a text."""
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import OccupancyGrid, Odometry
    from rclpy.context import Context
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from std_msgs.msg import String

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    context = Context()
    rclpy.init(context=context, args=[])
    node = rclpy.create_node("wheels", context=context, namespace="car")
    try:
        node.create_subscription(Twist, "cmd_vel", print, 1)
        node.create_publisher(Odometry, "odom", QoSProfile(depth=5))
        kept = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        node.create_publisher(OccupancyGrid, "grid", kept)
        node.create_publisher(String, "chatter", 10)
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def new(*words):
    words = (
        "new",
        "bridge",
        "face",
        "--from-graph",
        "--for",
        "60",
        "--model",
        "car.ros2jaus",
        *words,
    )
    return CliRunner().invoke(main, words)


@pytest.mark.usefixtures("vehicle")
def test_it_lists_what_runs_and_proposes_a_bridge(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = new("--yes")
    assert done.exit_code == 0, done.output
    assert "/car/cmd_vel  geometry_msgs/msg/Twist  from nobody to /car/wheels" in done.output
    assert "/car/odom  nav_msgs/msg/Odometry  from /car/wheels to nobody" in done.output
    assert "left out: no ready map carries std_msgs/String of car/chatter" in done.output
    model = read_models([tmp_path / "car.ros2jaus"], notations=NOTATIONS).model
    [made] = model.instances(bridge.Bridge, library=False)
    # Relative names, which a namespace of the bridge would move.
    found = {
        each.topics[0].name: (
            name_of(each.map),
            each.direction.name,
            each.topics[0].qos.reliability.name,
            each.topics[0].qos.durability.name,
        )
        for each in made.bridgeConnections
    }
    assert found == {
        "car/cmd_vel": ("velocity_command", "jausToRos", "reliable", "volatile"),
        "car/grid": ("cost_map", "rosToJaus", "reliable", "transient_local"),
        "car/odom": ("local_pose", "rosToJaus", "reliable", "volatile"),
    }
    done = CliRunner().invoke(main, ["validate", "car.ros2jaus", "--strict"])
    assert done.exit_code == 0, done.output
    other = new("/car/odom:velocity_state", "--model", "other.ros2jaus")
    assert other.exit_code == 0, other.output
    assert "velocity_state: reported as ReportVelocityState" in other.output
    words = ("--from-graph", "--for", "60", "/car/odom:velocity_state", "--model", "car.ros2jaus")
    further = CliRunner().invoke(main, ["new", "connection", *words])
    assert further.exit_code == 0, further.output
    text = (tmp_path / "car.ros2jaus").read_text("utf-8")
    (tmp_path / "car.ros2jaus").write_text(text.replace("address:", "namespace: car\naddress:"))
    inside = CliRunner().invoke(
        main, ["new", "connection", *words[:3], "/car/odom:local_pose_enu", *words[4:]]
    )
    assert "odom: ROS -> JAUS, local_pose_enu" in inside.output
    model = read_models([tmp_path / "car.ros2jaus"], notations=NOTATIONS).model
    [made] = model.instances(bridge.Bridge, library=False)
    assert [each.topics[0].name for each in made.bridgeConnections][-2:] == ["car/odom", "odom"]
