"""Each kind of JAUS attribute against each kind of ROS field: accepted maps can be generated."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from jausml.generation import GenerationError, load_targets
from jausml.validation.engine import validate

JAUS = {
    "scaled": '<fields xsi:type="jaus:FixedField" name="A" type="uint16">'
    '<scale lower="-1.0" upper="1.0"/></fields>',
    "integer": '<fields xsi:type="jaus:FixedField" name="A" type="int16"/>',
    "float": '<fields xsi:type="jaus:FixedField" name="A" type="float32"/>',
    "text": '<fields xsi:type="jaus:VariableLengthString" name="A"/>',
    "octets": '<fields xsi:type="jaus:VariableLengthField" name="A" format="JPEG"/>',
    "array": '<fields xsi:type="jaus:Array" name="A"><element xsi:type="jaus:FixedField" name="E"/>'
    "<dimensions>2</dimensions></fields>",
    "bits": '<fields xsi:type="jaus:BitField" name="A"><subFields name="S" lowBit="0" highBit="3"/>'
    "</fields>",
}
ROS = {
    "number": '<fields xsi:type="ros:PrimitiveField" name="a"/>',
    "integer": '<fields xsi:type="ros:PrimitiveField" name="a" type="int8"/>',
    "bool": '<fields xsi:type="ros:PrimitiveField" name="a" type="bool"/>',
    "byte": '<fields xsi:type="ros:PrimitiveField" name="a" type="byte"/>',
    "text": '<fields xsi:type="ros:PrimitiveField" name="a" type="string"/>',
    "octets": '<fields xsi:type="ros:PrimitiveField" name="a" type="uint8"'
    ' arrayKind="unboundedSequence"/>',
    "array": '<fields xsi:type="ros:PrimitiveField" name="a" arrayKind="fixedArray"'
    ' arraySize="2"/>',
    "message": '<fields xsi:type="ros:MessageField" name="a"><messageType'
    ' href="http://www.jausml.org/library/ros/geometry_msgs.xmi#Quaternion"/></fields>',
}
ACCEPTED = {
    *itertools.product(("scaled", "integer", "float"), ("number", "integer")),
    ("integer", "bool"),
    ("text", "text"),
    ("octets", "octets"),
}


def model(pairs):
    messages, types, maps, connections = [], [], [], []
    for number, (jaus, ros) in enumerate(pairs):
        name = f"{jaus}_{ros}"
        title = f"{jaus}{ros}".title()
        messages.append(
            f'<outputs xmi:id="m{number}" name="Report{title}" code="0x4F{number:02X}">'
            f'<body xsi:type="jaus:Record" name="rec">{JAUS[jaus]}</body></outputs>'
            f'<inputs name="Query{title}" code="0x2F{number:02X}"/>'
        )
        types.append(f'<messages xmi:id="t{number}" name="{title}">{ROS[ros]}</messages>')
        maps.append(
            f'<maps xmi:id="{name}" name="{name}" message="m{number}" type="t{number}">'
            '<toRos xsi:type="bridge:FieldAssignment" target="a" source="A"/>'
            '<toJaus xsi:type="bridge:FieldAssignment" target="A" source="a"/></maps>'
        )
        connections += [
            f'<bridgeConnections name="{name}" map="{name}" exchange="everyChangeEvent"'
            f' peers="sensor"><topics name="in/{name}"/></bridgeConnections>',
            f'<bridgeConnections name="{name}_out" map="{name}" direction="rosToJaus"'
            f' exchange="everyChangeEvent"><topics name="out/{name}"/></bridgeConnections>',
        ]
    return (
        '<system:System xmlns:xmi="http://www.omg.org/XMI" xmi:version="2.0"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:ros="http://www.jausml.org/ros/1.0"'
        ' xmlns:bridge="http://www.jausml.org/bridge/1.0"'
        ' xmlns:system="http://www.jausml.org/system/1.0" name="kinds"><serviceSets name="kinds">'
        f'<services xmi:id="S" name="Kinds" urn="urn:example:Kinds">{"".join(messages)}</services>'
        f'</serviceSets><interfaces name="kinds_interfaces">{"".join(types)}</interfaces>'
        '<components xmi:id="sensor" name="sensor" address="1.1.1" provides="S"/>'
        '<bridges name="kinds_bridge" address="1.1.2" provides="S">'
        f"{''.join(maps)}{''.join(connections)}</bridges></system:System>"
    )


def test_accepted_pairs(tmp_path):
    path = tmp_path / "model.xmi"
    pairs = list(itertools.product(JAUS, ROS))
    path.write_text(model(pairs), encoding="utf-8")
    findings = validate([path]).diagnostics
    assert {each.rule for each in findings} == {"JML412"}
    refused = {each.element.split("/")[2] for each in findings}
    assert {pair for pair in pairs if "_".join(pair) not in refused} == ACCEPTED


def test_accepted_pairs_are_generated(jausml, tmp_path, monkeypatch):
    try:
        load_targets()
    except GenerationError as error:
        pytest.skip(f"targets are not complete: {error}")
    monkeypatch.chdir(tmp_path)
    Path("model.xmi").write_text(model(sorted(ACCEPTED)), encoding="utf-8")
    result = jausml("--debug", "generate", "model.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
