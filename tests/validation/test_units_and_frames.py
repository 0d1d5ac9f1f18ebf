"""Units and axes along assignments: what is right passes, what is wrong is found."""

from __future__ import annotations

import pytest

from jausml.text.notation import NOTATIONS
from jausml.validation.engine import validate


def findings(folder, text):
    """Returns the rules that find something in a model, with their messages."""
    path = folder / "model.ros2jaus"
    path.write_text(text, encoding="utf-8")
    found = validate([path], notations=NOTATIONS).diagnostics
    return [(each.rule, each.message) for each in found if each.rule != "JML711"]


@pytest.mark.parametrize(
    ("sources", "conversion", "target", "message"),
    [
        (
            "r, p, p",
            "frd_angles_to_flu_quaternion",
            "orientation",
            "frd_angles_to_flu_quaternion takes radian, but gets degree",
        ),
        (
            "u, p, r",
            "frd_angles_to_flu_quaternion",
            "orientation",
            "frd_angles_to_flu_quaternion takes radian, but gets degree",
        ),
        (
            "r, p, p",
            "covariance_to_rms",
            "position.x",
            "covariance_to_rms takes one unit, but gets degree and radian",
        ),
    ],
)
def test_sources_of_different_units_are_no_sources_of_one_conversion(
    sources, conversion, target, message, tmp_path
):
    text = f"""
    turn {{
      JAUS Turn (
        float64 r {{ units: "degree" }}  float64 p {{ units: "radian" }}  float64 u
      )
      ROS geometry_msgs/Pose
      JAUS->ROS ( {sources} -> {target} : {conversion} )
    }}"""
    assert findings(tmp_path, text) == [("JML431", message)]
