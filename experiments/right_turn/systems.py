"""The two systems, generated from their models, and their processes.

`J` is JAUS alone, `R` drives by ROS nodes through the generated bridge. Vehicle, operator and laws
are the same code. Systems that run at the same time have ports and a ROS domain of their own,
and all stay on this machine.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from experiments.right_turn import EXAMPLE, ROOT
from jausml.generation import read_manifest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

FIRST_PORT = 14_000
"""JAUS port of the first place."""

PORTS_APART = 40
"""From one place to the next; processes that share a port use up to 32 more, 50,000 above it."""

FIRST_DOMAIN = 60
"""ROS domain of the first place."""

OPERATOR = "operator_control_unit"
"""The process that lets the vehicle move; started when the others run."""

POLL = 0.1
"""Seconds between two looks at whether a condition holds."""

GRACE = ((signal.SIGINT, 5.0), (signal.SIGTERM, 3.0), (signal.SIGKILL, 3.0))
"""What is sent to a process that shall end, and the seconds that it has."""


@dataclass(frozen=True)
class System:
    """A system from a model.

    Attributes:
        name: `J` or `R`.
        model: The model.
        sources: Folders of packages that users wrote.
        leaves_out: Processes that the experiment has no use for.
    """

    name: str
    model: Path
    sources: Sequence[Path]
    leaves_out: frozenset[str] = frozenset()


_SRC = EXAMPLE / "src"
_ALONE = EXAMPLE / "jaus_only"

JAUS_ALONE = System(
    "J",
    _ALONE / "jaus_only.xmi",
    (_SRC / "catvehicle", _SRC / "vehicle", *sorted((_ALONE / "src").glob("*"))),
)
"""The controller is a JAUS component."""

BRIDGED = System(
    "R", EXAMPLE / "catvehicle.xmi", sorted(_SRC.glob("*")), leaves_out=frozenset({"logger"})
)
"""The controllers are ROS nodes behind the generated bridge."""


@dataclass(frozen=True)
class Workspace:
    """A generated system.

    Attributes:
        system: What it was generated from.
        folder: Where it is.
        processes: Arguments of Python for each process, by its name.
    """

    system: System
    folder: Path
    processes: Mapping[str, Sequence[str]]


def generate(system: System, folder: Path) -> Workspace:
    """Generates a system around the users' code, into a folder that is made anew.

    Raises:
        RuntimeError: The model cannot be generated; says what jausml said.
    """
    shutil.rmtree(folder, ignore_errors=True)
    for source in system.sources:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(source, folder / source.name, ignore=ignored)
    command = [sys.executable, "-m", "jausml", "generate", str(system.model), "-o", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{system.model.name} was not generated:\n{done.stderr}")
    entries = [
        entry
        for model in read_manifest(folder).models.values()
        for entry in model.get("processes", ())
        if entry["name"] not in system.leaves_out
    ]
    return Workspace(system, folder, {entry["name"]: _line(entry, folder) for entry in entries})


def _line(entry: Mapping[str, Any], folder: Path) -> Sequence[str]:
    line = ["-u", "-m", entry["module"], *entry.get("arguments", ())]
    if entry["kind"] != "node":
        line += ["--jaus-port", "{port}"]
    if entry.get("parameters"):
        line += ["--ros-args", "--params-file", str(folder / entry["parameters"])]
    return line


@dataclass(frozen=True)
class Setting:
    """Where and how a system runs.

    Attributes:
        place: Number among the systems that run at the same time, from 0.
        plant: Name of the vehicle's plant.
        delay: Seconds that a command waits before the vehicle obeys.
    """

    place: int = 0
    plant: str = "kinematic"
    delay: float = 0.0

    @property
    def port(self) -> int:
        """JAUS port."""
        return FIRST_PORT + PORTS_APART * self.place

    @property
    def variables(self) -> Mapping[str, str]:
        """Environment of the processes, beside what they inherit."""
        return {
            "CATVEHICLE_PLANT": self.plant,
            "CATVEHICLE_DELAY": str(self.delay),
            "ROS_DOMAIN_ID": str(FIRST_DOMAIN + self.place),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }


@dataclass
class Running:
    """Processes of a system; use it in a `with` statement, which ends them.

    Attributes:
        workspace: What runs.
        setting: Where and how.
        logs: Folder for what the processes write and print.
    """

    workspace: Workspace
    setting: Setting
    logs: Path
    _processes: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)
    _files: ExitStack = field(default_factory=ExitStack)

    def __enter__(self) -> Running:
        """Make the folder anew; nothing is started."""
        shutil.rmtree(self.logs, ignore_errors=True)
        self.logs.mkdir(parents=True)
        return self

    def __exit__(
        self,
        exception_type: type[BaseException] | None,
        exception: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """End all processes."""
        self.stop()
        self._files.close()

    def start(self, *names: str) -> None:
        """Start processes, by default all but the operator, each with its output in a file."""
        for name in names or [
            process for process in self.workspace.processes if process != OPERATOR
        ]:
            line = [word.format(port=self.setting.port) for word in self.workspace.processes[name]]
            self._processes[name] = self._spawn(line, name)

    def _spawn(self, line: Sequence[str], name: str) -> subprocess.Popen[bytes]:
        folder = self.workspace.folder
        packages = (path for path in sorted(folder.iterdir()) if (path / path.name).is_dir())
        environment = {
            **os.environ,
            **self.setting.variables,
            "CATVEHICLE_LOG": str(self.logs),
            "PYTHONPATH": os.pathsep.join(map(str, packages)),
        }
        # The file stays open for the process until the system ends.
        output = self._files.enter_context((self.logs / f"{name}.txt").open("ab"))
        return subprocess.Popen(
            [sys.executable, *line], env=environment, stdout=output, stderr=output
        )

    def said(self, name: str) -> list[str]:
        """Return the lines that a process has printed."""
        path = self.logs / f"{name}.txt"
        return (
            path.read_text(encoding="utf-8", errors="replace").splitlines() if path.exists() else []
        )

    @property
    def arrived(self) -> bool:
        """Whether the operator saw the vehicle arrive."""
        return any("arrived at" in line for line in self.said(OPERATOR))

    @property
    def steps(self) -> bool:
        """Whether commands of the controller reach the vehicle."""
        path = self.logs / "vehicle_events.csv"
        return path.exists() and "command" in path.read_text(encoding="utf-8")

    def check(self) -> None:
        """Look whether everything runs that was started.

        Raises:
            RuntimeError: A process has ended; says which and what it said last.
        """
        for name, process in self._processes.items():
            if process.poll() is not None:
                last = "\n".join(self.said(name)[-5:])
                raise RuntimeError(f"{name} of {self.workspace.system.name} has ended:\n{last}")

    def stop(self) -> None:
        """End all processes in good order, or else firmly."""
        for number, seconds in GRACE:
            left = [child for child in self._processes.values() if child.poll() is None]
            for process in left:
                process.send_signal(number)
            deadline = time.monotonic() + seconds
            for process in left:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(max(0.0, deadline - time.monotonic()))
        self._processes.clear()


def wait_for(condition: Callable[[], bool], limit: float, systems: Sequence[Running]) -> bool:
    """Waits for a condition while systems run; returns whether it came in time.

    Args:
        condition: What is waited for.
        limit: Longest wait, s.
        systems: Must run meanwhile.

    Raises:
        RuntimeError: A process of a system has ended.
    """
    deadline = time.monotonic() + limit
    while not condition():
        if time.monotonic() > deadline:
            return False
        for system in systems:
            system.check()
        time.sleep(POLL)
    return True
