"""Campaigns: what notices mutations of a model is told, and what nothing notices."""

import json
import shlex
import sys
from pathlib import Path

import needs
import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.mutating.outcomes import Campaign, Outcome, render

GUARDS = ("jausml/mutating", "jausml/cli/models/prove.py")
MODEL = Path(__file__).with_name("drive.ros2jaus").read_text()


def run(*arguments):
    return CliRunner().invoke(main, ["mutate", *map(str, arguments)])


def outcomes(*arguments):
    """Returns what became of mutations by operator and change."""
    done = run(*arguments, "--format", "json")
    assert done.exit_code in (0, 1), done.output
    found = json.loads(done.stdout)
    return {(outcome["operator"], outcome["change"]): outcome for outcome in found["outcomes"]}


@pytest.fixture
def model(tmp_path):
    """Returns the path of a model with a bridge."""
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL)
    return path


@pytest.mark.slow
@pytest.mark.live
@pytest.mark.timeout(120)
def test_what_notices_a_mutation_is_told(model, tmp_path):
    needs.ask("rclpy")
    text = "open(os.environ['JAUSML_WORKSPACE'] + '/bridge/bridge/bridge_base.py').read()"
    command = f"import os; assert 'authority=100' in {text}"
    names = ("offset", "stop", "order", "authority", "control")
    asked = [argument for name in names for argument in ("--only", name)]
    asked += ["--run", shlex.join([sys.executable, "-c", command])]
    found = outcomes(model, *asked, "--jobs", 2, "-o", tmp_path / "page")
    offset = found["offset", "conversions: nothing -> linear"]
    assert (offset["verdict"], "test_drive" in offset["detail"]) == ("tests", True)
    stop = found["stop", "safeValue: PropulsiveLinearEffortX -> nothing"]
    assert (stop["verdict"], stop["detail"][:7]) == ("validate", "JML451 ")
    # The order of a sign and a factor makes no difference: nothing can notice it.
    order = found["order", "conversions: negate, scale -> scale, negate"]
    assert (order["verdict"], order["detail"]) == ("nothing", "")
    assert "bridge/bridge/bridge_base.py" in order["files"]
    assert "order: drive/bridge/drive/toJaus[1]" in (tmp_path / "page" / "index.html").read_text()
    authority = found["authority", "authority: 100 -> 50"]
    assert (authority["verdict"], authority["detail"]) == ("run", "AssertionError")
    assert found["control", "control: True -> False"]["verdict"] == "check"


def test_survivors_are_named():
    survivor = Outcome("rate", "robot/bridge/pose", "rate: 10.0 -> 5.0", "nothing", "", ("a.py",))
    noticed = Outcome("sign", "robot/bridge/pose", "x", "tests", "test_pose")
    text = render(Campaign("robot.xmi", 3, 3, [noticed, survivor], ["no rclpy"]))
    assert text.splitlines()[0] == (
        "robot.xmi: 2 of 3 possible mutations tried; the time was over before 1 more; "
        "nothing notices 1"
    )
    assert "note: no rclpy" in text
    assert text.endswith(
        "nothing notices:\n  rate: robot/bridge/pose rate: 10.0 -> 5.0 (changes a.py)"
    )
    matrix = [line.split() for line in text.splitlines() if line.startswith(("rate", "all"))]
    assert matrix == [["rate", *"........", "1"], ["all", *"..1.....1"]]


@pytest.mark.slow
def test_a_budget_ends_a_campaign(model):
    done = run(model, "--budget", "0.001")
    assert done.exit_code == 1
    assert "the time was over before" in done.output


def test_other_operators_are_refused(model):
    done = run(model, "--only", "nobody")
    assert done.exit_code == 2
    assert "there is no operator 'nobody'; there are sign, sign both ways, factor" in done.output


@pytest.mark.parametrize(
    ("given", "told"),
    [("no_such_program", "there is no program 'no_such_program'"), ("'", "No closing quotation")],
)
def test_a_command_that_is_none(model, given, told):
    done = run(model, "--run", given)
    assert done.exit_code == 2
    assert told in done.output


def test_no_mutation_is_no_campaign(model):
    done = run(model, "--limit", "0")
    assert done.exit_code == 2
    assert "--limit" in done.output


def test_a_model_with_errors_is_not_broken_further(model):
    model.write_text(MODEL.replace("linear.x ->", "linear.w ->"))
    done = run(model)
    assert done.exit_code == 1
    assert "nothing broken" in done.output


def test_a_model_without_anything_to_break(model):
    done = run(model, "--only", "table")
    assert done.exit_code == 2
    assert "nothing that these operators change" in done.output


def test_no_model(tmp_path):
    done = run(tmp_path / "nothing.xmi")
    assert done.exit_code == 2
    assert "No such file" in done.output


@pytest.mark.slow
def test_maps_alone_generate_nothing(tmp_path):
    path = tmp_path / "maps.ros2jaus"
    path.write_text(
        "import jaus.mobility\n"
        "speed {\n  JAUS ReportVelocityState\n  ROS geometry_msgs/Twist\n"
        "  JAUS->ROS ( Velocity_X -> linear.x )\n}\n"
    )
    done = run(path)
    assert done.exit_code == 2, done.output
    assert "system" in done.output
