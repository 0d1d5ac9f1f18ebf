"""Gathers what the stages left into the data of the page, and judges it.

Read are, below the folder of a stage:

- its runs (`data.Run`), wherever `run.json` is. The stage `wall` keeps those of `J` and `R`;
- `summary.json`. Whatever the stage, `claims` in it is a list of `{"text": ..., "holds": true}`
  that must hold.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from catvehicle.metrics import Sample, aligned, closeness
from catvehicle.parameters import VehicleParameters

from experiments.right_turn import judging
from experiments.right_turn.data import Plan, Run
from experiments.right_turn.pictures import moved
from experiments.right_turn.results import FORMAT, by_system, machine, of_system, runs_of, summaries

SHIFTS = (0.0, 0.1, 0.25)
"""Seconds by which states of two drives may be apart when they are looked for in each other."""

_ENOUGH_PAIRS = 4
"""Pairs of drives from which on a test of equivalence has the power to say yes."""


def gather(folder: Path, plan: Plan, failed: Mapping[str, str]) -> dict[str, Any]:
    """Returns the data of the page.

    Args:
        folder: Folder of the stages.
        plan: How much was done.
        failed: Why stages failed, by name.
    """
    wall = by_system(runs_of(folder, "wall"))
    data: dict[str, Any] = {
        "format": FORMAT,
        "quick": plan.quick,
        "machine": machine(),
        "failed": dict(failed),
        "load": summaries(folder).get("wall", {}).get("load"),
        "systems": {system: of_system(runs) for system, runs in wall.items()},
        "summaries": _plain(summaries(folder)),
        "figures": [],
    }
    data["verdicts"] = _verdicts(wall)
    data["closeness"] = _closeness(wall)
    data["claims"] = _claims(data)
    return data


def _verdicts(wall: Mapping[str, Sequence[Run]]) -> list[dict[str, Any]]:
    first, second = wall.get("J", []), wall.get("R", [])
    verdicts = []
    if first and second:
        verdicts.append(
            _verdict(
                "R against J, real time",
                "ROS controllers through the bridge against JAUS alone.",
                first,
                second,
                must_pass=True,
            )
        )
    if len(first) > 3:
        verdicts.append(
            _verdict(
                "J against J, real time",
                "Drives of J with odd numbers against those with even ones: what the experiment "
                "calls different though it is the same.",
                first[0::2],
                first[1::2],
                must_pass=True,
            )
        )
    return verdicts


def _verdict(
    title: str, about: str, first: Sequence[Run], second: Sequence[Run], *, must_pass: bool
) -> dict[str, Any]:
    verdict = judging.judge(first, second, VehicleParameters())
    return {
        "title": title,
        "about": about,
        "must_pass": must_pass,
        "passes": verdict.passes,
        "differs": verdict.differs,
        "pairs": verdict.pairs,
        "rows": [_row(row) for row in verdict.rows],
    }


def _row(row: Any) -> dict[str, Any]:
    return {name: _plain(value) for name, value in asdict(row).items()}


def _plain(value: Any) -> Any:
    """Returns a value as JSON has it: four digits, None for what is not finite."""
    if isinstance(value, float):
        return float(f"{value:.4g}") if math.isfinite(value) else None
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {name: _plain(member) for name, member in value.items()}
    return value


def _closeness(wall: Mapping[str, Sequence[Run]]) -> list[dict[str, Any]]:
    """Returns for each shift in time how far states of J and R are apart at most."""
    first, second = moved(wall.get("J", [])), moved(wall.get("R", []))
    pairs = list(zip(first, second, strict=False))
    if not pairs:
        return []
    rows = []
    for shift in SHIFTS:
        row: dict[str, Any] = {"shift": shift}
        for name, distance in _DISTANCES.items():
            row[name] = _plain(max(apart(one, two, shift, distance) for one, two in pairs))
        rows.append(row)
    return rows


def apart(
    one: Sequence[Sample],
    two: Sequence[Sample],
    shift: float,
    distance: Callable[[Sample, Sample], float],
) -> float:
    """Returns the eps of (shift, eps)-closeness over the time that both drives cover.

    Drives are not sampled at equal times, so without a shift one is interpolated to the other.
    """
    if not shift:
        return max(distance(*pair) for pair in aligned(one, two))
    end = min(one[-1].t, two[-1].t)
    common = [[sample for sample in drive if sample.t <= end] for drive in (one, two)]
    return closeness(*common, shift, distance)


_DISTANCES = {
    "position": lambda one, two: math.hypot(one.x - two.x, one.y - two.y),
    "speed": lambda one, two: abs(one.v - two.v),
    "angle": lambda one, two: abs(one.delta - two.delta),
}


def _claims(data: Mapping[str, Any]) -> list[dict[str, Any]]:
    claims: list[dict[str, Any]] = []
    for system, system_data in data["systems"].items():
        text = f"each drive of {system} arrives"
        claims.append({"text": text, "holds": system_data["arrived"] == system_data["drives"]})
        unsafe = system_data["measures"].get("violation_fraction")
        holds = None if unsafe is None else unsafe["most"] == 0
        claims.append({"text": f"no drive of {system} leaves the safe region", "holds": holds})
    claims += map(_claim, data["verdicts"])
    for summary in data["summaries"].values():
        claims += [dict(claim) for claim in summary.get("claims", ())]
    return claims


def _claim(verdict: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the claim of a verdict; with few drives neither it nor its contrary is shown."""
    if verdict["must_pass"]:
        holds = verdict["passes"] or (None if verdict["pairs"] < _ENOUGH_PAIRS else False)
        return {"text": f"{verdict['title']}: equivalent", "holds": holds}
    return {"text": f"{verdict['title']}: shown to be different", "holds": verdict["differs"]}
