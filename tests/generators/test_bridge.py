"""Generated bridges: what stands in them, that they are clean, and that their own tests pass."""

import ast
import os
from functools import partial
from pathlib import Path

import needs
import pytest
from generated import model_of, run_in
from sweeps import sweep
from workspaces import kept

from jausml.generation.artifact import Kind
from jausml.generation.rendering import render
from jausml_generators.bridge.target import TARGET
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi"
MODELS = [CASE, ROOT / "models" / "minimal" / "minimal.xmi"]
MODELS += [ROOT / "models" / "catvehicle" / "catvehicle.xmi"]
NARROW = Path(__file__).with_name("narrow_bridge.xmi")
MODELS += [NARROW]
WHOLE = [TARGET, MESSAGES, RUNTIME.for_whole_library()]


def files_of(path):
    return {artifact.path: artifact for artifact in render(model_of(path), [TARGET])}


@pytest.fixture(scope="module")
def loop_files():
    return files_of(CASE)


@pytest.fixture(scope="module")
def base(loop_files):
    return loop_files["loop_bridge/loop_bridge/loop_bridge_base.py"].text


# ------------------------------------------------------------------ what stands there


def test_files(loop_files):
    assert set(loop_files) == {
        "loop_bridge/package.xml",
        "loop_bridge/setup.cfg",
        "loop_bridge/setup.py",
        "loop_bridge/core/core.cpp",
        "loop_bridge/core/core.hpp",
        "loop_bridge/core/fastpath.hpp",
        "loop_bridge/core/jaus.hpp",
        "loop_bridge/resource/loop_bridge",
        "loop_bridge/loop_bridge/__init__.py",
        "loop_bridge/loop_bridge/loop_bridge.py",
        "loop_bridge/loop_bridge/loop_bridge_base.py",
        "loop_bridge/loop_bridge/main.py",
        "loop_bridge/loop_bridge/messages.py",
        "loop_bridge/loop_bridge/py.typed",
        "loop_bridge/loop_bridge/ros_types.py",
        "loop_bridge/test/test_loop_bridge_translations.py",
    }
    skeletons = [path for path, artifact in loop_files.items() if artifact.kind is Kind.SKELETON]
    assert skeletons == ["loop_bridge/loop_bridge/loop_bridge.py"]


def test_same_model_gives_the_same_bytes(loop_files):
    again = files_of(CASE)
    assert {path: artifact.text for path, artifact in again.items()} == {
        path: artifact.text for path, artifact in loop_files.items()
    }


@pytest.mark.parametrize(
    "text",
    [
        # An optional field without which the message makes no sense, and one that may be absent.
        """
        if source.velocity_x is None:
            raise AbsentFieldError("Velocity_X")
        target = Odometry()
""",
        """
        if source.velocity_y is not None:
            target.twist.twist.linear.y = conversions.negate(source.velocity_y)  # meter per second
""",
        # A time, relative to the clock of the bridge.
        """
            set_time(
                target.header.stamp,
                conversions.timestamp_to_time(source.time_stamp, near=self.now()),
            )
""",
        # Several sources of one conversion.
        """
        if source.roll is not None and source.pitch is not None and source.yaw is not None:
            set_quaternion(
                target.pose.orientation,
                conversions.frd_angles_to_flu_quaternion(source.roll, source.pitch, source.yaw),
            )
""",
        # The policy of the connection, and those of assignments that have their own.
        """
        target.x = self.estimate.drop_message("X", source.pose.pose.position.x, -100000.0, 100000.0)
""",
        """
        target.y = self.estimate.drop_field(
            "Y", conversions.negate(source.pose.pose.position.y), -100000.0, 100000.0
        )  # meter
""",
        """
        target.propulsive_linear_effort_x = self.drive.error(
            "PropulsiveLinearEffortX", conversions.scale(source.linear.x, 10.0), -100.0, 100.0
        )  # percent
""",
        # Conversions in order, within the range of the target.
        """
        target.propulsive_rotational_effort_z = self.drive.clamp(
            "PropulsiveRotationalEffortZ",
            conversions.scale(conversions.negate(source.angular.z), 100.0),
            -100.0,
            100.0,
        )  # percent
""",
        """
            target.time_stamp = ReportLocalPose.TimeStamp(
                *conversions.time_to_timestamp(source.header.stamp)
            )
""",
        # One query for two connections asks for what both of them read.
        """
            query=QueryVelocityState(presence_vector=0x0143),
            rate=20.0,
""",
        """
            when=lambda message: Guard.READY if message.command_type == 0 else Guard.CONTROLLED,
            answer=CommandAnswer(
                QueryVelocityCommand, ReportVelocityCommand, same=("command_type",)
            ),
            is_command=True,
            silence_timeout=0.5,
            safe_value=self.safe_cruise,
            stop=("twist.linear.x = 0.0",),
            peers=[JausAddress(20, 1, 1)],
""",
        """
        if source.command_type != 0:
            raise ConversionError("a limit, not the current command")
        if source.velocity_x is None:
""",
        """
            control=Guard.READY,
            priority=Priority.HIGH,
            is_command=True,
            silence_timeout=0.4,
            safe_value=self.safe_drive,
            stop=("PropulsiveLinearEffortX = 0",),
            peers=[JausAddress(10, 1, 1), JausAddress(10, 1, 2)],
""",
        """
    def safe_drive(self) -> SetWrenchEffort:
        \"\"\"Stops what was commanded.

        Sent once at the start, at the end, when nobody may command any more, and when drive hears
        nothing for 0.4 s.
        \"\"\"
        target = SetWrenchEffort()
        target.propulsive_linear_effort_x = 0.0  # percent
        return target
""",
    ],
)
def test_base_holds(base, text):
    assert text in base


def test_exactly_the_messages_used(loop_files):
    tree = ast.parse(loop_files["loop_bridge/loop_bridge/messages.py"].text)
    (exports,) = (node.value for node in tree.body if isinstance(node, ast.Assign))
    assert ast.literal_eval(exports) == [
        "QueryLocalPose", "QueryVelocityCommand", "QueryVelocityState", "ReportLocalPose",
        "ReportVelocityCommand", "ReportVelocityState", "SetVelocityCommand", "SetWrenchEffort",
    ]  # fmt: skip


def test_inherited_services_are_provided(base):
    for name in (
        "core:Events",
        "core:AccessControl",
        "core:Management",
        "mobility:LocalPoseSensor",
    ):
        assert f'ServiceIdentity("urn:jaus:jss:{name}", 1, 0),' in base


def test_contract_names_each_translation(loop_files):
    contract = loop_files["loop_bridge/loop_bridge/loop_bridge.py"].contract
    assert contract.base_name == "LoopBridgeBase"
    *translations, not_ready, control_lost = contract.methods
    assert [method.name for method in translations] == [
        f"translate_{name}" for name in ("odometry", "speed", "pose", "drive", "cruise", "estimate")
    ]
    assert [not_ready.name, control_lost.name] == ["on_not_ready", "on_control_lost"]
    assert all(method.optional for method in contract.methods)
    for method in translations:
        ast.parse(f"class Stub:\n{method.stub}")


# ------------------------------------------------------------------ clean


@pytest.mark.parametrize("model", sweep(MODELS, every=4), ids=lambda path: path.stem)
def test_output_needs_no_formatter_and_its_tests_pass(model):
    workspace = kept(model_of(model), WHOLE)
    (package,) = (path.parents[1].name for path in workspace.glob("*/core/core.cpp"))
    config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
    folder = workspace / package
    tool = partial(run_in, workspace, "-m", cwd=folder)
    tool("ruff", "format", "--check", *config, ".")
    tool("ruff", "check", *config, "--ignore", "S101", package, "test")
    needs.ask("rclpy")
    tool("pytest", "-q", "-c", os.devnull, "-p", "no:cacheprovider", "--rootdir", folder, "test")


def test_output_passes_the_type_checker(tmp_path):
    settings = tmp_path / "mypy.ini"
    settings.write_text(
        "[mypy]\nstrict = True\npython_version = 3.10\nfollow_imports = silent\n"
        "[mypy-rclpy.*,diagnostic_msgs.*,geometry_msgs.*,nav_msgs.*,rcl_interfaces.*,std_msgs.*]\n"
        "ignore_missing_imports = True\n"
        "follow_imports = skip\n"
    )
    workspace = kept(model_of(CASE), WHOLE)
    package = workspace / "loop_bridge" / "loop_bridge"
    folders = (package, package.parent / "test")
    modules = sorted(str(module) for folder in folders for module in folder.glob("*.py"))
    run_in(workspace, "-m", "mypy", "--config-file", settings, *modules, cwd=tmp_path)


def run(program, model=CASE):
    """Runs a program with the packages of a model; returns what it printed."""
    needs.ask("rclpy")
    return run_in(kept(model_of(model), WHOLE), "-c", program)


def test_a_light_class_that_differs_from_that_of_ros_is_told():
    """By the check that stands in the generated tests for each connection."""
    run("""
from jausml_runtime import differing_forms
from loop_bridge import ros_types
from loop_bridge.loop_bridge import LoopBridge

# A light class that mixes up two fields.
bridge = LoopBridge()
source = ros_types.Twist()
source.linear.x = 1.0
arguments = (bridge, bridge.translate_drive, bridge.drive)
assert differing_forms(*arguments, source) == []
honest = ros_types.Twist._read.__func__
def mixed(cls, data, offset, order):
    made, offset = honest(cls, data, offset, order)
    made.linear, made.angular = made.angular, made.linear
    return made, offset
ros_types.Twist._read = classmethod(mixed)
found = differing_forms(*arguments, source)
assert found[:2] == ["light.linear.x: 1.0, rclpy: 0.0", "light.angular.x: 0.0, rclpy: 1.0"]
""")


def test_skeleton_overrides_and_help():
    printed = run("""
from loop_bridge.loop_bridge import LoopBridge
from loop_bridge.main import main

class Mine(LoopBridge):
    def translate_speed(self, source):
        return None

    def safe_drive(self):
        return "mine"

mine = Mine()
assert mine.speed._translate("anything") is None
assert mine.drive._safe_value() == "mine"
assert [each.name for each in mine.connections][:2] == ["odometry", "speed"]
main(["--help"])
""")
    assert "--jaus-port" in printed
    assert "--jaus-id" in printed


def test_translations_keep_to_their_policies_before_the_bridge_is_open():
    run("""
from geometry_msgs.msg import Twist
from jausml_runtime import OutOfRangeError
from loop_bridge.loop_bridge import LoopBridge
from nav_msgs.msg import Odometry

bridge = LoopBridge()
twist = Twist()
twist.angular.z = -5.0
assert bridge.translate_drive(twist).propulsive_rotational_effort_z == 100.0
assert bridge.drive.statistics.out_of_range == {("clamp", "PropulsiveRotationalEffortZ"): 1}
twist.linear.x = 10.5
try:
    bridge.translate_drive(twist)
except OutOfRangeError as error:
    assert (error.field, error.policy) == ("PropulsiveLinearEffortX", "error")
else:
    raise AssertionError
odometry = Odometry()
odometry.pose.pose.position.x, odometry.pose.pose.position.y = 1.0, float("nan")
report = bridge.translate_estimate(odometry)
assert (report.x, report.y, report.yaw) == (1.0, None, 0.0)
assert type(report).decode(report.encode()).y is None
""")


def test_what_a_peer_sends_is_no_wrong_number_in_ros():
    program = """
import math
import pytest
from jausml_runtime import OutOfRangeError
from narrow_bridge.messages import ReportMeter
from narrow_bridge.narrow_bridge import NarrowBridge

bridge = NarrowBridge()

def report(ticks=0, level=0.0):
    return ReportMeter(ticks, level)

# Beyond what the definition allows, which a decoder takes all the same.
assert [bridge.translate_ticks(report(number)).data for number in (100, 255)] == [100, 255]
# The nearest number would count something else.
for number in (256, 65535):
    with pytest.raises(OutOfRangeError) as caught:
        bridge.translate_ticks(report(number))
    assert (caught.value.policy, caught.value.field) == ("drop_message", "data")
assert bridge.ticks.statistics.limited == 0
assert bridge.translate_level(report(level=0.5)).data == 0.5
assert bridge.translate_level(report(level=-1e300)).data == -3.4028234663852886e38
for level in (math.nan, math.inf):
    for translate, policy in (
        (bridge.translate_level, "not_clampable"),
        (bridge.translate_full, "error"),
    ):
        with pytest.raises(OutOfRangeError) as caught:
            translate(report(level=level))
        assert (caught.value.policy, caught.value.field) == (policy, "Level")
assert bridge.translate_full(report(level=2.6)).data == 3
"""
    run(program, NARROW)
