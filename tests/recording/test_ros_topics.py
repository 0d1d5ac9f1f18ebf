"""Topics of ROS as they are recorded: latched ones in each file of a row, lost messages counted."""

import re
import time
from contextlib import ExitStack
from threading import Event

import needs
import pytest

needs.ask("rclpy")

from ports import free_domain
from recordings import PATIENCE, by_mcap, wait_for
from rosbags.rosbag2 import Reader

from jausml.cli.shared.models import open_catalogue
from jausml.live.recording.mcap_files import TrafficFilter, copied
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.recorder import Recorder, RecordingFiles, SplitLimits
from jausml.live.recording.ros_topics import RosTopics

pytestmark = pytest.mark.live


@pytest.fixture
def nodes(monkeypatch):
    """Two nodes; a participant of DDS cannot have a topic with two types."""
    import rclpy
    from rclpy.context import Context

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with ExitStack() as stack:
        made = []
        for name in ("describing", "another"):
            context = stack.enter_context(Context())
            made.append(rclpy.create_node(name, context=context))
            stack.callback(made[-1].destroy_node)
        yield made


@pytest.fixture
def publisher(nodes):
    """Makes a publisher of texts with a quality of service; somebody wants another type."""
    from rclpy.qos import QoSProfile
    from std_msgs.msg import Bool, String

    node, other = nodes
    other.create_subscription(Bool, "/description", print, 1)
    return lambda **qos: node.create_publisher(String, "/description", QoSProfile(**qos))


def test_recordings_carry_the_quality_of_service_of_publishers(tmp_path, publisher):
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
    from std_msgs.msg import String

    first = publisher(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=1.5))
    parts = RecordingFiles(tmp_path / "run.mcap", SplitLimits())
    ros = RosTopics(TrafficFilter())
    recorder = Recorder(parts, open_catalogue([]), {}, TrafficFilter(), ros.offers)
    with recorder.kept(0.05, ros.repeat_latched):
        ros.open()
        ros.begin(["/description"], recorder.take_topic)
        try:
            first.publish(String(data="a robot"))
            wait_for(lambda: recorder.topics["/description"], "message")
        finally:
            ros.stop()
    # rosbags takes files of ROS alone, which this one is but for its profile.
    path = tmp_path / "copy.mcap"
    with path.open("wb") as stream:
        copied(McapRecording(str(parts.paths[0])).messages(), stream, ros_only=True)
    with Reader(path) as reader:
        (connection,) = reader.connections
        profiles = connection.ext.offered_qos_profiles
    found = {
        (profile.durability.name, profile.reliability.name, profile.deadline.sec)
        for profile in profiles
    }
    assert found == {("TRANSIENT_LOCAL", "RELIABLE", 9223372036), ("VOLATILE", "BEST_EFFORT", 1)}
    metadata = by_mcap(path)[0][1].metadata
    assert {profile.deadline.nsec for profile in profiles} == {854775807, 500_000_000}
    assert re.fullmatch("RIHS01_[0-9a-f]{64}", metadata["topic_type_hash"])


@pytest.mark.slow
def test_each_file_has_the_latest_of_a_latched_topic(tmp_path, publisher):
    from rclpy.qos import DurabilityPolicy
    from std_msgs.msg import String

    publisher(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL).publish(String(data="a robot"))
    parts = RecordingFiles(tmp_path / "run.mcap", SplitLimits(duration=0.5))
    recorder = Recorder(parts, open_catalogue([]), {}, TrafficFilter())
    ros = RosTopics(TrafficFilter())
    with recorder.kept(0.05, ros.repeat_latched):
        ros.open()
        ros.begin(["/description"], recorder.take_topic)
        try:
            wait_for(lambda: len(holding(parts)) >= 3, "files with messages")
        finally:
            ros.stop()
    for _, channel, message in (entry for path in holding(parts) for entry in by_mcap(path)):
        assert channel.topic == "/description"
        assert b"a robot" in message.data
    assert not ros.lost


def holding(parts):
    """The files that are ended and have messages."""
    return [path for path in parts.paths[:-1] if by_mcap(path)]


def test_a_topic_that_is_published_as_several_types_is_named(nodes):
    from std_msgs.msg import Bool, String

    for node, kind in zip(nodes, (String, Bool), strict=True):
        node.create_publisher(kind, "/description", 1)
    ros = RosTopics(TrafficFilter())
    ros.open()
    ros.begin(None, print)
    ros.stop()
    assert ros.mixed == {"/description": ["std_msgs/msg/Bool", "std_msgs/msg/String"]}


def test_messages_for_which_there_was_no_time_are_counted(publisher):
    from std_msgs.msg import String

    number, came, entered, go_on = 2500, [], Event(), Event()

    def take(*message):
        entered.set()
        go_on.wait(PATIENCE)
        came.append(message)

    made = publisher(depth=10)
    ros = RosTopics(TrafficFilter())
    ros.open()
    ros.begin(["/description"], take)
    try:
        wait_for(lambda: made.get_subscription_count() > 0, "recorder")
        # What was lost before the first that came, nobody can know.
        made.publish(String(data="first"))
        assert entered.wait(PATIENCE)
        for index in range(1, number):
            made.publish(String(data=str(index)))
            assert made.wait_for_all_acked()
        go_on.set()
        wait_for(lambda: len(came) + ros.lost["/description"] >= number, "messages")
        assert ros.lost["/description"] > 0
        assert len(came) + ros.lost["/description"] == number
    finally:
        go_on.set()
        ros.stop()


def test_messages_before_a_publisher_was_heard_are_counted(publisher):
    from std_msgs.msg import String

    came, published = [], 0
    ros = RosTopics(TrafficFilter())
    ros.open()
    ros.begin(["/description"], lambda *message: came.append(message))
    try:
        made = publisher(depth=10)
        end = time.monotonic() + PATIENCE
        while not came and time.monotonic() < end:
            made.publish(String(data=str(published)))
            published += 1
            time.sleep(0.02)
        wait_for(lambda: len(came) + ros.early["/description"] == published, "all accounted for")
    finally:
        ros.stop()
    assert ros.early["/description"] > 0
    assert not ros.lost
