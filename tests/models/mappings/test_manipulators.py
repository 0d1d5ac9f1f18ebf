"""Ready maps of arms, pan-tilt units and tools, by what the figures mean."""

import importlib
import math
from random import Random

import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from sensor_msgs.msg import JointState

GUARDS = ("models/library/mappings",)

ARM = [f"joint_{number}" for number in range(1, 7)]


def near(*values: float, tolerance: float = 1e-6) -> object:
    return pytest.approx(list(values), abs=tolerance)


def absent_error() -> type[Exception]:
    found: type[Exception] = importlib.import_module(
        "jausml_runtime.bridge.messages.limits"
    ).AbsentFieldError
    return found


# ------------------------------------------------------------------ joints by name


def test_velocities_go_to_their_joints(translator):
    maps = translator("joint_velocities")
    wanted = JointState(name=ARM[::-1], velocity=[0.6, 0.5, 0.4, 0.3, 0.2, 0.1])
    command = maps.to_jaus("set_joint_velocities", wanted)
    values = [joint.joint_velocity.value for joint in command.joint_velocity_list]
    assert values == near(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    back = maps.to_ros("set_joint_velocities", command)
    assert (list(back.name), list(back.velocity)) == (ARM, values)
    assert not back.position


def test_a_joint_that_is_missing_is_named(translator):
    maps = translator("joint_positions")
    arm = JointState(name=ARM[:4], position=[0.1, 0.2, 0.3, 0.4])
    with pytest.raises(absent_error(), match="position: 'joint_5', 'joint_6' is not among"):
        maps.to_jaus("joint_positions", arm)


def test_a_joint_that_slides_is_not_taken_for_one_that_turns(translator):
    for stem, name, message, item in (
        ("joint_velocities", "set_joint_velocities", "SetJointVelocities", "joint_velocity"),
        ("joint_positions", "set_joint_positions", "SetJointPositions", "joint_position"),
        ("joint_trajectory", "joint_trajectory", "SetJointPositions", "joint_position"),
    ):
        maps = translator(stem)
        kind = getattr(maps.messages, message)
        record = "".join(word.capitalize() for word in item.split("_"))
        command, element = kind(), getattr(kind, f"{record}Rec")()
        setattr(element, item, getattr(kind, record)(2, 0.25))
        getattr(command, f"{item}_list").append(element)
        with pytest.raises(absent_error()):
            maps.to_ros(name, command)


def test_efforts_are_shares_of_a_speed(translator):
    maps = translator("primitive_manipulator")
    wanted = JointState(name=ARM, velocity=[0.0, 0.5, -0.5, 1.0, -1.0, 0.25])
    command = maps.to_jaus("set_joint_efforts", wanted)
    efforts = [joint.joint_effort for joint in command.joint_effort_list]
    assert efforts == near(0, 50, -50, 100, -100, 25, tolerance=0.002)
    back = maps.to_ros("set_joint_efforts", command)
    assert list(back.velocity) == near(*wanted.velocity, tolerance=1e-4)
    assert back.velocity[0] == 0  # which the wire does not have


def test_a_trajectory_has_one_point(translator):
    maps = translator("joint_positions")
    wanted = JointState(name=ARM, position=[0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    command = maps.to_jaus("set_joint_positions", wanted)
    trajectory = translator("joint_trajectory").to_ros("joint_trajectory", command)
    assert list(trajectory.joint_names) == ARM
    (point,) = trajectory.points
    assert list(point.positions) == near(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    assert (point.time_from_start.sec, trajectory.header.stamp.sec) == (2, 0)


# ------------------------------------------------------------------ joints by their place


@pytest.mark.parametrize(
    ("stem", "name", "array", "kind"),
    [
        ("pan_tilt", "set_pan_tilt_positions", "position", "position"),
        ("pan_tilt", "pan_tilt_positions", "position", "position"),
        ("pan_tilt", "set_pan_tilt_efforts", "velocity", "effort"),
        ("pan_tilt", "pan_tilt_efforts", "velocity", "effort"),
        ("pan_tilt_velocities", "set_pan_tilt_velocities", "velocity", "velocity"),
        ("pan_tilt_velocities", "pan_tilt_velocities", "velocity", "velocity"),
    ],
)
def test_pan_and_tilt(translator, stem, name, array, kind):
    maps, scale = translator(stem), 100.0 if kind == "effort" else 1.0
    made = maps.to_jaus(name, JointState(**{array: [0.5, -0.25, 9.0]}))
    pan, tilt = (getattr(made, f"joint{number}_{kind}") for number in (1, 2))
    assert [pan, tilt] == near(0.5 * scale, -0.25 * scale, tolerance=0.002)
    back = maps.to_ros(name, made)
    assert (list(back.name), len(getattr(back, array))) == (["pan", "tilt"], 2)
    assert list(getattr(back, array)) == near(0.5, -0.25, tolerance=1e-4)
    for short in ([], [0.5]):
        with pytest.raises(absent_error(), match=rf"{array}\[{len(short)}\]"):
            maps.to_jaus(name, JointState(**{array: short}))


@pytest.mark.parametrize(
    ("stem", "name", "names"),
    [
        ("joint_velocities", "set_joint_velocities", ARM),
        ("primitive_manipulator", "set_joint_efforts", ARM),
        ("pan_tilt", "set_pan_tilt_efforts", ["pan", "tilt"]),
        ("pan_tilt_velocities", "set_pan_tilt_velocities", ["pan", "tilt"]),
    ],
)
def test_a_stop_names_all_joints_and_turns_none(translator, stem, name, names):
    maps = translator(stem)
    stop = getattr(maps.bridge, f"safe_{name}_to_ros")()
    assert (list(stop.name), list(stop.velocity)) == (names, [0.0] * len(names))
    back = maps.to_ros(name, getattr(maps.bridge, f"safe_{name}_to_jaus")())
    assert list(back.name) == names
    assert list(back.velocity) == near(*[0.0] * len(names))  # which the wire has nearly


# ------------------------------------------------------------------ tools


def rotated(quaternion: tuple[float, ...], point: tuple[float, ...]) -> list[float]:
    """A point turned by a quaternion (w, x, y, z), by the matrix of the textbook."""
    w, x, y, z = quaternion
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return [sum(a * b for a, b in zip(row, point, strict=True)) for row in rows]


def any_turn(chance: Random) -> tuple[float, ...]:
    parts = [chance.gauss(0, 1) for _ in range(4)]
    length = math.hypot(*parts)
    return tuple(part / length for part in parts)


@pytest.mark.parametrize("name", ["end_effector_pose", "set_end_effector_pose"])
def test_a_point_of_the_tool_is_where_it_is(translator, name):
    """Forward, right and down in JAUS is forward, left and up in ROS, for each point of a tool."""
    maps, chance = translator("end_effector"), Random(7)
    for _ in range(50):
        pose = PoseStamped()
        turn, point = any_turn(chance), tuple(chance.uniform(-1, 1) for _ in range(3))
        place = [chance.uniform(-2, 2) for _ in range(3)]
        pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = place
        orientation = pose.pose.orientation
        orientation.w, orientation.x, orientation.y, orientation.z = turn
        made = maps.to_jaus(name, pose)
        theirs = tuple(
            getattr(made, f"{letter}_component_of_unit_quaternion_q") for letter in "dabc"
        )
        origin = [getattr(made, f"tool_point_coordinate_{axis}") for axis in "xyz"]
        x, y, z = (a + b for a, b in zip(origin, rotated(theirs, point), strict=True))
        ours = [a + b for a, b in zip(place, rotated(turn, point), strict=True)]
        assert [x, -y, -z] == near(*ours)
        back = maps.to_ros(name, made).pose
        found = [getattr(back.orientation, axis) for axis in "wxyz"]
        assert found == near(*turn)
        assert [back.position.x, back.position.y, back.position.z] == near(*place)


@pytest.mark.parametrize("name", ["end_effector_velocity", "set_end_effector_velocity"])
def test_a_tool_that_rises_to_the_left(translator, name):
    maps, twist = translator("end_effector"), TwistStamped()
    twist.twist.linear.x, twist.twist.linear.y, twist.twist.linear.z = 0.1, 0.2, 0.3
    twist.twist.angular.x, twist.twist.angular.y, twist.twist.angular.z = 0.4, 0.5, 0.6
    made = maps.to_jaus(name, twist)
    linear = [getattr(made, f"linear_velocity_component_{axis}") for axis in "xyz"]
    angular = [getattr(made, f"angular_velocity_component_{axis}") for axis in "xyz"]
    assert linear == near(0.1, -0.2, -0.3)
    assert angular == near(0.4, -0.5, -0.6)
    back = maps.to_ros(name, made)
    assert back.header.frame_id == "base_link"
    assert back.twist.angular.z == pytest.approx(0.6, abs=1e-6)
