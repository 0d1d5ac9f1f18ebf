"""Figure 5 of the paper as it stands: declarations, and members checked against what is known."""

import pytest

FIGURE_5 = """\
struct [
  float32 x
  float32 y
] Position
uint8 [4] Codes

WinchState {
  JAUS WinchStatus ( uint16 length  Position here  Codes codes )
  ROS WinchState ( uint16 length  Position here  Codes codes )
  JAUS->ROS ( length -> length  here.x -> here.x )
  ROS->JAUS ( length -> length  here.x -> here.x )
}
"""


def test_as_it_stands(texts):
    result = texts.one(FIGURE_5, "winch.ros2jaus")
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML711"]
    names = [(root.eClass.name, root.name) for root in result.model.roots]
    assert names == [
        ("MapLibrary", "winch"),
        ("ServiceSet", "winch"),
        ("InterfacePackage", "winch_interfaces"),
    ]
    [found] = result.model.root.maps
    assert (found.name, found.message.name, found.type.name) == (
        "WinchState", "WinchStatus", "WinchState",
    )  # fmt: skip
    assert found.message.code == "0xD000"
    kinds = [(field.name, field.eClass.name) for field in found.message.body.fields]
    assert kinds == [("length", "FixedField"), ("here", "Record"), ("codes", "Array")]
    ros = [(field.name, field.eClass.name) for field in found.type.fields]
    assert ros == [
        ("length", "PrimitiveField"),
        ("here", "MessageField"),
        ("codes", "PrimitiveField"),
    ]
    assert found.type.fields[1].messageType.name == "Position"


def test_rules_have_no_error(texts):
    assert set(texts.rules(FIGURE_5)) == {"JML711", "JML322", "JML416"}


def test_known_members_are_checked(texts):
    texts.good(
        """\
m {
  JAUS ReportVelocityState ( uint32 Velocity_X  `unsigned integer` Velocity_Y  uint32 TimeStamp )
  ROS nav_msgs/Odometry (
    std_msgs/Header header  string child_frame_id  TwistWithCovariance twist
    struct [ struct [ geometry_msgs/Point position ] pose  float64 [36] covariance ] pose
  )
}
"""
    )


JAUS = "m {{ JAUS {} ROS std_msgs/Float64 }}"
ROS = "m {{ JAUS ReportVelocityState ROS {} }}"
FAULTS = {
    "missing": (JAUS, "ReportVelocityState ( uint32 ⟦JML708⟧VelocityX )", "'Velocity_X'"),
    "type": (JAUS, "ReportVelocityState ( ⟦JML709⟧float32 Velocity_X )", "write uint32 Velocity_X"),
    "array": (JAUS, "ReportVelocityState ( ⟦JML709⟧uint32 [2] Velocity_X )", "write uint32"),
    "struct": (JAUS, "ReportVelocityState ( ⟦JML709⟧struct [ uint8 a ] Velocity_X )", "uint32"),
    "twice": (JAUS, "ReportVelocityState ( uint32 Velocity_X uint32 ⟦JML707⟧Velocity_X )", ""),
    "facts": (JAUS, "ReportVelocityState { ⟦JML713⟧code: 0xD001 }", "remove"),
    "member_facts": (JAUS, "ReportVelocityState ( uint32 Velocity_X { ⟦JML713⟧units: m } )", ""),
    "ros_missing": (ROS, "std_msgs/Header ( string ⟦JML708⟧frame )", "frame_id"),
    "ros_type": (ROS, "std_msgs/Float64 ( ⟦JML709⟧float32 data )", "write float64 data"),
    "ros_message": (ROS, "nav_msgs/Odometry ( ⟦JML709⟧geometry_msgs/Pose pose )", "WithCovariance"),
    "ros_size": (ROS, "PoseWithCovariance ( ⟦JML709⟧float64 [35] covariance )", "[36]"),
    "ros_sequence": (ROS, "PoseWithCovariance ( ⟦JML709⟧float64 [] covariance )", "[36]"),
    "ros_inner": (ROS, "std_msgs/Header ( struct [ ⟦JML709⟧int64 sec ] stamp )", "write int32"),
    "typing_error": (ROS, "⟦JML215⟧std_msgs/Floaat64 ( float64 data )", "'Float64'"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_member_fault(name, texts):
    frame, end, hint = FAULTS[name]
    findings = texts.check(frame.format(end)).diagnostics
    assert any(hint in finding.hint for finding in findings), findings
