"""The bridge of the example is killed while the vehicle drives, and started again."""

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import warm

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "models" / "catvehicle"
OTHERS = ("vehicle", "operator_control_unit", "steering_controller", "velocity_controller")
PATIENCE = 40.0
SPEED = re.compile(r"vehicle at .* ([\d.]+) m/s\b")
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(150)]


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Generates the example around its skeletons."""
    folder = tmp_path / "ws"
    shutil.copytree(EXAMPLE / "src", folder, ignore=shutil.ignore_patterns("__pycache__"))
    command = [*warm.command(), "generate", str(EXAMPLE / "catvehicle.xmi")]
    subprocess.run([*command, "-o", str(folder)], check=True, capture_output=True, timeout=60)
    return folder


class System:
    """Processes of `jausml run` and the lines that they print."""

    def __init__(self, workspace: Path, names: tuple[str, ...]) -> None:
        only = [word for name in names for word in ("--only", name)]
        self.lines: list[str] = []
        self.process = subprocess.Popen(
            [sys.executable, "-m", "jausml", "run", str(workspace), *only],
            env={**os.environ, "ROS_DOMAIN_ID": "89"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line)

    def speeds(self, start: int = 0) -> list[float]:
        """Returns the speeds that the operator has seen since a line."""
        found = (SPEED.search(line) for line in self.lines[start:])
        return [float(match[1]) for match in found if match]

    def stop(self) -> None:
        """Ends the processes in good order."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        self.process.wait(20)
        self._reader.join()
        assert self.process.stdout is not None
        self.process.stdout.close()


@contextmanager
def running(workspace: Path, *names: str) -> Iterator[System]:
    """Starts some processes of a workspace."""
    system = System(workspace, names)
    try:
        yield system
    finally:
        system.stop()


def wait_for(condition: Callable[[], bool], what: str, system: System) -> None:
    """Waits until a condition holds.

    Raises:
        AssertionError: It did not come to hold.
    """
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f"{what}\n{''.join(system.lines[-30:])}"
        time.sleep(0.05)


def kill_bridge(bridge: System) -> None:
    """Kills the bridge itself, by the id that the system gives for the child of `jausml run`.

    The other child is the shell that ends the bridge when `jausml run` is killed.
    """
    children = Path(f"/proc/{bridge.process.pid}/task/{bridge.process.pid}/children")
    (child,) = [
        word
        for word in children.read_text(encoding="ascii").split()
        if b"bridge.main" in Path(f"/proc/{word}/cmdline").read_bytes().split(b"\0")
    ]
    os.kill(int(child), signal.SIGKILL)
    bridge.process.wait(20)


def test_vehicle_stops_without_the_bridge_and_goes_on_with_a_new_one(workspace):
    with running(workspace, *OTHERS) as others:
        with running(workspace, "bridge") as bridge:
            wait_for(lambda: max(others.speeds(), default=0.0) > 2.0, "never drove", others)
            kill_bridge(bridge)
        killed = len(others.lines)
        wait_for(lambda: 0.0 in others.speeds(killed), "did not stop", others)
        stopped = len(others.lines)
        with running(workspace, "bridge") as bridge:
            wait_for(
                lambda: max(others.speeds(stopped), default=0.0) > 2.0,
                "did not go on\n" + "".join(bridge.lines),
                others,
            )
