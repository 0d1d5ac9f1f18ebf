"""Scripts that start others beside them, of which nothing is left."""

import os
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

PATIENCE = 20.0
"""Seconds in which what was started shall end when it is told to."""


def run_script(
    line: Sequence[str], *, timeout: float, **options: Any
) -> subprocess.CompletedProcess[str]:
    """Runs a script as `subprocess.run` does, with its output as text, and ends what it started.

    One that fails in its midst leaves others running, which the next test would meet: a second
    vehicle with the same id, say.
    """
    with subprocess.Popen(
        line,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        **options,
    ) as process:
        try:
            output, errors = process.communicate(timeout=timeout)
        finally:
            _end(process.pid)
    return subprocess.CompletedProcess(line, process.returncode, output, errors)


def _end(group: int) -> None:
    """Ends the processes of a group; with violence those that do not end by themselves."""
    end = time.monotonic() + PATIENCE
    with suppress(ProcessLookupError):  # there are none any more
        os.killpg(group, signal.SIGTERM)
        while time.monotonic() < end:
            time.sleep(0.05)
            os.killpg(group, 0)
        os.killpg(group, signal.SIGKILL)


def ran(line: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a program as `subprocess.run` does, with its output as text."""
    return subprocess.run(line, capture_output=True, text=True, check=False, **options)


def succeeded(line: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a program so, which must not fail."""
    done = ran(line, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done
