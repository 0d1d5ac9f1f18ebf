"""`jausml judge` from the command line: sheets, choices, exit status."""

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

QUICK = ("--timeout", "0.4", "--quiet-time", "0.06")


def test_full_marks_exit_with_0_and_are_told_as_they_come(jausml, vehicle, tmp_path):
    vehicle()
    page = tmp_path / "sheet.html"
    choice = ("--only", "management.standby", "--only", "velocity.report")
    result = jausml("judge", "100.1.1", *choice, "-o", page, *QUICK)
    # The vehicle has a velocity without yaw rate.
    assert result.exit_code == 1, result.stderr
    lines = result.stdout.splitlines()
    assert lines[0] == "IGVC JAUS Challenge: 100.1.1"
    assert "System management" in lines
    assert any(line.split()[:2] == ["1/1", "management.standby"] for line in lines)
    assert any(line.split()[:3] == ["0/4", "LOST", "velocity.report"] for line in lines)
    assert any("lacks YawRate, TimeStamp" in line for line in lines)
    assert any(">> 42.1.1 > 100.1.1" in line for line in lines)
    assert any(line.split() == ["Sum", "7", "of", "11", "points"] for line in lines)
    assert "score sheet of 100.1.1" in page.read_text(encoding="utf-8")

    full = jausml("judge", "100.1.1", "--only", "management.standby", *QUICK)
    assert full.exit_code == 0, full.stdout


def test_json_alone_goes_to_stdout(jausml, vehicle):
    vehicle()
    options = ("--competition", "conformance", "--only", "liveness", "--format", "json")
    result = jausml("judge", "100.1.1", *options, *QUICK)
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert (found["competition"], found["points"], found["of"]) == ("conformance", 2, 2)


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ((), "Missing argument 'TARGET_ID'"),
        (("100.1",), "not a JAUS address"),
        (("42.1.7",), "choose another --id"),
        (("100.1.1", "--only", "velocty"), "did you mean velocity"),
        (("100.1.1", "--only", "nothing"), "it has capabilities,"),
        (("100.1.1", "--competition", "igvc"), "'igvc-jaus'"),
        (("100.1.1", "--waypoint", "2"), "'2' is not X,Y in metres"),
        (("100.1.1", "--waypoint", "nan,0"), "'nan,0' is more than 1000 m away"),
        (("100.1.1", "--only", "velocity", *QUICK), "100.1.1 does not answer"),
        (("100.1.1", "--interface", "192.0.2.1", *QUICK), "the network cannot be used"),
    ],
)
def test_usage_and_environment_exit_with_2(arguments, error, refused):
    refused(error, "judge", *arguments)


def test_a_sheet_that_cannot_be_written_is_told(refused, vehicle, tmp_path):
    vehicle()
    place = tmp_path / "no" / "sheet.html"
    refused("cannot write", "judge", "100.1.1", "--only", "management.status", "-o", place, *QUICK)


# -- what a sheet says stands in a recording made beside it ----------------------------------------


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
