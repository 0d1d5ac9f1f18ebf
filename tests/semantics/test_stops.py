"""What a stop sends: what it states and what says what a message means, and no speed of a map."""

import pytest
from generated import model_in

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.rates import fills_rates_alone
from jausml.language.semantics.connections import stops
from jausml.language.semantics.paths.scopes import target_paths
from jausml.language.validation.engine import check_project

GUARDS = ("jausml/language/semantics/connections/stops.py",)

TEXT = """\
import jaus.mobility
import ros.geometry_msgs

bridge front {{
    address: 100.1.2
    provides: VelocityStateDriver
    drive {{
        JAUS SetVelocityCommand
        ROS geometry_msgs/TwistStamped
        stopRos: {stop}
        JAUS->ROS (
            clock -> header.stamp
            "base_link" -> header.frame_id
            0.5 -> twist.linear.x
            YawRate -> twist.angular.z : negate
        )
    }}
    connection drive {{ map: drive  topic cmd_vel }}
}}
"""


@pytest.fixture
def connection(tmp_path):
    def read(stop):
        path = tmp_path / "front.ros2jaus"
        path.write_text(TEXT.format(stop=stop), encoding="utf-8")
        report = check_project([path])
        assert not report.has_errors, report.diagnostics
        (found,) = report.model.instances(bridge.Connection)
        return found

    return read


def sent(connection):
    return [path for stop in stops.stop_assignments(connection) for path in target_paths(stop)]


def test_a_constant_speed_of_a_map_does_not_fill_its_stop(connection):
    found = connection("{}")
    assert sent(found) == ["header.stamp", "header.frame_id"]
    assert stops.moving_values(found) == []
    assert stops.stop_text(found) == "zeros"


@pytest.mark.parametrize("value", ["-0.25", "Infinity", "NaN"])
def test_a_stop_that_states_a_speed_drives(connection, value):
    found = connection(f"{{ values: {{ target: twist.angular.z  value: {value} }} }}")
    assert sent(found) == ["header.stamp", "header.frame_id", "twist.angular.z"]
    assert stops.moving_values(found) == [("twist.angular.z", value)]
    assert stops.stop_text(found) == f"twist.angular.z = {value}"


def test_a_stop_that_states_zero_stands(connection):
    found = connection("{ values: { target: twist.angular.z  value: 0.0 } }")
    assert stops.moving_values(found) == []


# -- which commands zeros stop ---------------------------------------------------------------------


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
