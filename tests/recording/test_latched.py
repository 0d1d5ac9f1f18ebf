"""Latched topics in a row of files: each has what its publishers still offer."""

from __future__ import annotations

import time

import pytest

pytest.importorskip("rclpy")

from ports import free_domain
from recordings import by_mcap

from jausml.cli.messages import open_catalogue
from jausml.recording.parts import Limits, Parts
from jausml.recording.recorder import Recorder
from jausml.recording.ros_topics import RosTopics
from jausml.recording.selection import Selection

pytestmark = [
    pytest.mark.live,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
PATIENCE = 60.0


@pytest.fixture
def publish(monkeypatch):
    """Publishes a text on a latched topic, once."""
    import rclpy
    from rclpy.context import Context
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    context = Context()
    rclpy.init(context=context, args=[])
    node = rclpy.create_node("describing", context=context)
    profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(String, "/description", profile)
    yield lambda text: publisher.publish(String(data=text))
    node.destroy_node()
    context.try_shutdown()


def test_each_file_has_the_latest_of_a_latched_topic(tmp_path, publish):
    publish("a robot")
    parts = Parts(tmp_path / "run.mcap", Limits(duration=0.5))
    recorder = Recorder(parts, open_catalogue([]), {}, Selection())
    ros = RosTopics(["/description"], Selection())
    with recorder.kept(0.05, ros.repeat_latched):
        ros.open()
        ros.begin(recorder.take_topic)
        try:
            end = time.monotonic() + PATIENCE
            while len(holding := [path for path in parts.paths[:-1] if by_mcap(path)]) < 3:
                assert time.monotonic() < end, f"{recorder.topics} in {parts.paths}"
                time.sleep(0.02)
        finally:
            ros.stop()
    for _, channel, message in (each for path in holding for each in by_mcap(path)):
        assert channel.topic == "/description"
        assert b"a robot" in message.data
    assert not ros.lost
