"""Zeros stop a command of which all numbers are rates, and no other."""

import pytest
from generated import model_in

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.units import fills_rates_alone

SPEED = "X -> twist.twist.linear.x"
TIME = "TimeStamp -> header.stamp : timestamp_to_time"


@pytest.mark.parametrize(
    ("name", "expected"),
    [("velocity_command", True), ("local_waypoint", False), ("wrench_effort", True)],
)
def test_of_ready_maps(tmp_path, name, expected):
    model = model_in(
        tmp_path,
        "import mappings.velocity_state_driver\nimport mappings.local_waypoint_driver\n"
        "import mappings.primitive_driver\nbridge b { address: 1.1.1 }\n",
        "m.ros2jaus",
    )
    used = next(used for used in model.instances(bridge.AttributeMap) if used.name == name)
    assert fills_rates_alone(used, to_ros=True) is expected


@pytest.mark.parametrize(
    ("speed", "more", "expected"),
    [
        (SPEED, "", True),
        (SPEED, TIME, True),
        (SPEED, "Roll, Pitch, Yaw -> pose.pose.orientation : frd_angles_to_flu_quaternion", False),
        (SPEED, "X -> pose.pose.position.x", False),
        (SPEED, "Rates -> twist.covariance { . -> . }", False),
        ("", TIME, False),
    ],
)
def test_a_speed_beside_other_numbers_is_not_alone(tmp_path, speed, more, expected):
    """A quaternion of zeros is no orientation, and an attitude of zeros no standstill."""
    model = model_in(
        tmp_path,
        "import jaus.mobility\n"
        "own {\n  JAUS ReportLocalPose\n  ROS nav_msgs/Odometry\n  JAUS->ROS (\n"
        f"    {speed}\n    {more}\n  )\n}}\n",
        "m.ros2jaus",
    )
    [used] = [used for used in model.instances(bridge.AttributeMap) if used.name == "own"]
    assert fills_rates_alone(used, to_ros=True) is expected


def test_a_number_of_no_unit_is_what_its_source_is(tmp_path):
    model = model_in(
        tmp_path,
        "import jaus.mobility\n"
        "speed {\n  JAUS ReportVelocityState\n  ROS std_msgs/Float64\n"
        "  JAUS->ROS ( Velocity_X -> data )\n}\n",
        "m.ros2jaus",
    )
    [used] = [used for used in model.instances(bridge.AttributeMap) if used.name == "speed"]
    assert fills_rates_alone(used, to_ros=True)
