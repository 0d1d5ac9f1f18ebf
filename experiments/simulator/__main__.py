"""Runs the stage alone: `python -m experiments.simulator FOLDER [--quick]`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from .stage import run


@dataclass(frozen=True)
class _Plan:
    quick: bool
    runs: int = 1


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("folder", type=Path)
parser.add_argument("--quick", action="store_true")
arguments = parser.parse_args()
run(arguments.folder.resolve(), _Plan(arguments.quick), print)
