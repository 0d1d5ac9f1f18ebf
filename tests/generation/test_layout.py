"""Rendered Python is laid out as ruff's formatter lays it out, which judges here."""

import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from scripts import succeeded
from sources import PACKAGES, modules_below

from jausml.generation.python import layout

LETTERS = "abcdefghijklmnopqrstuvwxyz"

names = st.builds(
    lambda letter, length: letter * length,
    st.sampled_from([letter for letter in LETTERS if letter not in "bfrtu"]),
    st.integers(2, 14),
)
paths = st.lists(names, min_size=1, max_size=3).map(".".join)
strings = st.text(LETTERS, max_size=30).map(lambda text: f'"{text}"')
numbers = st.integers(0, 10**9).map(str)
atoms = st.one_of(paths, strings, numbers)


def several(inner: st.SearchStrategy[str], least: int, most: int) -> st.SearchStrategy[str]:
    return st.lists(inner, min_size=least, max_size=most).map(", ".join)


def chains(inner: st.SearchStrategy[str], *signs: str) -> st.SearchStrategy[str]:
    return st.builds(
        lambda sign, operands: f" {sign} ".join(operands),
        st.sampled_from(signs),
        st.lists(inner, min_size=2, max_size=4),
    )


def larger(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    keyword = st.builds(lambda name, value: f"{name}={value}", names, inner)
    return st.one_of(
        st.builds(lambda name, given: f"{name}({given})", paths, several(inner, 0, 4)),
        st.builds(lambda name, given: f"{name}({given})", paths, several(keyword, 1, 3)),
        st.builds(lambda name, at: f"{name}[{at}]", paths, inner),
        several(inner, 0, 4).map(lambda items: f"[{items}]"),
        several(inner, 2, 4).map(lambda items: f"({items})"),
        inner.map(lambda item: f"({item},)"),
        several(st.builds(lambda k, v: f"{k}: {v}", strings, inner), 0, 3).map(
            lambda items: f"{{{items}}}"
        ),
        st.builds(lambda e, n, s: f"[{e} for {n} in {s}]", inner, names, paths),
        st.builds(lambda e, n, s, c: f"f({e} for {n} in {s} if {c})", inner, names, paths, atoms),
    )


def operations(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        inner,
        chains(inner, "and", "or"),
        chains(inner, "+", "-", "|"),
        chains(inner, "*"),
        st.builds(lambda a, s, b: f"{a} {s} {b}", inner, st.sampled_from(["==", "in", "<"]), inner),
        st.builds(lambda a, c, b: f"{a} if {c} else {b}", inner, inner, inner),
        st.builds(lambda a: f"not {a}", inner),
    )


values = operations(larger(operations(larger(atoms)) | atoms) | atoms)
parameters = st.lists(
    st.builds(lambda name, kind: f"{name}: {kind}", names, paths), max_size=4, unique=True
)
statements = st.one_of(
    st.builds(lambda place, value: f"{place} = {value}", paths, values),
    st.builds(lambda place, value: f"{place} += {value}", names, values),
    st.builds(lambda place, kind, value: f"{place}: {kind} = {value}", names, paths, values),
    values.map(lambda value: f"return {value}"),
    values.map(lambda value: f"assert {value}"),
    values.map(lambda value: f"if {value}:\n        pass"),
    st.builds(lambda name, text: f"raise {name}({text})", names, values),
    st.builds(lambda n, call, g: f"for {n} in {call}({g}):\n        pass", names, paths, values),
    st.builds(
        lambda name, given, kind: f"def {name}({', '.join(given)}) -> {kind}:\n        pass",
        names,
        parameters,
        paths,
    ),
)


def formatted(text: str) -> str:
    """Returns a text as ruff formats it."""
    options = ("--isolated", "--line-length=100", "--target-version=py310")
    ruff = Path(sys.executable).with_name("ruff")
    return succeeded([ruff, "format", *options, "-"], input=text).stdout


@settings(
    max_examples=10, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck)
)
@given(st.lists(statements, min_size=40, max_size=40))
def test_random_statements_are_laid_out_as_ruff_does(lines):
    text = "".join(f"def function():\n    {line}\n\n\n" for line in lines).rstrip("\n") + "\n"
    laid = layout(text)
    assert formatted(laid) == formatted(text)
    assert laid == formatted(laid)


@pytest.mark.parametrize("part", ["generation", "runtime", "language/text", "live"])
def test_what_ruff_has_formatted_stays(part):
    stays(PACKAGES["jausml"] / part)


def test_what_ruff_has_formatted_of_the_generators_stays():
    stays(PACKAGES["jausml_generators"])


def stays(folder: Path) -> None:
    for path in modules_below(folder):
        text = path.read_text("utf-8")
        assert layout(text) == text, path


def test_short_statements_stay_as_they_are():
    text = "x = {'a':1}\n\n\n\ny = f( x )\n"
    assert layout(text) == text


def test_what_is_no_python_stays_as_it_is():
    text = f"x = f({'a' * 60}, {'b' * 60}\n"
    assert layout(text) == text


def test_a_comment_with_no_room_behind_its_statement_stands_above():
    text = f"def f():\n    x = {'a' * 80}  # meter per second\n"
    assert layout(text) == f"def f():\n    # meter per second\n    x = {'a' * 80}\n"


def test_comments_and_long_strings_inside_a_statement_stay():
    text = f'x = f(\n    {"a" * 60},  # first\n    """{"b" * 60}\n    """, 1)\n'
    assert layout(text) == text


def test_a_comma_at_the_end_asks_for_a_line_for_each_item():
    assert layout("x = [\n    a, b,\n]\n") == "x = [\n    a,\n    b,\n]\n"


def test_a_lone_parameter_that_does_not_fit_has_a_comma():
    """A generated test of a machine with a long name once was longer than a line."""
    head, kind = "def test_" + "x" * 60, "way: tuple[tuple[str, int, str], ...]"
    laid = layout(f"{head}({kind}) -> None:\n    pass\n")
    assert laid == f"{head}(\n    {kind},\n) -> None:\n    pass\n"


def test_strings_that_follow_each_other_become_one_where_there_is_room():
    text = f'x = f(a={"a" * 50}, b=("one " "two"), c={"c" * 40})\n'
    assert layout(text) == formatted(text)


def test_a_broken_statement_that_fits_becomes_a_line():
    assert layout("x = f(\n    a,\n    b\n)\n") == "x = f(a, b)\n"


def test_f_strings_are_not_broken():
    piece = "{each.value!r:>{width}}" * 3
    text = f'x = function(f"{piece}", {"a" * 40}, {"b" * 20})\n'
    assert layout(text) == formatted(text)
    assert f'f"{piece}"' in layout(text)
