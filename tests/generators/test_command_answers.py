"""Which commands a generated bridge tells by itself when somebody asks for them."""

from pathlib import Path

import pytest

from jausml.generation.rendering import render
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.bridge.target import TARGET

MODEL = """
import mappings.{maps}
component one {{ address: 2.1.1 external: true }}
component two {{ address: 2.1.2 external: true }}
bridge robot {{
    address: 1.1.1
    provides: {service}
    controlTimeout: 5
    connection drive {{ map: {map} direction: jausToRos {more} topic cmd }}
    {others}
}}
"""
REPORT = (
    "connection told { map: wrench_effort_report direction: rosToJaus exchange: query topic t }"
)
SECOND = "connection second { map: wrench_effort direction: jausToRos peers: two topic other }"
EFFORT = {"maps": "primitive_driver", "service": "PrimitiveDriver", "map": "wrench_effort"}
ANSWER = "answer=CommandAnswer(QueryWrenchEffort, ReportWrenchEffort, has_empty=True)"


def files_of(folder: Path, **values: str) -> dict[str, str]:
    """Returns the generated files of the bridge and its messages, by their names."""
    path = folder / "robot.ros2jaus"
    path.write_text(MODEL.format(**{"more": "", "others": "", **values}), encoding="utf-8")
    result = read_models([path], notations=NOTATIONS)
    assert not result.has_errors, result.diagnostics
    return {
        artifact.path.rpartition("/")[2]: artifact.text
        for artifact in render(result.model, [TARGET])
    }


def words(text: str) -> str:
    return " ".join(text.split()).replace("( ", "(").replace(" )", ")")


def test_the_last_effort_is_told(tmp_path):
    base = words(files_of(tmp_path, **EFFORT)["robot_base.py"])
    assert ANSWER in base


@pytest.mark.parametrize("others", [REPORT, SECOND])
def test_what_a_connection_tells_or_two_take_is_not(others, tmp_path):
    base = files_of(tmp_path, **EFFORT, more="peers: one", others=others)["robot_base.py"]
    assert "CommandAnswer" not in base


def test_the_kind_of_a_velocity_command_must_be_that_which_is_asked_for(tmp_path):
    base = files_of(
        tmp_path,
        maps="velocity_state_driver",
        service="VelocityStateDriver",
        map="velocity_command",
    )["robot_base.py"]
    answer = 'CommandAnswer(QueryVelocityCommand, ReportVelocityCommand, same=("command_type",))'
    assert answer in words(base)


def test_a_goal_is_told_too(tmp_path):
    base = files_of(
        tmp_path,
        maps="local_waypoint_driver",
        service="LocalWaypointDriver",
        map="local_waypoint",
        more='onSilence: hold holdReason: "a goal stands until the next one"',
    )["robot_base.py"]
    assert "CommandAnswer(QueryLocalWaypoint, ReportLocalWaypoint)" in words(base)
