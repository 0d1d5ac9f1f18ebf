"""Processes of an experiment: generated, started, listened to, ended; none outlives it."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from typing_extensions import Self

GRACE = 20.0
"""Seconds that a process has to end after it was asked to."""
JAUS_PORT = 3794
"""Never taken: real components may use it."""


class ExperimentError(Exception):
    """An experiment could not be carried out; the text says why."""


def free_port() -> int:
    """Returns a UDP port of the loopback interface that nobody has."""
    while True:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port: int = probe.getsockname()[1]
        if port != JAUS_PORT:
            return port


def wait_until(
    condition: Callable[[], object], seconds: float, check: Callable[[], object] = bool
) -> bool:
    """Waits until something holds; False when it did not in time.

    Args:
        check: Is called meanwhile; it may raise.
    """
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        check()
        time.sleep(0.02)
    return True


def generate(model: Path, workspace: Path, *packages: Path) -> None:
    """Copies the user's packages to a fresh workspace, and generates the rest around them.

    Args:
        model: The model.
        workspace: Where; what is there is removed.
        packages: Folders of the packages.

    Raises:
        ExperimentError: The model is wrong.
    """
    shutil.rmtree(workspace, ignore_errors=True)
    workspace.mkdir(parents=True)
    for package in packages:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(package, workspace / package.name, ignore=ignored)
    command = [sys.executable, "-m", "jausml", "generate", str(model), "-o", str(workspace)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ExperimentError(f"{model.name} cannot be generated: {done.stdout}{done.stderr}")


class Process:
    """A Python process whose lines are kept, in memory and in a file.

    Attributes:
        lines: What it has printed so far.
    """

    def __init__(
        self, arguments: Sequence[str | Path], log: Path, environment: Mapping[str, str]
    ) -> None:
        """Starts it.

        Args:
            arguments: What follows `python`.
            log: File for its lines.
            environment: What is added to the environment of this process.
        """
        self.lines: list[str] = []
        self._log = log
        self._process = subprocess.Popen(
            [sys.executable, "-u", *map(str, arguments)],
            env={**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        self._reader = threading.Thread(target=self._read, args=[self._process.stdout], daemon=True)
        self._reader.start()

    def _read(self, printed: TextIO) -> None:
        with printed, self._log.open("w", encoding="utf-8", buffering=1) as log:
            for line in printed:
                log.write(line)
                self.lines.append(line.rstrip())

    @property
    def code(self) -> int | None:
        """Its exit code; None while it runs."""
        return self._process.poll()

    def said(self, text: str) -> bool:
        """Tells whether a line had this text."""
        return any(text in line for line in tuple(self.lines))

    def wait_for(self, text: str, seconds: float) -> None:
        """Waits for a line with this text.

        Raises:
            ExperimentError: None came in time, or the process has ended.
        """
        wait_until(lambda: self.said(text) or self.code is not None, seconds)
        if not self.said(text):
            last = "\n".join(self.lines[-5:])
            raise ExperimentError(
                f"no line with '{text}' within {seconds:g} s in {self._log}; the last ones:\n{last}"
            )

    def ask_to_end(self) -> None:
        """Asks it to end and does not wait."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)

    def end(self) -> None:
        """Ends it, by force if it must be."""
        self.ask_to_end()
        try:
            self._process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join()


class Processes:
    """Processes that share an environment and end together.

    Args:
        folder: Where the lines of each are kept, in `<name>.log`.
        environment: What is added to the environment.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str]) -> None:
        self._folder = folder
        self._environment = environment
        self._by_name: dict[str, Process] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        self.stop()

    def start(self, name: str, *arguments: str | Path) -> Process:
        """Starts `python ARGUMENTS`."""
        process = Process(arguments, self._folder / f"{name}.log", self._environment)
        self._by_name[name] = process
        return process

    def lines(self, name: str) -> list[str]:
        """Returns what a process has printed so far; nothing where it was not started."""
        return list(self._by_name[name].lines) if name in self._by_name else []

    def check(self) -> None:
        """Looks whether all run.

        Raises:
            ExperimentError: One has ended; says which and what it said last.
        """
        for name, process in self._by_name.items():
            if process.code is not None:
                last = "\n".join(process.lines[-5:])
                raise ExperimentError(f"{name} in {self._folder} has ended:\n{last}")

    def stop(self) -> None:
        """Ends all; what they printed stays."""
        for process in self._by_name.values():
            process.ask_to_end()
        for process in self._by_name.values():
            process.end()
