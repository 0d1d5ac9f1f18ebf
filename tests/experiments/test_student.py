"""Student's t distribution against tables."""

import pytest

from experiments.right_turn.student import mean_interval, student_cdf, student_quantile


@pytest.mark.parametrize(
    ("share", "freedom", "value"),
    [
        # NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2.
        (0.95, 1, 6.314),
        (0.95, 2, 2.920),
        (0.95, 9, 1.833),
        (0.95, 19, 1.729),
        (0.975, 9, 2.262),
        (0.99, 5, 3.365),
        (0.95, 100, 1.660),
    ],
)
def test_quantiles(share, freedom, value):
    assert student_quantile(share, freedom) == pytest.approx(value, abs=5e-4)


def test_the_distribution_is_symmetric_and_whole():
    assert student_cdf(0.0, 7) == 0.5
    assert student_cdf(1.3, 7) + student_cdf(-1.3, 7) == pytest.approx(1.0)
    assert student_cdf(1e6, 2) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("share", "freedom"), [(0.5, 3), (1.0, 3), (0.95, 0)])
def test_what_has_no_quantile_is_refused(share, freedom):
    with pytest.raises(ValueError, match="no quantile"):
        student_quantile(share, freedom)


def test_interval_of_a_mean():
    # Mean 2, standard deviation 1: 2.920 / sqrt(3) on either side.
    assert mean_interval([1.0, 2.0, 3.0], 0.95) == pytest.approx((0.314, 3.686), abs=1e-3)
    assert mean_interval([2.0, 2.0], 0.95) == (2.0, 2.0)
    assert mean_interval([2.0], 0.95) is None
