"""A bridge that is asked to end at any moment of its life, and one whose log has no room."""

from __future__ import annotations

import errno
import random
import signal
import time

import pytest

pytest.importorskip("rclpy")

from isolation import small_folder

from tests.live.bridge_support import Process, free_port

from .conftest import running
from .failing import nonsense

ROUNDS = 100
LATEST = 2.0
"""Seconds after the start until which a signal comes: imports, ROS, sockets, and some rest."""

pytestmark = [
    pytest.mark.live,
    pytest.mark.faults,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]


@pytest.mark.timeout(600)
def test_bridge_ends_at_any_moment(path, tmp_path):
    rng = random.Random(17)
    bad = []
    for number in range(ROUNDS):
        kind = rng.choice((signal.SIGTERM, signal.SIGINT))
        moment = rng.uniform(0.0, LATEST)
        line = ["-m", "loop_bridge.main", "--jaus-port", str(free_port())]
        process = Process(line, path, tmp_path / f"{number}.log")
        time.sleep(moment)
        process.popen.send_signal(kind)
        code = process.popen.wait(timeout=30)
        process.close()
        log = process.log.read_text()
        # Before Python has begun to run the program, the signal itself ends the process.
        if code not in (0, -kind) or "Traceback" in log:
            bad.append(f"{kind.name} after {moment:.2f} s: exit code {code}\n{log[-1500:]}")
    assert not bad, f"{len(bad)} of {ROUNDS}:\n" + "\n".join(bad[:3])


@pytest.mark.timeout(120)
def test_log_without_room(path, tmp_path, monkeypatch):
    logs = tmp_path / "logs"
    reason = small_folder(logs, 1 << 16)
    if reason:
        pytest.skip(f"no small file system can be mounted ({reason})")
    monkeypatch.setenv("ROS_LOG_DIR", str(logs))
    with running(path, logs) as system:
        fill(logs / "rest")
        with nonsense(system):
            system.flows(time.monotonic())
        system.end("bridge")
        system.start("bridge")
        system.flows(time.monotonic())


def fill(file):
    """Writes until there is no room."""
    with file.open("wb", buffering=0) as out:
        try:
            while True:
                out.write(b"x")
        except OSError as error:
            assert error.errno == errno.ENOSPC  # noqa: PT017 - how many writes fit is not known
