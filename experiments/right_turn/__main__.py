"""Runs the whole experiment, judges it, draws it and writes it down.

Usage: python -m experiments.right_turn [--quick] [--stage NAME]... [--again] [--out FOLDER]

Each stage keeps its data in the folder, and is not repeated while neither the sources nor the plan
change. When all stages of the full experiment are done in the usual folder, docs/experiment.md and
its figures are written; else they are left beside the data. The exit status is 1 when a stage
failed or a claim does not hold.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.right_turn import ROOT
from experiments.right_turn.data import Plan
from experiments.right_turn.progress import Progress, clock
from experiments.right_turn.results import QUIET_SHARE
from experiments.right_turn.stages import DONE, STAGES, digest, is_done, perform

if TYPE_CHECKING:
    from collections.abc import Sequence

OUT = ROOT / "experiment-out"
DATA = ROOT / "experiments" / "results.json"
PAGE = ROOT / "docs" / "experiment.md"
FIGURES = ROOT / "docs" / "experiment"
NAMES = tuple(stage.name for stage in STAGES)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the experiment; returns the exit status."""
    options = _options(arguments)
    plan = Plan(quick=options.quick, runs=options.runs or (2 if options.quick else 10))
    folder = options.out / ("quick" if options.quick else "full")
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
    progress = Progress(sys.stdout, width)
    print(_expected(plan, os.getloadavg()[0], os.cpu_count() or 1))
    failed = _run_stages(options, plan, folder, progress)
    # matplotlib takes a second, which nobody waits for who only asked for help.
    from experiments.right_turn import gather, pictures, report  # noqa: PLC0415

    progress.begin("judging and drawing", 60.0)
    found = gather.gather(folder, plan, failed)
    pictures.draw(folder, found, folder / "figures")
    progress.end("done")
    text = json.dumps(found, indent=1, allow_nan=False) + "\n"
    (folder / "results.json").write_text(text, encoding="utf-8")
    (folder / "experiment.md").write_text(report.page(found, "figures"), encoding="utf-8")
    page = folder / "experiment.md"
    whole = all((folder / stage.name / DONE).exists() for stage in STAGES)
    if not plan.quick and options.out == OUT and whole:
        _publish(folder, text, report.page(found))
        page = PAGE
    print(f"\n{report.table(found)}\n\n{page} was written; it took {clock(progress.elapsed)}.")
    for name, why in failed.items():
        print(f"failed: {name}: {why}", file=sys.stderr)
    broken = [claim for claim in found["claims"] if claim["holds"] is False]
    for claim in broken:
        print(f"does not hold: {claim['text']}", file=sys.stderr)
    for claim in found["claims"]:
        if claim["holds"] is None:
            print(f"not measured: {claim['text']}", file=sys.stderr)
    return 1 if failed or broken else 0


def _expected(plan: Plan, load: float, processors: int) -> str:
    """Returns what is to be expected of the time that it takes, and of what it measures."""
    takes = "about seventy seconds" if plan.quick else "about ten minutes"
    text = f"This takes {takes} on a quiet computer; what was done with these sources is kept."
    if load > QUIET_SHARE * processors:
        text += (
            f"\nOther programs are at work (load {load:.1f} on {processors} processors): it takes "
            "longer, and a stage may pass its limit. Try --patience 3, and do not believe the "
            "delays."
        )
    return text


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m experiments.right_turn", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--quick", action="store_true", help="a look, in about seventy seconds")
    parser.add_argument(
        "--stage",
        action="append",
        choices=NAMES,
        metavar="NAME",
        help="only this stage, even if it was done; may be repeated; one of " + ", ".join(NAMES),
    )
    parser.add_argument("--again", action="store_true", help="repeat stages that were done")
    parser.add_argument(
        "--patience", type=float, default=1.0, help="times the limits, where other work is done"
    )
    parser.add_argument("--runs", type=int, help="drives of each system (10; 2 when quick)")
    parser.add_argument("--out", type=Path, default=OUT, metavar="FOLDER", help="where data goes")
    options = parser.parse_args(arguments)
    options.out = options.out.resolve()
    if not options.patience > 0:
        parser.error("--patience: more than 0")
    if options.runs is not None and options.runs < 2:
        parser.error("--runs: at least 2, or J cannot be compared with J")
    return options


def _run_stages(
    options: argparse.Namespace, plan: Plan, folder: Path, progress: Progress
) -> dict[str, str]:
    """Runs what has to be run; returns why stages failed, by name."""
    sources = digest()
    chosen = [stage for stage in STAGES if not options.stage or stage.name in options.stage]
    failed = {}
    for number, stage in enumerate(chosen, 1):
        place = folder / stage.name
        heading = f"[{number}/{len(chosen)}] {stage.name}: {stage.title}"
        limit = options.patience * (stage.quick_limit if plan.quick else stage.limit)
        progress.begin(heading, limit)
        repeat = options.again or options.stage
        if not repeat and is_done(place, plan, sources):
            progress.end("kept as it was")
            continue
        why = perform(stage, place, plan, sources, progress, limit)
        progress.end(f"failed: {why}" if why else "done")
        if why:
            failed[stage.name] = why
    return failed


def _publish(folder: Path, data: str, page: str) -> None:
    """Puts data, page and figures where the documentation has them."""
    DATA.write_text(data, encoding="utf-8")
    PAGE.write_text(page, encoding="utf-8")
    shutil.rmtree(FIGURES, ignore_errors=True)
    shutil.copytree(folder / "figures", FIGURES)


if __name__ == "__main__":
    sys.exit(main())
