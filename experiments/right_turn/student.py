"""Student's t distribution, as far as tests of equivalence need it.

The quantile is found by bisection of the integral of the density, so that no library of statistics
is needed for one number (docs/experiment.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean, stdev

_SLICES = 1000


def student_cdf(value: float, freedom: int) -> float:
    """Returns the share of Student's t distribution up to a value.

    With t = sqrt(freedom) tan(u) the density is a power of the cosine over a bounded interval,
    which Simpson's rule integrates exactly enough.

    Args:
        value: Where to cut the distribution.
        freedom: Degrees of freedom, at least 1.
    """
    scale = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2))
    scale /= math.sqrt(math.pi)
    end = math.atan(value / math.sqrt(freedom))
    width = end / _SLICES
    total = 0.0
    for index in range(_SLICES + 1):
        weight = 1 if index in (0, _SLICES) else 4 if index % 2 else 2
        total += weight * math.cos(index * width) ** (freedom - 1)
    return 0.5 + scale * total * width / 3


def student_quantile(share: float, freedom: int) -> float:
    """Returns the value below which a share of Student's t distribution lies.

    Raises:
        ValueError: The share is not within (0.5, 1), or there is no degree of freedom.
    """
    if not (0.5 < share < 1.0 and freedom >= 1):
        raise ValueError(f"no quantile of {share} with {freedom} degrees of freedom")
    low, high = 0.0, 1.0
    while student_cdf(high, freedom) < share:
        high *= 2
    while high - low > 1e-9 * high:
        middle = (low + high) / 2
        if student_cdf(middle, freedom) < share:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def mean_interval(values: Sequence[float], share: float) -> tuple[float, float] | None:
    """Returns the interval of a mean whose either end is passed with probability 1 - share.

    None for fewer than two values, which say nothing about how much they scatter.
    """
    if len(values) < 2:
        return None
    mean, error = fmean(values), stdev(values) / math.sqrt(len(values))
    half = student_quantile(share, len(values) - 1) * error if error > 0.0 else 0.0
    return mean - half, mean + half
