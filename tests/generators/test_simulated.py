"""Simulated components: what is set is reported, by a skeleton in which nothing is written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import warm
from workspaces import python_path

from jausml.generation import render
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.jaus_component.target import TARGET

HERE = Path(__file__).parent
MODEL = HERE / "simulated.ros2jaus"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workspace")
    line = [*warm.command(), "generate", str(MODEL), "-o", str(folder)]
    done = subprocess.run(line, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder


def run(workspace: Path, *arguments: str | Path) -> str:
    path = python_path(workspace)
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": path, "MYPYPATH": path},
        cwd=workspace,
        capture_output=True,
        text=True,
        timeout=110,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_component_does_as_it_is_told(workspace: Path) -> None:
    told = run(workspace, "-m", "pytest", "-q", "-p", "no:cacheprovider", HERE / "simulated_arm.py")
    assert "8 passed" in told


def test_its_code_is_clean(workspace: Path) -> None:
    base = workspace / "arm" / "arm" / "arm_base.py"
    run(workspace, "-m", "mypy", "--strict", base)
    run(workspace, "-m", "ruff", "check", "--isolated", base)


def test_other_components_are_as_before(tmp_path: Path) -> None:
    path = tmp_path / "plain.ros2jaus"
    path.write_text(MODEL.read_text(encoding="utf-8").replace("simulated: true", ""), "utf-8")
    model = read_models([path], notations=NOTATIONS).model
    texts = {each.path: each.text for each in render(model, [TARGET])}
    assert "imulation" not in texts["arm/arm/arm_base.py"]
    assert texts["arm/arm/arm_base.py"].count('"component.not_implemented"') == 13
