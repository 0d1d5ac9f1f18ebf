"""Commands and workers of the suite begin as forks of a process that has all loaded."""

import os
import subprocess

import pytest
import warm
from scripts import ran

WORKER = """
import os, subprocess, sys
import jausml.language.project, warm
assert warm.load.cache_info().currsize, "nothing is loaded"
done = subprocess.run([*warm.command(), "--version"], capture_output=True, text=True)
print(os.getcwd(), os.environ["COLOUR"], done.stdout.split()[1], sys.stdin.readline())
sys.exit(7)
"""


@pytest.fixture(scope="module")
def python() -> list[str]:
    return warm.python()


def test_a_python_runs_a_text_and_has_commands_of_its_own(tmp_path, python):
    done = ran(
        [*python, "-u", "-c", WORKER],
        cwd=tmp_path,
        env={**os.environ, "COLOUR": "green"},
        input="a line",
    )
    assert done.stderr == ""
    assert done.stdout == f"{tmp_path} green version a line\n"
    assert done.returncode == 7


def test_the_end_of_a_command_by_a_signal_is_told(python):
    text = "import os, signal; os.kill(os.getpid(), signal.SIGTERM)"
    assert subprocess.run([*python, "-u", "-c", text]).returncode == -15
