"""Runs every benchmark of this folder and prints what docs/performance.md quotes.

Usage: run.py [NAME...]  (names of the other scripts without .py; all by default)
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main() -> int:
    """Runs the named benchmarks one after the other; returns how many failed."""
    scripts = {path.stem: path for path in sorted(HERE.glob("*.py")) if path.stem != "run"}
    names = sys.argv[1:] or list(scripts)
    unknown = [name for name in names if name not in scripts]
    if unknown:
        sys.exit(f"no benchmark {unknown[0]}; there are: {', '.join(scripts)}")
    environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    failures = 0
    for name in names:
        print(f"== {name}", flush=True)
        result = subprocess.run([sys.executable, scripts[name]], env=environment, check=False)
        failures += result.returncode != 0
    return failures


if __name__ == "__main__":
    sys.exit(main())
