"""The page and the table say what the data says, and no more."""

import re

import pytest

from experiments.right_turn import report
from experiments.right_turn.data import Run
from experiments.right_turn.results import by_system, of_system
from experiments.right_turn.tables import markdown_table, number

METRICS = {
    "duration": 18.0,
    "path_error_max": 0.27,
    "path_error_rms": 0.1,
    "violation_fraction": 0.0,
    "peak_lateral_acceleration": 1.95,
    "least_speed_margin": 0.06,
    "steering_activity": 0.536,
}


def drive(system, **changes):
    metrics = METRICS | changes.pop("metrics", {})
    return Run(system, "01", **{"arrived": True, "metrics": metrics} | changes)


def data(**changes):
    runs = [drive("J"), drive("J", metrics={"duration": 18.2}), drive("R", arrived=False)]
    row = {"name": "gap", "value": 0.1, "interval": [0.05, 0.15], "bound": 0.2}
    row |= {"passes": True, "differs": False}
    verdict = {"title": "R against J", "about": "Both.", "must_pass": True}
    verdict |= {"passes": True, "differs": False, "pairs": 10}
    return {
        "quick": False,
        "failed": {},
        "load": 0.1,
        "machine": {"python": "3.11.0", "processors": 2},
        "systems": {name: of_system(found) for name, found in by_system(runs).items()},
        "verdicts": [{**verdict, "rows": [row]}],
        "closeness": [{"shift": 0.1, "position": 0.02, "speed": 0.01, "angle": 0.001}],
        "claims": [{"text": "each drive of R arrives", "holds": False}],
        "summaries": {},
        "figures": ["turn"],
        **changes,
    }


def row_of(text, begin):
    return next(line for line in text.splitlines() if line.startswith(f"| {begin}"))


def test_measures_are_means_with_their_extremes():
    text = report.page(data())
    assert row_of(text, "duration") == "| duration, s | 18.1 (18 to 18.2) | 18 |"
    assert row_of(text, "arrived") == "| arrived | 2 of 2 | 0 of 1 |"
    assert row_of(text, "steering activity").endswith("| 30.7 | 30.7 |")


def test_a_claim_that_does_not_hold_is_told():
    assert row_of(report.page(data()), "each drive of R") == "| each drive of R arrives | **no** |"
    assert re.search(r"each drive of R arrives +no", report.table(data()))


def test_only_figures_that_were_drawn_are_shown():
    text = report.page(data(), "pictures")
    assert re.findall(r"!\[.*?\]\((.*?)\)", text) == ["pictures/turn.svg"]


def test_stages_that_failed_are_told():
    text = report.page(data(failed={"wall": "not done after 200 s"}))
    assert "- wall: not done after 200 s" in text


def test_a_busy_computer_is_told():
    assert "Other work was done meanwhile" in report.page(data(load=5.8))
    assert "Other work was done meanwhile" in report.page(data(load=1.1))
    assert "Other work was done meanwhile" not in report.page(data(load=1.0))
    assert "Other work" not in report.page(data())


def test_a_quick_look_says_so():
    assert "quick look" in report.page(data(quick=True))
    assert "quick look" not in report.page(data())


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.12345, "0.123"), (0.0, "0"), (12345.6, "12,346"), (7, "7"), (None, ""), (-0.5, "-0.5")],
)
def test_numbers_have_three_digits(value, text):
    assert number(value) == text


def test_a_bar_in_a_cell_parts_no_cells():
    assert markdown_table(("a",), [("x|y",)]).splitlines()[-1] == r"| x\|y |"
