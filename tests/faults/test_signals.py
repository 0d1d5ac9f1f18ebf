"""A bridge ends well whenever a signal comes, once or twice, also while it begins.

Before its first own line Python itself decides what a signal does: SIGTERM ends the process at
once, and SIGINT too before Python looks for it; then, for some ten milliseconds in which
Python finds the module to run, SIGINT raises KeyboardInterrupt in Python's own lines. The first own
line catches SIGTERM, by which it is known to have run.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import needs
import pytest
from ports import free_domain, free_port

needs.ask("rclpy")

from tests.live.bridge_support import PATIENCE, generate, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.live]

LONGEST = 1.5
"""Seconds from the first line to the signal; a bridge runs after half of them."""
SHARED_MEMORY = Path("/dev/shm")


@pytest.fixture(scope="module")
def path():
    return os.pathsep.join(generate())


def catches_signals(process):
    status = Path(f"/proc/{process.pid}/status").read_text("ascii")
    mask = next(line for line in status.splitlines() if line.startswith("SigCgt"))
    return int(mask.split()[1], 16) & 1 << signal.SIGTERM - 1


def fast_dds():
    return {segment.name for segment in SHARED_MEMORY.glob("*fastdds*")} | {
        segment.name for segment in SHARED_MEMORY.glob("*fastrtps*")
    }


def test_no_line_before_the_first_own_one_takes_long(path):
    """Until signals are caught nothing is imported that is not Python's."""
    script = (
        "import runpy, signal, sys\n"
        "def first(number, handler):\n"
        "    found = sorted(each for each in sys.modules if each.startswith('jausml_runtime'))\n"
        "    print(found)\n"
        "    sys.exit(3)\n"
        "signal.signal = first\n"
        "runpy.run_module('loop_bridge.main', run_name='__main__', alter_sys=True)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.returncode) == ("[]\n", 3), done.stderr


@pytest.mark.parametrize("rounds", [5, pytest.param(20, marks=pytest.mark.faults)])
def test_sigterm_from_exec_on(path, tmp_path, rounds):
    """It ends the process plainly or in good order, and nothing is said of it."""
    chance = random.Random(rounds)
    for number in range(rounds):
        log = tmp_path / f"{number}.log"
        line = [sys.executable, "-m", "loop_bridge.main", "--jaus-port", str(free_port())]
        with log.open("wb") as output:
            process = subprocess.Popen(
                line, env={**os.environ, "PYTHONPATH": path}, stdout=output, stderr=output
            )
            try:
                time.sleep(chance.uniform(0.0, 0.3))
                process.send_signal(signal.SIGTERM)
                code = process.wait(PATIENCE)
            finally:
                process.kill()
                process.wait()
        assert code in (0, -signal.SIGTERM)
        assert "Traceback" not in log.read_text("utf-8")


@pytest.mark.parametrize(
    "rounds", [5, pytest.param(100, marks=[pytest.mark.faults, pytest.mark.timeout(600)])]
)
def test_signals_at_any_moment(path, tmp_path, rounds):
    chance, before = random.Random(rounds), fast_dds()
    environment = {
        **os.environ,
        "PYTHONPATH": path,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": free_domain(),
    }
    for number in range(rounds):
        log = tmp_path / f"{number}.log"
        line = [sys.executable, "-m", "loop_bridge.main", "--jaus-port", str(free_port())]
        with log.open("wb") as output:
            process = subprocess.Popen(line, env=environment, stdout=output, stderr=output)
            try:
                wait_for(lambda: catches_signals(process), "first line")  # noqa: B023
                time.sleep(chance.uniform(0.0, LONGEST))
                kinds = chance.choices((signal.SIGINT, signal.SIGTERM), k=chance.choice((1, 2)))
                for kind in kinds:
                    process.send_signal(kind)
                    time.sleep(chance.uniform(0.0, 0.1))
                code = process.wait(PATIENCE)
            finally:
                process.kill()
                process.wait()
        assert code == 0, (kinds, log.read_text("utf-8"))
        assert "Traceback" not in log.read_text("utf-8")
    assert fast_dds() <= before
