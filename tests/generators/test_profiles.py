"""The profiles of IOP that `jausml init` begins with, straight from the generator."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import warm
from generated import WITHOUT_PLUGINS
from profiles import decided
from scripts import succeeded
from workspaces import python_path

HERE = Path(__file__).parent
GUARDS = ("jausml/authoring/projects/templates", "models/library/mappings")


def jausml(*arguments: str | Path) -> None:
    line = [*warm.command(), *map(str, arguments)]
    succeeded(line, timeout=120)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> str:
    found = []
    # Each has a package of messages of its own, with those that it knows.
    for profile, name in (("iop-ugv", "robot"), ("iop-operator", "station")):
        folder = tmp_path_factory.mktemp("profile")
        jausml("init", folder, "--from", profile, "--name", name)
        model = folder / "models" / f"{name}.ros2jaus"
        text = decided(profile, model.read_text(encoding="utf-8"))
        # Hosts of the virtual network have no addresses.
        model.write_text(text.replace('allowedHosts: "127.0.0.1" ', ""), encoding="utf-8")
        jausml("generate", model, "--all", "-o", folder / "src")
        found.append(python_path(folder / "src"))
    return os.pathsep.join(found)


@pytest.mark.slow
def test_vehicle_and_unit_meet(path):
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            "-p",
            "pytest_timeout",
            HERE / "profiles_meet.py",
        ],
        env={**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": path},
        cwd=HERE,
        capture_output=True,
        text=True,
        timeout=110,
    )
    assert "4 passed" in done.stdout, done.stdout + done.stderr
