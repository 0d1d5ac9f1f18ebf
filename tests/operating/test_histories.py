"""The values of numbers over time that plots and plans are drawn from."""

from hypothesis import given
from hypothesis import strategies as st

from jausml.live.operating.values import decimated


@given(st.lists(st.floats(-9, 9), min_size=1, max_size=60), st.integers(3, 20))
def test_peaks_and_the_last_value_are_kept(values, most):
    points = [(float(at), value) for at, value in enumerate(values)]
    kept = decimated(points, most)
    assert len(kept) <= most
    assert kept == sorted(kept)
    assert kept[-1] == points[-1]
    assert {min(values), max(values)} <= {value for _, value in kept}
