"""The values of numbers over time that plots and plans are drawn from."""

import math
import time
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from suspended_clocks import SuspendedClocks

from jausml.generation.native import compiler
from jausml.live.messages import load_catalogue
from jausml.live.operating.values import RATE, Values, decimated
from jausml.runtime.base.address import JausAddress

BASE = JausAddress(100, 1, 1)


@given(st.lists(st.floats(-9, 9), min_size=1, max_size=60), st.integers(3, 20))
def test_peaks_and_the_last_value_are_kept(values, most):
    points = [(float(at), value) for at, value in enumerate(values)]
    kept = decimated(points, most)
    assert len(kept) <= most
    assert kept == sorted(kept)
    assert kept[-1] == points[-1]
    assert {min(values), max(values)} <= {value for _, value in kept}


def test_what_is_no_number_is_a_gap_and_moves_no_other_value():
    values = [3.0, math.nan, 5.0, 1.0, math.inf, *[2.0] * 20, 9.0, 0.5]
    kept = dict(decimated(list(enumerate(values)), 9))
    assert len(kept) <= 9
    assert sum(not math.isfinite(value) for value in kept.values()) == 1
    assert {9.0, 0.5} <= set(kept.values())


def test_a_history_says_when_it_was_asked_by_the_clock_of_its_times(operated):
    with operated.page() as page:
        asked = {"component": "1.1.1", "report": "ReportLocalPose", "path": ""}
        history = page.ask("history", **asked, seconds=60, points=100)
    assert time.time() - 60 < history["now"] + history["epoch"] <= time.time()


def test_values_are_as_old_as_they_are_whatever_the_clock_of_the_computer_does(monkeypatch):
    values, said = Values(), {}
    operator = SimpleNamespace(
        exchange=lambda *_: (None, SimpleNamespace(name="ReportStatus")),
        watch=lambda *arguments: said.update(take=arguments[3]),
    )
    values.watch(operator, BASE, "ReportStatus", 1.0, page=1)
    entry = load_catalogue().message("ReportStatus")
    fields = entry.decode(entry.encode({"ReportStatusRec": {"Status": 1, "Reserved": 0}}))
    clock = iter(range(100, 200))
    monkeypatch.setattr("jausml.live.operating.values.steady", lambda: float(next(clock)))
    said["take"](entry, fields)
    said["take"](entry, fields)
    (report,) = values.last()
    assert report["age"] == pytest.approx(1)
    assert values.history(str(BASE), "ReportStatus", RATE, 60, 100) == [(101, 1)]


AGES = """
from jausml.live.systems.monitoring import Monitor
from jausml.live.systems.state import SystemState

monitor = Monitor(SystemState())
before = monitor.state().now
print(flush=True)
input()
print(monitor.state().now - before >= 200)
"""


@pytest.mark.needs("compiler")
def test_what_was_heard_before_a_suspension_of_the_computer_is_old_after_it(tmp_path):
    assert SuspendedClocks(tmp_path, compiler()).told(AGES, 200) == "\nTrue\n"
