"""Interface packages: what rosidl reads out of them is what the model says."""

import json
import sys
from pathlib import Path

import pytest
import warm
from for_each import for_each
from generated import model_in, model_of, texts_of
from scripts import succeeded

from jausml.generation.artifact import has_valid_header
from jausml.generation.errors import GenerationError
from jausml.language.interfaces import parse_definition
from jausml.language.interfaces.definitions import (
    PRIMITIVES,
    ConstantDefinition,
    FieldDefinition,
    FieldType,
)
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import library_root
from jausml_generators.ros_interfaces.definitions import code_of
from jausml_generators.ros_interfaces.jaus_types import (
    MessagesPackage,
    constant_name,
    field_name,
    type_name,
)
from jausml_generators.ros_interfaces.target import DECLARED, TARGET

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:ros="http://www.jausml.org/ros/1.0"
    xmlns:system="http://www.jausml.org/system/1.0">
  <system:System name="tug" maintainer="Crew" maintainerEmail="crew@example.com" version="1.2.0">
    <interfaces name="tug_interfaces" documentation="What the tug says.">
      <messages xmi:id="Winch" name="Winch" documentation="A winch.&#10;&#10;--- of the tug">
        <fields xsi:type="ros:MessageField" name="header">
          <messageType href="http://www.jausml.org/library/ros/std_msgs.xmi#Header"/>
        </fields>
        <fields xsi:type="ros:PrimitiveField" name="speed" type="float32" units="m/s"
            minimum="-1.5" maximum="2" documentation="Of the rope."/>
        <fields xsi:type="ros:PrimitiveField" name="label" type="string" stringBound="8"
            defaultValue="a &quot;b&quot;"/>
        <fields xsi:type="ros:PrimitiveField" name="names" type="string"
            arrayKind="boundedSequence" arraySize="3"
            defaultValue="[&quot;x, y&quot;, &quot;&quot;]"/>
        <fields xsi:type="ros:MessageField" name="ropes" arrayKind="fixedArray" arraySize="2"
            messageType="Rope"/>
        <constants name="IDLE" type="uint8" value="0" documentation="Stands still."/>
        <constants name="MOTTO" type="string" value="a = b"/>
      </messages>
      <messages xmi:id="Rope" name="Rope"/>
      <services name="Pull" documentation="Pulls.">
        <request name="Pull_Request">
          <fields xsi:type="ros:PrimitiveField" name="length"/>
        </request>
        <response name="Pull_Response" documentation="How it went."/>
      </services>
      <actions name="Tow">
        <goal name="Tow_Goal"/>
        <result name="Tow_Result"/>
        <feedback name="Tow_Feedback">
          <fields xsi:type="ros:PrimitiveField" name="done" type="bool"/>
        </feedback>
      </actions>
    </interfaces>
  </system:System>
  <jaus:ServiceSet name="winches" version="1.0">
    <services name="Winch" urn="urn:example:Winch" version="1.0">
      <outputs name="ReportWinch" code="0xD101" documentation="State of the winch.">
        <body xsi:type="jaus:Record" name="Rec" presenceVector="uint8">
          <fields xsi:type="jaus:FixedField" name="Speed" type="uint16" units="meter per second"
              optional="true"><scale lower="-1" upper="1"/></fields>
          <fields xsi:type="jaus:FixedField" name="class" type="uint8">
            <values>
              <values xsi:type="jaus:EnumeratedValue" name="Not known" value="0"/>
              <values xsi:type="jaus:EnumeratedValue" name="drum" value="2"/>
              <values xsi:type="jaus:ValueRange" lower="10" upper="20"/>
            </values>
          </fields>
          <fields xsi:type="jaus:BitField" name="Flags" type="uint16">
            <subFields name="Mode" lowBit="0" highBit="2"/>
            <subFields name="Rest" lowBit="3" highBit="15"/>
          </fields>
        </body>
      </outputs>
    </services>
  </jaus:ServiceSet>
</xmi:XMI>
"""
WINCH = """
# A winch.
#
# --- of the tug

# Stands still.
uint8 IDLE=0
string MOTTO="a = b"
std_msgs/Header header
# Of the rope.
# [m/s] -1.5 to 2
float32 speed
string<=8 label "a \\"b\\""
string[<=3] names ["x, y", ""]
Rope[2] ropes
"""
REPORT = """
# JAUS message ReportWinch (0xD101).
#
# State of the winch.

uint8 CLASS_VALUE_NOT_KNOWN=0
uint8 CLASS_VALUE_DRUM=2
# Whether speed is there.
bool has_speed
# [meter per second] -1 to 1
float64 speed
# 10 to 20
uint8 class_value
ReportWinchFlags flags
"""


@pytest.fixture
def model(tmp_path):
    return model_in(tmp_path, SYSTEM, "tug.xmi")


def render(model, *targets):
    """Returns the files of targets, of both of them when none is named."""
    return texts_of(model, targets or (DECLARED, TARGET))


def body(text):
    """Returns a definition without the header."""
    return "\n" + "\n".join(text.splitlines()[2:]) + "\n"


def test_declared_packages_and_messages_without_a_map(model):
    files = render(model)
    assert sorted(files) == [
        "tug_interfaces/CMakeLists.txt", "tug_interfaces/action/Tow.action",
        "tug_interfaces/msg/Rope.msg", "tug_interfaces/msg/Winch.msg", "tug_interfaces/package.xml",
        "tug_interfaces/srv/Pull.srv", "tug_jaus_msgs/CMakeLists.txt",
        "tug_jaus_msgs/msg/ReportWinch.msg", "tug_jaus_msgs/msg/ReportWinchFlags.msg",
        "tug_jaus_msgs/package.xml",
    ]  # fmt: skip
    assert body(files["tug_interfaces/msg/Winch.msg"]) == WINCH
    assert body(files["tug_jaus_msgs/msg/ReportWinch.msg"]) == REPORT
    pull = "\n# Pulls.\n\nfloat64 length\n---\n# How it went.\n"
    assert body(files["tug_interfaces/srv/Pull.srv"]) == pull
    assert all(has_valid_header(text) for text in files.values() if text)


def test_packages_name_what_they_need(model):
    files = render(model)
    cmake = files["tug_interfaces/CMakeLists.txt"]
    assert '  "action/Tow.action"\n  "msg/Rope.msg"\n  "msg/Winch.msg"\n  "srv/Pull.srv"\n' in cmake
    assert "  DEPENDENCIES action_msgs std_msgs\n" in cmake
    manifest = files["tug_interfaces/package.xml"]
    assert "<depend>std_msgs</depend>" in manifest
    assert "<member_of_group>rosidl_interface_packages</member_of_group>" in manifest
    assert "DEPENDENCIES" not in files["tug_jaus_msgs/CMakeLists.txt"]


def test_a_model_without_a_system_gives_its_name(tmp_path):
    text = SYSTEM[: SYSTEM.index("  <system:System")] + SYSTEM[SYSTEM.index("  <jaus:Serv") :]
    files = render(model_in(tmp_path, text, "winch box.xmi"))
    assert "winch_box_jaus_msgs/msg/ReportWinch.msg" in files
    assert "<version>0.1.0</version>" in files["winch_box_jaus_msgs/package.xml"]


def test_comments_stay_where_they_belong(model):
    for path, text in render(model).items():
        if not path.endswith((".msg", ".srv", ".action")):
            continue
        for section in parse_definition(text, path.rpartition(".")[2]).sections:
            assert "there" not in section.comment
    text = render(model)["tug_jaus_msgs/msg/ReportWinchFlags.msg"]
    (section,) = parse_definition(text, "msg").sections
    assert [field.comment for field in section.fields] == ["3 bits.", "13 bits."]
    assert section.comment.startswith("Generated by jausml")
    assert "bits" not in section.comment


def test_messages_of_maps_have_their_ros_type_already():
    model = model_of(ROOT / "models" / "catvehicle" / "catvehicle.xmi")
    some = {path for path in render(model) if path.endswith(".msg")}
    every = {path for path in render(model, TARGET.for_whole_library()) if path.endswith(".msg")}
    mapped = {str(mapping.message.name) for mapping in model.instances(bridge.AttributeMap)}
    assert mapped
    for name in mapped:
        assert f"catvehicle_jaus_msgs/msg/{name}.msg" not in some
        assert f"catvehicle_jaus_msgs/msg/{name}.msg" in every
    assert "catvehicle_jaus_msgs/msg/ReportVelocityCommand.msg" in some


def files_of(*paths):
    package = MessagesPackage("all_msgs", "test.xmi")
    for message in model_of(*paths).instances(jaus.MessageDef):
        package.add(message)
    return package.files


def facts(section):
    fields = [(field.name, field.type, field.default, field.comment) for field in section.fields]
    constants = [
        (constant.name, constant.type, constant.value, constant.comment)
        for constant in section.constants
    ]
    return section.comment, fields, constants


@pytest.fixture(scope="module")
def library_files():
    """Definitions of all messages of the shipped library, and of all kinds of fields."""
    paths = sorted((library_root() / "jaus").glob("*.xmi"))
    return files_of(*paths, HERE / "every_kind.xmi", HERE / "hostile_messages.xmi")


def test_every_message_of_the_library_is_read_back_to_its_facts(library_files):
    assert len(library_files) > 500
    names = {file.name for file in library_files}
    assert len({name.lower() for name in names}) == len(library_files)
    for file in library_files:
        (section,) = file.sections
        read = parse_definition("\n".join(section.lines), "msg")
        assert read.faults == [], file.name
        assert facts(read.sections[0]) == facts(section)
        for field in section.fields:
            assert field.type.name in PRIMITIVES or field.type.name in names


@pytest.mark.needs("rosidl")
def test_rosidl_takes_every_message_of_the_library(library_files):
    from rosidl_adapter import parser

    for file in library_files:
        (section,) = file.sections
        theirs = parser.parse_message_string("all_msgs", file.name, "\n".join(section.lines))
        assert [field.name for field in theirs.fields] == [field.name for field in section.fields]
        shown = [str(field.type).replace("all_msgs/", "") for field in theirs.fields]
        assert shown == [str(field.type) for field in section.fields]
        units = [field.annotations.get("unit") for field in theirs.fields]
        assert all(unit is None or unit for unit in units)


def test_nested_kinds():
    files = {file.name: file for file in files_of(HERE / "every_kind.xmi")}
    kinds = {field.name: str(field.type) for field in files["Kinds"].sections[0].fields}
    assert kinds["first"] == "KindsFirst"
    assert kinds["has_second"] == "bool"
    assert kinds["lists"] == "KindsInner[<=3]"
    assert kinds["choice"] == "KindsChoice"
    numbers = {f.name: str(f.type) for f in files["KindsNumbers"].sections[0].fields}
    assert (numbers["wide"], numbers["signed_value"]) == ("float64", "int16")
    assert (numbers["matrix"], numbers["labels"]) == ("uint8[4]", "string<=255[2]")
    choice = files["KindsChoice"].sections[0]
    assert [(c.name, c.value) for c in choice.constants] == [
        ("TAG_A", "0"),
        ("TAG_B", "1"),
        ("TAG_NOTHING", "2"),
    ]


def test_integers_that_count_from_a_lower_limit_have_room_for_their_values():
    files = {file.name: file for file in files_of(HERE / "every_kind.xmi")}
    fields = {field.name: str(field.type) for field in files["Offsets"].sections[0].fields}
    assert (fields["year"], fields["gear"], fields["years"]) == ("uint16", "int16", "uint16[2]")


@for_each(
    ("function", "name", "expected"),
    [
        (field_name, "Velocity_X", "velocity_x"),
        (field_name, "class", "class_value"),
        (field_name, "from", "from_value"),
        (field_name, "2nd", "n2nd"),
        (field_name, "__x__y__", "x_y"),
        (field_name, "漢", "unnamed"),
        (type_name, "report_velocity", "ReportVelocity"),
        (type_name, "3D map", "N3DMap"),
        (type_name, "Exception", "JausException"),
    ],
)
def test_names(function, name, expected):
    assert function(name) == expected


def test_names_of_constants():
    assert constant_name("gear", "Park (P)") == "GEAR_PARK_P"
    assert constant_name("1st", "x") == "N1ST_X"


@for_each(
    "line",
    [
        FieldDefinition("x", FieldType("string"), "a # b"),
        FieldDefinition("x", FieldType("string"), "a = b"),
        FieldDefinition("x", FieldType("string"), "a\nb"),
        FieldDefinition("x", FieldType("string", "", 0, "unboundedSequence"), '[" a"]'),
        ConstantDefinition("X", "string", "a # b"),
    ],
)
def test_what_no_definition_can_say_is_an_error(line):
    with pytest.raises(GenerationError, match=r"no definition can hold|are lost"):
        assert code_of(line)


@for_each(
    "line",
    [
        FieldDefinition("x", FieldType("float64"), "much"),
        FieldDefinition("x", FieldType("uint8"), "256"),
        FieldDefinition("x", FieldType("string", string_bound=2), "abc"),
        FieldDefinition("x", FieldType("string", "", 0, "unboundedSequence"), "no list"),
        FieldDefinition("x", FieldType("string", "", 0, "unboundedSequence"), "[1]"),
        FieldDefinition("x", FieldType("bool", "", 0, "fixedArray", 2), "[true]"),
        ConstantDefinition("x", "int8", ""),
    ],
)
def test_a_value_of_another_type_is_an_error(line):
    with pytest.raises(GenerationError, match=r"value .* of .x. "):
        assert code_of(line)


def test_the_targets_make_the_same_again(model, tmp_path):
    assert render(model) == render(model)
    command = [*warm.command(), "generate", str(tmp_path / "tug.xmi")]
    command += ["--target", "ros_interfaces", "--target", "declared_interfaces"]
    succeeded([*command, "-o", tmp_path / "out"])
    for path, text in render(model).items():
        assert (tmp_path / "out" / path).read_text(encoding="utf-8") == text


def test_messages_are_made_on_request_and_declared_packages_always():
    assert TARGET.is_on_request
    assert not DECLARED.is_on_request


def test_a_package_of_a_file_that_is_referred_to_is_not_made(tmp_path):
    start, end = SYSTEM.index("    <interfaces"), SYSTEM.index("</interfaces>")
    package = SYSTEM[start:end].replace(
        "    <interfaces", '<ros:InterfacePackage xmi:version="2.0"'
    )
    head = SYSTEM[SYSTEM.index(" xmlns:xmi") : SYSTEM.index(">\n  <system")]
    package = package.replace(' xmi:version="2.0"', f' xmi:version="2.0"{head}', 1)
    (tmp_path / "own.xmi").write_text(f"{package}</ros:InterfacePackage>", encoding="utf-8")
    node = """<nodes name="n"><publishers name="w" topic="w"><type href="own.xmi#Winch"/>
        </publishers></nodes>"""
    text = SYSTEM[:start] + node + SYSTEM[end + len("</interfaces>") :]
    assert render(model_in(tmp_path, text, "tug.xmi"), DECLARED) == {}


ROSIDL = """
import json, pathlib, sys
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_generator_py import generate_py
package, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
idl = out / "idl" / "msg"
idl.mkdir(parents=True)
names = []
for path in sorted(package.glob("msg/*.msg")):
    convert_msg_to_idl(package, package.name, path.relative_to(package), idl)
    names.append(path.stem)
arguments = {
    "package_name": package.name,
    "output_dir": str(out / package.name),
    "template_dir": str(pathlib.Path(sys.prefix, "share/rosidl_generator_py/resource")),
    "idl_tuples": [f"{out / 'idl'}:msg/{name}.idl" for name in names],
    "ros_interface_dependencies": [],
    "target_dependencies": [],
    "type_description_tuples": [],
}
(out / "arguments.json").write_text(json.dumps(arguments))
generate_py(str(out / "arguments.json"), [])
sys.path.insert(0, str(out))
module = __import__(f"{package.name}.msg", fromlist=names)
types = {name: getattr(module, name).get_fields_and_field_types() for name in names}
drum = module.ReportWinch.CLASS_VALUE_DRUM
report = module.ReportWinch(speed=0.5, has_speed=True, class_value=drum)
print(json.dumps({"types": types, "class": report.class_value}))
"""


@pytest.mark.needs("rosidl")
def test_rosidl_generates_classes(model, tmp_path):
    """The real generators of ROS make Python of a package, which then is imported."""
    for path, text in render(model).items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    command = [sys.executable, "-c", ROSIDL, str(tmp_path / "tug_jaus_msgs"), str(tmp_path / "py")]
    done = succeeded(command)
    made = json.loads(done.stdout.splitlines()[-1])
    assert made["types"]["ReportWinch"] == {
        "has_speed": "boolean",
        "speed": "double",
        "class_value": "uint8",
        "flags": "tug_jaus_msgs/ReportWinchFlags",
    }
    assert made["types"]["ReportWinchFlags"] == {"mode": "uint8", "rest": "uint16"}
    assert made["class"] == 2
