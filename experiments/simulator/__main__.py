"""Runs the stage alone: `python -m experiments.simulator FOLDER [--quick]`."""

from __future__ import annotations

import argparse
from pathlib import Path

from experiments.right_turn.data import Plan

from .stage import run

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    run(arguments.folder.resolve(), Plan(quick=arguments.quick), print)
