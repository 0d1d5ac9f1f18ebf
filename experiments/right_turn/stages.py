"""The stages of the experiment: each in a process of its own, bounded, kept when it was done."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import json
import os
import signal
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from experiments.right_turn import ROOT
from experiments.right_turn.data import Plan

if TYPE_CHECKING:
    from experiments.right_turn.progress import Progress

DONE = "done.json"
"""File of a stage that was done: its plan, the digest of its sources, the load before it."""

_SOURCES = ("jausml", "metamodels", "models", "experiments")
_SOURCE_ENDS = frozenset({".py", ".xmi", ".ecore", ".j2", ".ros2jaus", ".lark", ".toml"})


@dataclass(frozen=True)
class Stage:
    """A part of the experiment.

    Attributes:
        name: Name on the command line and of the folder.
        module: Module with the function `run(folder, plan, tell)`.
        title: What is done, in some words.
        limit: Seconds after which it is ended.
        quick_limit: The same for a quick look.
    """

    name: str
    module: str
    title: str
    limit: float
    quick_limit: float = 40.0


STAGES = (
    Stage("wall", "experiments.right_turn.wall", "J and R in real time", 280),
    Stage("stress", "experiments.right_turn.stress", "kills and restarts in real time", 100),
    Stage("sweep", "experiments.right_turn.sweep", "delay, loss and rates in virtual time", 300),
    Stage("polling", "experiments.right_turn.polling", "bridges that poll, in virtual time", 100),
    Stage("stress_virtual", "experiments.right_turn.stress_virtual", "cuts in virtual time", 80),
    Stage("simulator", "experiments.simulator.stage", "a simulator that is not in real time", 80),
    Stage("waypoints", "experiments.waypoints.stage", "a robot along waypoints", 120, 80),
)


def digest(root: Path = ROOT) -> str:
    """Returns a digest of all that a stage is made of: the tool, the models, the experiments.

    Args:
        root: Folder that they stand in.
    """
    found = hashlib.sha256()
    for top in _SOURCES:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in _SOURCE_ENDS and path.is_file():
                found.update(path.relative_to(root).as_posix().encode())
                found.update(path.read_bytes())
    return found.hexdigest()


def is_done(folder: Path, plan: Plan, sources: str) -> bool:
    """Returns whether a stage was done in this folder, with this plan and these sources."""
    try:
        found = json.loads((folder / DONE).read_text(encoding="utf-8"))
        return bool(found["plan"] == asdict(plan) and found["sources"] == sources)
    except (OSError, ValueError, KeyError):
        return False


def load_before(folder: Path) -> float | None:
    """Returns how many processes wanted a processor before a stage began; None if it is not known.

    Args:
        folder: Folder of the stage.
    """
    try:
        return float(json.loads((folder / DONE).read_text(encoding="utf-8"))["load"])
    except (OSError, ValueError, KeyError):
        return None


def perform(
    stage: Stage, folder: Path, plan: Plan, sources: str, progress: Progress, limit: float
) -> str:
    """Runs a stage in a process group of its own.

    Its output goes to `log.txt` in its folder. What it starts is ended with it.

    Args:
        stage: What to run.
        folder: Where its data goes; what an earlier run left there is its own to replace.
        plan: How much is done.
        sources: Digest of the sources.
        progress: Told how far it is.
        limit: Seconds after which it is ended.

    Returns:
        Why it failed, or an empty text.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DONE).unlink(missing_ok=True)
    load = round(os.getloadavg()[0], 1)
    reading, writing = os.pipe()
    line = [sys.executable, "-m", "experiments.right_turn.stages", stage.module, str(folder)]
    line += [json.dumps(asdict(plan)), str(writing)]
    with (folder / "log.txt").open("w", encoding="utf-8") as log:
        process = subprocess.Popen(
            line, cwd=ROOT, stdout=log, stderr=log, pass_fds=(writing,), start_new_session=True
        )
        os.close(writing)
        listener = Thread(target=_listen, args=(reading, progress), daemon=True)
        listener.start()
        code = _wait(process, limit, progress)
    listener.join(2.0)
    if code is None:
        return f"not done after {limit:.0f} s; see {folder / 'log.txt'}"
    if code != 0:
        return f"exit status {code}; see {folder / 'log.txt'}"
    done = {"plan": asdict(plan), "sources": sources, "load": load}
    (folder / DONE).write_text(json.dumps(done) + "\n", encoding="utf-8")
    return ""


def _listen(reading: int, progress: Progress) -> None:
    with os.fdopen(reading, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            progress.tell(line.strip())


def _wait(process: subprocess.Popen[bytes], limit: float, progress: Progress) -> int | None:
    """Waits for a process and ends its group; returns its status, None when it took too long."""
    try:
        for _ in range(round(limit)):
            with contextlib.suppress(subprocess.TimeoutExpired):
                return process.wait(1.0)
            progress.refresh()
        return None
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def main(arguments: list[str]) -> None:
    """Runs one stage here: its module, the folder, the plan and where to tell how far it is."""
    module, folder, plan, tell_to = arguments
    with os.fdopen(int(tell_to), "w", encoding="utf-8") as told:

        def tell(detail: str) -> None:
            told.write(f"{detail}\n")
            told.flush()

        importlib.import_module(module).run(Path(folder), Plan(**json.loads(plan)), tell)


if __name__ == "__main__":
    main(sys.argv[1:])
