"""Rendered modules are finished piece by piece; what differs in a word alone, once."""

import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.generation.python import Imports, Modules, offered

HEAD = '"""About it."""\n\nfrom __future__ import annotations\n'
IMPORTS = Imports({**offered("nav_msgs.msg", "Odometry"), **offered(".messages", "ReportPose")})
TEST = '''

def test_{0}_of_some(bridge: Odometry) -> None:
    """Shows that 0x1E5, 1.0e5, f"{{x}}" and {0} stay."""
    source = ReportPose(1.0e5, x=0x1E5, text=f"{{bridge.{0}}} and {0}")
    target = bridge.translate_{0}(source, "{0}", bridge.{0}_frame_id, longer="than a line may be")
    assert f"a{0}b" "c" "d{0}_2" == {{"link_{0}": 'a"b"c', "in": ("x",)}}["link_{0}"], "of" "{0}x"
    assert target.{0}.x == source.e5.f.x{1} + 0x4403 + 0x0000, "0x4403"
'''
METHOD = '''
    def translate_{0}(self, source: ReportPose) -> Odometry | None:
        """From {0}."""
        {0}_2 = self.{0}.limit(source.x if source.x is not None else self.a_longer_name, self.{0})
        return Odometry({0}_2{1})
'''
CLASS = '\n\nclass Base:\n    """It."""\n'

# Names that may be parts of what stands around them, or look like other things than names.
words = st.one_of(
    st.sampled_from(["e5", "f", "rb", "x", "c1", "c12", "x_y", "of_some", "test", "source_", "j"]),
    st.from_regex(r"[a-z]{5,8}_[a-z0-9]{2,8}", fullmatch=True),
)


def module(names: list[str], ending: str = "") -> str:
    """Returns a module with a method and a test for each name."""
    methods = "".join(METHOD.format(name, ending) for name in names)
    tests = "".join(TEST.format(name, ending) for name in names)
    return f"{HEAD}{CLASS}{methods}{tests}"


@pytest.fixture
def parses(monkeypatch):
    """The texts that Python was asked to parse."""
    seen = []
    parse = ast.parse

    def noted(source, *arguments, **options):
        seen.append(source)
        return parse(source, *arguments, **options)

    monkeypatch.setattr(ast, "parse", noted)
    return seen


@given(st.lists(words, max_size=6, unique=True))
def test_words_change_nothing(names):
    text = module(names)
    expected = Modules().finished(text, IMPORTS)

    assert Modules().finished(text, IMPORTS, names) == expected
    assert Modules().finished(text, IMPORTS, names[:2]) == expected
    assert Modules().finished(text, IMPORTS, [*names, "ReportPose", "Odometry"]) == expected
    ast.parse(expected)


@given(st.lists(words, min_size=1, max_size=4, unique=True))
def test_what_is_kept_fits_what_comes_later(names):
    modules = Modules()
    for ending in ("", " + 1", ""):
        text = module(names, ending)
        assert modules.finished(text, IMPORTS, names) == Modules().finished(text, IMPORTS)


def test_pieces_that_differ_in_a_word_are_parsed_once(parses):
    modules = Modules()
    few = [f"c{number}" for number in range(10, 13)]
    many = [f"c{number}" for number in range(10, 90)]
    modules.finished(module(few), IMPORTS, few)
    once = len(parses)
    modules.finished(module(many), IMPORTS, many)

    # What stands before the methods has no word; the imports are parsed to be laid out.
    assert len(parses) - once <= 3
    assert once < 12


def test_pieces_that_differ_in_strings_are_parsed_once(parses):
    text = 'def test_{0}() -> None:\n    assert frame_of({0}) == "link_{1}"\n\n\n'
    names = [f"c{number}" for number in range(10, 90)]
    made = "".join(text.format(name, 150 - number) for number, name in enumerate(names))

    assert Modules().finished(made, None, names) == made
    assert len(parses) < 5


def test_pieces_that_differ_in_a_class_and_its_code_are_parsed_once(parses):
    text = (
        'def test_{0}(source: {1}) -> None:\n    """{1} ({2})."""\n    assert {1}.CODE == {2}\n\n\n'
    )
    numbers = range(10, 90)
    made = "".join(text.format(f"c{n}", f"Report{n}", f"0x60{n}") for n in numbers)
    words = [f"{name}{n}" for n in numbers for name in ("c", "Report")]

    assert Modules().finished(made, None, words) == made
    assert len(parses) < 5


def test_a_word_counts_in_attributes_of_anything(parses):
    text = "def make(bridge: object) -> object:\n    return bridge.{0}_speed\n\n\n"
    names = [f"c{number}" for number in range(10, 60)]
    Modules().finished("".join(text.format(name) for name in names), None, names)

    assert len(parses) < 5


def test_each_piece_is_parsed_once_and_again_where_it_was_broken(parses):
    names = ["one", "other"]
    Modules().finished(module(names), IMPORTS)

    whole = [parse for parse in parses if "translate_one" in parse and "translate_other" in parse]
    assert not whole
    assert len(parses) <= 2 * len(names) * 2 + 3


def test_statements_of_a_constructor_that_differ_in_a_word_are_parsed_once(parses):
    statement = """        self.{0} = Topics(
            "{0}",
            self.translate_{0},
        )
"""
    names = [f"c{number}" for number in range(10, 90)]
    made = "".join(statement.format(name) for name in names)
    text = f"class Base:\n    def __init__(self) -> None:\n{made}        self.last = 1\n"

    assert Modules().finished(text, None, names) == text
    assert len(parses) < 5


@pytest.mark.parametrize("quotes", ['"""', "'''"])
@pytest.mark.parametrize("looks", ["\ndef c1():\n    pass\n", "        self.c1 = C(\n        )\n"])
def test_what_looks_like_a_piece_in_a_string_is_none(quotes, looks):
    function = "\n\n\ndef c1():\n    pass\n"
    text = f"{HEAD}\n\nTEXT = {quotes}It says:\n{looks}{quotes}{function}"

    assert Modules().finished(text, Imports({}), ["c1"]) == text


def test_a_word_of_the_letters_that_stand_in_for_words_is_no_harm():
    for letter in "\u01c2\u01c0":
        text = f'{HEAD}\n\ndef c1({letter}):\n    return {letter}, "{letter}{letter}", "ab", 1\n'

        assert Modules().finished(text, Imports({}), ["c1"]) == text


def test_what_python_cannot_read_is_refused():
    with pytest.raises(SyntaxError):
        Modules().finished(f"{HEAD}\n\ndef c1():\n    return )\n", Imports({}), ["c1"])


def test_what_python_warns_of_is_refused():
    with pytest.raises(SyntaxError):
        Modules().finished(f'{HEAD}\n\nX = "\\d"\n', Imports({}))
