"""What is wrong with a definition is said with its place; what is right is read exactly."""

import pytest
from for_each import for_each

from jausml.language.interfaces import parse_definition
from jausml.language.interfaces.definitions import FieldType


def message(text):
    definition = parse_definition(text, "msg")
    assert definition.faults == []
    return definition.sections[0]


def fault(text, kind="msg"):
    (found,) = parse_definition(text, kind).faults
    return found


@for_each(
    ("line", "kind", "default"),
    [
        ("float64 x", FieldType("float64"), None),
        ("float64 x 1", FieldType("float64"), "1"),
        ("float64 x -1.5e-3  # real", FieldType("float64"), "-1.5e-3"),
        ("float64 x +.5", FieldType("float64"), "0.5"),
        ("float32[2] x [1., 007]", FieldType("float32", "", 0, "fixedArray", 2), "[1.0, 7.0]"),
        ("bool x True", FieldType("bool"), "true"),
        ("bool x 0", FieldType("bool"), "false"),
        ("uint8 x 0x1F", FieldType("uint8"), "31"),
        ("byte x 255", FieldType("byte"), "255"),
        ("char x 65", FieldType("char"), "65"),
        ("wstring x", FieldType("wstring"), None),
        ("string<=8 x", FieldType("string", string_bound=8), None),
        ("string<=8[<=3] x", FieldType("string", "", 8, "boundedSequence", 3), None),
        ('string x "a, b"', FieldType("string"), "a, b"),
        ("string x it's so", FieldType("string"), "it's so"),
        (r'string x "say \"hi\""', FieldType("string"), 'say "hi"'),
        ("string x ''", FieldType("string"), ""),
        ("float64[3] x [1, 2.5, -3]", FieldType("float64", "", 0, "fixedArray", 3), "[1, 2.5, -3]"),
        ("bool[] x [true, 0]", FieldType("bool", "", 0, "unboundedSequence"), "[true, false]"),
        ("int8[] x []", FieldType("int8", "", 0, "unboundedSequence"), "[]"),
        (
            "string[<=3] x [\"a, b\", 'c', d]",
            FieldType("string", "", 0, "boundedSequence", 3),
            '["a, b", "c", "d"]',
        ),
        (
            "string[] x [\" a \", ' b, ', '\"c\"']",
            FieldType("string", "", 0, "unboundedSequence"),
            '["a", "b,", "c"]',
        ),
        ("Point x", FieldType("Point"), None),
        (
            "geometry_msgs/Point[36] x",
            FieldType("Point", "geometry_msgs", 0, "fixedArray", 36),
            None,
        ),
        ("\tfloat64\tx\t# tabs", FieldType("float64"), None),
    ],
)
def test_field(line, kind, default):
    (field,) = message(line).fields
    assert (field.name, field.type, field.default) == ("x", kind, default)


@for_each(
    ("line", "kind", "name", "value"),
    [
        ("int8 A=-2", "int8", "A", "-2"),
        ("uint8 RESULT_OK = 0", "uint8", "RESULT_OK", "0"),
        ("float32 PI= 3.14", "float32", "PI", "3.14"),
        ("bool YES=1", "bool", "YES", "true"),
        ('string S="a = b"', "string", "S", "a = b"),
        ("string S=plain words", "string", "S", "plain words"),
        ("byte B2=0xff", "byte", "B2", "255"),
    ],
)
def test_constant(line, kind, name, value):
    (constant,) = message(line).constants
    assert (constant.type, constant.name, constant.value) == (kind, name, value)


def test_comments_belong_to_what_they_are_about():
    text = (
        "# About the winch.\n#   Two lines.\n\n"
        "# The speed\n# of the rope [m/s].\nfloat64 speed  # positive pulls\n"
        "    # and goes on\n\n"
        "float64 torque # [N*m]\n"
        "uint8 OK=0 # fine\n# left over\n"
    )
    section = message(text)
    assert section.comment == "About the winch.\n  Two lines."
    speed, torque = section.fields
    assert speed.comment == "The speed\nof the rope [m/s].\npositive pulls\nand goes on"
    assert (speed.units, torque.units) == ("m/s", "N*m")
    assert section.constants[0].comment == "fine"


def test_two_things_in_brackets_are_no_units():
    (field,) = message("float64 x # [0, 1] or [m] or [s]").fields
    assert field.units == ""


def test_sections_of_services_and_actions():
    text = "# Pulls.\nfloat64 length\n---\n# How it went.\nbool success\n---\nfloat64 done\n"
    definition = parse_definition(text, "action")
    assert definition.faults == []
    assert [section.comment for section in definition.sections] == ["Pulls.", "How it went.", ""]
    assert [section.line for section in definition.sections] == [1, 4, 7]
    names = [[field.name for field in section.fields] for section in definition.sections]
    assert names == [["length"], ["success"], ["done"]]


@for_each("text", ["", "\n\n", "# only a comment", "\ufeff# mark\r\n\r\n"])
def test_message_without_facts(text):
    section = message(text)
    assert not section.fields
    assert not section.constants


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_line_ends_and_byte_order_mark(ending):
    text = ending.join(["\ufeff# Head.", "", "float64 x 1.5 # one", "uint8 A=1", ""])
    section = message(text)
    assert section.comment == "Head."
    assert [(f.name, f.default, f.comment) for f in section.fields] == [("x", "1.5", "one")]
    assert [c.value for c in section.constants] == ["1"]


@for_each(
    ("text", "rule", "line", "column", "hint"),
    [
        ("what?", "JML643", 1, 1, "<type> <name>"),
        ("float64 a\n  float63 x", "JML644", 2, 3, "did you mean 'float64'?"),
        ("double x", "JML644", 1, 1, "did you mean 'float64'?"),
        ("time stamp", "JML644", 1, 1, "builtin_interfaces/Time"),
        ("geometry_msgs/msg/Point x", "JML644", 1, 1, "write geometry_msgs/Point"),
        ("Geometry/Point x", "JML644", 1, 1, ""),
        ("float64[0] x", "JML644", 1, 1, ""),
        ("float64[<=] x", "JML644", 1, 1, "[<=N]"),
        ("float64[3][3] x", "JML644", 1, 1, "[<=N]"),
        ("string<=0 x", "JML644", 1, 1, "string<=N"),
        ("int8<=4 x", "JML644", 1, 1, "[<=N]"),
        ("float64 frontLeft", "JML645", 1, 9, "lower case"),
        ("float64 a__b", "JML645", 1, 9, "lower case"),
        (f"float64 {'a' * 99}-", "JML645", 1, 9, "lower case"),
        ("uint8 ok=1", "JML645", 1, 7, "UPPER_CASE"),
        ('string s "a=b"', "JML645", 1, 8, "a default cannot hold one"),
        ("float64 x abc", "JML646", 1, 11, ""),
        ("float32 x -1e39", "JML646", 1, 11, ""),
        ("uint8 A=256", "JML646", 1, 9, ""),
        ("uint8 A =  0x100", "JML646", 1, 12, ""),
        ("bool x yes", "JML646", 1, 8, ""),
        ("bool x tru", "JML646", 1, 8, "did you mean 'true'?"),
        ("float64 x inf", "JML646", 1, 11, ""),
        ("float64 x 1e999", "JML646", 1, 11, ""),
        ("int32[2] x [1]", "JML646", 1, 12, ""),
        ("int32[<=1] x [1, 2]", "JML646", 1, 14, ""),
        ("int32[] x 1", "JML646", 1, 11, ""),
        ('string x "open', "JML646", 1, 10, ""),
        ('string x "a # b"', "JML646", 1, 10, ""),
        ('string x "a"b"', "JML646", 1, 10, ""),
        ("string<=2 x abc", "JML646", 1, 13, ""),
        ('string[] x ["a" "b"]', "JML646", 1, 12, ""),
        ("Point x 1", "JML646", 1, 9, ""),
        ("string<=4 S=a", "JML644", 1, 1, "primitive type without bounds"),
        ("Point P=1", "JML644", 1, 1, "primitive type without bounds"),
        ("float64 x\nfloat32 x", "JML647", 2, 9, ""),
        ("uint8 A=1\nuint8 A=2", "JML647", 2, 7, ""),
        ("float64 x # \x07", "JML642", 1, 13, ""),
        ("float64 x\n---\nfloat64 y", "JML649", 2, 1, ""),
    ],
)
def test_fault(text, rule, line, column, hint):
    found = fault(text)
    assert (found.rule, found.line, found.column) == (rule, line, column)
    assert hint in found.hint
    assert (hint == "") == (found.hint == "")


def test_sections_that_are_missing():
    assert fault("float64 x", "srv").rule == "JML649"
    assert fault("float64 x\n---\nfloat64 y", "action").rule == "JML649"


def test_all_faults_of_one_run():
    faults = parse_definition("what?\nfloat63 x\nfloat64 y\nuint8 A=300\n", "msg").faults
    pairs = [(finding.rule, finding.line) for finding in faults]
    assert pairs == [("JML643", 1), ("JML644", 2), ("JML646", 4)]
