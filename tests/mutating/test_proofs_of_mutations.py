"""Proofs of a broken map find what those of the map do not."""

from __future__ import annotations

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.validation.engine import check_project
from jausml.mutating.outcomes import Proofs, _demanding_map

GUARDS = ("jausml/mutating/outcomes.py",)

MODEL = """\
import jaus.mobility

speed {
    JAUS GlobalWaypointDriver.ReportTravelSpeed
    ROS ackermann_msgs/AckermannDrive
    JAUS->ROS ( Speed -> speed )
    ROS->JAUS ( speed -> Speed )
}
"""


@pytest.mark.slow
@pytest.mark.needs("compiler")
@pytest.mark.timeout(120)
def test_a_factor_in_one_direction_is_found(tmp_path):
    path = tmp_path / "speed.ros2jaus"
    path.write_text(MODEL)
    report = check_project([path])
    [used] = report.model.instances(bridge.AttributeMap, library=False)
    path.write_text(MODEL.replace("-> speed )", "-> speed : scale(1.1) )"))
    proofs = Proofs(report)
    broken = check_project([path])
    assert proofs.noticed(broken, used.toRos[0]).startswith("JML922 ")
    assert Proofs(broken).noticed(broken, used.toRos[0]) == ""  # it was so before
    path.write_text(MODEL)
    assert proofs.noticed(check_project([path]), used.toRos[0]) == ""
    assert proofs.noticed(report, report.model.root) == ""


@pytest.mark.parametrize(
    ("assignment", "name"),
    [("speed -> Speed", ""), ("1.0 -> Speed", ""), ("speed -> Speed { precision: 0.1 }", "speed")],
)
def test_a_map_of_one_way_is_proved_if_it_has_a_precision(tmp_path, assignment, name):
    path = tmp_path / "speed.ros2jaus"
    path.write_text(
        f"""\
import jaus.mobility

speed {{
    JAUS GlobalWaypointDriver.ReportTravelSpeed
    ROS ackermann_msgs/AckermannDrive
    ROS->JAUS ( {assignment} )
}}
"""
    )
    [used] = check_project([path]).model.instances(bridge.AttributeMap, library=False)
    assert _demanding_map(used.toJaus[0]) == name
