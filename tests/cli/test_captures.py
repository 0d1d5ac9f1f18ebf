"""Captures of the verbs: how far they are read."""

from __future__ import annotations

import sys

from terminal import at_terminal

# Results go elsewhere; waits until a line is typed, as the test looks at what is shown.
HALF = """
import os, sys
from jausml.cli import captures, manners
manners.PATIENCE = 0.0
sys.stdout = open(os.devnull, "w")
with captures.opened("day.pcap") as stream:
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
