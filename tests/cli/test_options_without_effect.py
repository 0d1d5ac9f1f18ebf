"""Options that have no effect beside others are refused, and how far captures are read."""

import shlex
import struct
import subprocess
import sys

import pytest
import warm
from terminal import at_terminal


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("init d --hold cmd_vel=brakes", "--hold: only with --from topics"),
        ("init d --from igvc --joints x=a,b --side operator", "--side, --joints: only with"),
        ("init d --copies --from example --name foo", "--name, --from: not with --copies"),
        ("init d --copies odom:nav_msgs/Odometry", "takes no SOURCE"),
        ("init . --copies", "is no project"),
        ("new --format json component foo", "--format: only with --open"),
        ("new connection scan:sensor_msgs/LaserScan --for 3", "--for: only with --from-graph"),
        ("new bridge b scan:sensor_msgs/LaserScan --for 3", "--for: only with --from-graph"),
        ("replay e.mcap -o o.mcap --with-jaus", "--with-jaus: not where an MCAP file is copied"),
        (
            "replay e.mcap -o o.mcap --ros-only --count 1 --loop --bridge-address 1.1.1",
            "--loop, --count, --bridge-address: not where an MCAP file is copied",
        ),
        ("replay e.mcap m.xmi --force", "--force: only with --output"),
        ("replay e.pcap m.xmi -o o.mcap --count 1", "--count: only where a ROS recording goes to"),
        ("replay e.pcap m.xmi -o o.mcap --loop --allow-commands", "--loop, --allow-commands: only"),
        ("decode --pcap e.pcap --duration 3", "--duration: only with --listen"),
        ("decode --pcap e.pcap --datagram", "--datagram: only with hex"),
        ("decode --listen --datagram --duration 0", "--datagram: only with hex"),
        ("decode 0220 --port 4000", "--port: only with --pcap or --listen"),
        ("decode 0220 --interface 127.0.0.1", "--interface: only with --listen"),
        ("validate e.pcap --frequency 5", "--frequency: only with --bridge-address"),
        ("convert a.xmi b.ros2jaus --frequency 5", "--frequency: only with --bridge-address"),
        (
            'new map m A b/C --direction to-ros --to-jaus "a=b"',
            "--to-jaus: not with --direction to-ros",
        ),
        (
            'new map m A b/C --direction to-jaus --to-ros "a=b"',
            "--to-ros: not with --direction to-jaus",
        ),
        ("new map m A b/C --joints a,b --zeros-stop", "--zeros-stop: not with --joints"),
        ("new map m A b/C --joints a,b --fill", "--fill: not with --joints"),
        ("new map m A b/C --copy x --fill", "--fill: not with --copy"),
    ],
)
def test_what_would_have_no_effect_is_refused(jausml, here, line, told):
    for name in ("e.pcap", "e.mcap"):
        (here / name).touch()
    done = jausml(*shlex.split(line))
    assert (done.exit_code, told in done.stderr) == (2, True), done.output
    assert done.stdout == ""
    assert {path.name for path in here.iterdir()} == {"e.pcap", "e.mcap"}


# -- captures --------------------------------------------------------------------------------------


DATAGRAM = bytes.fromhex("02 00 1000 01 0201c800 01016500 0220 0700")

# Results go elsewhere; waits until a line is typed, as the test looks at what is shown.
HALF = """
import os, sys
from jausml.cli.live import recordings
from jausml.cli.shared import terminal
terminal.PATIENCE = 0.0
sys.stdout = open(os.devnull, "w")
with recordings.opened("day.pcap") as stream:
    stream.read(50)
    sys.stdin.readline()
    left = len(stream.read())
print("left", left, file=sys.stderr)
"""


def test_how_far_a_capture_is_read_is_shown(tmp_path):
    (tmp_path / "day.pcap").write_bytes(bytes(100))
    with at_terminal(sys.executable, "-c", HALF, cwd=tmp_path) as terminal:
        terminal.wait_for("reading day.pcap ... 50%, ")
        terminal.type("\n")
        terminal.wait_for("left 50")


def test_nothing_is_shown_beside_results(tmp_path):
    (tmp_path / "day.pcap").write_bytes(bytes(100))
    code = HALF.replace('sys.stdout = open(os.devnull, "w")', "")
    with at_terminal(sys.executable, "-c", code, cwd=tmp_path) as terminal:
        terminal.type("\n")
        assert "day.pcap" not in terminal.read_all()


def test_no_log_has_it(tmp_path):
    udp = struct.pack(">HHHH", 3794, 3794, 8 + len(DATAGRAM), 0) + DATAGRAM
    packet = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 1, 0, 16, 17, 0) + bytes(8) + udp
    frame = struct.pack("<IIII", 1, 0, len(packet), len(packet)) + packet
    path = tmp_path / "day.pcap"
    path.write_bytes(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101) + 300 * frame)
    command = [*warm.command(), "decode", "--format", "json", "--pcap", str(path)]
    done = subprocess.run(command, capture_output=True, timeout=100)
    assert (done.returncode, done.stderr) == (0, b"")
    assert len(done.stdout.splitlines()) == 300
