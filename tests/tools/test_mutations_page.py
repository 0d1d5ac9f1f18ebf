"""docs/reference/mutations.md was made of the operators that there are, and of the examples."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import build_mutations

GUARDS = ("tools/build_mutations.py", "docs/reference/mutations.md", "jausml/mutating")


def test_the_page_has_the_present_operators():
    text = build_mutations.PAGE.read_text(encoding="utf-8")
    assert "\n".join(build_mutations.operators()) in text, "run `make mutate`"


def test_the_page_has_examples_that_are_there():
    text = build_mutations.PAGE.read_text(encoding="utf-8")
    shown = {line[3:] for line in text.splitlines() if line.startswith("## ")} - {"Operators"}
    names = {Path(model).name for model in build_mutations.MODELS}
    assert shown
    assert shown <= names
    assert all((ROOT / model).is_file() for model in build_mutations.MODELS)


def test_survivors_of_a_kind_stand_once():
    survivor = {
        "operator": "QoS",
        "words": "depth: 1 -> 2",
        "noticed_by": "nothing",
        "files": ["a/a.py"],
    }
    campaign = {
        "model": "m.xmi",
        "tried": 2,
        "possible": 3,
        "matrix": {"QoS": {"nothing": 2}},
        "outcomes": [survivor, survivor],
        "remarks": [],
    }
    lines = build_mutations.page([campaign]).splitlines()
    assert "2 of 3 possible mutations were tried; 2 survive." in lines
    assert "| QoS |  |  |  |  |  |  |  |  | 2 |" in lines
    assert "- QoS: `depth: 1 -> 2`, in `a/a.py`, 2 times" in lines
