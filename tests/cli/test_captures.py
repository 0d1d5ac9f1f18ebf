"""Captures of the verbs: how far they are read."""

import struct
import subprocess
import sys

from terminal import at_terminal

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
    command = [sys.executable, "-m", "jausml", "decode", "--format", "json", "--pcap", str(path)]
    done = subprocess.run(command, capture_output=True, timeout=100)
    assert (done.returncode, done.stderr) == (0, b"")
    assert len(done.stdout.splitlines()) == 300
