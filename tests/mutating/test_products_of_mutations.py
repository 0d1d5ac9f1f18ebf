"""Product checks of a broken model find what those of the unbroken one do not."""

from __future__ import annotations

from pathlib import Path

import pytest

from jausml.language.validation.engine import check_project
from jausml.mutating.outcomes import Products

GUARDS = ("jausml/mutating/outcomes.py",)

MODEL = Path(__file__).with_name("drive.ros2jaus").read_text()


@pytest.mark.slow
def test_commands_without_control_are_found(tmp_path):
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL)
    report = check_project([path])
    products = Products(report.model)
    assert products.noticed(report.model) == ""
    path.write_text(MODEL.replace("maxRate: 50", "maxRate: 50\n        control: false"))
    told = products.noticed(check_project([path]).model)
    assert told.startswith("JML934 bridge.drive to vehicle: SetWrenchEffort stands at vehicle in ")


def test_what_the_unbroken_model_violates_too_is_not_noticed(tmp_path):
    path = tmp_path / "drive.ros2jaus"
    path.write_text(MODEL.replace("maxRate: 50", "maxRate: 50\n        control: false"))
    model = check_project([path]).model
    assert Products(model).noticed(model) == ""


def test_a_model_without_a_system_has_no_products(tmp_path):
    path = tmp_path / "maps.ros2jaus"
    path.write_text(
        "import jaus.mobility\n"
        "speed {\n  JAUS ReportVelocityState\n  ROS geometry_msgs/Twist\n"
        "  JAUS->ROS ( Velocity_X -> linear.x )\n}\n"
    )
    model = check_project([path]).model
    assert Products(model).noticed(model) == ""
