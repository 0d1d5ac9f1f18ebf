"""The two systems, generated from their models, and their processes.

`J` is JAUS alone, `R` drives by ROS nodes through the generated bridge. Vehicle, operator and laws
are the same code. Systems that run at the same time have ports and a ROS domain of their own,
and all stay on this machine.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments import processes
from experiments.right_turn import EXAMPLE
from jausml.generation.manifest import read_manifest

FIRST_PORT = 14_000
"""JAUS port of the first place."""

PORTS_APART = 40
"""From one place to the next; processes that share a port use up to 32 more, 50,000 above it."""

FIRST_DOMAIN = 60
"""ROS domain of the first place."""

OPERATOR = "operator_control_unit"
"""The process that lets the vehicle move; started when the others run."""


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
        ExperimentError: The model cannot be generated; says what jausml said.
    """
    processes.generate(system.model, folder, *system.sources)
    entries = [
        entry
        for model in read_manifest(folder).models.values()
        for entry in model.get("processes", ())
        if entry["name"] not in system.leaves_out
    ]
    return Workspace(system, folder, {entry["name"]: _line(entry, folder) for entry in entries})


def _line(entry: Mapping[str, Any], folder: Path) -> Sequence[str]:
    line = ["-m", entry["module"], *entry.get("arguments", ())]
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
        }


class Running(processes.Processes):
    """Processes of a system; use it in a `with` statement, which ends them.

    Attributes:
        workspace: What runs.
        setting: Where and how.
        logs: Folder for what the processes write and print, made anew.
    """

    def __init__(self, workspace: Workspace, setting: Setting, logs: Path) -> None:
        """Makes the folder; nothing is started."""
        self.workspace = workspace
        self.setting = setting
        self.logs = logs
        shutil.rmtree(logs, ignore_errors=True)
        logs.mkdir(parents=True)
        folders = sorted(workspace.folder.iterdir())
        packages = (str(path) for path in folders if (path / path.name).is_dir())
        environment = {"CATVEHICLE_LOG": str(logs), "PYTHONPATH": os.pathsep.join(packages)}
        super().__init__(logs, {**setting.variables, **environment})

    def start_all(self) -> None:
        """Starts all but the operator."""
        for name in self.workspace.processes:
            if name != OPERATOR:
                self.start_named(name)

    def start_named(self, name: str) -> None:
        """Starts one of the system's processes."""
        line = self.workspace.processes[name]
        self.start(name, *(word.format(port=self.setting.port) for word in line))

    @property
    def arrived(self) -> bool:
        """Whether the operator saw the vehicle arrive."""
        return any("arrived at" in line for line in self.lines(OPERATOR))

    @property
    def steps(self) -> bool:
        """Whether commands of the controller reach the vehicle."""
        path = self.logs / "vehicle_events.csv"
        return path.exists() and "command" in path.read_text(encoding="utf-8")
