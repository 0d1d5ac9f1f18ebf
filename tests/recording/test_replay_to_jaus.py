"""`jausml replay` of topics: bridges on the network that say what was recorded, and no more."""

import signal
import struct
import subprocess
import time
from pathlib import Path

import pytest
import warm
from click.testing import CliRunner
from mcap.writer import Writer
from ports import free_port
from recordings import PATIENCE, wait_for

from jausml.cli import main
from jausml.live.api.component import Component
from jausml.live.peers.query_client import NoAnswer

pytestmark = pytest.mark.ports
ROOT = Path(__file__).resolve().parents[2]
FLEET = str(ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus")
FINDER = str(ROOT / "tests" / "live" / "found_peers.ros2jaus")
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND


def odometry(x, y, yaw_rate):
    """nav_msgs/Odometry in CDR, little endian: with empty names of frames."""
    data = struct.pack("<iI", 1_700_000_000, 0) + struct.pack("<I4s", 1, b"\0\0\0\0")
    data = data[:-3] + b"\0\0\0" + struct.pack("<I", 1) + b"\0"
    data += bytes(-len(data) % 8) + bytes(8 * (7 + 36))
    return b"\0\1\0\0" + data + struct.pack("<6d", x, y, 0, 0, 0, yaw_rate) + bytes(8 * 36)


def twist(linear, angular):
    """geometry_msgs/Twist in CDR."""
    return b"\0\1\0\0" + struct.pack("<6d", linear, 0, 0, 0, 0, angular)


def record(path, topic, kind, messages, step=SECOND // 10):
    """Writes an MCAP file with messages of one topic, and one that no bridge takes."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        channels = [
            writer.register_channel(name, "cdr", writer.register_schema(of, "ros2msg", b""))
            for name, of in ((topic, kind), ("/elsewhere", "std_msgs/msg/Bool"))
        ]
        for index, message in enumerate(messages):
            time_ns = BEGIN + index * step
            writer.add_message(channels[0], time_ns, message, time_ns)
        writer.add_message(channels[1], BEGIN, b"\0\1\0\0\1", BEGIN)
        writer.finish()
    return str(path)


class Replay:
    """The verb, in a process of its own."""

    def __init__(self, folder, *arguments):
        self.log = folder / "replay.log"
        with self.log.open("wb") as log:
            line = [*warm.command(), "replay", *arguments]
            self.process = subprocess.Popen(line, stderr=log)

    def end(self):
        """Ends it in good order; returns its exit code."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout=PATIENCE)

    def close(self):
        self.process.kill()
        self.process.wait(timeout=PATIENCE)


def subscribed(component, target, name):
    """Subscribes as soon as the target is there."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return component.subscribe(target, name)
        except NoAnswer:
            assert time.monotonic() < end, f"{target} does not answer"


def test_reports_come_as_they_were_recorded(tmp_path):
    port = free_port()
    speeds = [1 + number / 100 for number in range(2000)]
    messages = [odometry(speed, -0.5, 0.25) for speed in speeds]
    bag = record(tmp_path / "run.mcap", "/odom", "nav_msgs/msg/Odometry", messages, SECOND // 5)
    replay = Replay(tmp_path, bag, FLEET, "--port", str(port), "--wait", "0", "--speed", "2")
    try:
        with Component("65001.1.1", port=port) as component:
            with subscribed(component, "100.1.10", "ReportVelocityState") as reports:
                heard = [reports.next(PATIENCE).fields for _ in range(6)]
            assert replay.end() == 0, replay.log.read_text()
    finally:
        replay.close()
    moving = [report for report in heard if "Velocity_X" in report]
    # It comes in the midst, and then everything as it was.
    first = round((moving[0]["Velocity_X"] - 1) * 100)
    expected = speeds[first : first + len(moving)]
    assert [report["Velocity_X"] for report in moving] == pytest.approx(expected, abs=1e-6)
    assert len(moving) >= 5
    assert moving[0]["Velocity_Y"] == pytest.approx(0.5, abs=1e-6)  # left is minus right
    assert moving[0]["YawRate"] == pytest.approx(-0.25, abs=1e-3)
    said = replay.log.read_text()
    assert "of /odom" in said
    assert "robot.velocity_state: " in said
    assert "1 of /elsewhere, which no bridge takes" in said
    assert "no definition of the type of /odom: that of MODEL was used" in said


def test_commands_need_to_be_allowed(tmp_path):
    bag = record(tmp_path / "run.mcap", "/cmd_vel", "geometry_msgs/msg/Twist", [twist(1.0, 0.0)])
    result = CliRunner().invoke(main, ["replay", bag, FINDER, "--port", str(free_port())])
    assert result.exit_code == 2
    assert "--allow-commands sends finder.drive (SetWrenchEffort)" in result.stderr


@pytest.mark.slow
def test_commands_that_are_allowed_reach_who_obeys(tmp_path):
    port = free_port()
    bag = record(
        tmp_path / "run.mcap", "/cmd_vel", "geometry_msgs/msg/Twist", [twist(1.0, 0.0)] * 2000
    )
    taken = []
    provides = ["PrimitiveDriver", "VelocityStateSensor"]
    with Component("10.1.1", provides=provides, port=port) as vehicle:
        vehicle.obey("SetWrenchEffort", taken.append)
        arguments = ("--port", str(port), "--allow-commands", "--wait", "0")
        replay = Replay(tmp_path, bag, FINDER, *arguments)
        try:
            wait_for(lambda: len(taken) > 2, "commands")
            assert replay.end() == 0, replay.log.read_text()
        finally:
            replay.close()
    assert taken, replay.log.read_text()
    assert taken[0].sender == "10.1.9"
    efforts = [command.fields["PropulsiveLinearEffortX"] for command in taken]
    assert max(efforts) == pytest.approx(50.0, abs=0.01)  # 1 of 2 m/s
    assert efforts[-1] == pytest.approx(0.0, abs=0.01)  # the end stops what was commanded


def test_wrong_types_and_broken_files_are_told(tmp_path):
    bag = record(tmp_path / "run.mcap", "/odom", "std_msgs/msg/Bool", [b"\0\1\0\0\1"])
    line = [FLEET, "--port", str(free_port()), "--wait", "0", "--hold", "0"]
    result = CliRunner().invoke(main, ["replay", bag, *line])
    assert "/odom has the type std_msgs/msg/Bool, not nav_msgs/msg/Odometry" in result.stderr
    assert result.exit_code == 1
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(Path(bag).read_bytes()[:100])
    result = CliRunner().invoke(main, ["replay", str(broken), *line])
    assert "broken.mcap cannot be read" in result.stderr
    assert "on the network" not in result.stderr  # no bridge was opened for it
    assert result.exit_code == 2


def test_maps_alone_need_the_address_of_a_bridge(tmp_path):
    bag = record(tmp_path / "run.mcap", "/odom", "nav_msgs/msg/Odometry", [])
    maps = str(ROOT / "models" / "library" / "mappings" / "velocity_state_sensor.ros2jaus")
    result = CliRunner().invoke(main, ["replay", bag, maps])
    assert "--bridge-address ID makes a bridge of its maps" in result.stderr
    assert result.exit_code == 2
