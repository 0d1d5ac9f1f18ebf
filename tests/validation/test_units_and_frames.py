"""Units and axes along assignments: what is right passes, what is wrong is found."""

import pytest

from jausml.language.validation.engine import check_project


def findings(folder, text):
    """Returns the rules that find something in a model, with their messages."""
    path = folder / "model.ros2jaus"
    path.write_text(text, encoding="utf-8")
    found = check_project([path]).diagnostics
    return [(finding.rule, finding.message) for finding in found if finding.rule != "JML711"]


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


@pytest.mark.parametrize("conversion", ["scale(1e308)", "scale(1e308), negate", "linear(1, 1e308)"])
def test_ranges_of_huge_numbers_do_not_stop_checking(conversion, tmp_path):
    text = f"""
    turn {{
      JAUS Turn ( uint16 angle {{ lower: -3.14159 upper: 3.14159 }} )
      ROS std_msgs/UInt8
      ROS->JAUS ( data -> angle : {conversion} )
    }}"""
    assert {rule for rule, _ in findings(tmp_path, text)} <= {"JML434", "JML435", "JML517"}


@pytest.mark.parametrize(
    ("jaus", "ros", "is_wrong"),
    [
        ("localUp", "localUp", True),
        ("localDown", "localDown", True),
        ("localDown", "localUp", False),
        ("localUp", "localDown", False),
    ],
)
def test_horizontal_axes_change_places_only_between_up_and_down(jaus, ros, is_wrong, tmp_path):
    text = f"""
    place {{
      JAUS Place ( float64 x {{ units: "m" frame: {jaus} }} )
      ROS place_msgs/Place ( float64 y {{ units: "m" frame: {ros} }} )
      JAUS->ROS ( x -> y )
    }}"""
    assert ("JML433" in {rule for rule, _ in findings(tmp_path, text)}) == is_wrong


@pytest.mark.parametrize(
    ("jaus", "ros", "there", "back", "is_wrong"),
    [
        ("uint8", "int8", "scale(0.1)", "scale(10)", True),
        ("uint8", "float32", "scale(0.1)", "scale(10)", False),
        ("float64", "float64", "scale(0.0174532925)", "scale(57.29577951)", True),
        ("float32", "float64", "scale(0.0174532925)", "scale(57.29577951)", False),
        ("float64", "float64", "scale(0.5)", "scale(2)", False),
        ("int32", "int16", "clamp(-9, 9)", "clamp(-9, 9)", False),
    ],
)
def test_round_trips_are_judged_by_what_their_ends_can_hold(
    jaus, ros, there, back, is_wrong, tmp_path
):
    text = f"""
    trip {{
      JAUS Trip ( {jaus} a )
      ROS trip_msgs/Trip ( {ros} a )
      JAUS->ROS ( a -> a : {there} )
      ROS->JAUS ( a -> a : {back} )
    }}"""
    assert ("JML437" in {rule for rule, _ in findings(tmp_path, text)}) == is_wrong


@pytest.mark.parametrize(
    ("targets", "conversion", "is_wrong"),
    [
        ("Roll, Pitch, Yaw", "enu_quaternion_to_ned_angles", False),
        ("Roll, Pitch, Yaw", "flu_quaternion_to_frd_angles", True),
        ("Pitch, Roll, Yaw", "enu_quaternion_to_ned_angles", True),
        ("Yaw", "enu_quaternion_to_ned_heading", False),
        ("Yaw", "enu_quaternion_to_ned_heading, negate", True),
        ("Yaw", "flu_quaternion_to_frd_yaw", True),
    ],
)
def test_wrong_axes_of_an_orientation_are_found(targets, conversion, is_wrong, tmp_path):
    text = f"""
    attitude {{
      JAUS ReportGlobalPose
      ROS sensor_msgs/Imu
      ROS->JAUS ( orientation -> {targets} : {conversion} )
    }}"""
    assert ("JML433" in {rule for rule, _ in findings(tmp_path, text)}) == is_wrong
