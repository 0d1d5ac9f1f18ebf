"""Mapping defects of a bridge in the field, one model each: checking finds them before they run.

The rows are those of the comparison of JAUS and ROS semantics; the maps say what that bridge does.
"""

import pytest

from jausml.language.model import read_models
from jausml.language.semantics.assignments.units import unit_step
from jausml.language.validation.engine import check_project

JAUS = "http://www.jausml.org/library/jaus/"
ROS = "http://www.jausml.org/library/ros/"
MOBILITY = f"{JAUS}mobility.xmi#"


def library(*maps):
    return (
        '<bridge:MapLibrary xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xmlns:bridge="http://www.jausml.org/bridge/1.0" name="field">'
        f"{''.join(maps)}</bridge:MapLibrary>"
    )


STAMPED = ("sensor_msgs.xmi#Imu", "nav_msgs.xmi#Odometry")


def attribute_map(message, type_, *assignments):
    header = '<toRos xsi:type="bridge:Ignore" target="header"/>' if type_ in STAMPED else ""
    return (
        f'<maps name="map"><message href="{message}"/><type href="{ROS}{type_}"/>'
        f"{header}{''.join(assignments)}</maps>"
    )


def field(feature, target, source, *conversions, **features):
    attributes = "".join(f' {name}="{value}"' for name, value in features.items())
    steps = "".join(conversions)
    return (
        f'<{feature} xsi:type="bridge:FieldAssignment" target="{target}" source="{source}"'
        f"{attributes}>{steps}</{feature}>"
    )


def to_ros(target, source, *conversions, **features):
    absent = {} if "whenAbsent" in features else {"whenAbsent": "leave"}
    return field("toRos", target, source, *conversions, **features, **absent)


def to_jaus(target, source, *conversions, **features):
    return field("toJaus", target, source, *conversions, **features)


def conversion(kind, *arguments, **features):
    attributes = "".join(f' {name}="{value}"' for name, value in features.items())
    numbers = "".join(f"<arguments>{argument}</arguments>" for argument in arguments)
    return f'<conversions kind="{kind}"{attributes}>{numbers}</conversions>'


EFFORT = f"{MOBILITY}PrimitiveDriver.SetWrenchEffort"
GLOBAL_POSE = f"{MOBILITY}GlobalPoseSensor.ReportGlobalPose"
LOCAL_POSE = f"{MOBILITY}LocalPoseSensor.ReportLocalPose"
VELOCITY = f"{MOBILITY}VelocityStateSensor.ReportVelocityState"
TWIST, ODOMETRY = "geometry_msgs.xmi#Twist", "nav_msgs.xmi#Odometry"
IMU = "sensor_msgs.xmi#Imu"
GRID = f"{JAUS}iop.xmi#CostMap2D.ReportCostMap2D"

DEFECTS = {
    "row 1: the yaw of an effort keeps its sign": (
        attribute_map(
            EFFORT,
            TWIST,
            to_ros("angular.z", "PropulsiveRotationalEffortZ", conversion("percent_to_value", 1.5)),
        ),
        ("JML433", "add the conversion negate"),
    ),
    "row 2: all axes of a command but yaw keep their signs": (
        attribute_map(
            EFFORT,
            TWIST,
            to_jaus("PropulsiveLinearEffortY", "linear.y", conversion("value_to_percent", 3.5)),
        ),
        ("JML433", "have opposite signs"),
    ),
    "row 3: the angles of an IMU go raw into a global pose": (
        attribute_map(
            GLOBAL_POSE,
            IMU,
            to_jaus("Roll, Pitch, Yaw", "orientation", conversion("flu_quaternion_to_frd_angles")),
        ),
        ("JML433", "use enu_quaternion_to_ned_angles"),
    ),
    "row 4: a global pose goes raw into the orientation of an IMU": (
        attribute_map(
            GLOBAL_POSE,
            IMU,
            to_ros("orientation", "Roll, Pitch, Yaw", conversion("frd_angles_to_flu_quaternion")),
        ),
        ("JML433", "use ned_angles_to_enu_quaternion"),
    ),
    "row 5: a local position keeps the sign of y": (
        attribute_map(LOCAL_POSE, ODOMETRY, to_jaus("Y", "pose.pose.position.y")),
        ("JML433", "add the conversion negate"),
    ),
    "row 7: velocities keep the sign of y": (
        attribute_map(VELOCITY, ODOMETRY, to_jaus("Velocity_Y", "twist.twist.linear.y")),
        ("JML433", "add the conversion negate"),
    ),
    "row 8: roll and pitch change places": (
        attribute_map(VELOCITY, ODOMETRY, to_ros("twist.twist.angular.x", "PitchRate")),
        ("JML433", "are different directions"),
    ),
    "row 8: roll and pitch change places on the way back, axes unknown": (
        attribute_map(
            VELOCITY,
            "geometry_msgs.xmi#Quaternion",
            to_ros("x", "RollRate", conversion("scale", 1)),
            to_jaus("PitchRate", "x", conversion("scale", 1)),
        ),
        ("JML437", "becomes PitchRate, but it was made from RollRate"),
    ),
    "row 12: a path is of two variants at once": (
        attribute_map(
            f"{JAUS}iop.xmi#PathReporter.ReportPath",
            "nav_msgs.xmi#Path",
            *(
                f'<toJaus xsi:type="bridge:ListAssignment" target="PathVar.{name}" source="poses">'
                '<assignments xsi:type="bridge:Ignore" target="."/></toJaus>'
                for name in ("PlannedLocalPath", "PlannedGlobalPath")
            ),
        ),
        ("JML415", "selects"),
    ),
    "row 13: an unknown cell of a grid costs -2": (
        attribute_map(
            GRID,
            "nav_msgs.xmi#OccupancyGrid",
            '<toJaus xsi:type="bridge:ListAssignment" target="CostMap2DDataVar.CostDataList"'
            ' source="data">',
            field("assignments", "Cost", ".", conversion("scale", 2)),
            "</toJaus>",
        ),
        ("JML434", "may give -2..200, but 'Cost' carries 0..255"),
    ),
    "row 24: seconds since 1970 go into the day of a month": (
        attribute_map(LOCAL_POSE, ODOMETRY, to_jaus("TimeStamp.Day", "header.stamp.sec")),
        ("JML434", "but 'TimeStamp.Day' carries 1..31"),
    ),
    "row 24: a stamp goes raw into a TimeStamp": (
        attribute_map(LOCAL_POSE, ODOMETRY, to_jaus("TimeStamp", "header.stamp")),
        ("JML412", "convert it by time_to_timestamp"),
    ),
}


BESIDE = {"JML416", "JML459"}
"""Rules that find more in the same maps: what is left out, and what becomes of absent values."""


@pytest.mark.parametrize("name", DEFECTS)
def test_defect_is_found(name, tmp_path):
    found, (rule, words) = DEFECTS[name]
    path = tmp_path / "model.xmi"
    path.write_text(library(found), encoding="utf-8")
    findings = [
        diagnostic
        for diagnostic in check_project([path]).diagnostics
        if diagnostic.rule not in BESIDE
    ]
    assert [finding.rule for finding in findings] == [rule], [
        finding.message for finding in findings
    ]
    assert words in f"{findings[0].message} ({findings[0].hint})"


def test_the_right_maps_are_clean(tmp_path):
    right = library(
        attribute_map(
            VELOCITY,
            ODOMETRY,
            to_ros("twist.twist.linear.y", "Velocity_Y", conversion("negate")),
            to_ros("twist.twist.angular.x", "RollRate"),
            to_ros("twist.twist.angular.y", "PitchRate", conversion("negate")),
            to_jaus("RollRate", "twist.twist.angular.x"),
            to_jaus("PitchRate", "twist.twist.angular.y", conversion("negate")),
        ),
        attribute_map(
            GLOBAL_POSE,
            IMU,
            to_ros("orientation", "Roll, Pitch, Yaw", conversion("ned_angles_to_enu_quaternion")),
            to_jaus("Roll, Pitch, Yaw", "orientation", conversion("enu_quaternion_to_ned_angles")),
        ),
    )
    path = tmp_path / "model.xmi"
    path.write_text(right, encoding="utf-8")
    assert [diagnostic.message for diagnostic in check_project([path]).diagnostics] == []


def test_a_ratio_becomes_percent_by_itself(tmp_path):
    path = tmp_path / "model.xmi"
    copied = attribute_map(
        EFFORT, "sensor_msgs.xmi#BatteryState", to_jaus("ResistiveLinearEffortX", "percentage")
    )
    path.write_text(library(copied), encoding="utf-8")
    result = read_models([path])
    (found,) = result.model.documents[0].roots[0].maps
    assert unit_step(found, found.toJaus[0], to_ros=False) == (pytest.approx(100.0), 0.0)
    assert check_project([path]).diagnostics == ()
