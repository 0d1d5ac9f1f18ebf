"""Each kind of JAUS attribute against each kind of ROS field: accepted maps can be generated."""

import functools
import itertools
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.language.model.diagnostics import Severity
from jausml.language.validation.engine import check_project

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
# Further kinds, with the paths to the values in them.
MORE_JAUS = {
    "listed": '<fields xsi:type="jaus:FixedField" name="A"><values>'
    '<values xsi:type="jaus:EnumeratedValue" name="OFF" value="0"/>'
    '<values xsi:type="jaus:EnumeratedValue" name="ON" value="1"/></values></fields>',
    "optional": '<fields xsi:type="jaus:FixedField" name="A" optional="true" type="uint16">'
    '<scale lower="-1.0" upper="1.0"/></fields>',
    "chosen": '<fields xsi:type="jaus:VariableField" name="A">'
    '<alternatives name="radian" index="0" type="uint16"><scale lower="-1.0" upper="1.0"/>'
    '</alternatives><alternatives name="count" index="1" type="uint8"/></fields>',
    "elements": '<fields xsi:type="jaus:List" name="A"><element xsi:type="jaus:Record" name="R">'
    '<fields xsi:type="jaus:FixedField" name="E" type="uint16"/></element></fields>',
    "option": '<fields xsi:type="jaus:Variant" name="A"><options xsi:type="jaus:Record" name="O">'
    '<fields xsi:type="jaus:FixedField" name="E" type="uint16"/></options></fields>',
}
MORE_ROS = {
    "single": '<fields xsi:type="ros:PrimitiveField" name="a" type="float32"/>',
    "short": '<fields xsi:type="ros:PrimitiveField" name="a" type="string" stringBound="9"/>',
    "sequence": '<fields xsi:type="ros:PrimitiveField" name="a" arrayKind="unboundedSequence"/>',
    "vectors": '<fields xsi:type="ros:MessageField" name="a" arrayKind="boundedSequence"'
    ' arraySize="9"><messageType href="http://www.jausml.org/library/ros/geometry_msgs.xmi#Vector3"/>'
    "</fields>",
}
JAUS_PATHS = {
    "array": "A[1]",
    "bits": "A.S",
    "chosen": "A.radian",
    "elements": "A[1].E",
    "option": "A.O.E",
}
ROS_PATHS = {"array": "a[1]", "message": "a.x", "sequence": "a[1]", "vectors": "a[1].x"}
ACCEPTED = {
    *itertools.product(("scaled", "integer", "float"), ("number", "integer", "byte")),
    ("integer", "bool"),
    ("text", "text"),
    ("octets", "octets"),
    ("array", "array"),
}


def field(feature, target, source, inner="", **features):
    attributes = "".join(f' {name}="{value}"' for name, value in features.items())
    return (
        f'<{feature} xsi:type="bridge:FieldAssignment" target="{target}" source="{source}"'
        f"{attributes}>{inner}</{feature}>"
    )


def both(jaus, ros, inner="", **features):
    return field("toRos", ros, jaus, inner, **features) + field(
        "toJaus", jaus, ros, inner, **features
    )


def copied(jaus="A", ros="a"):
    return both(jaus, ros)


def converted(kind, inner="", **features):
    attributes = "".join(f' {name}="{value}"' for name, value in features.items())
    return lambda jaus, ros: both(
        jaus, ros, f'<conversions kind="{kind}"{attributes}>{inner}</conversions>'
    )


def tabled(jaus, ros):
    table = '<tables name="t"><entries jaus="0" ros="0"/><entries jaus="1" ros="1"/></tables>'
    used = '<conversions kind="look_up" table="{here}/@tables.0"/>'
    return table + both(jaus, ros, used)


def with_default(jaus, ros):
    return both(jaus, ros, whenAbsent="useDefault", defaultValue="1")


def with_last(jaus, ros):
    return both(jaus, ros, whenAbsent="lastValue")


def constant(jaus, ros):
    features = (("toRos", ros), ("toJaus", jaus))
    return "".join(
        f'<{feature} xsi:type="bridge:ConstantAssignment" target="{path}" value="1"/>'
        for feature, path in features
    )


def each_element(jaus, ros):
    """The lists at the ends of two paths, element by element."""
    (jaus_list, _, jaus_member), (ros_list, _, ros_member) = (
        path.partition("[1]") for path in (jaus, ros)
    )
    jaus_end, ros_end = jaus_member.strip(".") or ".", ros_member.strip(".") or "."
    return "".join(
        f'<{feature} xsi:type="bridge:ListAssignment" target="{target}" source="{source}">'
        f"{field('assignments', inner_target, inner_source)}</{feature}>"
        for feature, target, source, inner_target, inner_source in (
            ("toRos", ros_list, jaus_list, ros_end, jaus_end),
            ("toJaus", jaus_list, ros_list, jaus_end, ros_end),
        )
    )


CONSTRUCTS = {
    "copied": copied,
    "scaled": converted("scale", "<arguments>-2</arguments>"),
    "expression": converted("expression", expression="if(value &gt; 0, value, 0)"),
    "user": converted("user", method="mine"),
    "tabled": tabled,
    "default": with_default,
    "last": with_last,
    "constant": constant,
    "each": each_element,
}


def model(pairs, assigned=copied, suffix=""):
    messages, types, maps, connections = [], [], [], []
    for number, (jaus, ros) in enumerate(pairs):
        name = f"{jaus}_{ros}{suffix}"
        title = f"{jaus}{ros}".title()
        jaus_field, ros_field = {**JAUS, **MORE_JAUS}[jaus], {**ROS, **MORE_ROS}[ros]
        messages.append(
            f'<outputs xmi:id="m{number}" name="Report{title}" code="0x{0x4000 + number:04X}">'
            f"{in_body(jaus_field)}</outputs>"
            f'<inputs name="Query{title}" code="0x{0x2000 + number:04X}"/>'
        )
        types.append(f'<messages xmi:id="t{number}" name="{title}">{ros_field}</messages>')
        here = f"//@bridges.0/@maps.{number}"
        content = assigned(JAUS_PATHS.get(jaus, "A"), ROS_PATHS.get(ros, "a"))
        content = content.replace("{here}", here)
        maps.append(
            f'<maps xmi:id="{name}" name="{name}" message="m{number}" type="t{number}">'
            f"{content}</maps>"
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
        '<components xmi:id="sensor" name="sensor" address="1.1.1" provides="S"'
        ' coreServices="none"/>'
        '<bridges name="kinds_bridge" address="1.1.2" provides="S" coreServices="none">'
        f"{''.join(maps)}{''.join(connections)}</bridges></system:System>"
    )


def in_body(jaus_field):
    is_container = 'type="jaus:List"' in jaus_field or 'type="jaus:Variant"' in jaus_field
    body = "Sequence" if is_container else "Record"
    vector = ' presenceVector="uint8"' if "optional" in jaus_field else ""
    return f'<body xsi:type="jaus:{body}" name="rec"{vector}>{jaus_field}</body>'


def accepted(path, pairs, assigned, suffix=""):
    path.write_text(model(pairs, assigned, suffix), encoding="utf-8")
    errors = [
        diagnostic
        for diagnostic in check_project([path]).diagnostics
        if diagnostic.severity is Severity.ERROR
    ]
    refused = {error.element.split("/")[2] for error in errors if "/" in error.element}
    return {pair for pair in pairs if "_".join(pair) + suffix not in refused}, errors


def test_accepted_pairs(tmp_path):
    pairs = list(itertools.product(JAUS, ROS))
    found, errors = accepted(tmp_path / "model.xmi", pairs, lambda *_: copied())
    assert {error.rule for error in errors} == {"JML412"}
    assert found == ACCEPTED


def fifth(start):
    return (
        (jaus, ros)
        for row, jaus in enumerate({**JAUS, **MORE_JAUS}, start)
        for column, ros in enumerate({**ROS, **MORE_ROS})
        if (row + column) % 5 == 0
    )


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", sweep(CONSTRUCTS, every=4))
def test_what_is_accepted_is_generated(name, jausml):
    """Each construct between all kinds of values: validation and generation agree."""
    # A fifth of the pairs for each construct: all kinds with all constructs, and all pairs. Lists
    # go to lists alone, so that some of them must be there.
    pairs = list({("elements", "vectors"): 0, **dict.fromkeys(fifth(list(CONSTRUCTS).index(name)))})
    kept, _ = accepted(Path("all.xmi"), pairs, CONSTRUCTS[name])
    assert kept
    Path("model.xmi").write_text(model(sorted(kept), CONSTRUCTS[name]), encoding="utf-8")
    result = jausml("--debug", "generate", "model.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
    for path in Path("out").rglob("*.py"):
        compiles(path.read_text(encoding="utf-8"))


@functools.cache
def compiles(text):
    """The runtime is the same in each workspace."""
    compile(text, "generated.py", "exec")


@pytest.mark.usefixtures("here")
def test_accepted_pairs_are_generated(jausml):
    Path("model.xmi").write_text(model(sorted(ACCEPTED)), encoding="utf-8")
    result = jausml("--debug", "generate", "model.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
