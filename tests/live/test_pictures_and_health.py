"""Pictures and health go from a ROS node through two bridges to another, byte by byte."""

from __future__ import annotations

import sys

import pytest
from ports import free_domain, free_port

pytest.importorskip("rclpy")

from .bridge_support import Process, Repeater, RosPeer, generate_text, wait_for

pytestmark = [
    pytest.mark.live,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

SYSTEM = """
import mappings.still_image
import mappings.health_monitor

bridge vehicle {
    address: 10.1.1
    controlTimeout: 5
    provides: StillImage, HealthMonitor
    connection image { map: still_image topic in/image }
    connection health { map: health topic in/health }
}

bridge station {
    address: 10.1.2
    connection image { map: still_image peers: vehicle rate: 5 topic out/image }
    connection health { map: health peers: vehicle rate: 5 topic out/health }
}
"""
PICTURE = b"\xff\xd8\xff\xe0" + bytes(range(256)) * 400 + b"\xff\xd9"


@pytest.fixture
def ros(tmp_path, monkeypatch):
    """Yields a node of the test while both bridges run."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    path, port = generate_text(tmp_path, "camera", SYSTEM), str(free_port())
    peer = RosPeer()
    running = [
        Process(["-m", f"{name}.main", "--jaus-port", port], path, tmp_path / f"{name}.log")
        for name in ("vehicle", "station")
    ]
    yield peer
    for each in running:
        each.close()
        sys.stderr.write(each.log.read_text())
    peer.close()


def test_what_the_vehicle_sees_and_how_it_is(ros):
    from diagnostic_msgs.msg import DiagnosticStatus
    from sensor_msgs.msg import CompressedImage

    images, health = (
        ros.listen(CompressedImage, "out/image"),
        ros.listen(DiagnosticStatus, "out/health"),
    )
    image = CompressedImage(format="rgb8; jpeg compressed bgr8", data=PICTURE)
    image.header.stamp = ros.node.get_clock().now().to_msg()
    other = CompressedImage(format="rgb8; png compressed bgr8", data=b"\x89PNG")
    other.header.stamp = image.header.stamp
    status = DiagnosticStatus(level=DiagnosticStatus.WARN, name="everything")
    with (
        Repeater(ros.publisher(CompressedImage, "in/image"), image, 0.2),
        Repeater(ros.publisher(CompressedImage, "in/image"), other, 0.05),
        Repeater(ros.publisher(DiagnosticStatus, "in/health"), status, 0.2),
    ):
        wait_for(lambda: images and health, "a picture and the health", 60)
    seen, told = images[-1], health[-1]
    assert {bytes(each.data) for each in images} == {PICTURE}
    assert (seen.format, seen.header.frame_id) == ("jpeg", "camera")
    assert seen.header.stamp.sec == image.header.stamp.sec
    assert (told.level, told.name, told.message) == (DiagnosticStatus.WARN, "vehicle", "warning")
