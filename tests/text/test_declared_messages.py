"""Messages that nobody knows are declared: their place, code, types, limits and presence."""

# ruff: noqa: E501 -- a text stands on one line

import pytest

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.reading import declared_messages
from jausml.live.messages import load_catalogue


def declare(texts, members="", features="{ code: 0xD100 }", body="", name="Own"):
    result = texts.one(f"m {{ JAUS {name} ( {members} ) {features} ROS std_msgs/Float64 {body} }}")
    # The query of a report is given a code.
    assert [
        finding.message for finding in result.diagnostics if "'Query" not in finding.message
    ] == []
    found = result.model.instances(jaus.MessageDef, library=False)
    return next(message for message in found if message.name == name)


def field(texts, member):
    return declare(texts, member).body.fields[0]


def ros_field(texts, member):
    model = texts.good(f"m {{ JAUS ReportVelocityState ROS Own ( {member} ) }}")
    return model.instances(ros.MessageType, library=False)[0].fields[0]


@pytest.mark.parametrize(
    ("word", "wire"),
    [
        ("byte", "uint8"), ("int8", "int8"), ("uint64", "uint64"), ("float32", "float32"),
        ("`unsigned short integer`", "uint16"), ("`long integer`", "int64"), ("float", "float32"),
        ("`long float`", "float64"),
    ],
)  # fmt: skip
def test_numbers(texts, word, wire):
    found = field(texts, f"{word} a")
    assert (found.eClass.name, found.type.name, found.name) == ("FixedField", wire, "a")


def test_bool_is_a_byte_with_two_values(texts):
    found = field(texts, "bool a")
    assert found.type.name == "uint8"
    assert [(v.name, v.value) for v in found.values.values] == [("FALSE", 0), ("TRUE", 1)]


def test_strings_count_their_bytes(texts):
    bounded, free = declare(texts, "string<=20 a  string b").body.fields
    assert (bounded.countType.name, bounded.maximumLength) == ("uint8", 20)
    assert (free.countType.name, free.maximumLength) == ("uint16", 0)
    assert field(texts, "string<=300 a").countType.name == "uint16"


def test_limits_scale_integers_and_bound_reals(texts):
    scaled = field(texts, 'uint16 a { units: "meter" lower: -5 upper: 5 }')
    assert (scaled.units, scaled.scale.lower, scaled.scale.upper) == ("meter", -5.0, 5.0)
    real = field(texts, "float32 a { lower: 0 upper: 0x10 }")
    assert real.scale is None
    assert (real.values.values[0].lower, real.values.values[0].upper) == (0.0, 16.0)


@pytest.mark.parametrize(
    ("count", "width"), [(1, "uint8"), (8, "uint8"), (9, "uint16"), (33, "uint64")]
)
def test_optional_members_have_a_presence_vector(texts, count, width):
    members = " ".join(f"uint8 m{i} {{ optional: true }}" for i in range(count))
    body = declare(texts, f"{members} uint8 last").body
    assert body.presenceVector.name == width
    assert [member.optional for member in body.fields] == [True] * count + [False]


def test_arrays_and_lists(texts):
    array = field(texts, "uint8 [4] a")
    assert (array.eClass.name, list(array.dimensions)) == ("Array", [4])
    assert array.element.type.name == "uint8"
    many = field(texts, "struct [ uint8 x ] [<=9] a")
    assert (many.eClass.name, many.maximumCount, many.countType.name) == ("List", 9, "uint8")
    assert [member.name for member in many.element.fields] == ["x"]
    plain = field(texts, "uint8 [] a")
    assert [member.name for member in plain.element.fields] == ["value"]
    assert plain.countType.name == "uint16"


def test_what_is_said_of_a_list_is_not_said_of_its_elements(texts):
    members = "dot [2] a { optional: true }"
    text = f"m {{ JAUS Own ( {members} ) {{ code: 0xD100 }} ROS std_msgs/Float64 }}"
    model = texts.good(f"struct [ uint8 x ] dot\n{text}")
    (many,) = model.instances(jaus.List, library=False)
    assert (many.optional, many.element.optional) == (True, False)


def test_listing_a_declared_message_again_is_checked(texts):
    members = "uint8 [4] a  uint8 [] b  struct [ uint8 x ] [2] c  string<=9 d  bool e"
    ros = "ROS std_msgs/Float64"
    texts.good(
        f"m {{ JAUS Own ( {members} ) {{ code: 0xD100 }} {ros} }}\nn {{ JAUS Own ( {members} ) {ros} }}"
    )
    wrong = members.replace("[2]", "[3]").replace("bool e", "float32 e")
    found = texts.one(
        f"m {{ JAUS Own ( {members} ) {{ code: 0xD100 }} {ros} }}\nn {{ JAUS Own ( {wrong} ) {ros} }}"
    )
    assert [diagnostic.rule for diagnostic in found.diagnostics] == ["JML709", "JML709"]


def test_on_the_wire_structs_and_lists_follow_in_turn(texts):
    """The bytes were put together by hand: little endian, counts before lists and strings."""
    path = texts.write(
        "wire.ros2jaus",
        "m { JAUS Own ( uint16 a  struct [ uint8 b  int8 c ] d  uint8 [2] e  uint8 [] f  "
        "string<=9 g  bool h ) { code: 0xD100 } ROS std_msgs/Float64 }",
    )
    members = {
        "a": 0x0102, "d": {"b": 3, "c": -1}, "e": [4, 5], "f": [{"value": 6}, {"value": 7}],
        "g": "hi", "h": 1,
    }  # fmt: skip
    catalogue = load_catalogue([path], notations=NOTATIONS)
    data = catalogue.encode({"message": "Own", "fields": {"OwnRec": members}})
    assert data.hex() == "00d1020103ff04050200060702686901"


@pytest.mark.parametrize(
    ("name", "features", "body", "where"),
    [
        ("QueryOwn", "", "", "inputs"),
        ("SetOwn", "", "", "inputs"),
        ("ReportOwn", "", "ROS->JAUS ( data -> a )", "outputs"),
        ("Own", "isCommand: true", "", "inputs"),
        ("Own", "", "JAUS->ROS ( a -> data )", "outputs"),
        ("Own", "", "ROS->JAUS ( data -> a )", "inputs"),
    ],
)
def test_place_in_the_service(texts, name, features, body, where):
    found = declare(texts, "uint8 a", f"{{ code: 0xD100 {features} }}", body, name)
    assert found.eContainmentFeature().name == where
    assert found.eContainer().name == "Demo"


@pytest.mark.parametrize(("features", "inherited"), [("isCommand: true", "Management"), ("", None)])
def test_a_service_with_commands_inherits_management(texts, features, inherited):
    found = declare(texts, "uint8 a", f"{{ code: 0xD100 {features} }}", "", "SetOwn")
    parent = found.eContainer().inherits
    assert (parent and parent.name) == inherited
    assert parent is None or parent.version == "1.1"


def test_codes_are_assigned_in_order_and_skip_what_is_taken(texts):
    text = "\n".join(
        f"m{i} {{ JAUS Own{i} ( uint8 a ) {code} ROS std_msgs/Float64 }}"
        for i, code in enumerate(["", "{ code: 0xD000 }", "", "{ code: 0xD002 }", ""])
    )
    result = texts.one(text)
    codes = [m.code for m in result.model.instances(jaus.MessageDef, library=False)]
    assert codes == ["0xD001", "0xD000", "0xD003", "0xD002", "0xD004"]
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML711"] * 3
    assert "0xD001" in result.diagnostics[0].message


def test_codes_do_not_depend_on_what_else_is_read(texts):
    own = "m {{ JAUS {} ( uint8 a ) ROS std_msgs/Float64 }}"
    texts.write("one.ros2jaus", own.format("One"))
    texts.write("two.ros2jaus", own.format("Two"))
    texts.write("three.ros2jaus", 'import "one.ros2jaus"\n' + own.format("Three"))
    for names in (["one", "two", "three"], ["three", "two", "one"]):
        model = texts.read(*(f"{name}.ros2jaus" for name in names)).model
        codes = {m.name: m.code for m in model.instances(jaus.MessageDef, library=False)}
        assert codes == {"One": "0xD000", "Two": "0xD000", "Three": "0xD001"}


def test_imported_declarations_are_known(texts):
    texts.write(
        "one.ros2jaus", "m { JAUS Own ( uint8 a ) { code: 0xD100 } ROS OwnType ( uint8 a ) }"
    )
    model = texts.good(
        'import "one.ros2jaus"\nn { JAUS Own ( uint8 a ) ROS OwnType }', "two.ros2jaus"
    )
    assert len(model.instances(jaus.MessageDef, library=False)) == 1
    assert model.root.maps[0].type.eContainer().name == "one_interfaces"


def test_ros_types(texts):
    number = ros_field(texts, 'float32 a { units: "m" lower: 0 upper: 3 frame: forwardLeftUp }')
    assert (number.type.name, number.units, number.maximum) == ("float32", "m", 3.0)
    assert number.frame.name == "forwardLeftUp"
    text = ros_field(texts, "string<=9 [<=4] a")
    assert (text.stringBound, text.arrayKind.name, text.arraySize) == (9, "boundedSequence", 4)
    assert ros_field(texts, "uint8 [] a").arrayKind.name == "unboundedSequence"
    nested = ros_field(texts, "struct [ uint8 x ] [2] my_pose")
    assert (nested.messageType.name, nested.arraySize) == ("OwnMyPose", 2)
    assert ros_field(texts, "geometry_msgs/Pose a").messageType.name == "Pose"


def test_ros_type_of_a_package_of_its_own(texts):
    model = texts.good("m { JAUS ReportVelocityState ROS winch_msgs/State ( uint8 a ) }")
    own = model.instances(ros.InterfacePackage, library=False)
    assert [(p.name, p.messages[0].name) for p in own] == [("winch_msgs", "State")]


def test_documentation(texts):
    model = texts.good(
        "m {\n/** A state. */\nJAUS Own (\n/** Its length. */\nuint8 a ) { code: 0xD100 }\n"
        "ROS std_msgs/Float64 }"
    )
    [message] = model.instances(jaus.MessageDef, library=False)
    assert message.documentation == "A state."
    assert message.body.fields[0].documentation == "Its length."


FAULTS = {
    "type": "m { JAUS Own ( ⟦JML710⟧uint12 a ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "size": "m { JAUS Own ( ⟦JML712⟧uint8 [s] a uint8 b ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "zero": "m { JAUS Own ( ⟦JML712⟧uint8 [0] a uint8 b ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "twice": "m { JAUS Own ( uint8 a uint8 ⟦JML707⟧a ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "code": "m { JAUS Own ( uint8 a ) { code: ⟦JML107⟧D1 } ROS std_msgs/Float64 }",
    "feature": "m { JAUS ⟦JML711⟧Own ( uint8 a ) { ⟦JML103⟧cod: 0xD100 } ROS std_msgs/Float64 }",
    "member_feature": "m { JAUS Own ( uint8 a { ⟦JML103⟧unit: m } ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "circle": "struct [ b x ] a struct [ ⟦JML712⟧a x uint8 y ] b\n"
              "m { JAUS Own ( a x ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "bool": "m { JAUS Own ( bool a { ⟦JML712⟧upper: 2 } ) { code: 0xD100 } ROS std_msgs/Float64 }",
    "ros_optional": "m { JAUS ReportVelocityState ROS Own ( uint8 a { ⟦JML103⟧optional: true } ) }",
    "ros_type": "m { JAUS ReportVelocityState ROS Own ( ⟦JML215⟧uint12 a ) }",
    "unlisted": "m { JAUS ⟦JML215⟧Own ROS std_msgs/Float64 }",
    "qualified": "m { JAUS ⟦JML215⟧mobility.Own ( uint8 a ) ROS std_msgs/Float64 }",
    "array_of_arrays": "uint8 [2] pair\nm { JAUS ReportVelocityState ROS Own ( ⟦JML712⟧pair [2] a ) }",
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_fault(name, texts):
    texts.check(FAULTS[name])


def test_a_near_name_is_hinted_at(texts):
    text = "m { JAUS ReportVelocitySate ( uint8 a ) ROS std_msgs/Float64 }"
    query, finding = texts.one(text).diagnostics
    assert (query.rule, finding.rule) == ("JML711", "JML711")
    assert "QueryVelocitySate" in query.message
    assert "did you mean 'ReportVelocityState'" in finding.hint


def test_65_optional_members_are_too_many(texts):
    members = " ".join(f"uint8 m{i} {{ optional: true }}" for i in range(65))
    result = texts.one(f"m {{ JAUS Own ( {members} ) {{ code: 0xD100 }} ROS std_msgs/Float64 }}")
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML712"]


def test_types_that_unfold_without_end_are_bounded(texts):
    doubling = "".join(f"struct [ t{i} a  t{i} b ] t{i + 1}\n" for i in range(30))
    result = texts.one(
        f"struct [ uint8 a ] t0\n{doubling}m {{ JAUS X ( t30 a ) {{ code: 0xD100 }} ROS Y ( t30 a ) }}"
    )
    assert {diagnostic.rule for diagnostic in result.diagnostics} == {"JML712"}


REPORT = (
    "m { JAUS ReportWinch ( uint16 length ) ROS std_msgs/UInt16 ROS->JAUS ( data -> length ) }\n"
)


def messages_of(model):
    [service] = model.instances(jaus.Service, library=False)
    return {output.name: output.code for output in [*service.inputs, *service.outputs]}


def test_reports_get_their_query(texts):
    result = texts.one(REPORT)
    assert messages_of(result.model) == {"QueryWinch": "0xD001", "ReportWinch": "0xD000"}
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML711", "JML711"]
    bridge = "bridge b { address: 100.1.2 provides: Demo connection c { map: m topic t } }"
    assert not any(rule.startswith("JML42") for rule in texts.rules(REPORT + bridge))


def test_a_query_that_is_declared_is_no_second_one(texts):
    text = "ask { JAUS QueryWinch ( ) { code: 0xD000 } ROS std_msgs/Empty }\n" + REPORT
    assert messages_of(texts.one(text).model) == {"QueryWinch": "0xD000", "ReportWinch": "0xD001"}


def test_service_of_new_messages_has_the_name_that_the_text_gives_it(texts):
    text = """\
service Winch {
    inputs: new message_def QueryWinch { code: 0xD00A }
}
bridge b { address: 100.1.2  provides: Winch  connection c { map: m  topic t } }
"""
    for name in ("depot.ros2jaus", "depot2.ros2jaus"):
        model = texts.good(text + REPORT.replace("length )", "length ) { code: 0xD00B }", 1), name)
        [service] = model.instances(jaus.Service, library=False)
        assert (service.name, service.urn) == ("Winch", "urn:jausml:winch:Winch")
        assert messages_of(model) == {"QueryWinch": "0xD00A", "ReportWinch": "0xD00B"}


def test_name_of_the_service_after_another_file_is_explained(texts):
    result = texts.one(f"bridge b {{ address: 100.1.2 provides: Depot }}\n{REPORT}")
    [finding] = [diagnostic for diagnostic in result.diagnostics if diagnostic.rule == "JML215"]
    assert finding.hint == (
        "did you mean 'Demo'?; the messages of this file belong to 'Demo', named after the file: "
        "'service Depot' gives it a name that stays"
    )


def test_where_no_code_is_left_it_is_told(texts, monkeypatch):
    monkeypatch.setattr(declared_messages, "LAST_CODE", declared_messages.FIRST_CODE)
    text = "a { JAUS One ( uint8 x ) ROS std_msgs/Float64 }\nb { JAUS Two ( uint8 x ) ROS std_msgs/Float64 }"
    told = [
        finding for finding in texts.one(text).diagnostics if "no code is left" in finding.message
    ]
    assert [
        (diagnostic.rule, diagnostic.message, diagnostic.location.line) for diagnostic in told
    ] == [("JML712", "no code is left for the new message 'Two'", 2)]
