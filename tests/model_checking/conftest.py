"""The packages of the rover, generated once, and scripts that run beside them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from workspaces import python_path

from jausml.cli import main

FOLDER = Path(__file__).parent


@pytest.fixture(scope="session")
def workspace(tmp_path_factory):
    """The packages of the rover."""
    folder = tmp_path_factory.mktemp("rover")
    line = ["generate", str(FOLDER / "rover.ros2jaus"), "-o", str(folder), "-q"]
    result = CliRunner().invoke(main, line)
    assert result.exit_code == 0, result.output
    return folder


@pytest.fixture(scope="session")
def run_script(workspace):
    """Runs a script of this folder with the packages; returns what it prints as JSON."""

    def run(name, *words):
        result = subprocess.run(
            [sys.executable, str(FOLDER / name), *words],
            env={**os.environ, "PYTHONPATH": python_path(workspace)},
            capture_output=True,
            text=True,
            timeout=100,
        )
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    return run
