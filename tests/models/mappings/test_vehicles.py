"""Ready maps of two sides, steering, brakes, health and pictures, by what the figures mean."""

import importlib
from types import SimpleNamespace
from typing import Any

import pytest
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float32, Float64, Float64MultiArray

GUARDS = ("models/library/mappings",)


def near(*values: float, tolerance: float = 1e-3) -> object:
    return pytest.approx(list(values), abs=tolerance)


def error(name: str) -> type[Exception]:
    module = importlib.import_module("jausml_runtime.bridge.messages.limits")
    found: type[Exception] = getattr(module, name)
    return found


# ------------------------------------------------------------------ two sides


@pytest.mark.parametrize("name", ["skid_steer_wheels", "skid_steer_wheels_report"])
def test_left_is_left(translator, name):
    maps = translator("skid_steer_driver")
    made = maps.to_jaus(name, Float64MultiArray(data=[5.0, -2.5, 9.0]))
    assert [made.left_side_propulsive_effort, made.right_side_propulsive_effort] == near(
        50, -25, tolerance=0.002
    )
    assert list(maps.to_ros(name, made).data) == near(5.0, -2.5)
    with pytest.raises(error("AbsentFieldError"), match=r"data\[1\]"):
        maps.to_jaus(name, Float64MultiArray(data=[5.0]))


@pytest.mark.parametrize(
    ("left", "right", "speed", "turn"),
    [
        (100, 100, 2, 0),  # ahead
        (-50, -50, -1, 0),  # back
        (-100, 100, 0, 1),  # on the spot, to the left
        (60, 20, 0.8, -0.2),  # a bend to the right
        (0, 0, 0, 0),
    ],
)
def test_sides_make_a_twist(translator, left, right, speed, turn):
    maps = translator("skid_steer_driver")
    command = maps.messages.SetSkidSteerEffort()
    command.left_side_propulsive_effort = float(left)
    command.right_side_propulsive_effort = float(right)
    twist = maps.to_ros("skid_steer_effort", command)
    assert [twist.linear.x, twist.angular.z] == near(speed, turn)
    if not (left or right):
        assert (twist.linear.x, twist.angular.z) == (0, 0)


# ------------------------------------------------------------------ steering and brakes


def ackermann(angle: float, speed: float, rate: float = 0.0) -> Any:
    drive = SimpleNamespace(steering_angle=angle, steering_angle_velocity=rate)
    drive.speed, drive.acceleration, drive.jerk = speed, 0.0, 0.0
    return SimpleNamespace(header=SimpleNamespace(), drive=drive)


@pytest.mark.parametrize("name", ["ackermann_drive", "ackermann_drive_report"])
def test_steering_to_the_left(translator, name):
    maps = translator("ackermann_driver")
    made = maps.to_jaus(name, ackermann(0.5, 1.0))
    assert [made.steering_angle, made.throttle_effort, made.brake_effort] == near(-0.5, 50, 0)
    made.brake_effort = 40.0
    back = maps.to_ros(name, made)
    assert back.header.frame_id == "base_link"
    assert [back.drive.steering_angle, back.drive.speed] == near(0.5, 0.6)


def test_no_throttle_goes_back(translator):
    with pytest.raises(error("OutOfRangeError"), match="ThrottleEffort"):
        translator("ackermann_driver").to_jaus("ackermann_drive", ackermann(0.5, -1.0))


def test_a_steering_rate_is_a_limit(translator):
    maps = translator("ackermann_driver")
    made = maps.to_jaus("ackermann_drive", ackermann(0.0, 1.0, 0.25))
    assert made.max_steering_rate == pytest.approx(0.25, abs=1e-3)
    assert maps.to_ros("ackermann_drive", made).drive.steering_angle_velocity == pytest.approx(
        0.25, abs=1e-3
    )
    with pytest.raises(error("OutOfRangeError"), match="MaxSteeringRate"):
        maps.to_jaus("ackermann_drive", ackermann(0.0, 1.0, -1.0))


def test_a_steering_rate_of_zero_is_none_in_ros_and_a_limit_in_jaus(translator):
    maps = translator("ackermann_driver")
    made = maps.to_jaus("ackermann_drive", ackermann(-0.3, 1.0))
    assert made.max_steering_rate is None
    made.max_steering_rate = 0.0
    with pytest.raises(error("OutOfRangeError"), match="nothing limits it"):
        maps.to_ros("ackermann_drive", made)


def test_a_parking_brake(translator):
    maps = translator("parking_brake")
    made = maps.to_jaus("parking_brake", Float32(data=60.0))
    assert maps.to_ros("parking_brake", made).data == pytest.approx(60, abs=0.2)
    report = maps.messages.ReportParkingBrake()
    report.commanded_parking_brake, report.actual_parking_brake = 100.0, 20.0
    assert maps.to_ros("parking_brake_report", report).data == pytest.approx(20, abs=0.2)


def test_metres_of_a_life(translator):
    maps = translator("odometer")
    report = maps.to_jaus("odometer", Float64(data=119_999.75))
    assert (int(report.odom), report.odometry) == (1, 120_000)
    assert maps.to_ros("odometer", report).data == 120_000


# ------------------------------------------------------------------ health


@pytest.mark.parametrize(
    ("level", "severity"), [(0, 0), (1, 2), (2, 3), (3, 3)], ids=["ok", "warn", "error", "stale"]
)
def test_health_of_ros(translator, level, severity):
    maps = translator("health_monitor")
    report = maps.to_jaus("health", SimpleNamespace(level=level, name="", message=""))
    assert int(report.ugv_severity_rec.severity) == severity
    assert report.severity_list == []


@pytest.mark.parametrize(
    ("severity", "level", "words"),
    [
        (0, 0, "no fault"),
        (1, 0, "information"),
        (2, 1, "warning"),
        (3, 2, "error"),
        (4, 2, "failure"),
    ],
)
def test_health_of_jaus(translator, severity, level, words):
    maps = translator("health_monitor")
    report = maps.messages.ReportUGVSummary()
    report.ugv_severity_rec.severity = severity
    status = maps.to_ros("health", report)
    assert (status.level, status.name, status.message) == (level, "vehicle", words)


# ------------------------------------------------------------------ pictures

PICTURE = b"\xff\xd8\xff\xe0" + bytes(range(256)) * 40 + b"\xff\xd9"


def test_a_picture_byte_by_byte(translator):
    maps = translator("still_image")
    image = CompressedImage(format="rgb8; jpeg compressed bgr8", data=PICTURE)
    image.header.stamp.sec = 1_700_000_000
    report = maps.to_jaus("still_image", image)
    (frame,) = report.still_image_data_list
    assert (frame.sensor_id, int(frame.image_frame.format_index)) == (1, 0)
    assert frame.image_frame.data == PICTURE
    maps.bridge.now = lambda: importlib.import_module("jausml_runtime.conversions").Time(
        1_700_000_100, 0
    )
    back = maps.to_ros("still_image", report)
    assert (back.header.stamp.sec, back.header.frame_id) == (1_700_000_000, "camera")
    assert back.format == "jpeg"
    assert bytes(back.data) == PICTURE


def test_another_format_is_not_taken_for_jpeg(translator):
    maps = translator("still_image")
    report = maps.to_jaus("still_image", CompressedImage(format="jpeg", data=PICTURE))
    (frame,) = report.still_image_data_list
    frame.image_frame.format_index = 2
    with pytest.raises(error("AbsentFieldError"), match=r"ImageFrame\.JPEG"):
        maps.to_ros("still_image", report)
