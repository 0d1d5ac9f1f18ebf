"""`jausml replay` of captures: an MCAP file that others read, with the right values and times."""

import json
import math
import struct
from pathlib import Path

import pytest
from click.testing import CliRunner
from recordings import BEGIN, by_mcap, by_rosbags, event, frame, nano_pcap, pose, velocity

from jausml.cli import main

ROOT = Path(__file__).resolve().parents[2]
MAPS = str(ROOT / "models" / "library" / "mappings" / "odometry.ros2jaus")
VELOCITIES = str(ROOT / "models" / "library" / "mappings" / "velocity_state_sensor.ros2jaus")
SMALL = str(ROOT / "models" / "library" / "mappings" / "odometer.ros2jaus")
FLEET = str(ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus")
STEP = 10_000_001
QUERY_STATUS = bytes.fromhex("0220")
NOON = 12 * 3600 * 1000


def replay(tmp_path, frames, model, *options, name="found.mcap"):
    """Replays a capture of frames; returns the file and what the verb said."""
    capture, found = tmp_path / "capture.pcap", tmp_path / name
    capture.write_bytes(nano_pcap(frames, STEP))
    result = CliRunner().invoke(
        main, ["replay", str(capture), model, "--output", str(found), *options]
    )
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return found, result


@pytest.fixture(scope="module")
def joined(tmp_path_factory):
    """Two vehicles that report velocity and pose by events; the second says no velocity.

    The name of the join is none that a parameter in Python has.
    """
    frames = [
        frame(event(velocity(2.0, 0.5, 0.25))),
        frame(event(pose(3.0, 4.0, math.pi / 2))),
        frame(QUERY_STATUS),
        frame(event(pose(1.0, 1.0, 0.0)), source=(101, 1, 1)),
        *([frame(QUERY_STATUS)] * 60),
        frame(pose(5.0, 0.0, 0.0), source=(100, 1, 2)),
    ]
    folder = tmp_path_factory.mktemp("joined")
    model, text = folder / "odometry.ros2jaus", Path(MAPS).read_text(encoding="utf-8")
    text = text.replace("report_join velocity", "report_join ownVelocity")
    model.write_text(text.replace("velocity.", "ownVelocity."), encoding="utf-8")
    return replay(folder, frames, str(model), "--with-jaus")


@pytest.fixture(scope="module")
def velocities(tmp_path_factory):
    """Velocities of two components, and what is none."""
    frames = [
        frame(event(velocity(2.0, 0.5, 0.25, NOON + 123))),
        frame(velocity(-1.5, 0.0, -0.5), source=(7, 2, 3)),
        frame(velocity(1.0, 0.0, 0.0)[:7]),
        frame(b"\x04"),
    ]
    return replay(tmp_path_factory.mktemp("velocities"), frames, VELOCITIES)


def test_values_frames_and_times_by_figures_of_their_own(velocities):
    path, result = velocities
    heard = {}
    for by_rosbag in by_rosbags(path):
        heard.setdefault(by_rosbag.topic, []).append(by_rosbag)
    first, second = heard["/velocity_state"]
    assert (first.time, second.time) == (BEGIN, BEGIN + STEP)  # to the nanosecond
    linear, angular = first.message.twist.twist.linear, first.message.twist.twist.angular
    assert linear.x == pytest.approx(2.0, abs=1e-6)
    assert linear.y == pytest.approx(-0.5, abs=1e-6)  # right in JAUS is minus left in ROS
    assert angular.z == pytest.approx(-0.25, abs=1e-3)
    assert (first.message.header.frame_id, first.message.child_frame_id) == ("odom", "base_link")
    # Noon of the day of the month that the message says, of the month of the capture.
    stamp = first.message.header.stamp
    assert (stamp.sec, stamp.nanosec) == (1_699_963_200, 123_000_000)
    assert second.message.twist.twist.linear.x == pytest.approx(-1.5, abs=1e-6)
    assert set(heard) == {"/velocity_state", "/velocity_state_twist"}
    assert "of 2 components together" in result.stderr


@pytest.mark.slow
def test_joined_report_of_the_same_vehicle_while_it_is_fresh(joined):
    path, result = joined
    odometry = [
        (channel, message)
        for _, channel, message in by_mcap(path)
        if channel.message_encoding == "cdr"
    ]
    ((channel, message),) = odometry
    assert (channel.topic, message.log_time) == ("/odometry", BEGIN + STEP)
    # Its end: covariance of the twist, before it the twist itself.
    twist = struct.unpack_from("<6d", message.data, len(message.data) - 8 * 36 - 8 * 6)
    assert twist[:3] == pytest.approx((2.0, -0.5, 0.0), abs=1e-6)
    assert twist[5] == pytest.approx(-0.25, abs=1e-3)
    # The pose of the other vehicle, and one that comes too late, have no fresh velocity.
    assert "2 not translated: a joined report is not fresh" in result.stderr
    assert "61 QueryStatus (0x2002)" in result.stderr
    assert result.exit_code == 1


def test_jaus_messages_as_json_with_a_schema(tmp_path):
    frames = [
        frame(event(velocity(2.0, 0.5, 0.25))),
        frame(event(pose(1.0, 1.0, 0.0)), source=(101, 1, 1)),
    ]
    path, _ = replay(tmp_path, frames, SMALL, "--with-jaus")
    found = [
        (schema, channel, json.loads(message.data))
        for schema, channel, message in by_mcap(path)
        if channel.message_encoding == "json"
    ]
    topics = {channel.topic for _, channel, _ in found}
    assert "/jaus/100.1.1/ReportVelocityState" in topics
    assert "/jaus/101.1.1/ReportLocalPose" in topics
    schema, _, value = found[0]
    assert value["fields"]["Velocity_X"] == pytest.approx(2.0, abs=1e-6)
    assert (value["source"], value["destination"]) == ("100.1.1", "200.1.1")
    assert schema.encoding == "jsonschema"
    fields = json.loads(schema.data)["properties"]["fields"]["properties"]
    assert fields["Velocity_X"]["type"] == "number"
    assert "meter per second" in fields["Velocity_X"]["description"]
    assert set(value["fields"]) <= set(fields)


def test_file_that_bags_are_made_of(velocities):
    path, _ = velocities
    # What rosbag2 asks of a bag: one encoding, the names of types, their definitions.
    records = by_mcap(path)
    assert {channel.message_encoding for _, channel, _ in records} == {"cdr"}
    assert {schema.name for schema, _, _ in records} == {
        "nav_msgs/msg/Odometry",
        "geometry_msgs/msg/TwistStamped",
    }
    assert {schema.encoding for schema, _, _ in records} == {"ros2msg"}


def test_broken_messages_are_counted_and_the_rest_is_done(velocities):
    _, result = velocities
    assert "maps.velocity_state: 1 not translated: the message cannot be read" in result.stderr
    assert result.exit_code == 1


def test_what_a_bridge_of_the_project_has_sent_stands_on_the_topic_it_came_from(
    tmp_path, monkeypatch
):
    effort = struct.pack("<HHH", 0x0405, 0x0001, round((50 + 100) / 200 * 0xFFFF))
    frames = [
        frame(velocity(1.0, 0.0, 0.0), source=(100, 1, 10)),
        frame(velocity(9.0, 0.0, 0.0), source=(100, 1, 11)),  # another component
        frame(effort, source=(200, 1, 1)),
    ]
    capture, found = tmp_path / "capture.pcap", tmp_path / "found.mcap"
    capture.write_bytes(nano_pcap(frames))
    (tmp_path / "fleet.ros2jaus").write_bytes(Path(FLEET).read_bytes())
    monkeypatch.chdir(tmp_path)
    words = ["replay", str(capture), "--output", str(found)]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 2
    assert "Missing argument 'MODEL': no project is here" in result.stderr
    (tmp_path / ".project").write_text("<projectDescription/>", encoding="utf-8")
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, result.output
    assert "1 ReportVelocityState (0x4404)" in result.stderr
    (_, odometry), (_, twist) = speeds = [
        (by_rosbag.topic, by_rosbag.message) for by_rosbag in by_rosbags(found)
    ]
    assert [topic for topic, _ in speeds] == ["/odom", "/cmd_vel"]
    assert odometry.twist.twist.linear.x == pytest.approx(1.0, abs=1e-6)
    assert twist.linear.x == pytest.approx(1.0, abs=1e-3)  # half of 2 m/s
    # A recording of topics is still copied as it is.
    again = tmp_path / "again.mcap"
    result = CliRunner().invoke(main, ["replay", str(found), "--output", str(again)])
    assert result.exit_code == 0, result.output
    assert "2 messages" in result.stderr


def test_capture_that_ends_early_gives_what_it_has(tmp_path):
    capture, found = tmp_path / "cut.pcap", tmp_path / "found.mcap"
    capture.write_bytes(nano_pcap([frame(velocity(1.0, 0.0, 0.0))] * 2)[:-5])
    result = CliRunner().invoke(main, ["replay", str(capture), VELOCITIES, "-o", str(found)])
    assert "the file ends within frame 2 (at byte " in result.stderr
    assert "; it was read until 2023-11-14 22:13:20.123+00:00" in result.stderr
    assert result.exit_code == 1
    assert len(by_rosbags(found)) == 2


def test_existing_file_is_not_overwritten_unasked_nor_by_what_is_no_capture(tmp_path):
    (tmp_path / "found.mcap").write_bytes(b"precious")
    path, result = replay(tmp_path, [], SMALL)
    assert "is there already; --force overwrites it" in result.stderr
    assert (result.exit_code, path.read_bytes()) == (2, b"precious")
    text = tmp_path / "text.pcap"
    text.write_text("no capture", encoding="utf-8")
    words = ["replay", str(text), SMALL, "--force", "-o"]
    for name, content in (("none.mcap", None), ("found.mcap", b"precious")):
        result = CliRunner().invoke(main, [*words, str(tmp_path / name)])
        assert "neither pcap nor pcapng" in result.stderr
        assert result.exit_code == 1
        assert (tmp_path / name).exists() is (content is not None)
    assert path.read_bytes() == b"precious"


def test_model_without_maps_to_ros(tmp_path):
    model = tmp_path / "bare.ros2jaus"
    model.write_text("component vehicle { address: 1.1.1 }\n", encoding="utf-8")
    _, result = replay(tmp_path, [], str(model))
    assert result.exit_code == 2
    assert not (tmp_path / "found.mcap").exists()
