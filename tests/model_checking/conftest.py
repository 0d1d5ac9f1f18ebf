"""Scripts that run beside the packages of a model, which are generated once."""

import json
import os
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from scripts import succeeded
from workspaces import python_path

from jausml.cli import main

FOLDER = Path(__file__).parent
ROVER = FOLDER / "rover.ros2jaus"


@pytest.fixture(scope="session")
def path_of(tmp_path_factory):
    """Returns the Python path of the packages of a model, which are generated once."""
    workspaces = {}

    def found(model):
        if model not in workspaces:
            workspaces[model] = tmp_path_factory.mktemp(model.stem)
            line = ["generate", str(model), "--all", "-o", str(workspaces[model]), "-q"]
            result = CliRunner().invoke(main, line)
            assert result.exit_code == 0, result.output
        return python_path(workspaces[model])

    return found


@pytest.fixture(scope="session")
def run_script(path_of):
    """Runs a script of this folder beside the packages of a model; returns what it says as JSON."""

    def run(name, *words, model=ROVER):
        result = succeeded(
            [sys.executable, str(FOLDER / name), *words],
            env={**os.environ, "PYTHONPATH": path_of(model)},
            timeout=100,
        )
        return json.loads(result.stdout)

    return run
