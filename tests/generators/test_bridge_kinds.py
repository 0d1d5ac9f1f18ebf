"""Generated bridges of models of all kinds: each kind of field and value, and odd names."""

import ast

import pytest
from for_each import for_each
from generated import model_in, text_of

from jausml.generation.errors import InternalError
from jausml.generation.rendering import render
from jausml.generation.target import system_of
from jausml_generators.bridge.checks.ends import Ends, Paths
from jausml_generators.bridge.checks.samples import sample_of
from jausml_generators.bridge.target import TARGET
from jausml_generators.bridge.views import BridgeView

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
    "units": "", "package": "demo_msgs", "type": "Thing", "documentation": "", "assignments": "",
    "name": "things", "direction": "jausToRos", "topic": "things", "extra": "",
}  # fmt: skip


def small(tmp_path, template=SYSTEM, **texts):
    return model_in(tmp_path, template.format(**{**DEFAULTS, **texts}), "small.xmi")


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
    inner = "".join(f"<arguments>{argument}</arguments>" for argument in arguments)
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
    base = text_of(model, [TARGET])
    literals = {n.value for n in ast.walk(ast.parse(base)) if isinstance(n, ast.Constant)}
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
    base = text_of(small(tmp_path, assignments=line, type="Mixed"), [TARGET])
    assert "from .ros_types import Mixed as DemoMsgsMixed\n" in base
    assert "def translate_things(self, source: Mixed) -> DemoMsgsMixed | None:" in base
    assert "target = DemoMsgsMixed()" in base


PATHS = ["pose", "pose.position.x", "pose.position.x", "poses", "covariance[3]", "covariance[30]"]


@for_each(
    ("path", "count"),
    [
        ("pose", 3),
        ("pose.position", 3),
        ("pose.position.x", 3),
        ("pose.position.x.y", 3),
        ("pose.orientation", 1),
        ("poses", 1),
        ("pos", 0),
        ("covariance", 2),
        ("covariance[3]", 1),
        ("covariance[4]", 0),
    ],
)
def test_paths_overlap_with_what_they_are_in_and_what_is_in_them(path, count):
    assert Paths(PATHS).overlapping(path) == count
