"""A generated bridge that makes one JAUS report of two ROS topics."""

from pathlib import Path

import needs
import pytest

needs.ask("rclpy")


from .bridge_support import Repeater, System, generate_text, wait_for

pytestmark = pytest.mark.live

OBSERVER = str(Path(__file__).with_name("join_observer.py"))
MODEL = """
import mappings.global_pose_sensor
import mappings.travel_speed
bridge pose_bridge {
  address: 10.1.9
  provides: GlobalPoseSensor, mobility.GlobalWaypointDriver
  connection pose {
    map: global_pose
    direction: rosToJaus
    exchange: query
    topic fix { }
    topic `imu/data` { join: global_pose.imu }
  }
  connection speed {
    map: travel_speed_report
    direction: rosToJaus
    exchange: query
    whenStale: absent
    freshness: 0.5
    topic speed { }
  }
}
"""


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """Starts the bridge and an observer; yields the observer and a node of the test."""
    folder = tmp_path_factory.mktemp("joins")
    with System(generate_text(folder, "pose", MODEL), folder) as system:
        system.start("-m", "pose_bridge.main")
        yield system.start(OBSERVER), system.ros


def test_the_attitude_is_that_of_the_joined_topic_while_it_is_fresh(system):
    from sensor_msgs.msg import Imu, NavSatFix, NavSatStatus

    observer, ros = system

    def poses(*, with_yaw):
        # Before the first fix, poses say that there is none.
        told = [fact for fact in observer.of_kind("pose") if fact["latitude"] is not None]
        return [pose for pose in told if (pose["yaw"] is not None) is with_yaw]

    has_fix = NavSatStatus(status=NavSatStatus.STATUS_FIX)
    fix = NavSatFix(status=has_fix, latitude=48.5, longitude=-11.25, altitude=519.75)
    east = Imu()  # REP 103: no turn is east
    with Repeater(ros.publisher(NavSatFix, "fix"), fix):
        before = wait_for(lambda: poses(with_yaw=False), "pose without attitude")
        assert before[0]["latitude"] == pytest.approx(48.5, abs=1e-7)
        with Repeater(ros.publisher(Imu, "imu/data"), east):
            joined = wait_for(lambda: poses(with_yaw=True), "pose with attitude")
            assert joined[0]["latitude"] == pytest.approx(48.5, abs=1e-7)
            assert joined[0]["yaw"] == pytest.approx(1.5707963, abs=1e-4)
        known = len(poses(with_yaw=False))
        wait_for(lambda: len(poses(with_yaw=False)) > known, "pose with a stale joined topic")


@pytest.mark.slow
def test_a_report_says_that_its_sensor_is_dead_and_that_it_lives_again(system):
    from sensor_msgs.msg import NavSatFix, NavSatStatus

    observer, ros = system

    def latitudes():
        return [pose["latitude"] for pose in observer.of_kind("pose")]

    has_fix = NavSatStatus(status=NavSatStatus.STATUS_FIX)
    fix = NavSatFix(status=has_fix, latitude=48.5, longitude=-11.25, altitude=519.75)
    publisher = ros.publisher(NavSatFix, "fix")
    for _ in range(2):
        with Repeater(publisher, fix):
            known = len(latitudes())
            wait_for(lambda known=known: any(latitudes()[known:]), "pose of the sensor")
        # The map takes a fix of 3 s ago for none: each field of the report is absent then.
        wait_for(lambda: latitudes()[-1] is None, "pose without a fix")


def test_a_report_that_cannot_say_so_is_not_given_while_its_sensor_is_dead(system):
    from std_msgs.msg import Float64

    observer, ros = system

    def answers():
        return [fact["kind"] for fact in observer.of_kind("speed", "no speed")]

    publisher = ros.publisher(Float64, "speed")
    for _ in range(2):
        with Repeater(publisher, Float64(data=2.0)):
            known = len(answers())
            wait_for(lambda known=known: "speed" in answers()[known:], "speed of the sensor")
        # The message has its speed in any case, and nobody measures one.
        wait_for(lambda: answers()[-1] == "no speed", "silence of the bridge")
