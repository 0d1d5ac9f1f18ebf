"""A log for which the disk has no room."""

import errno
import time

import needs
import pytest

needs.ask("rclpy")

from isolation import small_folder

from .conftest import running
from .failing import nonsense

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.faults]


@pytest.mark.needs("mounts")
@pytest.mark.timeout(120)
def test_log_without_room(path, tmp_path, monkeypatch):
    logs = tmp_path / "logs"
    monkeypatch.setenv("ROS_LOG_DIR", str(logs))
    with small_folder(logs, 1 << 16), running(path, logs) as system:
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
