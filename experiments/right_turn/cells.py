"""The cells of the sweep: conditions, and what a drive under them may differ from J."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from experiments.right_turn.loops import Conditions

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from experiments.right_turn.data import Plan

DELAYS = (0, 5, 10, 25, 50, 100, 200)
"""One-way delays in milliseconds, added to the way of each packet."""
LOSSES = (0, 1, 5, 20, 50)
"""Packets that get lost, in percent of each way."""
RATES = (5, 10, 25, 50, 100)
"""Reports each second."""
BURST = 5.0
"""Mean number of packets that get lost in a row, where losses are bursty."""
WAYS = ("sense", "act", "both")
"""Which way is worse: that of the reports, that of the commands, or both."""
MOST_SEEDS = 3
"""Seeds of a cell; nominal conditions and controls have as many as the plan says."""


@dataclass(frozen=True)
class Bounds:
    """What a drive of R may differ from J; the worst drive counts.

    Each is a little more than what 5 ms each way and the jitter of a computer give to a single
    drive; they are not chosen by what the bridge does. Those of `judging` are tighter, since they
    are for the mean of many drives.

    Attributes:
        violation_fraction: Share of the samples outside the safe region.
        path_error_excess: Largest distance from the path beyond that of J, m.
        gap_position: Largest distance of the vehicles at equal times since their first motion, m.
        gap_speed_rms: Root mean square of the difference in speed, m/s.
        gap_steering_rms: Root mean square of the difference in tyre angle, rad.
        closeness_100ms: Distance of the vehicles when 0.1 s of shift in time are forgiven, m.
        activity_ratio: Steering activity over that of J.
    """

    violation_fraction: float = 0.0
    path_error_excess: float = 0.05
    gap_position: float = 0.15
    gap_speed_rms: float = 0.05
    gap_steering_rms: float = 0.003
    closeness_100ms: float = 0.10
    activity_ratio: float = 1.10

    def broken(self, metrics: Mapping[str, float]) -> list[str]:
        """Returns the names of the bounds that a drive breaks; all when it never began."""
        return [
            name
            for name, bound in asdict(self).items()
            if not metrics.get(name, math.inf) <= bound + 1e-12
        ]


BOUNDS = Bounds()


@dataclass(frozen=True)
class Cell:
    """Conditions that are driven with several seeds.

    Attributes:
        name: Name of the cell.
        conditions: What its drives meet; the seed is that of each drive.
        about: Where it stands in tables and maps.
        seeds: How many seeds it is driven with.
        other_seed: Whether J drives with another seed than what is compared with it.
        is_kept: Whether every drive is written, and not the first alone.
    """

    name: str
    conditions: Conditions
    about: Mapping[str, Any]
    seeds: int
    other_seed: bool = False
    is_kept: bool = False

    @property
    def system(self) -> str:
        """Name of the system in the results."""
        conditions = self.conditions
        return f"P{conditions.polling:g}" if conditions.polling else conditions.system

    @property
    def drives(self) -> range:
        """Seeds of its drives."""
        return range(1, self.seeds + 1)


def under(way: str, **link: float) -> Conditions:
    """Returns conditions of R with a link on one way, or on both."""
    return Conditions(
        sense=link if way in ("sense", "both") else {}, act=link if way in ("act", "both") else {}
    )


def cells(plan: Plan) -> list[Cell]:
    """Returns what is driven, the nominal conditions and the controls first."""
    seeds = 1 if plan.quick else min(MOST_SEEDS, plan.runs)
    many = min(2, plan.runs) if plan.quick else plan.runs
    late = {"delay": 0.1}
    found = [
        Cell("nominal", Conditions(), {"group": "nominal"}, many),
        Cell("null", Conditions(system="J"), {"group": "null"}, many, other_seed=True),
        Cell("late", Conditions(sense=late, act=late), {"group": "control"}, seeds),
        Cell("understeer", Conditions(plant="understeer"), {"group": "control"}, seeds),
    ]
    found += _map_cells(plan, seeds)
    if not plan.quick:
        found += [*_way_cells(seeds), *_fault_cells(seeds), *_rate_cells(seeds)]
    return found


def _map_cells(plan: Plan, seeds: int) -> Iterator[Cell]:
    for delay in (0, 25, 100) if plan.quick else DELAYS:
        for loss in (0, 20) if plan.quick else LOSSES:
            about = {"group": "map", "delay_ms": delay, "loss_percent": loss}
            conditions = under("both", delay=delay / 1000, loss=loss / 100)
            yield Cell(f"delay-{delay}-loss-{loss}", conditions, about, seeds)


def _way_cells(seeds: int) -> Iterator[Cell]:
    for delay in DELAYS[1:]:
        for way in WAYS[:2]:
            about = {"group": "way", "way": way, "delay_ms": delay}
            yield Cell(f"{way}-{delay}", under(way, delay=delay / 1000), about, seeds)
        about = {"group": "J", "delay_ms": delay}
        conditions = replace(under("both", delay=delay / 1000), system="J")
        yield Cell(f"J-{delay}", conditions, about, seeds)


def _fault_cells(seeds: int) -> Iterator[Cell]:
    faults: dict[str, Conditions] = {
        "jitter-5": under("both", jitter=0.005),
        "jitter-20": under("both", jitter=0.02),
        "exponential-20": under("both", exponential=0.02),
        "reorder-10": under("both", reorder=0.1),
        "duplicate-10": under("both", duplicate=0.1),
    }
    for loss in LOSSES[1:]:
        faults[f"burst-{loss}"] = under("both", loss=loss / 100, burst=BURST)
    for name, conditions in faults.items():
        yield Cell(name, conditions, {"group": "fault"}, seeds)
        other = replace(conditions, system="J")
        yield Cell(f"J-{name}", other, {"group": "fault"}, seeds)


def _rate_cells(seeds: int) -> Iterator[Cell]:
    for rate in RATES:
        about = {"group": "rate", "rate": rate}
        yield Cell(f"rate-{rate}", Conditions(rate=float(rate)), about, seeds)
