"""What systemd hears of a process that it watches."""

import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.component.process import feed_watchdog

PROCESS = Path(__file__).parent / "services" / "robot_process.py"
TIME_OUT = 0.3
pytestmark = pytest.mark.ports


@pytest.fixture
def manager(tmp_path):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as made:
        made.bind(str(tmp_path / "notify"))
        made.settimeout(20)
        yield made


def watched(manager, **more):
    microseconds = str(int(TIME_OUT * 1e6))
    return {"NOTIFY_SOCKET": manager.getsockname(), "WATCHDOG_USEC": microseconds, **more}


def heard(manager):
    """Whether a word comes within three times the time-out."""
    manager.settimeout(3 * TIME_OUT)
    try:
        return manager.recv(64) == b"WATCHDOG=1"
    except TimeoutError:
        return False


def drain(manager):
    manager.setblocking(False)
    try:
        while manager.recv(64):
            pass
    except BlockingIOError:
        manager.setblocking(True)


def test_a_component_that_runs_is_alive_and_one_that_stands_still_is_not(manager):
    line = [sys.executable, str(PROCESS), "--jaus-id", "100.1.77"]
    environment = {**os.environ, **watched(manager)}
    with subprocess.Popen(line, env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            assert [manager.recv(64) for _ in range(3)] == [b"WATCHDOG=1"] * 3
            process.send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
            drain(manager)
            assert not heard(manager)
            process.send_signal(signal.SIGCONT)
            assert heard(manager)
        finally:
            process.send_signal(signal.SIGCONT)
            process.terminate()


@pytest.mark.parametrize(
    "change",
    [
        {"NOTIFY_SOCKET": ""}, {"WATCHDOG_USEC": ""}, {"WATCHDOG_USEC": "-1"},
        {"WATCHDOG_USEC": "0"}, {"WATCHDOG_PID": "1"},
    ],
)  # fmt: skip
def test_whom_nobody_watches_says_nothing(manager, change):
    with Loop() as loop:
        feed_watchdog(loop, watched(manager, **change))
    manager.setblocking(False)
    with pytest.raises(BlockingIOError):
        manager.recv(64)


def test_an_abstract_socket_is_one_too():
    name = f"\0jausml-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager, Loop() as loop:
        manager.bind(name)
        manager.settimeout(20)
        own = {"NOTIFY_SOCKET": f"@{name[1:]}", "WATCHDOG_USEC": "1000000"}
        feed_watchdog(loop, {**own, "WATCHDOG_PID": str(os.getpid())})
        assert manager.recv(64) == b"WATCHDOG=1"


def test_a_manager_that_is_gone_ends_nothing(tmp_path, caplog):
    with Loop() as loop:
        feed_watchdog(loop, {"NOTIFY_SOCKET": str(tmp_path / "no"), "WATCHDOG_USEC": "1000"})
        loop.run_once(0.01)
    assert "cannot be told" in caplog.text


def test_a_manager_that_comes_back_is_told_again(tmp_path):
    place = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager, Loop() as loop:
        feed_watchdog(loop, {"NOTIFY_SOCKET": str(place), "WATCHDOG_USEC": "3000"})
        manager.bind(str(place))
        manager.settimeout(0.01)
        for _ in range(1000):
            loop.run_once(0.01)
            with suppress(TimeoutError):
                assert manager.recv(64) == b"WATCHDOG=1"
                return
    pytest.fail("it is told no more")


def test_a_manager_that_reads_nothing_does_not_hold_up_the_loop(manager):
    with Loop() as loop:
        feed_watchdog(loop, {**watched(manager), "WATCHDOG_USEC": "300"})
        # More than its socket takes in.
        for _ in range(1000):
            loop.run_once(0.01)
    drain(manager)
