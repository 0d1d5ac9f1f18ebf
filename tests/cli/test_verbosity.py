"""How much the command line says, and to whom."""

import sys

import pytest
import warm
from scripts import ran
from terminal import at_terminal

from jausml.cli.shared.terminal import Verbosity, verbosity

# Waits until a line is typed, so that the step lasts as long as the test looks at it.
STEP = """
import sys
from jausml.cli.shared import terminal
terminal.PATIENCE = 0.0
with terminal.step("checking models") as progress:
    progress.at(0.25)
    sys.stdin.readline()
print("done", file=sys.stderr)
"""
ESCAPE = "\x1b["


def test_a_long_step_is_shown_on_a_terminal_and_wiped_away(tmp_path):
    with at_terminal(sys.executable, "-c", STEP, cwd=tmp_path) as terminal:
        terminal.wait_for("checking models ... 25%, ")
        terminal.type("\n")
        terminal.wait_for("done")
        last = terminal.shown.rpartition("checking models")[2]
        assert last.index(f"\r{ESCAPE}K") < last.index("done")


def test_no_log_has_progress(tmp_path):
    done = ran([sys.executable, "-c", STEP], cwd=tmp_path, input="\n", timeout=60)
    assert done.stderr == "done\n"


def test_a_terminal_that_cannot_wipe_has_no_progress(tmp_path):
    code = STEP.replace("sys.stdin.readline()", "import time; time.sleep(0.6)")
    dumb = {"TERM": "dumb"}
    with at_terminal(sys.executable, "-c", code, cwd=tmp_path, environment=dumb) as terminal:
        assert terminal.read_all() == "done\r\n"


def test_a_step_that_prints_to_the_terminal_has_no_progress_beside(tmp_path):
    code = STEP.replace('models")', 'models", prints=True)')
    with at_terminal(sys.executable, "-c", code, cwd=tmp_path) as terminal:
        terminal.type("\n")
        assert "checking" not in terminal.read_all()


@pytest.mark.usefixtures("folder")
def test_quiet_tells_problems_alone(jausml):
    assert "no problems" in jausml("validate", "good.xmi").stderr
    silent = jausml("--quiet", "validate", "good.xmi")
    assert (silent.exit_code, silent.stdout, silent.stderr) == (0, "", "")
    assert "JML" in jausml("-q", "validate", "bad.xmi").stdout


@pytest.mark.usefixtures("folder")
def test_verbose_tells_steps_and_their_time(jausml):
    said = jausml("--verbose", "generate", "good.xmi", "-o", "out").stderr
    steps = [line.partition(":")[0] for line in said.splitlines() if line.endswith(" s")]
    assert steps == ["checking the model", "generating"]


def test_quiet_and_verbose_exclude_each_other(refused):
    refused("exclude each other", "-q", "-v", "rules")


@pytest.mark.parametrize(("variables", "coloured"), [({}, True), ({"NO_COLOR": "1"}, False)])
def test_no_color_is_heeded(folder, monkeypatch, variables, coloured):
    monkeypatch.delenv("NO_COLOR", raising=False)
    command = (*warm.command(), "diff", "good.xmi", "doubtful.xmi")
    with at_terminal(*command, cwd=folder, environment=variables) as terminal:
        shown = terminal.read_all()
    assert "1 change" in shown
    assert (ESCAPE in shown) is coloured


def test_outside_the_command_line_verbosity_is_the_usual():
    assert verbosity() == Verbosity()
