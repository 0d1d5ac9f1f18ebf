"""The tests of generated bridges can fail: each kind of damage to a translation is found."""

import os
import re
import sys
import tempfile
from functools import cache
from pathlib import Path

import needs
import pytest
from generated import WITHOUT_PLUGINS, model_in, model_of, text_of
from scripts import succeeded
from sweeps import sweep
from workspaces import python_path, share_runtime, write

from jausml_generators.bridge.target import TARGET
from jausml_generators.messages.target import TARGET as MESSAGES

pytestmark = pytest.mark.timeout(300)  # the first one waits for all of them

ROOT = Path(__file__).resolve().parents[2]

# What is damaged, the text that is replaced in the base, and what replaces it.
DAMAGES = {
    "a factor of the effort": ("source.linear.y, -20.0", "source.linear.y, -2.0"),
    "a sign of the effort": ("source.linear.z, -10.0", "source.linear.z, 10.0"),
    "percent the other way": ("value_to_percent(source.linear.x",
        "percent_to_value(source.linear.x"),
    "a negation": ("= conversions.negate(source.velocity_y)", "= source.velocity_y"),
    "a negation on the way back": ("conversions.negate(source.twist.twist.angular.z)",
        "source.twist.twist.angular.z"),
    "two members": ("twist.twist.linear.x = source.velocity_x",
        "twist.twist.linear.y = source.velocity_x"),
    "two sources": ('"Velocity_X", source.twist.twist.linear.x',
        '"Velocity_X", source.twist.twist.linear.y'),
    "a field that is forgotten": ("target.yaw_rate = self", "target.yaw_accel = self"),
    "clamp for drop": ("self.drive.drop_field(", "self.drive.clamp("),
    "drop for clamp": ('self.own_speed.clamp(\n            "Velocity_Z"',
        'self.own_speed.drop_field(\n            "Velocity_Z"'),
    "drop for error": ("self.drive.error(", "self.drive.drop_message("),
    "the name of a counter": ('"PropulsiveLinearEffortY", c', '"PropulsiveLinearEffortZ", c'),
    "a limit": ("linear.y, -20.0), -100.0, 100.0", "linear.y, -20.0), -100.0, 200.0"),
    "the world for the body": ("ned_angles_to_enu_quaternion(source.roll",
        "frd_angles_to_flu_quaternion(source.roll"),
    "the body for the world": ("= conversions.enu_quaternion_to_ned_angles(source",
        "= conversions.flu_quaternion_to_frd_angles(source"),
    "roll and pitch": ("(source.roll, source.pitch, source.yaw)",
        "(source.pitch, source.roll, source.yaw)"),
    "pitch and yaw on the way back": ("roll, pitch, yaw = conversions.enu",
        "roll, yaw, pitch = conversions.enu"),
    "the required field": ('raise AbsentFieldError("Velocity_X")', "source.velocity_x = 0.0"),
    "the default value": ("twist.linear.z = 0.25", "twist.linear.z = 0.5"),
    "the last value": (
        "self.last_speed_twist_twist_angular_z = conversions.negate(source.yaw_rate)",
        "target.twist.twist.angular.z = conversions.negate(source.yaw_rate)",
    ),
    "a square": ("= conversions.square(source.velocity_rms)", "= source.velocity_rms"),
    "the constant": ('frame_id = "odom"', 'frame_id = "map"'),
    "the time": ("set_time(\n", "(\n"),
    "a figure of a stop": ("target.twist.linear.z = 0.125", "target.twist.linear.z = 0.25"),
    "more in a stop than the model says": ("target.twist.linear.z = 0.125",
        "target.twist.linear.z = target.twist.angular.z = 0.125"),
    "a stop that is no zero": ("target.propulsive_rotational_effort_z = 0.0",
        "target.propulsive_rotational_effort_z = 1.0"),
    "a time of silence": ("silence_timeout=1.0,\n            safe_value=self.safe_drive,",
        "silence_timeout=2.0,\n            safe_value=self.safe_drive,"),
    "a rate": ("query=QueryVelocityState(presence_vector=0x014F),\n            rate=1.0,",
        "query=QueryVelocityState(presence_vector=0x014F),\n            rate=0.5,"),
    "a freshness": ("query=QueryVelocityState,\n            freshness=1.0,",
        "query=QueryVelocityState,\n            freshness=2.0,"),
    "what is ignored": ("header.frame_id = self.speed_frame_id",
        "child_frame_id = target.header.frame_id = self.speed_frame_id"),
}  # fmt: skip
DAMAGES_OF_PARTS = {
    "what is ignored in an element of an element": ("velocities[1].linear.y = conversions",
        "velocities[1].linear.z = target.points[0].velocities[1].linear.y = conversions"),
    "what is ignored in an element": ("velocities[0].linear.x = source",
        "velocities[0].linear.y = target.points[0].velocities[0].linear.x = source"),
    "an element that is left": ("if source.velocity_z is not None:",
        "target.points[1].velocities[0].linear.z = 1.0\n        if source.velocity_z is not None:"),
    "what is ignored in an element of JAUS": ("outer_1.third = ",
        "outer_1.second = outer_1.third = "),
    "an optional member that is ignored": ("outer_0.second = ",
        "outer_0.first = outer_0.second = "),
    "what is ignored in an option": ("target.cost_map2d_pose_var.map_center_x = ",
        "target.cost_map2d_pose_var.map_center_y = target.cost_map2d_pose_var.map_center_x = "),
    "what is ignored in an element of an option": ("cost_and_confidence_data_list_0.cost = 2",
        "cost_and_confidence_data_list_0.cost = cost_and_confidence_data_list_0.confidence = 2"),
    "the alternative of a number": ("JointPosition(\n            2,",
        "JointPosition(\n            1,"),
    "the alternative of a number on the way back": ("joint_position.index != 2",
        "joint_position.index != 1"),
    "the alternative of octets": ("ImageFrame(1, ", "ImageFrame(2, "),
    "the alternative of octets on the way back": ("format_index != 1", "format_index != 2"),
    "the octets": ("target.data = ", 'target.data = b"a" + '),
    "the octets on the way back": ("bytes(source.data)", "bytes(source.data)[:1]"),
}  # fmt: skip
MODELS = {"checked_bridge": DAMAGES, "checked_parts": DAMAGES_OF_PARTS}
GUARDING = {"a sign of the effort", "a figure of a stop"}
MORE_NAMES = "from jausml_runtime.conversions import (\n"
IMPORTED = (
    "    flu_quaternion_to_frd_angles,\n    frd_angles_to_flu_quaternion,\n    percent_to_value,\n"
)


def damaged(text, found, replacement):
    assert text.count(found) == 1, found
    return text.replace(found, replacement).replace(MORE_NAMES, MORE_NAMES + IMPORTED)


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """Returns what gives the folder of the package of a generated bridge by its name."""

    @cache
    def made(name):
        folder = tmp_path_factory.mktemp("checked")
        model = model_of(Path(__file__).with_name(f"{name}.ros2jaus"))
        write(model, [TARGET, MESSAGES], folder)
        share_runtime(folder)
        return folder / name

    return made


@pytest.mark.parametrize("name", MODELS)
def test_the_generated_tests_need_no_formatter(package, name):
    config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
    for check in (["format", "--check"], ["check", "--ignore", "S101"]):
        succeeded([sys.executable, "-m", "ruff", *check, *config, "test"], cwd=package(name))


def test_hypothesis_is_what_the_tests_need(package):
    manifest = (package("checked_bridge") / "package.xml").read_text(encoding="utf-8")
    assert "<test_depend>python3-hypothesis</test_depend>" in manifest


def test_a_bridge_without_vectors_has_a_test(tmp_path):
    """Without one, pytest ends with an exit status of its own, and linters see unused imports."""
    model = model_in(
        tmp_path,
        """\
import `jaus.manipulator-2.0`
joints { JAUS ReportJointPositions  ROS sensor_msgs/JointState
  JAUS->ROS ( JointPositionList -> position { JointPosition.radian -> . : user(trim) } )
}
component arm { address: 10.1.2  provides: ManipulatorJointPositionSensor }
bridge arm_bridge {
  address: 10.1.1  uses: ManipulatorJointPositionSensor
  connection joints { map: joints  exchange: query  peers: arm  topic joint_states {} }
}
""",
    )
    tests = text_of(model, [TARGET], "_translations.py")
    assert "differing_forms(bridge, bridge.translate_joints, bridge.joints, source) == []" in tests


def test_alternatives_of_one_field_do_not_stand_in_one_message(tmp_path):
    """What is made of all three would be the sum of two that are not there."""
    model = model_in(
        tmp_path,
        """\
import jaus.hmi
axis { JAUS ReportAnalogAction  ROS std_msgs/Float64
  JAUS->ROS (
    Yaw.byte, Yaw.integer -> data : expression("byte + integer") {
      whenAbsent: useDefault  defaultValue: 0
    }
  )
}
component desk { address: 10.1.2  provides: AnalogControl }
bridge desk_bridge {
  address: 10.1.1  uses: AnalogControl
  connection axis { map: axis  exchange: query  peers: desk  topic yaw {} }
}
""",
    )
    tests = text_of(model, [TARGET], "_translations.py")
    assert "source.yaw = ReportAnalogAction.Yaw" not in tests


def test_a_field_is_not_tried_absent_beside_a_value_of_its_own(tmp_path):
    model = model_in(
        tmp_path,
        """\
import jaus.mobility
days { JAUS ReportLocalPose  ROS std_msgs/Header
  table words ( 2 <-> "two" )
  JAUS->ROS ( TimeStamp -> stamp : timestamp_to_time  TimeStamp.Day -> frame_id : look_up(words) )
}
component rover { address: 10.1.2  provides: LocalPoseSensor }
bridge day_bridge {
  address: 10.1.1  uses: LocalPoseSensor
  connection days { map: days  peers: rover  topic days {} }
}
""",
    )
    tests = text_of(model, [TARGET], "_translations.py")
    assert "source.time_stamp.day = 2" in tests
    assert "without_time_stamp" not in tests


JOINED = """\
import jaus.mobility
import `jaus.core-1.1`
poses { JAUS ReportLocalPose  ROS nav_msgs/OccupancyGrid
  table words ( 1 <-> "one" )
  report_join near { message: Discovery.ReportServices  freshness: 1.5  whenStale: %s }
  JAUS->ROS ( X -> info.origin.position.x  %s )
}
component rover { address: 10.1.2  provides: LocalPoseSensor, Discovery }
bridge pose_bridge {
  address: 10.1.1  uses: LocalPoseSensor
  connection poses { map: poses  peers: rover  topic poses {} }
}
"""


@pytest.mark.parametrize(
    ("stale", "assignment"),
    [
        ("dropMessage", "near.NodeList.count -> info.width { whenAbsent: dropMessage }"),
        ("leave", "near.NodeList[0].NodeRec.NodeID -> info.width { whenAbsent: dropMessage }"),
        ("dropMessage", "near.NodeList[0].NodeRec.NodeID -> header.frame_id : look_up(words)"),
    ],
)
def test_no_message_is_tried_that_what_is_joined_may_refuse(tmp_path, stale, assignment):
    model = model_in(tmp_path, JOINED % (stale, assignment))
    tests = text_of(model, [TARGET], "_translations.py")
    assert "def test_poses_has_the_same_bytes_in_each_form" in tests
    assert "def test_poses(" not in tests


def outcomes_of(package, module, damages):
    """Returns exit code and output of the generated tests by damage; undamaged for None."""
    folder = package.parent
    text = (package / module).read_text(encoding="utf-8")
    replacements, place = [], Path(tempfile.mkdtemp(dir=folder))
    for number, (found, replacement) in enumerate(damages.values()):
        replacements.append(place / f"damage_{number}.py")
        replacements[-1].write_text(damaged(text, found, replacement), encoding="utf-8")
    runner = Path(__file__).with_name("forked_pytest.py")
    done = succeeded(
        [sys.executable, str(runner), str(package), module, *map(str, replacements)],
        env={**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": python_path(folder)},
        timeout=250,
    )
    outputs = [path.with_suffix(".txt").read_text() for path in (package, *replacements)]
    codes = map(int, done.stdout.split())
    return dict(zip([None, *damages], zip(codes, outputs, strict=True), strict=True))


TRIED = sweep(
    ((name, damage) for name, damages in MODELS.items() for damage in damages),
    every=lambda pair: pair[1] in GUARDING,
    rest=12,
)


@pytest.fixture(scope="module")
def outcomes(package):
    """Returns what gives what becomes of damages of the readable translations of a bridge."""
    needs.ask("rclpy")

    taken = [getattr(case, "values", case) for case in TRIED]

    @cache
    def found(name, *, guards):
        damages = {
            damage: MODELS[name][damage]
            for owner, damage in taken
            if owner == name and (damage in GUARDING) is guards
        }
        return outcomes_of(package(name), f"{name}/{name}_base.py", damages)

    return found


@pytest.mark.parametrize("name", sweep(MODELS, every=2))
def test_the_generated_tests_pass(outcomes, name):
    code, output = outcomes(name, guards=True)[None]
    assert code == 0, output
    assert re.search("^[0-9]{2} passed", output, re.MULTILINE)


@pytest.mark.parametrize(("name", "damage"), TRIED)
def test_damage_is_found(outcomes, name, damage):
    code, output = outcomes(name, guards=damage in GUARDING)[damage]
    # Other codes than 1 mean that the tests did not run.
    assert code == 1, output
    assert "1 failed" in output
    assert "NameError" not in output
