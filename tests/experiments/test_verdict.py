"""The verdicts of the experiments on generated packages: sound ones pass, broken ones do not."""

from __future__ import annotations

import logging
import shutil
import sys
from pathlib import Path

import pytest
from sweeps import sweep

from experiments import verdict
from experiments.waypoints.systems import generated

MISTAKES = {
    "right_turn": (
        "bridge/bridge/bridge_base.py",
        'Topic("speed_command"',
        'Topic("another"',
        "the vehicle does not arrive",
    ),
    "waypoints": (
        "robot/robot/robot_base.py",
        "conversions.negate(source.y)",
        "source.y",
        "whole: not so: each waypoint is passed",
    ),
}


@pytest.fixture(scope="module")
def packages(tmp_path_factory, virtual_workspaces):
    folder = tmp_path_factory.mktemp("verdicts") / "R"
    return {"right_turn": virtual_workspaces["R"], "waypoints": generated("R", folder)}


@pytest.mark.parametrize("name", MISTAKES)
def test_sound_packages_pass(packages, name, capsys) -> None:
    assert verdict.main([name, str(packages[name])]) == 0
    assert capsys.readouterr().out == ""
    # For the tests that follow: the runtime, which all share, can still load the rest of itself.
    assert Path(sys.modules["jausml_runtime"].__file__).exists()
    assert logging.getLogger("jausml").isEnabledFor(logging.WARNING)


@pytest.mark.parametrize("name", sweep(MISTAKES, every=4))
def test_a_mistake_fails(packages, name, tmp_path, capsys) -> None:
    file, right, wrong, told = MISTAKES[name]
    broken = shutil.copytree(packages[name], tmp_path / "broken")
    text = (broken / file).read_text("utf-8")
    assert right in text
    (broken / file).write_text(text.replace(right, wrong), encoding="utf-8")
    assert verdict.main([name, str(broken)]) == 1
    assert capsys.readouterr().out.startswith(told)


def test_code_that_does_not_run_fails(packages, tmp_path, capsys) -> None:
    broken = shutil.copytree(packages["waypoints"], tmp_path / "broken")
    (broken / "robot" / "robot" / "robot_base.py").write_text("raise OSError('no')\n", "utf-8")
    assert verdict.main(["waypoints", str(broken)]) == 1
    assert capsys.readouterr().out == "OSError: no\n"


def test_each_verdict_is_tried() -> None:
    assert set(verdict.VERDICTS) == set(MISTAKES)
