"""How long whole commands take, from start to end of the process, beside an empty Python."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MODEL = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
RUNS = 7


def seconds(*command: str | Path) -> float:
    """Returns the median time of a command.

    Raises:
        subprocess.CalledProcessError: The command failed.
    """
    times = []
    for _ in range(RUNS):
        started = time.perf_counter()
        subprocess.run([sys.executable, *command], check=True, capture_output=True)
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def main() -> None:
    """Measures the verbs on the example system."""
    empty = seconds("-c", "pass")
    print(f"{'python -c pass':44} {empty:6.3f} s")
    with tempfile.TemporaryDirectory() as folder:
        verbs = {
            "jausml --version": ("--version",),
            "jausml validate catvehicle.xmi": ("validate", MODEL),
            "jausml generate catvehicle.xmi (first and again)": ("generate", MODEL, "-o", folder),
            "jausml generate --check": ("generate", MODEL, "-o", folder, "--check"),
        }
        for name, arguments in verbs.items():
            taken = seconds("-m", "jausml", *map(str, arguments))
            print(f"{name:44} {taken:6.3f} s, {taken / empty:5.1f} times an empty Python")


if __name__ == "__main__":
    main()
