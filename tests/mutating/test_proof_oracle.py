"""Proofs of a broken map find what those of the map do not."""

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.validation.engine import check_project
from jausml.mutating.oracles import ProofOracle, _provable_map

GUARDS = ("jausml/mutating/oracles.py",)

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
def test_a_finding_of_the_sound_map_hides_none_of_another_field(tmp_path):
    path = tmp_path / "speed.ros2jaus"
    text = """\
velocity {
    JAUS SetVelocity (
        uint16 x { lower: 0  upper: 9 }
        uint16 yaw { lower: 0  upper: 9 }
    ) { code: 0xD301 }
    ROS geometry_msgs/Twist
    JAUS->ROS ( x -> linear.x : scale(1.1)  yaw -> angular.z )
    ROS->JAUS ( linear.x -> x  angular.z -> yaw )
}
"""
    path.write_text(text)
    report = check_project([path])
    [used] = report.model.instances(bridge.AttributeMap, library=False)
    path.write_text(text.replace("-> angular.z )", "-> angular.z : scale(1.2) )"))
    oracle = ProofOracle(report)
    broken = check_project([path])
    assert oracle.new_finding(broken, used.toRos[1]).startswith("JML922 velocity: JAUS yaw ")
    assert ProofOracle(broken).new_finding(broken, used.toRos[1]) == ""  # it was so before
    assert oracle.new_finding(report, report.model.root) == ""


def test_a_sound_map_without_a_proof_notices_nothing(tmp_path, monkeypatch):
    failing = tmp_path / "compiler"
    failing.write_text("#!/bin/sh\necho it is broken >&2\nexit 1\n")
    failing.chmod(0o755)
    monkeypatch.setenv("CXX", str(failing))
    path = tmp_path / "speed.ros2jaus"
    path.write_text(MODEL)
    report = check_project([path])
    [used] = report.model.instances(bridge.AttributeMap, library=False)
    oracle = ProofOracle(report)
    assert [oracle.new_finding(report, used.toRos[0]) for _ in range(2)] == ["", ""]
    assert oracle.remarks == ["speed cannot be proved without a mutation: it is broken"]


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
    assert _provable_map(used.toJaus[0]) == name
