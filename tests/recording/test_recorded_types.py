"""Types of messages that have changed since they were recorded: never read by their bytes alone."""

import struct
from functools import cache

import pytest
from click.testing import CliRunner
from mcap.writer import Writer
from ports import free_port
from rosbags.typesys import get_types_from_msg

from jausml.cli import main
from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import ros
from jausml.language.model import library_root, read_models
from jausml.live.recording.mcap_reading import UNDEFINED, RecordedDefinition
from jausml.live.recording.recorded_types import RecordedTypes
from jausml.live.recording.ros_definitions import (
    full_name,
    installed_definition,
    modelled_definition,
)

KIND = "drive_msgs/msg/Drive"
MODEL = """drive {
    JAUS ReportDrive ( float64 speed  float64 turn ) { code: 0xD501 }
    ROS drive_msgs/Drive ( float64 speed  float64 turn )
    ROS->JAUS ( speed -> speed  turn -> turn )
}
bridge b { address: 100.1.9  provides: Drives
  connection d { map: drive direction: rosToJaus exchange: everyChangeEvent topic /drive }
}
"""


@cache
def modelled():
    """A type of the shared library of models that has a type in it."""
    found = read_models(["models/library/ros/geometry_msgs.xmi"], allow_outside=True).model
    return next(kind for kind in found.instances(ros.MessageType) if kind.name == "Twist")


def difference(text, kind="geometry_msgs/msg/Twist", encoding="ros2msg"):
    types = RecordedTypes({"/cmd": modelled()})
    return types.difference("/cmd", kind, RecordedDefinition(encoding, text))


VECTOR = "=" * 80 + "\nMSG: geometry_msgs/Vector3\n"


@pytest.mark.parametrize(
    "text",
    [
        f"Vector3 linear\nVector3 angular\n{VECTOR}float64 x\nfloat64 y\nfloat64 z\n",
        "# how fast\nfloat64 FAST=3.0\ngeometry_msgs/Vector3 linear # m/s\nVector3  angular\n"
        f"{VECTOR}float64 x 0\nfloat64 y\n\nfloat64 z",
        "other_msgs/Vector linear\nother_msgs/Vector angular\n"
        + "=" * 80
        + "\nMSG: other_msgs/Vector\nfloat64 x\nfloat64 y\nfloat64 z\n",
        "",
    ],
)
def test_the_same_bytes_are_read(text):
    assert difference(text) == ""
    assert RecordedTypes({}).difference("/other", "a/msg/B", UNDEFINED) == ""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            f"Vector3 angular\nVector3 linear\n{VECTOR}float64 x\nfloat64 y\nfloat64 z\n",
            "has geometry_msgs/Twist recorded as 'Vector3 angular, Vector3 linear', and the model"
            " has 'geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular'",
        ),
        (
            f"Vector3 linear\nVector3 angular\n{VECTOR}float64 x\nfloat64 y\nfloat32 z\n",
            "has geometry_msgs/Vector3 recorded as 'float64 x, float64 y, float32 z'",
        ),
        (f"Vector3[1] linear\nVector3 angular\n{VECTOR}float64 x\nfloat64 y\nfloat64 z\n", "[1]"),
        ("Vector3 linear\nVector3 angular\n", "does not define geometry_msgs/Vector3"),
        ("Vector3 linear\nno field\n", "definition of geometry_msgs/msg/Twist that cannot be"),
        (
            f"Vector3 linear\nVector3 angular\n{VECTOR}Vector3 x\nfloat64 y\nfloat64 z\n",
            "'Vector3 x",
        ),
    ],
)
def test_others_are_refused_with_both_definitions(text, said):
    assert said in difference(text)


def test_definitions_that_are_not_read_are_refused():
    assert "in 'ros2idl', which is not read" in difference("module", encoding="ros2idl")
    assert "has the type a/msg/B, not geometry_msgs/msg/Twist" in difference("", kind="a/msg/B")


@pytest.mark.ports
@pytest.mark.parametrize(
    ("definition", "used"),
    [
        ("float64 speed\nfloat64 turn\n", True),
        ("float64 turn\nfloat64 speed\n", False),
        ("float64 stamp\nfloat64 speed\nfloat64 turn\n", False),
        ("float32 speed\nfloat64 turn\n", False),
    ],
)
def test_replay_gives_bridges_what_was_recorded_as_their_type(tmp_path, definition, used):
    model, path = tmp_path / "drives.ros2jaus", tmp_path / "run.mcap"
    model.write_text(MODEL)
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        schema = writer.register_schema(KIND, "ros2msg", definition.encode())
        channel = writer.register_channel("/drive", "cdr", schema)
        writer.add_message(channel, 0, b"\0\1\0\0" + struct.pack("<3d", 2.0, 0.25, 7.0), 0)
        writer.finish()
    line = ["replay", str(path), str(model), "--port", str(free_port()), "--wait", "0"]
    result = CliRunner().invoke(main, [*line, "--hold", "0"])
    assert ("1 of /drive" in result.stderr) is used
    assert result.exit_code == (0 if used else 1), result.stderr
    if not used:
        recorded = ", ".join(definition.split("\n")).removesuffix(", ")
        assert f"recorded as '{recorded}', and the model has 'float64 speed, float64 turn'" in (
            result.stderr
        )


@pytest.fixture(scope="module")
def types():
    """The message types of the library, those of services and actions left out."""
    files = sorted((library_root() / "ros").glob("*.xmi"))
    found = read_models(files).model.instances(ros.MessageType)
    return [kind for kind in found if isinstance(kind.eContainer(), ros.InterfacePackage)]


def fields(text, name):
    """What rosbags understands of a definition: names and types of all fields."""
    return {key: value[1] for key, value in get_types_from_msg(text, name).items()}


def test_definitions_of_all_types_of_the_library_are_understood(types):
    assert len(types) > 50
    for message_type in types:
        found = fields(modelled_definition(message_type), full_name(message_type))
        assert [name for name, _ in found[full_name(message_type)]] == [
            str(f.name) for f in message_type.fields
        ]


@pytest.mark.needs("interfaces")
def test_installed_definitions_say_the_same(types):
    installation = Installation()
    compared = 0
    for message_type in types:
        name = full_name(message_type)
        installed = installed_definition(name, installation)
        if installed:
            assert fields(installed, name) == fields(modelled_definition(message_type), name)
            compared += 1
    assert compared


def test_type_that_is_not_installed_has_no_definition():
    assert installed_definition("no_such_msgs/msg/Thing", Installation()) == ""
    assert installed_definition("std_msgs/msg/../../Thing", Installation()) == ""
