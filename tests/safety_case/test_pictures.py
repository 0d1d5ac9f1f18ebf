"""Pictures of safety cases."""

from dataclasses import replace
from pathlib import Path

from jausml.language.validation.engine import check_project
from jausml.safety_case.answers import Answer
from jausml.safety_case.argument import safety_case
from jausml.safety_case.pictures import pictures

GUARDS = ("jausml/safety_case",)

MOWER = Path(__file__).with_name("mower.ros2jaus")


def test_each_reason_of_a_goal_is_in_its_picture():
    case = safety_case(check_project([str(MOWER)], is_one=True), (), ())
    hazard = case.hazards[0]
    reasons = tuple(Answer("it stays", reason=reason) for reason in ("uphill", "anchored"))
    goal = replace(hazard.goals[0], answers=reasons)
    drawn = pictures(replace(case, hazards=(replace(hazard, goals=(goal,)),)))
    assert "uphill" in drawn["case-link"]
    assert "anchored" in drawn["case-link"]
