"""Pictures and health go from a ROS node through two bridges to another, byte by byte."""

import needs
import pytest
from ports import free_domain

needs.ask("rclpy")

from .bridge_support import Repeater, System, generate_text, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

MODEL = """
import mappings.still_image
import mappings.health_monitor

bridge vehicle {
    address: 10.1.1
    controlTimeout: 5
    provides: StillImage, HealthMonitor
    connection image { map: MAP topic in/image }
    connection health { map: health topic in/health }
}

bridge station {
    address: 10.1.2
    connection image { map: MAP peers: vehicle rate: 5 topic out/image }
    connection health { map: health peers: vehicle rate: 5 topic out/health }
}
"""
JPEG = b"\xff\xd8\xff\xe0" + bytes(range(256)) * 400 + b"\xff\xd9"
PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 400
PICTURES = {
    "still_image": ("rgb8; jpeg compressed bgr8", JPEG),
    "still_image_png": ("16UC1; png compressed ", PNG),
}


@pytest.fixture
def ros(tmp_path, monkeypatch, used):
    """Yields a node of the test while both bridges run."""
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    path = generate_text(tmp_path, "camera", MODEL.replace("MAP", used))
    with System(path, tmp_path) as system:
        for name in ("vehicle", "station"):
            system.start("-m", f"{name}.main")
        yield system.ros


@pytest.mark.slow
@pytest.mark.parametrize(
    ("used", "other", "word"),
    [("still_image", "still_image_png", "jpeg"), ("still_image_png", "still_image", "png")],
)
def test_what_the_vehicle_sees_and_how_it_is(ros, used, other, word):
    from diagnostic_msgs.msg import DiagnosticStatus
    from sensor_msgs.msg import CompressedImage

    images, health = (
        ros.listen(CompressedImage, "out/image"),
        ros.listen(DiagnosticStatus, "out/health"),
    )
    image, unfit = (
        CompressedImage(format=PICTURES[name][0], data=PICTURES[name][1]) for name in (used, other)
    )
    image.header.stamp = ros.node.get_clock().now().to_msg()
    unfit.header.stamp = image.header.stamp
    status = DiagnosticStatus(level=DiagnosticStatus.WARN, name="everything")
    with (
        Repeater(ros.publisher(CompressedImage, "in/image"), image, 0.2),
        Repeater(ros.publisher(CompressedImage, "in/image"), unfit, 0.05),
        Repeater(ros.publisher(DiagnosticStatus, "in/health"), status, 0.2),
    ):
        wait_for(lambda: images and health, "a picture and the health", 60)
    seen, told = images[-1], health[-1]
    assert {bytes(picture.data) for picture in images} == {PICTURES[used][1]}
    assert (seen.format, seen.header.frame_id) == (word, "camera")
    assert seen.header.stamp.sec == image.header.stamp.sec
    assert (told.level, told.name, told.message) == (DiagnosticStatus.WARN, "vehicle", "warning")


@pytest.mark.parametrize("used", ["still_image_raw"])
def test_raw_pixels_cross_and_those_without_a_file_are_dropped(ros):
    from sensor_msgs.msg import Image

    images = ros.listen(Image, "out/image")
    blue_first = bytes(range(240)) * 80
    padded = b"".join(blue_first[at : at + 480] + b"....." for at in range(0, 19200, 480))
    image = Image(height=40, width=160, encoding="bgr8", step=485, data=padded)
    image.header.stamp = ros.node.get_clock().now().to_msg()
    depths = Image(height=1, width=1, encoding="32FC1", step=4, data=b"\0\0\x80?")
    depths.header.stamp = image.header.stamp
    with (
        Repeater(ros.publisher(Image, "in/image"), image, 0.2),
        Repeater(ros.publisher(Image, "in/image"), depths, 0.05),
    ):
        wait_for(lambda: images, "an image", 60)
    seen = images[-1]
    assert {picture.encoding for picture in images} == {"rgb8"}
    assert (seen.height, seen.width, seen.step, seen.is_bigendian) == (40, 160, 480, 0)
    assert bytes(seen.data[:6]) == b"\2\1\0\5\4\3"
    assert bytes(seen.data[2::3]) == blue_first[0::3]
    assert seen.header.stamp.sec == image.header.stamp.sec
