"""The example winch runs with real processes through all its states, and stops when left alone."""

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import warm
from ports import free_port
from scripts import ran, succeeded
from workspaces import python_path

HERE = Path(__file__).resolve().parent
EXAMPLE = HERE.parents[2] / "models" / "examples" / "winch"
LIBRARY = "http://www.jausml.org/library/"
PROGRAM = [
    ("control the winch", "IDLE"),
    ("pay out", "PAYING_OUT"),
    ("wait for the end of the rope", "IDLE"),
    ("pay out further", "refused (END_OF_ROPE), IDLE"),
    ("pay in", "PAYING_IN"),
    ("lock", "LOCKED"),
    ("pay in while locked", "refused (LOCKED), LOCKED"),
    ("release the brake", "IDLE"),
    ("pay in again", "PAYING_IN"),
    ("let go of control", "OUT_OF_WORK"),
    ("take control again", "IDLE"),
    ("pay in slowly", "PAYING_IN"),
    ("set an emergency", "OUT_OF_WORK"),
    ("clear the emergency", "IDLE"),
    ("pay in too fast", "LOCKED"),
]
LINE = re.compile(
    r"operator: ([^:]+): (.+), ([\d.]+) m out at (-?[\d.]+) m/s, load (\d+) N$", re.MULTILINE
)
pytestmark = [pytest.mark.live, pytest.mark.timeout(120)]


@pytest.fixture
def workspace(tmp_path):
    """Generates the example around its skeletons, with a port of its own."""
    for name in ("service.xmi", "winch.xmi"):
        text = (EXAMPLE / name).read_text(encoding="utf-8").replace("../../library/", LIBRARY)
        text = text.replace('<hosts xmi:id="here"', f'<hosts xmi:id="here" port="{free_port()}"')
        (tmp_path / name).write_text(text, encoding="utf-8")
    folder = tmp_path / "ws"
    shutil.copytree(EXAMPLE / "src", folder, ignore=shutil.ignore_patterns("__pycache__"))
    command = ["generate", tmp_path / "winch.xmi", "-o", folder]
    succeeded([*warm.command(), *command], timeout=60)
    return folder


def start(workspace: Path, *options: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*warm.command(), "run", str(workspace), *options],
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def read_until(process: subprocess.Popen[str], text: str, seconds: float = 45.0) -> str:
    """Returns what a process prints up to a text; ends the process when it takes too long."""
    watchdog = threading.Timer(seconds, process.send_signal, [signal.SIGINT])
    watchdog.start()
    seen = ""
    for line in process.stdout:
        seen += line
        if text in line:
            break
    watchdog.cancel()
    return seen


def stop(process: subprocess.Popen[str]) -> str:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=30)
    assert process.returncode == 0, rest
    return rest


@pytest.mark.slow
def test_the_operator_leads_the_winch_through_its_states(workspace):
    process = start(workspace)
    seen = read_until(process, "all done")
    rest = stop(process)
    rows = LINE.findall(seen)
    assert [(name, told) for name, told, *_ in rows] == PROGRAM, seen
    for name, told, length, speed, load in rows:
        moves = told.startswith("PAYING")
        assert (float(speed) != 0) == moves, name
        assert (load == "0") == (name == "pay in too fast")
        assert 0 <= float(length) <= 2.01
    assert rest.count("drops: none") == 2, rest


@pytest.mark.slow
def test_the_winch_stops_when_its_operator_dies(workspace):
    process = start(workspace, "--only", "winch")
    seen = read_until(process, "winch runs as")
    assert "winch runs as 120.1.1" in seen
    try:
        done = ran(
            [sys.executable, str(HERE / "dying_operator.py")],
            env={**os.environ, "PYTHONPATH": python_path(workspace)},
            timeout=60,
        )
    finally:
        rest = stop(process)
    assert done.returncode == 0, done.stdout + done.stderr + rest
    assert done.stdout.split() == ["IDLE", "PAYING_OUT", "OUT_OF_WORK"]
