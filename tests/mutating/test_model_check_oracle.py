"""Model checks of a broken model find what those of the sound one do not."""

from pathlib import Path

import pytest

from jausml.language.validation.engine import check_project
from jausml.mutating import oracles
from jausml.mutating.oracles import ModelCheckOracle

GUARDS = ("jausml/mutating/oracles.py",)

MODEL = Path(__file__).with_name("drive.ros2jaus").read_text()


@pytest.mark.slow
def test_commands_without_control_are_found(tmp_path):
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL)
    report = check_project([path])
    oracle = ModelCheckOracle(report.model)
    assert oracle.new_violation(report.model) == ""
    path.write_text(MODEL.replace("maxRate: 50", "maxRate: 50\n        control: false"))
    told = oracle.new_violation(check_project([path]).model)
    assert told.startswith("JML934 bridge.drive to vehicle: SetWrenchEffort stands at vehicle in ")


def test_what_the_sound_model_violates_too_is_not_new(tmp_path):
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL.replace("maxRate: 50", "maxRate: 50\n        control: false"))
    model = check_project([path]).model
    assert ModelCheckOracle(model).new_violation(model) == ""


def test_what_a_search_that_was_cut_off_has_not_found_is_not_new(tmp_path, monkeypatch):
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL.replace("maxRate: 50", "maxRate: 50\n        control: false"))
    model = check_project([path]).model
    oracle = ModelCheckOracle(model)
    with monkeypatch.context() as context:
        context.setattr(oracles, "_MODEL_CHECK_BUDGET", -1.0)
        assert oracle.new_violation(model) == ""
    assert oracle.new_violation(model) == ""
    cut_off = "bridge.drive to vehicle was cut off without a mutation: it notices nothing"
    assert any(cut_off in remark for remark in oracle.remarks)


def test_a_model_without_a_system_has_no_products(tmp_path):
    path = tmp_path / "maps.ros2jaus"
    path.write_text(
        "import jaus.mobility\n"
        "speed {\n  JAUS ReportVelocityState\n  ROS geometry_msgs/Twist\n"
        "  JAUS->ROS ( Velocity_X -> linear.x )\n}\n"
    )
    model = check_project([path]).model
    assert ModelCheckOracle(model).new_violation(model) == ""
