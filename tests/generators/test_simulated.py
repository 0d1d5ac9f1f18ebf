"""Simulated components: what is set is reported, by a skeleton in which nothing is written."""

import os
from pathlib import Path

import pytest
import warm
from generated import STRICT, model_in, run_in, text_of
from ports import free_port
from scripts import succeeded
from workspaces import python_path

from jausml_generators.jaus_component.target import TARGET

HERE = Path(__file__).parent
MODEL = HERE / "simulated.ros2jaus"
SUPPORT = HERE.parent / "support"

PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "pytest_timeout")


def generated(model: Path, folder: Path) -> Path:
    line = [*warm.command(), "generate", str(model), "--all", "-o", str(folder)]
    succeeded(line, timeout=60)
    return folder


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated(MODEL, tmp_path_factory.mktemp("workspace"))


def run(workspace: Path, *command: str | Path, **more: str) -> str:
    path = os.pathsep.join([python_path(workspace), str(SUPPORT)])
    return run_in(workspace, *command, PYTHONPATH=path, **more)


@pytest.mark.slow
def test_the_component_does_as_it_is_told(workspace):
    told = run(workspace, *PYTEST, HERE / "simulated_arm.py")
    assert "8 passed" in told


@pytest.mark.slow
@pytest.mark.ports
def test_a_judge_has_every_answer_that_a_robot_should_give(tmp_path):
    robot = generated(HERE / "judged.ros2jaus", tmp_path)
    words = (*PYTEST, HERE / "judges_messages.py")
    assert "1 passed" in run(robot, *words, JUDGED_PORT=str(free_port()))


@pytest.mark.slow
def test_its_code_is_clean(workspace):
    base = workspace / "arm" / "arm" / "arm_base.py"
    run(workspace, "-m", "mypy", *STRICT, base)
    run(workspace, "-m", "ruff", "check", "--isolated", base)


def test_other_components_are_as_before(tmp_path):
    text = MODEL.read_text(encoding="utf-8").replace("simulated: true", "")
    base = text_of(model_in(tmp_path, text), [TARGET], "arm_base.py")
    assert "imulation" not in base
    assert base.count('"component.not_implemented"') == 13
