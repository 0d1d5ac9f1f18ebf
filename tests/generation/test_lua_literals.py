"""Model text stays data in a Lua file."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lupa import lua52, lua54

from jausml.generation.literals import lua_literal, lua_string

HOSTILE = ['"', "\\", "\\\n", "]]--[[", '"..os.execute("true").."', "\x00", "9", "\u202e", "\ud800"]
texts = st.one_of(st.sampled_from(HOSTILE), st.text(st.characters(), max_size=200))


def unescaped(literal: str) -> str:
    """Returns the text of a Lua string, as its manual (3.1) says."""
    inside = re.sub(r"\\(\d{3})", lambda m: chr(int(m[1])), literal[1:-1])
    return inside.encode("latin-1").decode("utf-8")


@given(texts)
def test_a_string_is_the_same_in_ascii_on_one_line(text):
    literal = lua_string(text)

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
    assert lua_literal(value) == literal


def test_a_long_table_takes_a_line_for_each_item():
    text = lua_literal({"fields": [{"name": "a" * 60}, {"name": "b" * 60}]})

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
    text = lua_literal(value, 17)

    assert max(map(len, text.split("\n"))) <= 100
    assert text.count(f'{{ name = "{"a" * 30}", filter = "{"b" * 25}" }},') == 1


def test_other_values_are_refused():
    with pytest.raises(TypeError, match="no Lua literal for object"):
        lua_literal([object()])


@pytest.mark.parametrize("lua", [lua52, lua54], ids=["5.2", "5.4"])
@given(text=texts)
def test_lua_itself_reads_the_same(lua, text):
    runtime = lua.LuaRuntime(encoding=None)
    read = runtime.eval(lua_string(text).encode())

    assert read == text.encode("utf-16", "surrogatepass").decode("utf-16", "replace").encode()
