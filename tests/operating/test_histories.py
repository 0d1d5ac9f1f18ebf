"""The values of numbers over time that plots and plans are drawn from."""

import time

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


def test_a_history_says_when_it_was_asked_by_the_clock_of_its_times(operated):
    with operated.page() as page:
        asked = {"component": "1.1.1", "report": "ReportLocalPose", "path": ""}
        history = page.ask("history", **asked, seconds=60, points=100)
    assert time.time() - 60 < history["now"] <= time.time()
