"""What a generated bridge tells by itself when somebody asks: of commands and of lists."""

from pathlib import Path

import pytest
from generated import model_in, text_of

from jausml_generators.bridge.target import TARGET

MODEL = """
import mappings.{maps}
component one {{ address: 2.1.1 external: true }}
component two {{ address: 2.1.2 external: true }}
bridge robot {{
    address: 1.1.1  provides: {service}  controlTimeout: 5
    connection drive {{ map: {map} direction: jausToRos {more} topic cmd }}
    {others}
}}
"""
REPORT = (
    "connection told { map: wrench_effort_report direction: rosToJaus exchange: query topic t }"
)
SECOND = "connection second { map: wrench_effort direction: jausToRos peers: two topic other }"
EFFORT = {"maps": "primitive_driver", "service": "PrimitiveDriver", "map": "wrench_effort"}
ANSWER = "answer=CommandAnswer(QueryWrenchEffort, ReportWrenchEffort, has_empty=True)"


def base_of(folder: Path, **values: str) -> str:
    """Returns the words of the base of the bridge."""
    text = MODEL.format(**{"more": "", "others": "", **values})
    base = text_of(model_in(folder, text), [TARGET])
    return " ".join(base.split()).replace("( ", "(").replace(" )", ")")


def test_the_last_effort_is_told(tmp_path):
    assert ANSWER in base_of(tmp_path, **EFFORT)


@pytest.mark.parametrize("others", [REPORT, SECOND])
def test_what_a_connection_tells_or_two_take_is_not(others, tmp_path):
    assert "CommandAnswer" not in base_of(tmp_path, **EFFORT, more="peers: one", others=others)


def test_the_kind_of_a_velocity_command_must_be_that_which_is_asked_for(tmp_path):
    base = base_of(
        tmp_path,
        maps="velocity_state_driver",
        service="VelocityStateDriver",
        map="velocity_command",
    )
    answer = 'CommandAnswer(QueryVelocityCommand, ReportVelocityCommand, same=("command_type",))'
    assert answer in base


def test_a_goal_is_told_too(tmp_path):
    base = base_of(
        tmp_path,
        maps="local_waypoint_driver",
        service="LocalWaypointDriver",
        map="local_waypoint",
        more='onSilence: hold holdReason: "a goal stands until the next one"',
    )
    assert "CommandAnswer(QueryLocalWaypoint, ReportLocalWaypoint)" in base


LISTS = """
import mappings.global_waypoint_driver
import mappings.local_waypoint_driver
import mappings.travel_speed

bridge robot {{
    address: 1.1.1  provides: LocalWaypointListDriver, GlobalWaypointListDriver, LocalWaypointDriver
    {more}
    ros_action_connection local {{
        direction: jausToRos  action: follow_waypoints  type: nav2_msgs/FollowWaypoints
        driver: LocalWaypointListDriver  element: local_waypoint  goalMember: poses
    }}
    ros_action_connection gps {{
        direction: jausToRos  action: follow_gps_waypoints  type: nav2_msgs/FollowGPSWaypoints
        driver: GlobalWaypointListDriver  element: global_waypoint_pose  goalMember: gps_poses
    }}
}}
"""
SPEED_REPORT = """connection speed {{
        map: local_travel_speed_report
        direction: rosToJaus
        exchange: {exchange}
        topic speed {{}}
    }}"""
SPEED = "speed=(QueryTravelSpeed, ReportTravelSpeed)"


def base_of_lists(folder: Path, more: str = "") -> str:
    """Returns the base of the bridge with drivers of lists."""
    return text_of(model_in(folder, LISTS.format(more=more)), [TARGET])


def test_each_driver_tells_the_speed_and_what_its_elements_hold(tmp_path):
    base = base_of_lists(tmp_path)
    assert base.count(SPEED) == 2
    assert base.count("element=(QueryLocalWaypoint, ReportLocalWaypoint)") == 1
    assert base.count("element=(QueryGlobalWaypoint, ReportGlobalWaypoint)") == 1


def test_a_connection_with_the_report_comes_first(tmp_path):
    base = base_of_lists(tmp_path, SPEED_REPORT.format(exchange="periodicEvent"))
    assert SPEED not in base
    assert "element=(QueryLocalWaypoint, ReportLocalWaypoint)" in base


def test_a_report_that_is_sent_unasked_answers_nothing(tmp_path):
    base = base_of_lists(tmp_path, SPEED_REPORT.format(exchange="message"))
    assert base.count(SPEED) == 2
