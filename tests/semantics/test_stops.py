"""What a stop sends: what it states and what says what a message means, and no speed of a map."""

import pytest

from jausml.language.metamodel.classes import bridge
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


def test_a_stop_that_states_a_speed_drives(connection):
    found = connection("{ values: { target: twist.angular.z  value: -0.25 } }")
    assert sent(found) == ["header.stamp", "header.frame_id", "twist.angular.z"]
    assert stops.moving_values(found) == [("twist.angular.z", "-0.25")]
    assert stops.stop_text(found) == "twist.angular.z = -0.25"


def test_a_stop_that_states_zero_stands(connection):
    found = connection("{ values: { target: twist.angular.z  value: 0.0 } }")
    assert stops.moving_values(found) == []
