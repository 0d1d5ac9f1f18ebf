"""The page of mutations has the operators that there are, and what was found of each model."""

from pathlib import Path

import build_mutations
import pytest

GUARDS = ("tools/build_mutations.py", "jausml/mutating")


@pytest.mark.slow
def test_a_small_campaign_makes_a_page(tmp_path):
    page = tmp_path / "made" / "mutations.md"
    build_mutations.main(["--limit", "1", "--page", str(page), build_mutations.MODELS[1]])
    lines = page.read_text(encoding="utf-8").splitlines()
    assert f"## {Path(build_mutations.MODELS[1]).name}" in lines
    assert any(line.startswith("1 of ") for line in lines)
    assert set(build_mutations.operators()) <= set(lines)


def test_the_examples_are_there():
    assert all((build_mutations.ROOT / model).is_file() for model in build_mutations.MODELS)


def test_survivors_of_a_kind_stand_once():
    survivor = {
        "operator": "QoS",
        "change": "depth: 1 -> 2",
        "verdict": "nothing",
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
