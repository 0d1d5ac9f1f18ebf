"""Generated bridges: what stands in them, that they are clean, and that their own tests pass."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspaces import python_path

from jausml.generation import InternalError, Kind, render
from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.samples import sample_of
from jausml_generators.bridge.target import TARGET
from jausml_generators.bridge.views import BridgeView
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi"
MODELS = [CASE, ROOT / "models" / "minimal" / "minimal.xmi"]
MODELS += [ROOT / "models" / "catvehicle" / "catvehicle.xmi"]
MODELS += [Path(__file__).with_name("narrow_bridge.xmi")]
LIBRARY = "http://www.jausml.org/library"


def files_of(path):
    result = read_models([path])
    assert [each for each in result.diagnostics if each.severity.name == "ERROR"] == []
    return {artifact.path: artifact for artifact in render(result.model, [TARGET])}


@pytest.fixture(scope="module")
def loop_files():
    return files_of(CASE)


@pytest.fixture(scope="module")
def base(loop_files):
    return loop_files["loop_bridge/loop_bridge/loop_bridge_base.py"].text


def write(files, folder):
    for artifact in files:
        path = folder / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")


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
    skeletons = [path for path, each in loop_files.items() if each.kind is Kind.SKELETON]
    assert skeletons == ["loop_bridge/loop_bridge/loop_bridge.py"]


def test_same_model_gives_the_same_bytes(loop_files):
    again = files_of(CASE)
    assert {path: each.text for path, each in again.items()} == {
        path: each.text for path, each in loop_files.items()
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
        "QueryLocalPose",
        "QueryVelocityCommand",
        "QueryVelocityState",
        "ReportLocalPose",
        "ReportVelocityCommand",
        "ReportVelocityState",
        "SetVelocityCommand",
        "SetWrenchEffort",
    ]


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
    *translations, not_ready, control_lost, handoff = contract.methods
    assert [method.name for method in translations] == [
        f"translate_{name}" for name in ("odometry", "speed", "pose", "drive", "cruise", "estimate")
    ]
    hooks = [each.name for each in (not_ready, control_lost, handoff)]
    assert hooks == ["on_not_ready", "on_control_lost", "on_handoff_requested"]
    assert all(method.optional for method in contract.methods)
    for method in translations:
        ast.parse(f"class Stub:\n{method.stub}")


# ------------------------------------------------------------------ clean


@pytest.mark.parametrize("model", MODELS, ids=lambda path: path.stem)
def test_output_needs_no_formatter_and_its_tests_pass(model, tmp_path):
    result = read_models([model])
    artifacts = render(result.model, [TARGET])
    write([*artifacts, *render(result.model, [MESSAGES, RUNTIME])], tmp_path)
    package = artifacts[0].path.split("/")[0]
    config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
    folder = tmp_path / package

    def tool(*arguments, **environment):
        done = subprocess.run(
            [sys.executable, "-m", *arguments],
            cwd=folder,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr

    tool("ruff", "format", "--check", *config, ".")
    tool("ruff", "check", *config, "--ignore", "S101", package, "test")
    pytest.importorskip("rclpy")
    path = python_path(tmp_path)
    tool("pytest", "-q", "-c", os.devnull, "--rootdir", str(folder), "test", PYTHONPATH=path)


def test_output_passes_the_type_checker(tmp_path):
    result = read_models([CASE])
    write(render(result.model, [TARGET, MESSAGES, RUNTIME]), tmp_path)
    settings = tmp_path / "mypy.ini"
    settings.write_text(
        "[mypy]\nstrict = True\npython_version = 3.10\nfollow_imports = silent\n"
        "[mypy-rclpy.*,diagnostic_msgs.*,geometry_msgs.*,nav_msgs.*,rcl_interfaces.*,std_msgs.*]\n"
        "ignore_missing_imports = True\n"
        "follow_imports = skip\n"
    )
    package = tmp_path / "loop_bridge" / "loop_bridge"
    path = python_path(tmp_path)
    folders = (package, package.parent / "test")
    modules = sorted(str(each) for folder in folders for each in folder.glob("*.py"))
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", str(settings), *modules],
        env={**os.environ, "MYPYPATH": path},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_forms_that_differ_are_told(tmp_path):
    """By the check that stands in the generated tests for each connection."""
    pytest.importorskip("rclpy")
    result = read_models([CASE])
    write(render(result.model, [TARGET, MESSAGES, RUNTIME]), tmp_path)
    program = """
from jausml_runtime import ConversionError, differing_forms
from loop_bridge import ros_types
from loop_bridge.loop_bridge import LoopBridge
from loop_bridge.messages import ReportVelocityState

def outcome(change):
    class Mine(LoopBridge):
        def translate_speed(self, source):
            made = super().translate_speed(source)
            return change(made) if self.speed.goes_over_lists else made
    mine = Mine()
    source = ReportVelocityState(velocity_x=1.0)
    return differing_forms(mine, mine.translate_speed, mine.speed, source)

def another(made):
    return ros_types.Float64(data=made.data + 1.0)

def fails(made):
    raise ConversionError("no")

assert outcome(lambda made: made) == []
[told] = outcome(another)
assert ": one by one: 00010000" in told and ", as a whole: 00010000" in told
[told] = outcome(lambda made: None)
assert told.endswith("as a whole: None")
[told] = outcome(fails)
assert told.endswith("as a whole: ConversionError")

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
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": python_path(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_skeleton_overrides_and_help(tmp_path):
    pytest.importorskip("rclpy")
    result = read_models([CASE])
    write(render(result.model, [TARGET, MESSAGES, RUNTIME]), tmp_path)
    program = """
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
"""
    path = python_path(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "--jaus-port" in done.stdout
    assert "--jaus-id" in done.stdout


def test_translations_keep_to_their_policies_before_the_bridge_is_open(tmp_path):
    pytest.importorskip("rclpy")
    result = read_models([CASE])
    write(render(result.model, [TARGET, MESSAGES, RUNTIME]), tmp_path)
    program = """
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
"""
    path = python_path(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_what_a_peer_sends_is_no_wrong_number_in_ros(tmp_path):
    pytest.importorskip("rclpy")
    result = read_models([Path(__file__).with_name("narrow_bridge.xmi")])
    assert result.diagnostics == []
    write(render(result.model, [TARGET, MESSAGES, RUNTIME]), tmp_path)
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
    path = python_path(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


# ------------------------------------------------------------------ models of all kinds

SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" xmlns:jaus="http://www.jausml.org/jaus/1.0"
    xmlns:ros="http://www.jausml.org/ros/1.0" xmlns:system="http://www.jausml.org/system/1.0"
    name="small">
  <serviceSets name="set">
    <services xmi:id="service" name="Things" urn="urn:example:Things">
      <outputs xmi:id="jaus" name="Mixed" code="0xD001">
        <body xsi:type="jaus:Sequence" name="MixedSeq" presenceVector="uint8">
          <fields xsi:type="jaus:Record" name="Head" optional="true">
            <fields xsi:type="jaus:FixedField" name="Count" type="uint8"/>
            <fields xsi:type="jaus:FixedField" name="Wide" type="int32"/>
            <fields xsi:type="jaus:FixedField" name="Percent" type="uint8">
              <values><values xsi:type="jaus:ValueRange" lower="0" upper="100"/></values>
            </fields>
            <fields xsi:type="jaus:FixedField" name="Mode" type="uint8">
              <values>
                <values xsi:type="jaus:EnumeratedValue" name="One" value="1"/>
                <values xsi:type="jaus:ValueRange" lower="4" upper="5"/>
              </values>
            </fields>
            <fields xsi:type="jaus:FixedField" name="Single" type="float32"/>
            <fields xsi:type="jaus:FixedLengthString" name="Plate" length="12"/>
            <fields xsi:type="jaus:VariableLengthField" name="Large" countType="uint32"/>
            <fields xsi:type="jaus:FixedField" name="Number" type="float64"/>
            <fields xsi:type="jaus:VariableLengthString" name="Word" countType="uint8"/>
            <fields xsi:type="jaus:VariableLengthField" name="Blob" countType="uint8"/>
            <fields xsi:type="jaus:FixedField" name="Effort" type="uint16" units="{units}">
              <scale lower="-1.0" upper="1.0"/>
            </fields>
            <fields xsi:type="jaus:BitField" name="Flags" type="uint8">
              <subFields name="Lamp" lowBit="0" highBit="0"/>
              <subFields name="Level" lowBit="1" highBit="3"/>
              <subFields name="Gear" lowBit="4" highBit="7">
                <values>
                  <values xsi:type="jaus:EnumeratedValue" name="Low" value="0"/>
                  <values xsi:type="jaus:ValueRange" lower="1" upper="2"/>
                </values>
              </subFields>
            </fields>
          </fields>
        </body>
      </outputs>
    </services>
  </serviceSets>
  <interfaces name="{package}">
    <messages xmi:id="ros" name="{type}">
      <fields xsi:type="ros:PrimitiveField" name="small" type="uint8"/>
      <fields xsi:type="ros:PrimitiveField" name="large" type="int64"/>
      <fields xsi:type="ros:PrimitiveField" name="real" type="float64"/>
      <fields xsi:type="ros:PrimitiveField" name="single" type="float32"/>
      <fields xsi:type="ros:PrimitiveField" name="signed" type="int8"/>
      <fields xsi:type="ros:PrimitiveField" name="short" type="string" stringBound="8"/>
      <fields xsi:type="ros:PrimitiveField" name="flag" type="bool"/>
      <fields xsi:type="ros:PrimitiveField" name="text" type="string"/>
      <fields xsi:type="ros:PrimitiveField" name="matrix" arrayKind="fixedArray" arraySize="36"/>
      <fields xsi:type="ros:PrimitiveField" name="octets" arrayKind="unboundedSequence"
          type="uint8"/>
    </messages>
  </interfaces>
  <bridges name="small" address="1.1.1">
    <maps xmi:id="map" name="map" documentation="{documentation}">
      <message href="#jaus"/>
      <type href="#ros"/>
{assignments}
    </maps>
    <bridgeConnections name="{name}" map="map" direction="{direction}">
      <topics name="{topic}"/>
      {extra}
    </bridgeConnections>
  </bridges>
</system:System>
"""
DEFAULTS = {
    "units": "",
    "package": "demo_msgs",
    "type": "Thing",
    "documentation": "",
    "assignments": "",
    "name": "things",
    "direction": "jausToRos",
    "topic": "things",
    "extra": "",
}


def small(tmp_path, template=SYSTEM, **texts):
    path = tmp_path / "small.xmi"
    path.write_text(template.format(**{**DEFAULTS, **texts}), encoding="utf-8")
    result = read_models([path], project_root=tmp_path)
    assert [each for each in result.diagnostics if each.severity.name == "ERROR"] == []
    return result.model


def assignment(kind, feature, target, *, source=None, value=None, conversions=""):
    origin = f' source="{source}"' if source else f' value="{value}"'
    return (
        f'      <{feature} xsi:type="bridge:{kind}" target="{target}"{origin}>{conversions}'
        f"</{feature}>"
    )


def body(tmp_path, line, **texts):
    """The statements of the only translation of a small model."""
    model = small(tmp_path, assignments=line, **texts)
    view = BridgeView(system_of(model).bridges[0], system_of(model), "small.xmi")
    text = "\n".join(view.connections[0].translated.lines)
    ast.parse(text)
    return text


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        ("Head.Count", "small", "target.small = source.head.count"),
        ("Head.Count", "large", "target.large = source.head.count"),
        ("Head.Count", "real", "target.real = float(source.head.count)"),
        ("Head.Count", "flag", "target.flag = bool(source.head.count)"),
        ("Head.Wide", "small", 'drop_message.integer("small", source.head.wide, 0, 255)'),
        ("Head.Number", "large", "clamp.integer("),
        ("Head.Number", "real", 'self.things.clamp.finite("Head.Number", source.head.number)'),
        ("Head.Number", "matrix[7]", "target.matrix[7] = self.things.clamp.finite("),
        ("Head.Number", "single", "clamp.single("),
        ("Head.Effort", "single", "target.single = source.head.effort"),
        ("Head.Effort", "matrix[7]", "target.matrix[7] = source.head.effort"),
        ("Head.Percent", "signed", 'drop_message.integer("signed", source.head.percent, -1'),
        ("Head.Word", "short", 'clamp.text("short", source.head.word, 0, 8)'),
        ("Head.Word", "text", "target.text = source.head.word"),
        ("Head.Blob", "octets", "target.octets = source.head.blob"),
        ("Head.Flags.Lamp", "flag", "target.flag = bool(source.head.flags.lamp)"),
        ("Head.Flags.Level", "small", "target.small = source.head.flags.level"),
    ],
)
def test_kinds_to_ros(tmp_path, source, target, expected):
    text = body(tmp_path, assignment("FieldAssignment", "toRos", target, source=source))
    assert "if source.head is not None:" in text
    assert expected in text


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        ("small", "Head.Count", "target.head.count = source.small"),
        ("large", "Head.Count", '("Head.Count", source.large, 0, 255)'),
        ("large", "Head.Percent", '("Head.Percent", source.large, 0, 100)'),
        ("small", "Head.Mode", 'clamp.listed("Head.Mode", source.small, ((1, 1), (4, 5)))'),
        ("real", "Head.Flags.Gear", 'clamp.listed("Head.Flags.Gear", source.real, ((0, 2),))'),
        ("large", "Head.Wide", "-2147483648, 2147483647"),
        ("real", "Head.Number", 'clamp.finite("Head.Number", source.real)'),
        ("small", "Head.Number", "target.head.number = float(source.small)"),
        ("small", "Head.Single", "target.head.single = float(source.small)"),
        ("real", "Head.Single", 'clamp.single("Head.Single", source.real)'),
        ("text", "Head.Word", 'clamp.text("Head.Word", source.text, 0, 255)'),
        ("text", "Head.Plate", 'clamp.text("Head.Plate", source.text, 0, 12)'),
        ("octets", "Head.Blob", 'octets("Head.Blob", bytes(source.octets), 0, 255)'),
        ("octets", "Head.Large", "target.head.large = bytes(source.octets)"),
        ("real", "Head.Effort", '("Head.Effort", source.real, -1.0, 1.0)'),
        ("matrix[7]", "Head.Effort", '("Head.Effort", source.matrix[7], -1.0, 1.0)'),
        ("flag", "Head.Flags.Lamp", '("Head.Flags.Lamp", source.flag, 0, 1)'),
    ],
)
def test_kinds_to_jaus(tmp_path, source, target, expected):
    line = assignment("FieldAssignment", "toJaus", target, source=source)
    text = body(tmp_path, line, direction="rosToJaus")
    assert "target.head = Mixed.Head()" in text
    assert expected in text


@pytest.mark.parametrize(
    ("connection", "field", "expected"),
    [
        ("clamp", "asConnection", "clamp"),
        ("dropMessage", "asConnection", "drop_message"),
        ("error", "asConnection", "error"),
        ("dropField", "asConnection", "drop_field"),
        ("dropField", "clamp", "clamp"),
        ("clamp", "dropField", "drop_field"),
        ("clamp", "dropMessage", "drop_message"),
        ("dropMessage", "error", "error"),
    ],
)
def test_policy_of_the_field_comes_before_that_of_the_connection(
    tmp_path, connection, field, expected
):
    line = assignment("FieldAssignment", "toJaus", "Head.Effort", source="real")
    line = line.replace(" target=", f' outOfRange="{field}" target=')
    template = SYSTEM.replace('direction="{direction}"', 'direction="{direction}" {policy}')
    policy = f'outOfRange="{connection}"'
    text = body(tmp_path, line, direction="rosToJaus", template=template, policy=policy)
    assert f'self.things.{expected}("Head.Effort", source.real, -1.0, 1.0)' in text


@pytest.mark.parametrize(
    ("target", "conversion", "expected"),
    [
        # The first choice would be 0.125.
        ("Head.Mode", "", 1.0),
        ("Head.Effort", "", 0.125),
        ("Head.Effort", "scale 1000", 0.001),
        ("Head.Effort", "linear 2.0 5.0", None),
        ("Head.Percent", "linear 1.0 -3", 3.0),
        ("Head.Flags.Gear", "linear 1.0 -3", 3.0),
    ],
)
def test_examples_are_values_that_the_target_carries(tmp_path, target, conversion, expected):
    kind, *arguments = conversion.split() or [""]
    inner = "".join(f"<arguments>{each}</arguments>" for each in arguments)
    conversions = f'<conversions kind="{kind}">{inner}</conversions>' if kind else ""
    line = assignment("FieldAssignment", "toJaus", target, source="real", conversions=conversions)
    model = small(tmp_path, assignments=line, direction="rosToJaus")
    view = BridgeView(system_of(model).bridges[0], system_of(model), "small.xmi")
    uses = view.translations.uses
    connection = view.connections[0]
    sample = sample_of(Ends(connection, connection.name, uses.type_name, uses))
    assert (sample and sample.values) == (expected and {"real": expected})
    for artifact in render(model, [TARGET]):
        if artifact.path.endswith("_translations.py"):
            assert ("def test_things(" in artifact.text) is (expected is not None)
            ast.parse(artifact.text)


@pytest.mark.parametrize(
    ("target", "value", "expected"),
    [
        ("small", "0x10", "target.small = 16"),
        ("real", "1", "target.real = 1.0"),
        ("flag", "true", "target.flag = True"),
        ("text", "base", 'target.text = "base"'),
    ],
)
def test_constants(tmp_path, target, value, expected):
    assert expected in body(
        tmp_path, assignment("ConstantAssignment", "toRos", target, value=value)
    )


@pytest.mark.parametrize(
    ("target", "source", "value"),
    [
        ("small", "Head.Word", None),
        ("text", "Head.Count", None),
        ("real", "Nothing", None),
        ("nothing", "Head.Number", None),
        ("matrix", "Head.Number", None),
        ("real.x", "Head.Number", None),
        ("real", "Head.Number, Head.Wide", None),
        ("small", None, "many"),
        ("flag", None, "yes"),
    ],
)
def test_what_does_not_fit_names_the_template(tmp_path, target, source, value):
    """Validation tells users before; a target that is run all the same must not guess."""
    kind = "FieldAssignment" if source else "ConstantAssignment"
    line = assignment(kind, "toRos", target, source=source, value=value)
    with pytest.raises(InternalError, match=r"base\.py\.j2"):
        render(small(tmp_path, assignments=line), [TARGET])


HOSTILE = "&quot;&quot;&quot;\\&#10;import injected #{{ 7 * 7 }} {% raw %} \u202e\u2028'"


def test_text_of_the_model_stays_data(tmp_path):
    model = small(
        tmp_path,
        assignments=assignment("ConstantAssignment", "toRos", "text", value=HOSTILE)
        + assignment("FieldAssignment", "toRos", "real", source="Head.Effort"),
        units=HOSTILE,
        documentation=HOSTILE,
        topic=HOSTILE,
        extra=f"<documentation>{HOSTILE}</documentation>",
    )
    (connection,) = system_of(model).bridges[0].bridgeConnections
    for artifact in render(model, [TARGET]):
        if artifact.path.endswith(".py"):
            tree = ast.parse(artifact.text)
            modules = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
            assert "injected" not in modules
            assert "\u202e" not in artifact.text
    base = next(a for a in render(model, [TARGET]) if a.path.endswith("_base.py"))
    literals = {n.value for n in ast.walk(ast.parse(base.text)) if isinstance(n, ast.Constant)}
    assert connection.topics[0].name in literals
    assert connection.map.toRos[0].value in literals


@pytest.mark.parametrize("name", ["class", "settings", "on", "2 x", "open", "def f(): pass"])
def test_names_of_the_model_become_names(tmp_path, name):
    line = assignment("FieldAssignment", "toRos", "real", source="Head.Number")
    for artifact in render(small(tmp_path, assignments=line, name=name), [TARGET]):
        if artifact.path.endswith(".py"):
            ast.parse(artifact.text)


def test_types_that_mirror_jaus_messages_get_their_own_name(tmp_path):
    line = assignment("FieldAssignment", "toRos", "real", source="Head.Number")
    artifacts = render(small(tmp_path, assignments=line, type="Mixed"), [TARGET])
    base = next(a.text for a in artifacts if a.path.endswith("_base.py"))
    assert "from .ros_types import Mixed as DemoMsgsMixed\n" in base
    assert "def translate_things(self, source: Mixed) -> DemoMsgsMixed | None:" in base
    assert "target = DemoMsgsMixed()" in base
