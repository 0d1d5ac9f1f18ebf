"""The whole suite; tests that fail in the crowd are run once more, alone.

Tests with real processes wait for conditions, with bounds. On a computer that is busy with several
of them at once a bound is missed now and then, which says nothing about the code; a test that fails
alone too does. What failed first is named at the end either way: it may hide a race.

In the crowd, assertions are compiled as Python has them: to rewrite them, so that a failure shows
its values, takes as long as to read all tests. Alone they are rewritten, and so the second run
shows why a test fails.

The page of the studio is built before, once: no worker does.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import build_studio

ROOT = Path(__file__).resolve().parent.parent
LAST_FAILED = ROOT / ".pytest_cache" / "v" / "cache" / "lastfailed"
MOST = 3
"""So many failures may be bad luck; more are a fault."""
SHOWN = 20
"""So many are run again to show why they fail."""

FAILED, NOTHING_CHOSEN, INTERRUPTED = 1, 5, 130


def run(*arguments: str) -> int:
    """Runs pytest, and returns its exit status; 0 where no test was chosen, 130 after Ctrl-C."""
    command = [sys.executable, "-m", "pytest", *arguments]
    try:
        status = subprocess.run(command, cwd=ROOT, check=False).returncode
    except KeyboardInterrupt:
        # Pytest has had it too, and tells of it.
        return INTERRUPTED
    return 0 if status == NOTHING_CHOSEN else status


def failed() -> list[str]:
    """Returns the ids of the tests that failed in the last run."""
    try:
        return sorted(json.loads(LAST_FAILED.read_text(encoding="utf-8")))
    except FileNotFoundError:
        return []


def main(arguments: list[str]) -> int:
    """Runs the suite with pytest's arguments; returns the exit status."""
    try:
        status = build_studio.refresh()
    except KeyboardInterrupt:
        return INTERRUPTED
    if status:
        return status
    LAST_FAILED.unlink(missing_ok=True)
    status = run(
        "--assert=plain", "--durations=15", "-n", "auto", "--dist", "worksteal", *arguments
    )
    first = failed()
    if status != FAILED or not first:
        return status
    shown = first[:SHOWN]
    print(f"{len(first)} failed beside other tests; {len(shown)} once more, alone:", flush=True)
    alone = run("-p", "no:xdist", *shown)
    again = failed()
    for test in shown:
        verdict = "fails alone too" if test in again else "passed alone, and may hide a race"
        print(f"{test}: {verdict}")
    return alone if len(first) <= MOST else status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
