"""The linter, and the tests that matter to what changed, in fifteen seconds.

Ruff runs beside the choice of the tests. Those come first that say that they guard what changed,
then those that are nearest to it, without those that start ROS or take long; what is not reached
in time is skipped, and is for `make test`, as types and layers are for `make lint`.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from affected import Checkout, changed_files

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(sys.executable).parent
LINTERS = (("format", "--check"), ("check",))


def lint() -> list[subprocess.Popen[str]]:
    """Starts what ruff judges, side by side."""
    return [
        subprocess.Popen(
            [BIN / "ruff", *arguments, "."],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for arguments in LINTERS
    ]


def complaints(running: list[subprocess.Popen[str]]) -> list[str]:
    """Waits for what was started, shows what fails, and returns its names."""
    failed = []
    for arguments, process in zip(LINTERS, running, strict=True):
        output, _ = process.communicate()
        if process.returncode:
            failed.append(" ".join(("ruff", *arguments)))
            print(f"{failed[-1]}:\n{output}")
    return failed


NEAREST = 10
"""Test files that are run: each worker has to read all of them first."""


def test(files: list[Path], seconds: int) -> bool:
    """Runs test files in their order for a time; returns whether no test failed."""
    order = ("-n", str(min(2, len(files))), "--dist", "loadfile", "--no-loadscope-reorder")
    chosen = ("-m", "not live and not slow", "-p", "budget", "--budget", str(seconds))
    command = [sys.executable, "-m", "pytest", "-q", *order, *chosen, *map(str, files)]
    nothing_chosen = 5
    return subprocess.run(command, cwd=ROOT, check=False).returncode in (0, nothing_chosen)


def main() -> int:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--since", default="", metavar="COMMIT", help="compare with this commit")
    parser.add_argument("--seconds", type=int, default=8, help="time for tests (8)")
    parser.add_argument("--list", action="store_true", help="list the test files, run nothing")
    arguments = parser.parse_args()
    running = [] if arguments.list else lint()
    files = Checkout(ROOT).affected(changed_files(ROOT, arguments.since))
    if arguments.list:
        print(*(path.relative_to(ROOT) for path in files), sep="\n")
        return 0
    failed = complaints(running)
    near = files[:NEAREST]
    print(f"lint: {', '.join(failed) or 'clean'}")
    print(f"tests: the nearest {len(near)} of {len(files)} files that the change reaches")
    passed = not near or test(near, arguments.seconds)
    return 0 if passed and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
