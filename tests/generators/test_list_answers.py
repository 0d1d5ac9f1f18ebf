"""What a generated list driver tells besides its active element."""

from pathlib import Path

from generated import model_in, text_of

from jausml_generators.bridge.target import TARGET

MODEL = """
import mappings.global_waypoint_driver
import mappings.local_waypoint_driver
import mappings.travel_speed

bridge robot {{
    address: 1.1.1
    provides: LocalWaypointListDriver, GlobalWaypointListDriver, LocalWaypointDriver
    {more}
    ros_action_connection local {{
        direction: jausToRos
        action: follow_waypoints
        type: nav2_msgs/FollowWaypoints
        driver: LocalWaypointListDriver
        element: local_waypoint
        goalMember: poses
    }}
    ros_action_connection gps {{
        direction: jausToRos
        action: follow_gps_waypoints
        type: nav2_msgs/FollowGPSWaypoints
        driver: GlobalWaypointListDriver
        element: global_waypoint_pose
        goalMember: gps_poses
    }}
}}
"""
REPORT = """connection speed {{
        map: local_travel_speed_report
        direction: rosToJaus
        exchange: {exchange}
        topic speed {{}}
    }}"""
SPEED = "speed=(QueryTravelSpeed, ReportTravelSpeed)"


def generated(folder: Path, more: str = "") -> str:
    """Returns the base class of the bridge."""
    return text_of(model_in(folder, MODEL.format(more=more)), [TARGET])


def test_each_driver_tells_the_speed_and_what_its_elements_hold(tmp_path):
    base = generated(tmp_path)
    assert base.count(SPEED) == 2
    assert base.count("element=(QueryLocalWaypoint, ReportLocalWaypoint)") == 1
    assert base.count("element=(QueryGlobalWaypoint, ReportGlobalWaypoint)") == 1


def test_a_connection_with_the_report_comes_first(tmp_path):
    base = generated(tmp_path, REPORT.format(exchange="periodicEvent"))
    assert SPEED not in base
    assert "element=(QueryLocalWaypoint, ReportLocalWaypoint)" in base


def test_a_report_that_is_sent_unasked_answers_nothing(tmp_path):
    base = generated(tmp_path, REPORT.format(exchange="message"))
    assert base.count(SPEED) == 2
