"""Which commands a generated bridge tells by itself when somebody asks for them."""

from pathlib import Path

import pytest
from generated import model_in, text_of

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


def base_of(folder: Path, **values: str) -> str:
    """Returns the words of the base of the bridge."""
    text = MODEL.format(**{"more": "", "others": "", **values})
    base = text_of(model_in(folder, text), [TARGET])
    return " ".join(base.split()).replace("( ", "(").replace(" )", ")")


def test_the_last_effort_is_told(tmp_path):
    assert ANSWER in base_of(tmp_path, **EFFORT)


@pytest.mark.parametrize("others", [REPORT, SECOND])
def test_what_a_connection_tells_or_two_take_is_not(others, tmp_path):
    assert "CommandAnswer" not in base_of(tmp_path, **EFFORT, more="peers: one", others=others)


def test_the_kind_of_a_velocity_command_must_be_that_which_is_asked_for(tmp_path):
    base = base_of(
        tmp_path,
        maps="velocity_state_driver",
        service="VelocityStateDriver",
        map="velocity_command",
    )
    answer = 'CommandAnswer(QueryVelocityCommand, ReportVelocityCommand, same=("command_type",))'
    assert answer in base


def test_a_goal_is_told_too(tmp_path):
    base = base_of(
        tmp_path,
        maps="local_waypoint_driver",
        service="LocalWaypointDriver",
        map="local_waypoint",
        more='onSilence: hold holdReason: "a goal stands until the next one"',
    )
    assert "CommandAnswer(QueryLocalWaypoint, ReportLocalWaypoint)" in base
