"""The shipped examples: what is generated from them is what a careful engineer would write."""

import compileall
import os
import shutil
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from scripts import succeeded
from sweeps import sweep

from jausml.cli import main

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = [
    "catvehicle", "catvehicle/jaus_only", "minimal", "examples/simulator", "examples/waypoint_list",
    "examples/waypoint_list/without_ros", "examples/winch",
]  # fmt: skip
NOTATIONS = {".xmi", ".ros2jaus"}
SHARED = {
    "examples/simulator": {"catvehicle/src/catvehicle": "catvehicle"},
    "examples/waypoint_list/without_ros": {
        "examples/waypoint_list/src/operator_unit": "operator_unit",
        "examples/waypoint_list/driving.py": "robot/robot/driving.py",
    },
}
"""Packages and modules that examples take from others, and where they belong."""
RUNTIME = "jausml_runtime"
RULES = "E,F,W,UP,B,SIM,D,N,PIE,RET"
# What ROS itself leaves untyped.
MYPY = """[mypy]
strict = true
python_version = 3.10
ignore_missing_imports = true
disallow_untyped_calls = false
disallow_subclassing_any = false
warn_return_any = false
"""


@pytest.fixture(scope="module", params=sweep(EXAMPLES, every=8))
def workspace(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Generates an example, around its skeletons where it has any."""
    source = ROOT / "models" / request.param
    folder = tmp_path_factory.mktemp(source.name) / "ws"
    ignored = shutil.ignore_patterns("__pycache__")
    if (source / "src").is_dir():
        shutil.copytree(source / "src", folder, ignore=ignored)
    for shared, place in SHARED.get(request.param, {}).items():
        taken = ROOT / "models" / shared
        if taken.is_dir():
            shutil.copytree(taken, folder / place, ignore=ignored)
        else:
            shutil.copy(taken, folder / place)
    generate(model_in(source), "-o", str(folder))
    return folder


def generate(model: Path, *options: str) -> str:
    """Runs `jausml generate` in this process; returns what it printed."""
    result = CliRunner().invoke(main, ["generate", str(model), *options])
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the runtime is, which mypy shall know by one path: it is the same in all examples."""
    folder = tmp_path_factory.mktemp("typed")
    (folder / "mypy.ini").write_text(MYPY, encoding="utf-8")
    return folder


def model_in(source: Path) -> Path:
    """Returns the model of an example, in whichever notation it is."""
    (model,) = (path for path in source.glob(f"{source.name}.*") if path.suffix in NOTATIONS)
    return model


def run(*arguments: str, cwd: Path | None = None, path: str | None = None) -> str:
    """Runs Python; returns what it printed."""
    environment = {**os.environ, **({"MYPYPATH": path} if path else {})}
    command = [sys.executable, *arguments]
    result = succeeded(command, cwd=cwd, env=environment, timeout=110)
    return result.stdout + result.stderr


def test_no_skeleton_has_drifted(workspace):
    name = workspace.parent.name.rstrip("0123456789")
    (example,) = (path for path in EXAMPLES if Path(path).name == name)
    model = model_in(ROOT / "models" / example)
    said = generate(model, "-o", str(workspace), "--check")
    assert "does not define" not in said
    assert "warning" not in said


def test_compiles(workspace):
    assert compileall.compile_dir(workspace, quiet=1)


def test_is_formatted_and_clean(workspace):
    isolated = ["--isolated", "--config", "line-length=100", "--target-version", "py310"]
    run("-m", "ruff", "format", "--check", *isolated, str(workspace))
    docs = ["--config", "lint.pydocstyle.convention='google'", "--ignore", "D105,D107,D417"]
    # The core messages have the names of the standard, which says what they mean.
    ours = workspace / RUNTIME / RUNTIME / "messages" / "*.py"
    docs += ["--per-file-ignores", f"{ours}:D101,{ours}:D106"]
    run("-m", "ruff", "check", "--select", RULES, *docs, *isolated, str(workspace))


@pytest.mark.slow
def test_is_typed(workspace, judged):
    packages = [path for path in sorted(workspace.iterdir()) if (path / path.name).is_dir()]
    run(
        "-m",
        "mypy",
        "--config-file",
        str(judged / "mypy.ini"),
        "--cache-dir",
        f"{os.environ['MYPY_CACHE_DIR']}-ros",  # what mypy knows is of one set of options
        "--explicit-package-bases",
        *(str(package / package.name) for package in packages),
        cwd=judged,
        path=os.pathsep.join(map(str, packages)),
    )
