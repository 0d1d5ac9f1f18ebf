"""A running bridge is recorded on both sides, and both recordings say again what it said."""

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path

import needs
import pytest
import warm
from ports import free_domain, free_port

needs.ask("rclpy")

from mcap.reader import make_reader

from jausml.live.api.component import Component
from jausml.live.peers.query_client import NoAnswer

from .bridge_support import Process, RosPeer, generate, wait_for

pytestmark = [pytest.mark.live, pytest.mark.ports]
ROOT = Path(__file__).resolve().parents[2]
FLEET = ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus"
ROBOT, TOPIC, REPORT = "100.1.10", "/odom", "ReportVelocityState"
PATIENCE = 90.0


class Speaker:
    """Publishes odometry whose speed grows, so that each message is known by it."""

    def __init__(self, publisher):
        self.said = 0
        self._publisher = publisher
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        from nav_msgs.msg import Odometry

        while not self._stop.wait(0.1):
            message = Odometry()
            message.twist.twist.linear.x = 1 + self.said / 100
            message.twist.twist.linear.y = -0.5
            self._publisher.publish(message)
            self.said += 1

    @property
    def is_heard(self):
        return self._publisher.get_subscription_count() > 0

    def close(self):
        self._stop.set()
        self._thread.join()


def jausml(*arguments, log, folder=None):
    line = [*warm.command(), *arguments]
    with log.open("wb") as stream:
        return subprocess.Popen(line, stderr=stream, cwd=folder)


def ended(process):
    process.send_signal(signal.SIGTERM)
    return process.wait(timeout=PATIENCE)


def hear(port, count):
    """The speeds and sideways speeds of moving reports, by a component that subscribes."""
    with Component("65001.1.1", port=port) as component:
        subscription = []

        def subscribe():
            try:
                subscription.append(component.subscribe(ROBOT, REPORT))
            except NoAnswer:
                return False
            return True

        wait_for(subscribe, "subscription", PATIENCE)
        with subscription[0] as reports:
            found = []
            while len(found) < count:
                fields = reports.next(PATIENCE).fields
                if "Velocity_X" in fields:
                    found.append((fields["Velocity_X"], fields["Velocity_Y"]))
    return found


def recorded(path, encoding):
    """Topic and message of the records in an encoding."""
    with path.open("rb") as stream:
        return [
            (channel.topic, message.data)
            for _, channel, message in make_reader(stream).iter_messages()
            if channel.message_encoding == encoding
        ]


def speeds_of(path):
    from nav_msgs.msg import Odometry
    from rclpy.serialization import deserialize_message

    messages = [
        deserialize_message(data, Odometry)
        for topic, data in recorded(path, "cdr")
        if topic == TOPIC
    ]
    return [(message.twist.twist.linear.x, message.twist.twist.linear.y) for message in messages]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """What a component heard of a bridge, and the file in which both sides stand."""
    folder = tmp_path_factory.mktemp("recording")
    path, port = folder / "run.mcap", free_port()
    log = folder / "record.log"
    packages = generate(FLEET)
    ros = RosPeer()
    line = ["-m", "robot.main", "--jaus-port", str(port)]
    bridge = Process(line, packages, folder / "bridge.log")
    arguments = ["record", str(FLEET), "--output", str(path), "--port", str(port)]
    arguments += ["--topic", TOPIC, "--topic", "/of_nobody/*"]
    recorder, speaker = jausml(*arguments, log=log), None
    try:
        from nav_msgs.msg import Odometry

        wait_for(lambda: "record" in log.read_text(), "recorder", PATIENCE)
        publisher = ros.publisher(Odometry, TOPIC.strip("/"))
        wait_for(lambda: publisher.get_subscription_count() > 1, "recorder of ROS", PATIENCE)
        speaker = Speaker(publisher)
        heard = hear(port, 10)
        speaker.close()
        assert ended(recorder) == 0, log.read_text()
    finally:
        if speaker is not None:
            speaker.close()
        recorder.kill()
        recorder.wait()
        bridge.close()
        ros.close()
        sys.stderr.write(log.read_text())
    return path, heard, port


@pytest.mark.slow
def test_both_sides_stand_in_one_file(recording):
    path, heard, _ = recording
    reports = [
        json.loads(data)["fields"]
        for topic, data in recorded(path, "json")
        if topic == f"/jaus/{ROBOT}/{REPORT}"
    ]
    said = [
        (report["Velocity_X"], report["Velocity_Y"]) for report in reports if "Velocity_X" in report
    ]
    assert set(heard) <= set(said)
    published = speeds_of(path)
    # Each report is one of the messages, with the axis to the right.
    for x, y in heard:
        assert any(x == pytest.approx(speed, abs=1e-6) for speed, _ in published)
        assert y == pytest.approx(0.5, abs=1e-6)
    assert {y for _, y in published} == {-0.5}


@pytest.mark.slow
def test_capture_beside_it_gives_the_topics_again(recording, tmp_path):
    path, heard, port = recording
    found, log = tmp_path / "again.mcap", tmp_path / "replay.log"
    arguments = ["replay", str(path.with_suffix(".pcap")), str(FLEET), "--output", str(found)]
    process = jausml(*arguments, "--port", str(port), log=log)
    try:
        process.wait(timeout=PATIENCE)
    finally:
        process.kill()
        process.wait()
    again = [x for x, _ in speeds_of(found)]
    for x, _ in heard:
        assert any(x == pytest.approx(speed, abs=1e-6) for speed in again), log.read_text()


@pytest.mark.slow
def test_topics_given_back_to_jaus_say_the_same(recording, tmp_path):
    path, _, _ = recording
    port, log = free_port(), tmp_path / "replay.log"
    arguments = ["replay", str(path), str(FLEET), "--port", str(port), "--speed", "0.1"]
    process = jausml(*arguments, "--wait", "0", log=log)
    try:
        again = hear(port, 3)
        assert ended(process) == 0, log.read_text()
    finally:
        process.kill()
        process.wait()
    published = [x for x, _ in speeds_of(path)]
    for x, y in again:
        assert any(x == pytest.approx(speed, abs=1e-6) for speed in published), log.read_text()
        assert y == pytest.approx(0.5, abs=1e-6)


@pytest.mark.slow
def test_all_is_recorded_from_when_it_says_so_of_the_model_of_the_project(tmp_path, monkeypatch):
    from nav_msgs.msg import Odometry

    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    project = tmp_path / "project"
    (project / "models").mkdir(parents=True)
    (project / ".project").write_text("<projectDescription/>", encoding="utf-8")
    (project / "models" / FLEET.name).write_bytes(FLEET.read_bytes())
    path, log = tmp_path / "run.mcap", tmp_path / "record.log"
    ros = RosPeer()
    speaker = Speaker(ros.node.create_publisher(Odometry, TOPIC, 10))
    arguments = ("record", "--output", str(path), "--port", str(free_port()))
    recorder = jausml(*arguments, log=log, folder=project / "models")
    try:
        wait_for(lambda: "recorded" in log.read_text() or "recording" in log.read_text(), "begin")
        if f"nobody publishes {TOPIC} yet" in log.read_text():  # discovery can take long here
            wait_for(lambda: speaker.is_heard, "subscription", PATIENCE)
            first = speaker.said + 1  # what is said now may have been before
        else:
            first = speaker.said
        wait_for(lambda: speaker.said > first + 5, "messages", PATIENCE)
        last = speaker.said - 1
        wait_for(lambda: path.stat().st_size > 0, "file", PATIENCE)
        assert ended(recorder) == 0, log.read_text()
    finally:
        recorder.kill()
        recorder.wait()
        speaker.close()
        ros.close()
    found = {round((x - 1) * 100) for x, _ in speeds_of(path)}
    assert set(range(first, last)) <= found
