"""The hooks for pre-commit name commands that take files and fail as hooks shall."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

GUARDS = (".pre-commit-hooks.yaml",)

ROOT = Path(__file__).resolve().parents[2]
HOOKS = {hook["id"]: hook for hook in yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())}
RIGHT = "component vehicle { address: 1.1.1 }\n"


def run(hook, *files):
    program, *words = shlex.split(hook["entry"])
    command = [str(Path(sys.executable).with_name(program)), *words, *map(str, files)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("hook", HOOKS.values(), ids=lambda hook: hook["id"])
def test_hook_runs_on_the_files_that_it_is_for(hook, tmp_path):
    right = tmp_path / "right.ros2jaus"
    assert re.search(hook["files"], right.name)
    right.write_text(RIGHT, encoding="utf-8")
    done = run(hook, right)
    assert (done.returncode, right.read_text(encoding="utf-8")) == (0, RIGHT), done.stderr


def test_model_with_errors_fails_the_hook(tmp_path):
    wrong = tmp_path / "wrong.ros2jaus"
    wrong.write_text(RIGHT.replace("1.1.1", "0.1.1"), encoding="utf-8")
    done = run(HOOKS["jausml-validate"], wrong)
    assert done.returncode == 1
    assert "JML301" in done.stdout
