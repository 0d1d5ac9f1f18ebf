"""Runs the experiment, judges it, draws it and writes it down.

Usage: python -m experiments.right_turn [--quick] [--stage NAME]... [--runs N] [--out FOLDER]

Each stage leaves its data in the folder; the page, experiment.md, and its figures are beside them.
The exit status is 1 when a stage failed or a claim does not hold.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

from experiments.right_turn import ROOT, wall
from experiments.right_turn.data import STAGES, Plan
from experiments.simulator import stage as simulator

OUT = ROOT / "experiment-out"
RUN = dict(zip(STAGES, (wall.run, simulator.run), strict=True))


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the experiment; returns the exit status."""
    options = _options(arguments)
    plan = Plan(quick=options.quick, runs=options.runs or (2 if options.quick else 10))
    folder = options.out / ("quick" if options.quick else "full")
    failed = {}
    for name in options.stage or STAGES:
        print(f"{name}:", flush=True)
        (folder / name).mkdir(parents=True, exist_ok=True)
        try:
            RUN[name](folder / name, plan, lambda detail: print(f"  {detail}", flush=True))
        except Exception as error:  # the other stages say something without it
            traceback.print_exc()
            failed[name] = str(error)
    # matplotlib takes a second, which nobody waits for who only asked for help.
    from experiments.right_turn import gather, pictures, report  # noqa: PLC0415

    data = gather.gather(folder, plan, failed)
    pictures.draw(folder, data, folder / "figures")
    text = json.dumps(data, indent=1, allow_nan=False) + "\n"
    (folder / "results.json").write_text(text, encoding="utf-8")
    page = folder / "experiment.md"
    page.write_text(report.page(data), encoding="utf-8")
    print(f"\n{report.table(data)}\n\n{page} was written.")
    for name, why in failed.items():
        print(f"failed: {name}: {why}", file=sys.stderr)
    broken = [claim["text"] for claim in data["claims"] if claim["holds"] is False]
    for claim in broken:
        print(f"does not hold: {claim}", file=sys.stderr)
    return 1 if failed or broken else 0


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.right_turn", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--quick", action="store_true", help="a look, in about seventy seconds")
    parser.add_argument(
        "--stage", action="append", choices=STAGES, help="only this stage; may be repeated"
    )
    parser.add_argument("--runs", type=int, help="drives of each system (10; 2 when quick)")
    parser.add_argument("--out", type=Path, default=OUT, metavar="FOLDER", help="where data goes")
    options = parser.parse_args(arguments)
    options.out = options.out.resolve()
    if options.runs is not None and options.runs < 2:
        parser.error("--runs: at least 2, or J cannot be compared with J")
    return options


if __name__ == "__main__":
    sys.exit(main())
