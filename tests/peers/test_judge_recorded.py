"""What a score sheet says stands in a recording made beside it, so that it can be appealed."""

import json
import signal
import subprocess
from datetime import datetime

import needs
import pytest
import warm

from jausml.live.traffic.captures import read_frames
from jausml.live.traffic.frames import UdpReader

pytestmark = pytest.mark.ports

WAIT = 60.0
CLOCKS = 0.5
"""Seconds between the times of a message on the sheet and in the capture, with a busy computer."""


@pytest.fixture
def recorded(free_port, tmp_path, wait_until):
    """Records what is done, and returns the datagrams and their times."""
    needs.ask("capture")
    path, log = tmp_path / "run.mcap", tmp_path / "record.log"
    line = [*warm.command(), "record", "--output", path, "--port", str(free_port)]

    def record(act):
        with log.open("wb") as stream:
            recorder = subprocess.Popen([*map(str, line)], stderr=stream, cwd=tmp_path)
        try:
            wait_until(lambda: "record" in log.read_text() or recorder.poll() is not None, WAIT)
            act()
            recorder.send_signal(signal.SIGTERM)
            assert recorder.wait(WAIT) == 0, log.read_text()
        finally:
            recorder.kill()
            recorder.wait()
        reader = UdpReader(free_port)
        with path.with_suffix(".pcap").open("rb") as stream:
            found = [reader.read(frame) for frame in read_frames(stream)]
        return [(datagram.time, datagram.data.hex()) for datagram in found if datagram is not None]

    return record


def test_each_message_of_a_sheet_stands_in_the_capture_at_its_time(jausml, vehicle, recorded):
    vehicle()
    sheets = []

    def judge():
        options = ("--only", "management", "--only", "velocity", "--format", "json")
        result = jausml("judge", "100.1.1", *options)
        assert result.exit_code == 1, result.stderr
        sheets.append(json.loads(result.stdout))

    capture = recorded(judge)
    parts = [part for task in sheets[0]["tasks"] for part in task["parts"]]
    assert 0 < sum(part["points"] > 0 for part in parts) < len(parts)
    said = [
        (datetime.fromisoformat(part["begun"]).timestamp() + line["time"], line)
        for part in parts
        for line in part["evidence"]
        if line["hex"]
    ]
    assert {line["direction"] for _, line in said} == {"sent", "received"}
    for at, line in said:
        near = [data for time, data in capture if abs(time - at) < CLOCKS]
        assert any(data.startswith(line["hex"]) for data in near), line
