"""Whatever a model holds: validation ends, and what it finds no error in can be generated and read.

A long run takes more mutants: JAUSML_EXAMPLES=1000 (see CONTRIBUTING.md).
"""

import os
import random
import re
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import compositions
import lupa
import mutants
import needs
import pytest
import yaml
from generated import WITHOUT_PLUGINS
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from workspaces import packages_of, python_path

from jausml.generation.artifact import find_problems
from jausml.generation.errors import GenerationError, NoSystemError
from jausml.generation.rendering import render
from jausml.generation.target import load_targets
from jausml.language.interfaces.parsing import PARTS, parse_definition
from jausml.language.validation.engine import check_project
from jausml_generators.deployment.target import TARGET as DEPLOYMENT

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "4"))
FILE_NAMES = (
    "model.xmi", "coding:utf-7;m.xmi", "a--b -->.xmi", "é\"'.xmi", "x\ny=1.xmi", "${x}.xmi",
)  # fmt: skip
_IMPORT = """
import importlib, sys
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        # Interface packages of the model are built by colcon, and some of ROS are not installed.
        if "messages" in error.name or (error.name or "").startswith("jausml"):
            raise
"""


@pytest.fixture(scope="module")
def targets():
    """Returns every target, with that of dissectors."""
    return [target for target in load_targets().values() if target.name != "declared_interfaces"]


@pytest.mark.slow
@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_model_without_errors_makes_a_workspace(targets, data):
    def choose(things):
        # By numbers: things print all that they know of when an example fails.
        return things[data.draw(st.integers(0, len(things) - 1))]

    text = mutants.mutant(choose, mutants.seed_texts())
    make_a_workspace(targets, choose, text, choose(FILE_NAMES))


@pytest.mark.slow
@settings(max_examples=EXAMPLES // 2, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_ready_maps_can_be_put_together(targets, data):
    def choose(things):
        # By numbers: things print all that they know of when an example fails.
        return things[data.draw(st.integers(0, len(things) - 1))]

    make_a_workspace(targets, choose, compositions.composition(choose), "model.ros2jaus")


def make_a_workspace(targets, choose, text, file_name):
    """Generates and reads what a model makes, unless validation refuses it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = folder / file_name
        model.write_text(text, encoding="utf-8")
        report = check_project([model])
        if report.has_errors:
            return
        try:
            artifacts = render(
                report.model, [target for target in targets if target is not DEPLOYMENT]
            )
        except NoSystemError:
            return  # a mutant of several systems, or none
        with suppress(GenerationError):  # it asks for hosts, and for such as can meet
            artifacts += render(report.model, [DEPLOYMENT])
        assert find_problems(artifacts) == {}
        for artifact in artifacts:
            read_as_its_format(artifact)
            (folder / "ws" / artifact.path).parent.mkdir(parents=True, exist_ok=True)
            (folder / "ws" / artifact.path).write_bytes(artifact.text.encode("utf-8"))
        read_by_python(folder / "ws", runs_tests=choose((True, *[False] * 9)))


def read_as_its_format(artifact):
    """Reads what is no Python; that is compiled when it is rendered."""
    ending = artifact.path.rpartition(".")[2]
    if ending in ("yaml", "yml"):
        yaml.safe_load(artifact.text)
    elif ending == "lua":
        problem = lupa.LuaRuntime().eval("function(s) local f, e = load(s) return e end")
        assert problem(artifact.text) is None
    elif ending in PARTS:
        assert parse_definition(artifact.text, ending).faults == []


def read_by_python(workspace, *, runs_tests):
    """Imports the packages, and runs their tests where the ROS packages are that they need."""
    needs.ask("rclpy")
    names = [Path(package).name for package in packages_of(workspace)]
    environment = {**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": python_path(workspace)}
    run = {"env": environment, "capture_output": True, "text": True, "check": False}
    done = subprocess.run([sys.executable, "-c", _IMPORT, *names], timeout=300, **run)
    assert done.returncode == 0, done.stderr
    for folder in sorted(workspace.glob("*/test")) if runs_tests else ():
        command = [sys.executable, "-m", "pytest", "-q", "-c", os.devnull, "--rootdir", ".", "test"]
        done = subprocess.run(command, cwd=folder.parent, timeout=600, **run)
        missing = set(re.findall(r"No module named '(\w+)", done.stdout)) - set(names)
        # Test vectors of users judge their conversions, which nobody has written here.
        errors = set(re.findall(r"^E +(\w+Error)\b", done.stdout, re.MULTILINE))
        assert done.returncode == 0 or missing or errors == {"NotImplementedError"}, done.stdout


@pytest.mark.slow
def test_neither_mutants_nor_compositions_are_all_refused():
    """Else the property would say nothing: a good part of what is drawn is generated."""
    chosen = random.Random(0).choice
    texts = {
        "model.xmi": [mutants.mutant(chosen, mutants.seed_texts()) for _ in range(8)],
        "model.ros2jaus": [compositions.composition(chosen) for _ in range(8)],
    }
    with tempfile.TemporaryDirectory() as name:
        for file_name, drawn in texts.items():
            model = Path(name) / file_name
            refused = 0
            for text in drawn:
                model.write_text(text, encoding="utf-8")
                refused += check_project([model]).has_errors
            assert 0 < refused < 8


def test_compositions_can_be_made_again():
    first, again = (compositions.composition(random.Random(7).choice) for _ in range(2))
    assert first == again


def test_compositions_use_every_ready_map():
    choose = random.Random(0).choice
    drawn = "\n".join(compositions.composition(choose) for _ in range(200))
    assert {ready_map.name for ready_map in compositions.ready_maps()} == set(
        re.findall(r"^    map: (\w+)$", drawn, flags=re.MULTILINE)
    )
