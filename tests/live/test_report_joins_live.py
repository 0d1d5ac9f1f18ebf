"""A generated bridge that makes one ROS message of two JAUS reports."""

from pathlib import Path

import needs
import pytest

needs.ask("rclpy")


from .bridge_support import System, generate_text, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

VEHICLE = str(Path(__file__).with_name("odometry_vehicle.py"))
MODEL = """
import mappings.odometry
component pose { address: 10.1.1 provides: LocalPoseSensor external: true }
component velocity { address: 10.1.2 provides: VelocityStateSensor external: true }
bridge odometry_bridge {
  address: 10.1.9
  connection odometry {
    map: odometry
    peers: pose
    rate: 10
    sources: { join: velocity peers: velocity rate: 20 }
    topic odom
  }
}
"""


@pytest.fixture
def system(tmp_path):
    """Yields what starts a process, and a node of the test; the bridge runs."""
    with System(generate_text(tmp_path, "odometry", MODEL), tmp_path) as system:
        system.start("-m", "odometry_bridge.main")
        yield system.start, system.ros


def test_odometry_is_there_while_both_reports_are(system):
    from diagnostic_msgs.msg import DiagnosticArray
    from nav_msgs.msg import Odometry

    start, ros = system
    found = ros.listen(Odometry, "odom")
    told = ros.listen(DiagnosticArray, "/diagnostics")

    def warnings():
        statuses = [status for array in told for status in array.status]
        return [status.message for status in statuses if status.name.endswith(": odometry")]

    start(VEHICLE, "pose")
    wait_for(lambda: "nothing fresh from velocity" in warnings(), "a pose without a velocity")
    assert found == []
    velocity = start(VEHICLE, "velocity")
    wait_for(lambda: len(found) > 5, "odometry of both")
    made = found[-1]
    assert (made.header.frame_id, made.child_frame_id) == ("odom", "base_link")
    assert made.pose.pose.position.x == pytest.approx(3.0, abs=1e-3)
    assert made.pose.pose.position.y == pytest.approx(-4.0, abs=1e-3)
    assert made.pose.pose.orientation.z == pytest.approx(-0.70710678, abs=1e-3)
    assert made.twist.twist.linear.x == pytest.approx(2.0, abs=1e-3)
    assert made.twist.twist.linear.y == pytest.approx(-0.5, abs=1e-3)
    assert made.twist.twist.angular.z == pytest.approx(-0.25, abs=1e-3)
    velocity.kill()
    told.clear()
    wait_for(lambda: "nothing fresh from velocity" in warnings(), "that the velocity is stale")
    found.clear()
    told.clear()
    wait_for(lambda: len(warnings()) > 1, "more diagnostics")
    assert found == []  # the vehicle does not stand: nobody knows how fast it is
    start(VEHICLE, "velocity")
    wait_for(lambda: len(found) > 5, "odometry again", 60.0)
