"""Generates the example system, starts it, drives it through the turn and judges the drive.

Run it by `make demo`. Everything stays on this machine: ROS discovery is limited to the host and
JAUS uses the loopback interface. The workspace, the logs, the table and the picture are left in
demo-out/ (or the folder named on the command line).
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "src" / "catvehicle"))

from typing import TYPE_CHECKING

from catvehicle.evaluation import draw, report
from catvehicle.parameters import VehicleParameters

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

MODEL = HERE / "catvehicle.xmi"
TIME_LIMIT = 45.0
"""Seconds after which a drive that has not arrived is ended, unless `--limit` says another time."""
GRACE = 15.0
"""Seconds in which the processes must have ended after they were asked to."""
OPERATOR = "operator_control_unit"
SHOWN = (OPERATOR, "error", "warning", "Traceback")


def jausml(*arguments: str | Path, is_needed: bool = True) -> None:
    """Runs a jausml command and shows it, without the list of files that it writes.

    Raises:
        SystemExit: The command failed, and nothing goes on without it.
    """
    words = [str(argument) for argument in arguments]
    print("$ jausml", *words, flush=True)
    result = subprocess.run(
        [sys.executable, "-m", "jausml", *words], stdout=subprocess.DEVNULL, check=False
    )
    if result.returncode and is_needed:
        sys.exit(result.returncode)


def prepare(folder: Path) -> Path:
    """Validates the model and generates a fresh workspace around the user's code."""
    shutil.rmtree(folder, ignore_errors=True)
    workspace = folder / "ws"
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(HERE / "src", workspace, ignore=ignored)
    jausml("validate", MODEL)
    jausml("generate", MODEL, "-o", workspace)
    jausml("build", workspace, is_needed=False)  # before the time of the drive runs
    return workspace


def settings(logs: Path) -> Mapping[str, str]:
    """Returns the environment of the processes: discovery on this host and a domain of its own."""
    return {
        **os.environ,
        "CATVEHICLE_LOG": str(logs),
        "PYTHONUNBUFFERED": "1",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": os.environ.get("ROS_DOMAIN_ID", "87"),
    }


@contextmanager
def running(workspace: Path, logs: Path, limit: float) -> Iterator[subprocess.Popen[str]]:
    """Starts the whole system and stops it cleanly in the end."""
    command = [sys.executable, "-m", "jausml", "run", str(workspace)]
    print("$ jausml run", workspace, flush=True)
    process = subprocess.Popen(
        command,
        env=dict(settings(logs)),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    watchdog = threading.Timer(limit, process.send_signal, [signal.SIGINT])
    watchdog.start()
    try:
        yield process
    finally:
        watchdog.cancel()
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait(GRACE)


def drive(workspace: Path, logs: Path, limit: float) -> list[str]:
    """Runs the system until the operator sees the vehicle arrive; returns what was printed."""
    lines: list[str] = []
    with running(workspace, logs, limit) as process:
        assert process.stdout is not None  # noqa: S101 - for the type checker
        for line in process.stdout:
            lines.append(line.rstrip())
            if any(word in line for word in SHOWN):
                print(lines[-1], flush=True)
            if "arrived at" in line:
                process.send_signal(signal.SIGINT)
    (logs / "output.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return lines


def reason_of_failure(lines: Sequence[str], limit: float) -> str:
    """Returns why a drive was none, by the words of the operator; empty if the vehicle arrived."""
    said = [line for line in lines if line.startswith(OPERATOR)]
    if any("arrived at" in line for line in said):
        return ""
    places = [line for line in said if "vehicle at" in line or "stands at" in line]
    last = places[-1].partition("operator: ")[2] or places[-1] if places else "it never reported"
    return f"the vehicle did not arrive within {limit:g} s; its last word: {last}"


def main() -> int:
    """Command line entry; returns 0 when the vehicle arrived, 1 when the drive failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("demo-out"))
    parser.add_argument(
        "--limit", type=float, default=TIME_LIMIT, help="seconds that the drive may take"
    )
    given = parser.parse_args()
    folder, limit = given.folder.resolve(), given.limit
    workspace = prepare(folder)
    logs = folder / "logs"
    logs.mkdir()
    lines = drive(workspace, logs, limit)
    parameters = VehicleParameters()
    try:
        table = report(logs, lines, parameters)
        draw(logs, folder / "turn.png", parameters)
    except (OSError, ValueError) as error:
        print(f"no drive to judge: {error}; see {logs / 'output.txt'}", file=sys.stderr)
        return 1
    (folder / "table.txt").write_text(table + "\n", encoding="utf-8")
    print(f"\n{table}\n\npicture: {folder / 'turn.png'}")
    failure = reason_of_failure(lines, limit)
    if failure:
        print(failure, file=sys.stderr)
    return 1 if failure else 0


if __name__ == "__main__":
    sys.exit(main())
