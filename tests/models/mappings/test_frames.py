"""Ready maps, by what the figures mean: where the nose points, and which side is down.

The expected figures come from trigonometry here, not from the conversions of the runtime.
"""

import math
from itertools import product

import pytest
from for_each import for_each
from geometry_msgs.msg import (
    AccelWithCovarianceStamped,
    PoseStamped,
    Quaternion,
    Twist,
    TwistStamped,
)
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import Imu, NavSatFix, NavSatStatus

GUARDS = ("models/library/mappings",)

HALF = math.sqrt(0.5)
ATTITUDES = list(product((-0.5, 0.0, 1.0), (-1.2, 0.0, 0.4), (-2.5, 0.0, 0.7, 3.0)))


def near(value: float, tolerance: float = 1e-3) -> object:
    return pytest.approx(value, abs=tolerance)


def turned(orientation: Quaternion, vector: tuple[float, float, float]) -> tuple[float, ...]:
    """Turns a vector by the rotation matrix of a unit quaternion."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return tuple(sum(a * b for a, b in zip(row, vector, strict=True)) for row in rows)


def about(axis: str, angle: float) -> Quaternion:
    """The rotation about one axis."""
    parts = {axis: math.sin(angle / 2), "w": math.cos(angle / 2)}
    return Quaternion(**{"x": 0.0, "y": 0.0, "z": 0.0, **parts})


def nose(pitch: float, heading: float) -> tuple[float, float, float]:
    """Where the nose of a vehicle points: ahead or north, right or east, up."""
    return (
        math.cos(pitch) * math.cos(heading),
        math.cos(pitch) * math.sin(heading),
        math.sin(pitch),
    )


def height_of_the_left_side(roll: float, pitch: float) -> float:
    """How much the left side is above the middle, for each metre to the left."""
    return math.sin(roll) * math.cos(pitch)


# ------------------------------------------------------------------ attitudes


@for_each(("roll", "pitch", "heading"), ATTITUDES)
def test_attitude_on_the_earth(translator, roll, pitch, heading):
    maps = translator("global_pose_sensor")
    source = maps.messages.ReportGlobalPose(roll=roll, pitch=pitch, yaw=heading)
    imu = maps.to_ros("global_attitude", source)
    north, east, up = nose(pitch, heading)
    assert turned(imu.orientation, (1, 0, 0)) == pytest.approx((east, north, up), abs=1e-3)
    left = turned(imu.orientation, (0, 1, 0))
    assert left[2] == near(height_of_the_left_side(roll, pitch))
    fix = NavSatFix(latitude=48.5, longitude=-11.25, altitude=519.75)
    back = maps.to_jaus("global_pose", fix, imu=imu)
    assert (back.roll, back.pitch, back.yaw) == pytest.approx((roll, pitch, heading), abs=1e-3)


@pytest.mark.parametrize("from_vertical", [0.0, 1e-9, 1e-7, 1e-5])
@pytest.mark.parametrize("up", [1.0, -1.0])
def test_nearly_straight_up_and_down_on_the_earth(translator, up, from_vertical):
    maps = translator("global_pose_sensor")
    half_pitch, half_yaw = -up * (math.pi / 2 - from_vertical) / 2, 0.6
    sp, cp, sy, cy = (f(angle) for angle in (half_pitch, half_yaw) for f in (math.sin, math.cos))
    orientation = Quaternion(x=-sp * sy, y=sp * cy, z=cp * sy, w=cp * cy)
    report = maps.to_jaus("global_pose", NavSatFix(), imu=Imu(orientation=orientation))
    source = maps.messages.ReportGlobalPose(roll=report.roll, pitch=report.pitch, yaw=report.yaw)
    again = maps.to_ros("global_attitude", source).orientation
    for axis in ((1, 0, 0), (0, 1, 0)):
        assert turned(again, axis) == pytest.approx(turned(orientation, axis), abs=1e-3)


@for_each(("roll", "pitch", "yaw"), ATTITUDES)
def test_attitude_in_odom(translator, roll, pitch, yaw):
    maps = translator("local_pose_sensor")
    source = maps.messages.ReportLocalPose(x=0.0, y=0.0, z=0.0, roll=roll, pitch=pitch, yaw=yaw)
    for name in ("local_pose", "local_pose_stamped"):
        target = maps.to_ros(name, source)
        pose = target.pose.pose if name == "local_pose" else target.pose
        ahead, right, up = nose(pitch, yaw)
        assert turned(pose.orientation, (1, 0, 0)) == pytest.approx((ahead, -right, up), abs=1e-3)
        left = turned(pose.orientation, (0, 1, 0))
        assert left[2] == near(height_of_the_left_side(roll, pitch))
        back = maps.to_jaus(name, target)
        assert (back.roll, back.pitch, back.yaw) == pytest.approx((roll, pitch, yaw), abs=1e-3)


@for_each(("roll", "pitch", "yaw"), ATTITUDES)
def test_odometry_has_the_pose_in_odom_and_the_twist_in_the_axes_of_the_vehicle(
    translator, roll, pitch, yaw
):
    """The pose turns nothing of the twist, which REP 105 has in the child frame, as JAUS has."""
    maps = translator("odometry")
    pose = maps.messages.ReportLocalPose(x=5.0, y=2.0, z=-1.0, roll=roll, pitch=pitch, yaw=yaw)
    velocity = maps.messages.ReportVelocityState(
        velocity_x=3.0, velocity_y=1.0, velocity_z=-0.5, roll_rate=0.1, pitch_rate=0.2, yaw_rate=0.3
    )
    made = maps.to_ros("odometry", pose, velocity=velocity)
    assert (made.header.frame_id, made.child_frame_id) == ("odom", "base_link")
    where = made.pose.pose.position
    assert (where.x, where.y, where.z) == pytest.approx((5.0, -2.0, 1.0), abs=1e-4)
    ahead, right, up = nose(pitch, yaw)
    assert turned(made.pose.pose.orientation, (1, 0, 0)) == pytest.approx(
        (ahead, -right, up), abs=1e-3
    )
    linear, angular = made.twist.twist.linear, made.twist.twist.angular
    assert (linear.x, linear.y, linear.z) == pytest.approx((3.0, -1.0, 0.5), abs=1e-4)
    assert (angular.x, angular.y, angular.z) == pytest.approx((0.1, -0.2, -0.3), abs=1e-3)


def test_a_vehicle_that_turns_left_while_it_drives_a_left_circle(translator):
    """A quarter of the circle of radius 10 m to the left, as JAUS (x ahead, y right) has it."""
    maps = translator("odometry")
    quarter = math.pi / 2
    pose = maps.messages.ReportLocalPose(x=10.0, y=-10.0, yaw=-quarter)
    velocity = maps.messages.ReportVelocityState(velocity_x=2.0, yaw_rate=-0.2)
    made = maps.to_ros("odometry", pose, velocity=velocity)
    assert (made.pose.pose.position.x, made.pose.pose.position.y) == pytest.approx(
        (10.0, 10.0), abs=1e-3
    )
    assert turned(made.pose.pose.orientation, (1, 0, 0)) == pytest.approx((0, 1, 0), abs=1e-3)
    assert made.twist.twist.linear.x == near(2.0)
    assert made.twist.twist.angular.z == near(0.2)  # to the left is positive in ROS (REP 103)


def test_the_headings_of_the_compass(translator):
    """REP 103: yaw 0 is east and grows to the left; JAUS headings grow to the right from north."""
    maps = translator("global_pose_sensor")
    compass = {"north": (90, 0), "east": (0, 90), "south-east": (-45, 135), "west": (180, -90)}
    for name, (yaw, heading) in compass.items():
        imu = Imu(orientation=about("z", math.radians(yaw)))
        report = maps.to_jaus("global_pose", NavSatFix(), imu=imu)
        assert math.degrees(report.yaw) == near(heading, 0.01), name
        assert (report.roll, report.pitch) == (near(0.0), near(0.0))


def test_a_raised_nose_and_a_lowered_right_side(translator):
    """In ROS both are turns about y (left) and x: a raised nose is a negative one."""
    maps = translator("local_pose_sensor")
    raised = Odometry()
    raised.pose.pose.orientation = about("y", -0.3)
    assert maps.to_jaus("local_pose", raised).pitch == near(0.3)
    lowered = Odometry()
    lowered.pose.pose.orientation = about("x", 0.2)
    assert maps.to_jaus("local_pose", lowered).roll == near(0.2)


def test_an_enu_pose_of_a_vehicle_east_of_the_origin(translator):
    maps = translator("local_pose_sensor")
    source = Odometry()
    source.pose.pose.position.x, source.pose.pose.position.y = 100.0, 7.0
    source.pose.pose.position.z = 2.0
    source.pose.pose.orientation = about("z", math.pi / 2)
    report = maps.to_jaus("local_pose_enu", source)
    assert (report.x, report.y, report.z) == (near(7.0), near(100.0), near(-2.0))
    assert report.yaw == near(0.0)
    back = maps.to_ros("local_pose_enu", report)
    assert (back.pose.pose.position.x, back.pose.pose.position.y) == (near(100.0), near(7.0))
    assert turned(back.pose.pose.orientation, (1, 0, 0)) == pytest.approx((0, 1, 0), abs=1e-3)


# ------------------------------------------------------------------ motion


def test_velocities_to_the_left_are_negative_in_jaus(translator):
    maps = translator("velocity_state_sensor")
    source = Odometry()
    twist = source.twist.twist
    twist.linear.x, twist.linear.y, twist.linear.z = 1.0, 2.0, 3.0
    twist.angular.x, twist.angular.y, twist.angular.z = 0.1, 0.2, 0.3
    report = maps.to_jaus("velocity_state", source)
    assert (report.velocity_x, report.velocity_y) == (near(1.0), near(-2.0))
    assert report.velocity_z == near(-3.0)
    rates = (report.roll_rate, report.pitch_rate, report.yaw_rate)
    assert rates == (near(0.1), near(-0.2), near(-0.3))
    back = maps.to_ros("velocity_state_twist", report)
    assert back.twist.linear.y == near(2.0)
    assert (back.twist.angular.x, back.twist.angular.y) == (near(0.1), near(0.2))


def test_axes_without_motion_are_zero_and_nothing_else(translator):
    maps = translator("velocity_state_sensor")
    report = maps.messages.ReportVelocityState(velocity_x=1.0, yaw_rate=0.0)
    target = maps.to_ros("velocity_state", report)
    twist = target.twist.twist
    assert (twist.linear.y, twist.linear.z) == (0.0, 0.0)
    assert (twist.angular.x, twist.angular.y, twist.angular.z) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("velocity_state_driver", "velocity_command"),
        ("velocity_state_driver", "velocity_command_stamped"),
    ],
)
def test_a_velocity_command_to_the_right(translator, stem, name):
    maps = translator(stem)
    command = maps.messages.SetVelocityCommand(velocity_x=2.0, yaw_rate=0.5)
    target = maps.to_ros(name, command)
    twist = getattr(target, "twist", target)
    assert (twist.linear.x, twist.angular.z) == (near(2.0), near(-0.5))
    back = maps.to_jaus(name, target)
    assert (back.velocity_x, back.yaw_rate) == (near(2.0), near(0.5))
    assert int(back.command_type) == 0


def test_efforts_and_brakes(translator):
    """The defaults of the map: 100 percent are 2 m/s and 1 rad/s."""
    maps = translator("primitive_driver")
    wrench = maps.messages.SetWrenchEffort
    ahead = maps.to_ros("wrench_effort", wrench(propulsive_linear_effort_x=75.0))
    assert ahead.linear.x == near(1.5)
    braked = maps.to_ros(
        "wrench_effort", wrench(propulsive_linear_effort_x=75.0, resistive_linear_effort_x=20.0)
    )
    assert braked.linear.x == near(1.2)
    right = maps.to_ros("wrench_effort", wrench(propulsive_rotational_effort_z=50.0))
    assert (right.linear.x, right.angular.z) == (0.0, near(-0.5))
    nothing = maps.to_ros("wrench_effort", wrench(propulsive_linear_effort_x=0.0))
    assert nothing.linear.x == 0.0
    command = Twist()
    command.linear.x, command.angular.z = 1.0, 0.25
    back = maps.to_jaus("wrench_effort", command)
    assert back.propulsive_linear_effort_x == near(50.0, 0.01)
    assert back.propulsive_rotational_effort_z == near(-25.0, 0.01)
    assert back.resistive_linear_effort_x is None


def test_accelerations(translator):
    maps = translator("acceleration_state_sensor")
    source = AccelWithCovarianceStamped()
    source.accel.accel.linear.x, source.accel.accel.linear.y = -2.0, 1.5
    source.accel.accel.angular.z = 0.25
    report = maps.to_jaus("acceleration_state", source)
    assert (report.acceleration_x, report.acceleration_y) == (near(-2.0), near(-1.5))
    assert report.yaw_acceleration == near(-0.25, 0.01)


@pytest.mark.parametrize(
    ("heading", "east", "north"), [(0.0, 0.0, 3.0), (90.0, 3.0, 0.0), (-135.0, -2.1213, -2.1213)]
)
def test_global_vectors(translator, heading, east, north):
    maps = translator("global_vector_driver")
    command = maps.messages.SetGlobalVector(speed=3.0, heading=math.radians(heading))
    target = maps.to_ros("global_vector", command)
    assert (target.twist.linear.x, target.twist.linear.y) == (near(east, 0.01), near(north, 0.01))
    back = maps.to_jaus("global_vector", target)
    assert back.speed == near(3.0, 0.01)
    assert math.degrees(back.heading) == near(heading, 0.02)


def test_local_vectors_to_the_right(translator):
    maps = translator("local_vector_driver")
    command = maps.messages.SetLocalVector(speed=3.0, heading=math.pi / 2)
    target = maps.to_ros("local_vector", command)
    assert (target.twist.linear.x, target.twist.linear.y) == (near(0.0, 0.01), near(-3.0, 0.01))
    back = TwistStamped()
    back.twist.linear.y = 3.0
    assert maps.to_jaus("local_vector", back).heading == near(-math.pi / 2)


# ------------------------------------------------------------------ positions


def test_a_fix_becomes_a_position_without_an_attitude(translator):
    maps = translator("global_pose_sensor")
    fix = NavSatFix(latitude=-33.25, longitude=151.5, altitude=12.5)
    fix.position_covariance = [1.0, 0, 0, 0, 1.0, 0, 0, 0, 10.0]
    fix.position_covariance_type = NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN
    fix.status.status = NavSatStatus.STATUS_FIX
    report = maps.to_jaus("global_pose", fix)
    assert report.latitude == near(-33.25, 1e-7)
    assert report.longitude == near(151.5, 1e-7)
    assert report.altitude == near(12.5, 1e-4)
    assert report.position_rms == near(2.0, 1e-6)
    assert (report.roll, report.pitch, report.yaw) == (None, None, None)


def test_unknown_is_absent(translator):
    maps = translator("global_pose_sensor")
    no_fix = NavSatFix(latitude=1.0, longitude=2.0, altitude=math.nan)
    no_fix.status.status = -1
    report = maps.to_jaus("global_pose", no_fix)
    assert (report.latitude, report.longitude, report.altitude) == (None, None, None)
    assert report.position_rms is None
    without_altitude = NavSatFix(latitude=1.0, longitude=2.0, altitude=math.nan)
    without_altitude.status.status = NavSatStatus.STATUS_FIX
    report = maps.to_jaus("global_pose", without_altitude)
    assert report.latitude == near(1.0)
    assert report.altitude is None
    back = maps.to_ros("global_pose", maps.messages.ReportGlobalPose(latitude=1.0, longitude=2.0))
    assert math.isnan(back.altitude)
    assert back.position_covariance_type == 0


def test_stamps_arrive(translator):
    """Day 3, 04:05:06.007 of the month that is now; the ends agree about it to the millisecond."""
    maps = translator("velocity_state_sensor")
    source = Odometry()
    now = maps.bridge.now()
    source.header.stamp.sec, source.header.stamp.nanosec = now.sec, 7_000_000
    report = maps.to_jaus("velocity_state", source)
    assert report.time_stamp.milliseconds == 7
    assert report.time_stamp.seconds == now.sec % 60
    assert report.time_stamp.hour == now.sec // 3600 % 24
    back = maps.to_ros("velocity_state", report)
    assert (back.header.stamp.sec, back.header.stamp.nanosec) == (now.sec, 7_000_000)


def test_a_waypoint_at_the_origin_is_one(translator):
    maps = translator("local_waypoint_driver")
    goal = maps.to_ros("local_waypoint", maps.messages.SetLocalWaypoint(x=0.0, y=0.0))
    assert goal.TYPE == "geometry_msgs/msg/PoseStamped"
    assert goal.pose.position.x == near(0.0)
    assert goal.pose.orientation.w == 1.0


def test_a_waypoint_with_a_yaw_alone_is_level(translator):
    maps = translator("local_waypoint_driver")
    goal = maps.to_ros("local_waypoint", maps.messages.SetLocalWaypoint(x=5.0, y=2.0, yaw=0.7))
    assert goal.pose.position.y == near(-2.0)
    expected = (math.cos(0.7), -math.sin(0.7), 0.0)
    assert turned(goal.pose.orientation, (1, 0, 0)) == pytest.approx(expected, abs=1e-3)


def test_a_global_waypoint(translator):
    """No wheel brings geographic_msgs, and light classes need none."""
    maps = translator("global_waypoint_driver")
    message = maps.messages.SetGlobalWaypoint(latitude=48.5, longitude=-11.25, yaw=0.0)
    goal = maps.to_ros("global_waypoint", message)
    assert goal.pose.position.latitude == near(48.5, 1e-7)
    assert math.isnan(goal.pose.position.altitude)
    assert turned(goal.pose.orientation, (1, 0, 0)) == pytest.approx((0, 1, 0), abs=1e-3)
    goal.pose.position.altitude = 100.0
    back = maps.to_jaus("global_waypoint", goal)
    assert (back.altitude, back.yaw) == (near(100.0), near(0.0))


def test_a_path_becomes_a_list_of_waypoints(translator):
    maps = translator("waypoint_lists")
    path = Path(poses=[PoseStamped(), PoseStamped(), PoseStamped()])
    for index, pose in enumerate(path.poses):
        pose.pose.position.x, pose.pose.position.y = 10.0 * index, 3.0
        pose.pose.orientation = about("z", math.pi / 2)
    command = maps.to_jaus("local_waypoint_list", path)
    links = [
        (waypoint.element_uid, waypoint.previous_uid, waypoint.next_uid)
        for waypoint in command.element_list
    ]
    assert links == [(1, 0, 2), (2, 1, 3), (3, 2, 0)]
    back = maps.to_ros("local_waypoint_list", command)
    assert [pose.pose.position.x for pose in back.poses] == [near(0.0), near(10.0), near(20.0)]
    assert [pose.pose.position.y for pose in back.poses] == [near(3.0)] * 3
    assert turned(back.poses[1].pose.orientation, (1, 0, 0)) == pytest.approx((0, 1, 0), abs=1e-3)


def test_a_path_that_is_empty_empties_the_list(translator):
    maps = translator("waypoint_lists")
    assert maps.to_jaus("local_waypoint_list", Path()).element_list == []


def test_the_bytes_of_a_list_of_one_waypoint(translator):
    """AS5710 SetElement: one element, numbered 1 without neighbours, whose data is a message."""
    maps = translator("waypoint_lists")
    command = maps.to_jaus("local_waypoint_list", Path(poses=[PoseStamped()]))
    head = "1a 04  01  01  01 00  00 00  00 00  00  15 00  0d 04  0f"
    assert command.encode().startswith(bytes.fromhex(head))


def test_a_list_of_other_messages_is_no_path(translator):
    maps = translator("waypoint_lists")
    command = maps.to_jaus("local_waypoint_list", Path(poses=[PoseStamped()]))
    data = command.element_list[0].element_data
    data.data = b"\x0c\x04" + data.data[2:]
    with pytest.raises(ValueError, match="another message"):
        maps.to_ros("local_waypoint_list", command)
