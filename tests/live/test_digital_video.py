"""A video stream from a real RTSP server, whose address a real client learns through JAUS and ROS.

The camera is a bridge of its own and registers the address at the vehicle. The station asks that.
"""

import subprocess

import needs
import pytest
from ports import free_port

needs.ask("rclpy")

from .bridge_support import SUPPORT, System, generate_text, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.needs("gstreamer")]

MODEL = """
import mappings.digital_resource
import mappings.odometer
import mappings.visual_sensor

bridge vehicle {
    address: 10.1.1
    provides: DigitalResourceDiscovery, OdometryService
    connection odometer { map: odometer topic in/odometer }
}

bridge camera {
    address: 10.1.2
    controlTimeout: 5
    provides: DigitalVideo
    connection stream { map: digital_video_stream topic camera/stream }
}

bridge station {
    address: 10.9.1
    connection stream { map: digital_video_stream peers: camera topic station/stream }
    connection address { map: digital_resource_endpoint peers: vehicle rate: 5 topic endpoint }
    connection all { map: digital_resources peers: vehicle rate: 5 topic endpoints }
}
"""


@pytest.fixture
def front(tmp_path):
    """Yields the address of a stream while it is served."""
    port = str(free_port())
    line = [needs.SYSTEM_PYTHON, f"{SUPPORT}/rtsp_server.py", port, "320", "240"]
    with (tmp_path / "server.log").open("w") as log:
        server = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=log, text=True)
    assert server.stdout.readline() == "serving\n"
    yield f"rtsp://127.0.0.1:{port}/front"
    server.kill()
    server.wait()
    server.stdout.close()


@pytest.fixture
def ros(front, tmp_path):
    """Yields a node of the test while the bridges run; the camera is told two addresses."""
    urls = f"jaus_digital_resources:={front} http://127.0.0.1/rear"
    told = {"camera": ["--ros-args", "-p", urls, "--"]}
    with System(generate_text(tmp_path, "video", MODEL), tmp_path) as system:
        for name in ("vehicle", "camera", "station"):
            system.start("-m", f"{name}.main", *told.get(name, ()))
        yield system.ros


def test_a_client_plays_what_it_has_discovered(ros, front):
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
    from std_msgs.msg import Bool

    endpoints = ros.listen(KeyValue, "endpoint")
    lists = ros.listen(DiagnosticStatus, "endpoints")
    switched = ros.listen(Bool, "camera/stream")
    play = ros.publisher(Bool, "station/stream")

    def has_both():
        return endpoints and lists and len(lists[-1].values) == 2

    wait_for(has_both, "the endpoints of the camera", 60)
    found = [(value.key, value.value) for value in lists[-1].values]
    assert found == [("RTSP", front), ("HTTP", "http://127.0.0.1/rear")]
    assert (endpoints[-1].key, endpoints[-1].value) == ("RTSP", front)

    def is_switched():
        play.publish(Bool(data=True))
        return any(message.data for message in switched)

    wait_for(is_switched, "the command to play", 60)
    line = [needs.SYSTEM_PYTHON, f"{SUPPORT}/rtsp_client.py", endpoints[-1].value, "3"]
    played = subprocess.run(line, check=False, capture_output=True, text=True, timeout=60)
    assert played.stdout == "320 240\n" * 3, played.stderr
