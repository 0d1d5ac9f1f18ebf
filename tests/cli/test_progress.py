"""How far a capture is read stands on a terminal, and in no log."""

from __future__ import annotations

import contextlib
import os
import pty
import struct
import subprocess
import sys
import threading

import pytest

DATAGRAM = bytes.fromhex("02 00 1000 01 0201c800 01016500 0220 0700")


@pytest.fixture
def capture(tmp_path):
    """Datagrams over raw IP, as many as a bar has steps."""
    udp = struct.pack(">HHHH", 3794, 3794, 8 + len(DATAGRAM), 0) + DATAGRAM
    packet = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 1, 0, 16, 17, 0) + bytes(8) + udp
    frames = b"".join(
        struct.pack("<IIII", n, 0, len(packet), len(packet)) + packet for n in range(300)
    )
    path = tmp_path / "day.pcap"
    path.write_bytes(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101) + frames)
    return path


def command(capture):
    return [sys.executable, "-m", "jausml", "decode", "--format", "json", "--pcap", str(capture)]


class Terminal:
    """What a program writes to a terminal, which somebody has to read all the time."""

    def __init__(self):
        self._ours, self.end = pty.openpty()
        self._parts = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with contextlib.suppress(OSError):  # nobody has the other end any more
            while part := os.read(self._ours, 1 << 16):
                self._parts.append(part)

    def close(self):
        """Returns what was written."""
        os.close(self.end)
        self._reader.join(timeout=60)
        os.close(self._ours)
        return b"".join(self._parts).decode()


def test_terminal_shows_it_while_the_output_goes_elsewhere(capture, tmp_path):
    terminal = Terminal()
    try:
        with (tmp_path / "out").open("wb") as out:
            done = subprocess.run(command(capture), stdout=out, stderr=terminal.end, timeout=100)
    finally:
        said = terminal.close()
    assert done.returncode == 0
    assert "day.pcap" in said
    assert "100%" in said
    assert len((tmp_path / "out").read_text().splitlines()) == 300


def test_log_has_nothing_of_it(capture):
    done = subprocess.run(command(capture), capture_output=True, timeout=100)
    assert (done.returncode, done.stderr) == (0, b"")
    assert len(done.stdout.splitlines()) == 300
