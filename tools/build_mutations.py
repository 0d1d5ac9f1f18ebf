"""Breaks models, those of the examples at first, and writes a page on what notices it.

python tools/build_mutations.py [--limit N] [--jobs N] [--page FILE] [MODEL...]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from jausml.mutating.operators import OPERATORS
from jausml.mutating.outcomes import VERDICTS
from jausml.views.pages import markdown_table

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "build" / "results" / "mutations.md"
MODELS = (
    "models/catvehicle/catvehicle.xmi",
    "models/examples/waypoint_list/waypoint_list.ros2jaus",
    "models/examples/winch/winch.xmi",
    "models/examples/waypoints/waypoints.ros2jaus",
)

HEAD = """\
# Mutations

Look up what notices a mistake in the models of the examples. `make mutate` has broken them, one
thing at a time, as `jausml mutate` does with any model, and has written this page.
"""


def operators() -> Iterator[str]:
    """Yields the table of the operators."""
    rows = []
    for operator in OPERATORS:
        features = "; ".join(
            f"`{name}`: {', '.join(f'`{one}`' for one in of)}" for name, of in operator.of_classes()
        )
        rows.append((operator.name, operator.does, features))
    yield from ("## Operators", "")
    yield from markdown_table(("operator", "what it does", "of which features"), rows)


def main(arguments: Sequence[str]) -> None:
    """Breaks the models, and writes the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--limit", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--page", type=Path, default=PAGE)
    parser.add_argument("models", nargs="*", default=MODELS, metavar="MODEL")
    asked = parser.parse_args(arguments)
    campaigns = [_campaign(model, asked.limit, asked.jobs) for model in asked.models]
    asked.page.parent.mkdir(parents=True, exist_ok=True)
    asked.page.write_text(page(campaigns), encoding="utf-8")


def _campaign(model: str, limit: int, jobs: int) -> dict[str, Any]:
    command = [sys.executable, "-m", "jausml", "mutate", model, "--format", "json"]
    options = ["--limit", str(limit), "--jobs", str(jobs), "--budget", "3600"]
    done = subprocess.run(
        [*command, *options], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False
    )
    if done.returncode not in (0, 1):
        sys.exit(done.returncode)
    campaign: dict[str, Any] = json.loads(done.stdout)
    return campaign


def page(campaigns: Iterable[Mapping[str, Any]]) -> str:
    """Returns the page of some campaigns."""
    lines = [HEAD, *markdown_table(("column", "meaning"), VERDICTS.items()), ""]
    for campaign in campaigns:
        lines += [*_of_model(campaign), ""]
    return "\n".join([*lines, *operators()]) + "\n"


def _of_model(campaign: Mapping[str, Any]) -> Iterator[str]:
    tried, possible = campaign["tried"], campaign["possible"]
    survivors = [outcome for outcome in campaign["outcomes"] if outcome["verdict"] == "nothing"]
    yield f"## {campaign['model']}"
    yield ""
    yield f"{tried} of {possible} possible mutations were tried; {len(survivors)} survive."
    yield ""
    rows = (
        (name, *(str(row.get(verdict, "")) for verdict in VERDICTS))
        for name, row in campaign["matrix"].items()
    )
    yield from markdown_table(("operator", *VERDICTS), rows)
    for remark in campaign["remarks"]:
        yield from ("", f"Note: {remark}.")
    if survivors:
        yield from ("", "These survive:", "")
    # What differs only in where it stands is one thing that nothing notices.
    counts_by_kind = Counter(_kind(survivor) for survivor in survivors)
    for (operator, change, file), count in counts_by_kind.items():
        times = f", {count} times" if count > 1 else ""
        yield f"- {operator}: `{change}`, in `{file}`{times}"


def _kind(survivor: Mapping[str, Any]) -> tuple[str, str, str]:
    return survivor["operator"], survivor["change"], survivor["files"][0]


if __name__ == "__main__":
    main(sys.argv[1:])
