"""The parser of ros2jaus text: all faults in one run, located, and never an exception."""

import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from for_each import for_each
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.language.text.keywords import KEYWORDS
from jausml.language.text.reading.parsing import MOST_FAULTS, parse
from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.tree import DEEPEST, LONGEST, Direction, Element, Member, Span
from jausml.language.text.writing.layout import lay_out

# Figure 5 of the paper, as it stands.
FIGURE_5 = """\
struct [
  type name
]
array_type [s] name

MessageName {
  JAUS jausname ( type membername  type secondmembername )
  ROS rosname ( type membername2  type secondmembername2 )
  JAUS->ROS ( membername -> membername2  secondmembername -> secondmembername2 )
  ROS->JAUS ( membername2 -> membername  secondmembername2 -> secondmembername )
}
"""


def faults(text):
    found = parse(text).faults
    return [f"{fault.span.line}:{fault.span.column}: {fault.message}" for fault in found]


def names(items):
    return [item.text for item in items]


def test_figure_5_of_the_paper():
    parsed = parse(FIGURE_5)
    assert parsed.faults == []
    struct, array, message = parsed.document.items
    assert (struct.name, array.size, array.name.text) == (None, "s", "name")
    assert message.name.text == "MessageName"
    jaus, ros, to_ros, to_jaus = message.items
    assert (jaus.is_jaus, jaus.type.text) == (True, "jausname")
    assert [member.name.text for member in ros.members] == ["membername2", "secondmembername2"]
    assert to_ros.to_ros
    assert not to_jaus.to_ros
    assert [
        (names(assignment.sources), names(assignment.targets)) for assignment in to_jaus.assignments
    ] == [(["membername2"], ["membername"]), (["secondmembername2"], ["secondmembername"])]


def test_members_of_all_shapes():
    text = """m { JAUS W ( uint16 length uint8 [4] codes uint8[4] more string<=20 note
        struct [ float32 x ] pose  float64 [] all  int8 [<=3] few { optional: true } )
        { code: 1 } }"""
    (element,) = parse(text).document.items
    (end,) = element.items
    sizes = {member.name.text: member.size for member in end.members if member.size}
    assert sizes == {"codes": "4", "more": "4", "all": "*", "few": "<=3"}
    assert end.members[3].type.text == "string<=20"
    assert isinstance(end.members[4].type, list)
    assert [feature.name.text for feature in end.features] == ["code"]


def test_a_struct_is_named_on_the_line_of_its_bracket():
    named, other = parse("struct [ int8 x ] pose\ngear [2] x").document.items
    assert (named.name.text, other.name.text) == ("pose", "x")
    bare, element = parse("struct [ int8 x ]\npose { }").document.items
    assert isinstance(bare, Member)
    assert bare.name is None
    assert isinstance(element, Element)


def test_keywords_are_features_before_a_colon():
    (element,) = parse("c { table: gear clock: 1 }").document.items
    assert [item.name.text for item in element.items] == ["table", "clock"]


def test_spans():
    (element,) = parse("\n  bridge `a b` {\n}").document.items
    assert element.span == Span(2, 3, 3, 2)
    assert element.name.span == Span(2, 10, 2, 15)


@for_each(
    ("text", "fault", "hint"),
    [
        ("m { JAUS->ROS ( speed } }", "expected '->' or ',' behind 'speed', found '}'", ""),
        ("bridge b { rate 25 }", "expected ':', '{', '[' or a name behind 'rate', found '25'", ""),
        ("x { rate = 25 }", "expected ", "a feature is written 'rate: ...'"),
        ("m { JAUS->ROS ( a = b ) }", "expected ", "an assignment is written 'source -> target'"),
        ("m { JAUS->ROS ( a -> b, c -> d ) }", "expected ", "no comma stands between assignments"),
        ("x { a: table }", "expected a value", "as a name it stands in back quotes: `table`"),
        ("m { JASU X ( int8 x ) }", "expected ", "did you mean 'JAUS'?"),
        ("m {", "expected an item or '}'", "the '{' of line 1 is not closed"),
        ("}", "expected an item, found '}'", ""),
        ('a: "b', "the text is not closed on its line", "a line break is written \\n"),
        ("/* a", "the comment is not closed", "it ends with '*/'"),
        ("a: `b", "the name in back quotes is not closed on its line", ""),
        ("a: 3d", "'3d' is no number", "a name that begins with a digit stands in back quotes"),
        ("a: my-robot", "nothing is written with '-' here", "back quotes"),
        ("m { JAUS->ROS ( a → b ) }", "nothing is written with '→' here", "write '->'"),
        ("# no", "nothing is written with '#' here", "comments begin with '//'"),
        ('a: "\\x"', "'\\x' is no escape", "\\uXXXX"),
        ('a: "\\ud800"', "'\\ud800' is no escape", ""),
        ("\0", "nothing is written with 'U+0000' here", ""),
    ],
)
def test_faults_say_what_was_expected(text, fault, hint):
    first = parse(text).faults[0]
    assert first.message.startswith(fault)
    assert hint in first.hint


def test_all_faults_of_a_text_in_one_run_and_all_the_rest_is_understood():
    text = """\
front
bridge b {
    rate 25
    frequency: 10
    connection c { map: velocity  topic t { } }
}
velocity {
    JAUS ReportVelocityState (
    ROS nav_msgs/Odometry
    JAUS->ROS (
        Velocity_X -> twist.twist.linear.x : scale(0.5
        Velocity_Y -> : negate
        Velocity_Z -> twist.twist.linear.z
    }
    vector v JAUS->ROS ( Yaw = 0 )
    table gear ( A <-> 0 )
}
node last { }
"""
    assert [fault.partition(": ")[0] for fault in faults(text)] == [
        "1:1",  # a word by itself
        "3:10",  # a colon
        "9:5",  # a bracket
        "12:9",  # a bracket
        "12:23",  # a target
        "14:5",  # a bracket of another kind
        "15:34",  # what is to be expected
    ]
    items = parse(text).document.items
    assert [item.name.text for item in items] == ["b", "velocity", "last"]
    assert [type(item).__name__ for item in items[1].items] == ["End", "End", "Direction", "Table"]


def test_elements_need_no_block():
    (bridge,) = parse(
        "bridge b { a: x topic /odom topic cmd { } topic\n odom\n rate: 5 }"
    ).document.items
    kinds = [type(item).__name__ for item in bridge.items]
    assert kinds == ["Feature", "Element", "Element", "Element", "Feature"]
    assert [item.name.text for item in bridge.items] == ["a", "/odom", "cmd", "odom", "rate"]
    assert lay_out(parse("topic cmd { }\ntopic b { // Why.\n}").document) == (
        "topic cmd\ntopic b {\n    // Why.\n}\n"
    )


@for_each(
    ("text", "place", "pair"),
    [
        ("b { provides: A B\n connection a { } }", "1:17", "'A' and 'B'"),
        ("b { provides: A B }", "1:17", "'A' and 'B'"),
        ("b { provides: A\n    B\n rate: 5 }", "2:5", "'A' and 'B'"),
        ("b { provides: A B, C\n rate: 5 }", "1:17", "'A' and 'B'"),
        ("b { provides: A, B C rate: 5 }", "1:20", "'B' and 'C'"),
        ("b { arguments: 1 2 }", "1:18", "'1' and '2'"),
        ('b { names: "a" "b" }', "1:16", '"a" and "b"'),
        ("m { ROS->JAUS ( a -> b : negate scale(2) c -> d ) }", "1:33", "'negate' and 'scale'"),
    ],
)
def test_missing_comma_is_reported_at_its_place_with_the_cure(text, place, pair):
    [fault] = parse(text).faults
    assert f"{fault.span.line}:{fault.span.column}" == place
    assert fault.hint == f"write a comma between {pair}"


@for_each(
    "text",
    [
        "b { a: x qos { } }",
        "b { a: x\n component\n y { } }",
        "b { a: x Position [3] p }",
        "m { JAUS->ROS ( a -> b : negate c, d -> e : negate f -> g ) }",
        'm { JAUS->ROS ( a -> b : negate "odom" -> e ) }',
        "m { a: x JAUS A ROS B }",
        "b { a: x; c: y }",
    ],
)
def test_no_comma_is_missed_where_an_item_begins(text):
    assert parse(text).faults == []


def test_a_fault_leaves_its_neighbours_alone():
    text = "m { JAUS->ROS (\n a -> b\n c ->\n d -> e : scale(1\n f -> g\n) a: 1\n}\nn { }"
    document = parse(text).document
    element, last = document.items
    direction, feature = element.items
    assert isinstance(direction, Direction)
    assert direction.assignments[0].sources[0].text == "a"
    assert direction.assignments[-1].sources[0].text == "f"
    assert feature.name.text == "a"
    assert last.name.text == "n"


def test_missing_brackets_are_added_and_surplus_ones_left_out():
    assert faults("m { JAUS->ROS ( a -> b }\nn { ) }") == [
        "1:24: expected an assignment or ')' behind 'b', found '}'",
        "2:5: expected an item or '}' behind '{', found ')'",
    ]
    items = parse("m { JAUS->ROS ( a -> b }\nn { ) }").document.items
    assert [item.name.text for item in items] == ["m", "n"]
    assert len(items[0].items[0].assignments) == 1


@pytest.mark.parametrize("text", ["struct [ uint8 x ]\n}", "struct [ uint8 x ] )"])
def test_a_surplus_bracket_behind_a_struct_is_left_out(text):
    parsed = parse(text)

    assert len(parsed.faults) == 1
    assert parsed.document.items == parse(text[:-1]).document.items


def test_a_broken_item_at_the_end_of_a_whole_one_keeps_that():
    (element,) = parse("m { } )").document.items
    assert element.name.text == "m"


def test_nesting_is_bounded():
    deep = "m { " * (DEEPEST + 1)
    assert "nested more than" in faults(deep)[-1]
    assert faults("m { " * DEEPEST + "}" * DEEPEST) == []
    # The tree of what is too deep can still be walked.
    assert parse("x { a: { " * 5000).document.items


def test_faults_and_length_are_bounded():
    assert len(faults("x\n:\n" * 500)) == MOST_FAULTS + 1
    assert faults(" " * (LONGEST + 1)) == [f"1:1: the text is longer than {LONGEST:,} characters"]


def test_marks_and_line_ends_of_other_systems():
    assert parse("\ufeffnode a {\r\n}\r\n").faults == []
    assert faults("\ufeffnode a\r\n\r\nb").count("3:1") == 0


@settings(max_examples=60)
@given(
    st.text(max_size=60)
    | st.lists(
        st.sampled_from([*"{}()[]:,;a1\n", "->", "<->", "=>", *KEYWORDS, '"t"', "/*"]), max_size=30
    ).map(" ".join)
)
def test_it_never_raises_and_places_each_fault_in_the_text(text):
    parsed = parse(text)
    lines = with_line_feeds(text.removeprefix("\ufeff")).split("\n")
    for fault in parsed.faults:
        assert fault.message
        assert 1 <= fault.span.line <= len(lines)
        assert 1 <= fault.span.column <= len(lines[fault.span.line - 1]) + 1


@settings(max_examples=60)
@given(st.integers(0, len(FIGURE_5) - 1), st.sampled_from(["", "{", ")", "->", "x", '"']))
def test_a_text_broken_anywhere_still_yields_a_tree(position, put):
    broken = FIGURE_5[:position] + put + FIGURE_5[position + 1 :]
    assert parse(broken).document is not None


def test_the_texts_of_the_language_page():
    page = Path(__file__).parents[2] / "docs" / "ros2jaus.md"
    text = re.sub("^```.*?^```", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    blocks = re.findall(r"(?:^ {4}.*\n|^\n)+", text, re.MULTILINE)
    texts = [textwrap.dedent(block).strip() for block in blocks if block.strip()]
    example, *_, members, structs, wholes, _ = texts
    for text in (example, f"m {{ {members} }}", structs, f"{structs}\n{wholes}"):
        assert faults(text) == []
    assert example.startswith("import ")
    assert members.startswith("JAUS ")
    assert structs.startswith("struct ")


def test_who_reads_no_text_does_not_wait_for_the_parser():
    model = Path(__file__).parents[2] / "models" / "minimal" / "minimal.xmi"
    code = (
        "import sys; from click.testing import CliRunner; from jausml.cli import main; "
        f"print(CliRunner().invoke(main, ['validate', {str(model)!r}]).exit_code); "
        "print([each for each in ('lark', 'pygls') if each in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout.split("\n")[:2] == ["0", "[]"]
