"""Filters keep model text data, whatever is in it, and lay code out as ruff's formatter does."""

import ast
import math
import re
import xml.etree.ElementTree as ET

import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st
from lupa import lua52, lua54

from jausml.generation import literals

HOSTILE = [
    '"""; import os; os.abort() #',
    "'''\n",
    "\\",
    '\\"',
    '"',
    "a\\\n",
    "x\r\ny\rz\u2028w\x85v",
    "\x00\x1b[31m\x7f",
    "\u202e\u2066txt",
    "{{ 7*7 }}{% raw %}",
    '"..os.execute("true").."',
    "]]--[[",
    "\x009",
    "-->--<!-- ]]>",
    "%s {0} $HOME `id`",
    "tab\there",
    "\U0001f600 \xff \ud800",
    "a" * 300,
    "-" * 7,
    "",
    "#\n#!x",
]

texts = st.one_of(
    st.sampled_from(HOSTILE),
    st.text(st.sampled_from("'\"\\\n\r\t -#<>&x{}\x00\u2028é😀"), max_size=60),
    st.text(max_size=60),
    st.text(st.characters(), max_size=400),
)
encodable = texts.map(lambda text: text.encode("utf-8", "replace").decode("utf-8"))


@given(texts)
def test_pystr_is_the_same_string_in_ascii_on_one_line(text):
    literal = literals.python_string(text)

    assert literal.isascii()
    assert "\n" not in literal
    assert ast.literal_eval(literal) == text


@pytest.mark.parametrize(
    "value",
    [None, True, False, 0, -7, 1e-9, 0.1, "it's", b"\x00it's\xff", b"", math.inf, -math.inf],
)
def test_pyliteral_evaluates_to_the_value(value):
    assert eval(literals.python_literal(value)) == value  # noqa: S307 - our own literal


def test_pyliteral_of_nan_and_of_other_types():
    assert math.isnan(eval(literals.python_literal(math.nan)))  # noqa: S307 - our own literal
    with pytest.raises(TypeError, match="no Python literal for object"):
        literals.python_literal(object())


@given(encodable, st.integers(0, 12))
def test_docstring_is_one_string_and_nothing_else(text, indent):
    margin = " " * indent
    literal = literals.model_docstring(text, indent)
    source = f"if True:\n{margin} {literal}\n"

    body = ast.parse(source).body[0].body

    assert len(body) == 1
    assert isinstance(body[0].value, ast.Constant)
    assert isinstance(body[0].value.value, str)
    assert not any(line != line.rstrip() for line in literal.split("\n"))


def test_docstring_keeps_words_and_paragraphs():
    text = 'Says "hi" to C:\\temp.\n\nSecond\nparagraph.'

    literal = literals.model_docstring(text, 4)

    assert literal == ('"""Says \'hi\' to C:/temp.\n\n    Second paragraph.\n    """')


def test_docstring_splits_a_long_first_paragraph_after_its_sentence():
    literal = literals.model_docstring("First. " + "word " * 30, 4)

    assert literal.startswith('"""First.\n\n    word word')
    assert max(map(len, literal.split("\n"))) <= 100


@given(encodable, st.integers(0, 12))
def test_comment_is_comments_only(text, indent):
    margin = " " * indent
    result = margin + literals.comment(text, indent)

    assert all(line.lstrip().startswith("#") for line in result.splitlines())
    assert ast.parse(result + "\n").body == []


@given(encodable)
def test_xml_text_comes_back_as_content_and_as_attribute(text):
    escaped = literals.xml_text(text)
    root = ET.fromstring(f"<a b=\"{escaped}\" c='{escaped}'>{escaped}</a>")  # noqa: S314 - ours

    shown = "".join(c if c in "\t\n\r" or c >= " " else "\ufffd" for c in text)
    shown = shown.replace("\ufffe", "\ufffd").replace("\uffff", "\ufffd")
    assert (root.text or "") == shown
    assert root.get("b") == root.get("c") == shown


@given(encodable)
def test_xmlcomment_stays_inside_its_comment(text):
    document = f"<a><!-- {literals.xml_comment(text)} --></a>"

    assert len(ET.fromstring(document)) == 0  # noqa: S314 - ours
    assert "\n" not in document


@given(encodable)
@example("\x7f\x80\x9f\U0001f600")
def test_yamlstr_comes_back_on_one_ascii_line(text):
    scalar = literals.yaml_string(text)

    assert scalar.isascii()
    assert "\n" not in scalar
    assert yaml.safe_load(f"key: {scalar}") == {"key": text}


@pytest.mark.parametrize(
    "name",
    ["", "1x", "a b", "x;import os", "class", "a.", "é", "a.None", "x\n", "__import__('os')"],
)
def test_ident_refuses_what_is_no_name(name):
    with pytest.raises(ValueError, match="is not a Python name"):
        literals.identifier(name)


def test_ident_returns_names_unchanged():
    assert literals.identifier("geometry_msgs.msg.Twist") == "geometry_msgs.msg.Twist"


@pytest.mark.parametrize(("value", "text"), [(1e22, "1e22"), (-2.5e-7, "-2.5e-07"), (1.0, "1.0")])
def test_floats_are_written_as_the_formatter_does(value, text):
    assert literals.python_literal(value) == text


LONG = "and says what the peer is to do with it when the time has come"


@pytest.mark.parametrize(
    ("text", "first", "others"),
    [
        (f"Takes a value. {LONG} {LONG}", "Takes a value.", f"{LONG} {LONG}."),
        (f"Takes a value; {LONG} {LONG}", "Takes a value.", f"{LONG[0].upper()}{LONG[1:]} {LONG}."),
        (f"Takes: one; {LONG} {LONG}", "Takes: one.", f"{LONG[0].upper()}{LONG[1:]} {LONG}."),
        (f"Takes one: two, {LONG} {LONG}", "Takes one.", f"Two, {LONG} {LONG}."),
        (f"Takes one, {LONG} {LONG}", "Takes one.", f"Takes one, {LONG} {LONG}."),
        (f"{LONG} {LONG}", f"{LONG} and says what the peer is to.", f"{LONG} {LONG}."),
        ("x" * 120, f"{'x' * 95}.", f"{'x' * 96}{'x' * 24}."),
    ],
)
def test_first_lines_end_with_a_thought(text, first, others):
    quoted, _, rest = literals.model_docstring(text, 0).removesuffix('"""').partition("\n")
    assert quoted.startswith(f'"""{first}'[:50])
    assert "..." not in quoted
    assert quoted.endswith(".")
    assert "".join(rest.split()) == "".join(others.split())
    assert len(quoted) <= 100


def unescaped(literal: str) -> str:
    """Returns the text of a Lua string, as its manual (3.1) says."""
    inside = re.sub(r"\\(\d{3})", lambda m: chr(int(m[1])), literal[1:-1])
    return inside.encode("latin-1").decode("utf-8")


@given(texts)
def test_a_string_of_lua_is_the_same_in_ascii_on_one_line(text):
    literal = literals.lua_string(text)

    assert re.fullmatch(r'"(?:[ !#-\[\]-~]|\\[0-9]{3})*"', literal)
    assert unescaped(literal) == re.sub("[\ud800-\udfff]", "\ufffd", text)


@pytest.mark.parametrize(
    ("value", "literal"),
    [
        (True, "true"),
        (-7, "-7"),
        (0.1, "0.1"),
        (float("-inf"), "-math.huge"),
        ([], "{}"),
        ([1, "a"], '{ 1, "a" }'),
        ({0: "off", "name": 1, "end": 2}, '{ [0] = "off", name = 1, ["end"] = 2 }'),
    ],
)
def test_values_become_lua(value, literal):
    assert literals.lua_literal(value) == literal


def test_a_long_table_of_lua_takes_a_line_for_each_item():
    text = literals.lua_literal({"fields": [{"name": "a" * 60}, {"name": "b" * 60}]})

    assert text.split("\n") == [
        "{",
        "    fields = {",
        f'        {{ name = "{"a" * 60}" }},',
        f'        {{ name = "{"b" * 60}" }},',
        "    },",
        "}",
    ]


def test_indented_tables_keep_to_the_line_width():
    item = {"name": "a" * 30, "filter": "b" * 25}
    value = {"fields": [{"fields": [{"fields": [item, item]}, item]}]}
    text = literals.lua_literal(value, 17)

    assert max(map(len, text.split("\n"))) <= 100
    assert text.count(f'{{ name = "{"a" * 30}", filter = "{"b" * 25}" }},') == 1


def test_other_values_are_none_of_lua():
    with pytest.raises(TypeError, match="no Lua literal for object"):
        literals.lua_literal([object()])


@pytest.mark.parametrize("lua", [lua52, lua54], ids=["5.2", "5.4"])
@given(text=texts)
def test_lua_itself_reads_the_same(lua, text):
    runtime = lua.LuaRuntime(encoding=None)
    read = runtime.eval(literals.lua_string(text).encode())

    assert read == text.encode("utf-16", "surrogatepass").decode("utf-16", "replace").encode()
