"""Expressions in Python: that they compute what the expression language says."""

import math

import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.attributes.expressions import (
    FUNCTIONS,
    EvaluationError,
    evaluate,
    parse_expression,
)
from jausml.runtime.conversions import ConversionError, arithmetic
from jausml_generators.python.expressions import FormulaPrinter, python_expression
from jausml_generators.python.names import Scope


def python(text):
    return python_expression(parse_expression(text), {"x": "source.x", "y": "y"})


@for_each(
    ("text", "code"),
    [
        ("x * 2 + y", "source.x * 2.0 + y"),
        ("x * (2 + y)", "source.x * (2.0 + y)"),
        ("x - (y - 1)", "source.x - (y - 1.0)"),
        ("-x * -1", "-source.x * -1.0"),
        ("-(x + y)", "-(source.x + y)"),
        ("x / 2 ^ y", "arithmetic.divide(source.x, arithmetic.power(2.0, y))"),
        ("x < 1", "float(source.x < 1.0)"),
        ("if(x < 1, y, -y)", "y if source.x < 1.0 else -y"),
        ("1 + if(x, 1, 2)", "1.0 + (1.0 if source.x != 0 else 2.0)"),
        (
            "not (x < 1 or y) and isfinite(x)",
            "float(not (source.x < 1.0 or y != 0) and arithmetic.is_finite(source.x))",
        ),
        ("max(0, min(x, 1))", "arithmetic.greatest(0.0, arithmetic.least(source.x, 1.0))"),
        ("if(isfinite(x), 1, nan)", '1.0 if arithmetic.is_finite(source.x) else float("nan")'),
        ("(x < y) < 1", "float(float(source.x < y) < 1.0)"),
        # What linters would ask to be written otherwise.
        ("1 < x", "float(source.x > 1.0)"),
        ("not (1 == x)", "float(source.x != 1.0)"),
        ("not not (x < y)", "float(source.x < y)"),
        ("if(not x, 1, 0)", "1.0 if source.x == 0 else 0.0"),
        ("not (if(x, y, 1))", "float((y if source.x != 0 else 1.0) == 0)"),
        ("x and y or y", "float((source.x != 0 and y != 0) or y != 0)"),
        ("x or y or x", "float(source.x != 0 or y != 0 or source.x != 0)"),
        ("1 + -(-x)", "1.0 + source.x"),
    ],
)
def test_code(text, code):
    assert python(text) == code


def test_no_source():
    with pytest.raises(KeyError):
        python("z")


def test_a_choice_that_fits_a_line_once_its_conditions_have_names_is_one_line():
    steps, sources = [], {"x": 'self.up.clamp.single("j6", source.j6)'}
    expression = parse_expression("if(3 < x and not x == 7, 1 - x, -2)")
    assert FormulaPrinter(steps, Scope(), sources).code(expression) == "term"
    assert [step.place for step in steps] == ["term_2", "term_3", "term"]


LEAVES = st.sampled_from(["x", "y", "0", "1", "-2", "0.5", "3", "pi", "(nan + 0)", "inf"])
OPERATORS = ["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or"]


def _compound(inner):
    def call(name, arguments):
        return f"{name}({', '.join(arguments)})"

    calls = [
        st.builds(
            call,
            st.just(name),
            st.lists(inner, min_size=function.fewest, max_size=min(function.most, 3)),
        )
        for name, function in FUNCTIONS.items()
    ]
    return st.one_of(
        st.builds("({}) {} ({})".format, inner, st.sampled_from(OPERATORS), inner),
        st.builds("{} ({})".format, st.sampled_from(["-", "not"]), inner),
        st.builds("if({}, {}, {})".format, inner, inner, inner),
        *calls,
    )


VALUES = st.one_of(st.integers(-3, 3), st.floats(-10, 10), st.floats())


@given(st.recursive(LEAVES, _compound, max_leaves=8), VALUES, VALUES)
def test_python_agrees_with_the_language(text, x, y):
    expression = parse_expression(text)
    found = python_expression(expression, {"x": "x", "y": "y"})
    names = {"arithmetic": arithmetic}
    try:
        expected = evaluate(expression, {"x": x, "y": y})
    except EvaluationError:
        with pytest.raises(ConversionError):
            eval(found, {**names, "x": x, "y": y})  # noqa: S307 - written here
        return
    value = eval(found, {**names, "x": x, "y": y})  # noqa: S307 - written here
    assert value == expected or (math.isnan(value) and math.isnan(expected))
