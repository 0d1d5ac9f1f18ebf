"""How far apart the paths of two drives are, and how far they may be.

The bound follows from one choice: a bridge may make the answer to an odometry one period (20 ms)
later. That is the age that the odometry of a robot has anyway when its wheels obey. What it does
to the same body and the same law, without any middleware, is the most that paths may differ; what
the experiment cannot tell apart is a floor: the robot moves 0.02 m between two samples.

In real time, each process of the loop may be late by a period besides, since the computer decides
when it runs: the wheels and the follower of R, and the robot of J.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from driving import PERIOD, SPEED, Body, Course

from .drives import LIMIT, LIST
from .results import STANDSTILL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .drives import Point
    from .results import State

TOLERATED, IN_REAL_TIME = 1, 4
"""Periods of the odometry by which an answer may be later, in virtual and in real time."""
_EACH = 5
"""Every how many samples of a path are looked for in the other one."""


def path_gap(one: Sequence[Point], two: Sequence[Point]) -> float:
    """Returns how far a point of either path is from the other path at most, m."""
    return max(_farthest(one, two), _farthest(two, one))


def path_of(truth: Sequence[State]) -> list[Point]:
    """Returns where a robot moved; it stands at both ends."""
    moving = [at for at, each in enumerate(truth) if abs(each.speed) >= STANDSTILL]
    return [(each.x, each.y) for each in truth[moving[0] : moving[-1] + 2]] if moving else []


@lru_cache
def bound(waypoints: Sequence[Point] = LIST, periods: int = TOLERATED) -> float:
    """Returns how far two paths along a list may be apart, m."""
    moved = path_gap(_driven(waypoints, 0), _driven(waypoints, periods))
    return max(moved, SPEED * PERIOD)


def _driven(waypoints: Sequence[Point], late: int) -> list[Point]:
    """Returns the path without middleware, where answers are so many periods late."""
    body, course, path = Body(), Course(waypoints), [(0.0, 0.0)]
    waiting = [(0.0, 0.0)] * late
    for _ in range(round(LIMIT / PERIOD)):
        waiting.append(course.command(body.x, body.y, body.psi))
        body.advance(*waiting.pop(0), PERIOD)
        path.append((body.x, body.y))
        if course.is_over and body.speed < STANDSTILL:
            break
    return path


def _farthest(one: Sequence[Point], two: Sequence[Point]) -> float:
    if not one or len(two) < 2:
        return math.inf
    points, path = np.array(one[::_EACH])[:, None], np.array(two)
    starts, along = path[:-1], np.diff(path, axis=0)
    lengths = np.maximum((along**2).sum(axis=1), 1e-12)
    shares = np.clip(((points - starts) * along).sum(axis=2) / lengths, 0.0, 1.0)
    away = points - starts - shares[..., None] * along
    return float(np.hypot(away[..., 0], away[..., 1]).min(axis=1).max())
