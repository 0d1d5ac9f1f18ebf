"""Expressions: their grammar, their values, bounds that hold, and what is refused."""

import math

import pytest
from for_each import for_each
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.language.attributes.expressions import (
    DEEPEST,
    FUNCTIONS,
    LONGEST,
    Call,
    Conditional,
    EvaluationError,
    ExpressionError,
    Number,
    Operation,
    Variable,
    evaluate,
    interval,
    parse_expression,
    source_names,
    variables,
)

INF = math.inf


def value(text, **values):
    return evaluate(parse_expression(text), values)


# --------------------------------------------------------------- what texts mean


@for_each(
    ("text", "expected"),
    [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("8 - 4 - 2", 2.0),
        ("16 / 4 / 2", 2.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("-2 ^ 2", -4.0),
        ("(-2) ^ 2", 4.0),
        ("2 ^ -1", 0.5),
        ("2 * -3", -6.0),
        ("--5", 5.0),
        (".5 + 1e2 + 3.", 103.5),
        ("pi", math.pi),
        ("1 < 2", 1.0),
        ("2 <= 1", 0.0),
        ("2 > 1", 1.0),
        ("2 >= 3", 0.0),
        ("2 == 2.0", 1.0),
        ("2 != 2", 0.0),
        ("1 < 2 and 3 < 2", 0.0),
        ("1 < 2 or 3 < 2", 1.0),
        ("not 1 < 2", 0.0),
        ("not 0 and 0", 0.0),
        ("0 and 0 or 1", 1.0),
        ("1 + 1 < 1 * 3", 1.0),
        ("if(2 > 1, 10, 20)", 10.0),
        ("if(0, 10, 20)", 20.0),
        ("sin(pi / 2)", 1.0),
        ("cos(0)", 1.0),
        ("tan(0)", 0.0),
        ("asin(1)", math.pi / 2),
        ("acos(1)", 0.0),
        ("atan(1)", math.pi / 4),
        ("atan2(1, -1)", 3 * math.pi / 4),
        ("sqrt(9)", 3.0),
        ("abs(-2)", 2.0),
        ("min(3, 1, 2)", 1.0),
        ("max(3, 1, 2)", 3.0),
        ("floor(-1.5)", -2.0),
        ("ceil(-1.5)", -1.0),
        ("round(2.5)", 2.0),
        ("round(3.5)", 4.0),
        ("sign(-7)", -1.0),
        ("sign(0)", 0.0),
        ("hypot(3, 4)", 5.0),
        ("fmod(-7, 3)", -1.0),
        ("fmod(5, 3)", 2.0),
        ("remainder(5, 3)", -1.0),
        ("remainder(6, 4)", -2.0),
        ("isfinite(1)", 1.0),
        ("isfinite(nan)", 0.0),
        ("isfinite(-inf)", 0.0),
        ("-inf", -INF),
    ],
    ids=lambda pair: pair[0],
)
def test_values(text, expected):
    assert value(text) == expected


def test_the_tree():
    x = Variable("x", 4)
    assert parse_expression("if(x, 1, -x)") == Conditional(
        x, Number(1.0), Operation("-", (Variable("x", 11),))
    )
    assert parse_expression("min(2, x)") == Call("min", (Number(2.0), Variable("x", 8)))


def test_variables_in_their_order():
    expression = parse_expression("b + a.x * b - c[2].d + `and` + `Battery Level`")
    assert variables(expression) == ("b", "a.x", "c[2].d", "and", "Battery Level")
    found = value("`Battery Level` / and_more", **{"Battery Level": 6, "and_more": 3})
    assert found == 2.0


def test_a_function_is_one_only_before_a_parenthesis():
    assert value("min + max(min, 2)", min=1.0) == 3.0


def test_only_the_chosen_branch_is_computed():
    text = "if(x == 0, 0, 1 / x)"
    assert value(text, x=0.0) == 0.0
    assert value(text, x=4.0) == 0.25
    assert value("x != 0 and 1 / x > 2", x=0.0) == 0.0
    assert value("x == 0 or 1 / x > 2", x=0.0) == 1.0


def test_not_a_number():
    nan = math.nan
    assert math.isnan(value("x + 1", x=nan))
    assert math.isnan(value("min(1, x)", x=nan))
    assert math.isnan(value("max(x, 1)", x=nan))
    assert math.isnan(value("floor(x)", x=nan))
    # Comparisons are those of IEEE 754, so that a range test finds what is no number.
    assert value("if(x >= 0 and x <= 10, 1, 0)", x=nan) == 0.0
    assert value("x == x", x=nan) == 0.0


@pytest.mark.parametrize(
    "text",
    [
        "1 / x",
        "fmod(1, x)",
        "remainder(1, x)",
        "remainder(inf - x, 1)",
        "x ^ -1",
        "(x - 8) ^ (1 / 3)",
        "sqrt(x - 1)",
        "asin(x + 2)",
        "acos(x - 2)",
        "sin(inf + x)",
        "1e200 ^ (x + 2)",
    ],
)
def test_no_value(text):
    with pytest.raises(EvaluationError, match="has no value for"):
        value(text, x=0.0)


# --------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 1, "missing before the end"),
        ("1 +", 4, "missing before the end"),
        ("* 2", 1, r"missing before '\*'"),
        ("(1", 1, "not closed"),
        ("1)", 2, "should end"),
        ("a b", 3, "'b' where the expression should end"),
        ("1 < 2 < 3", 7, "joined by"),
        ("x == nan", 3, "value != value holds for nan alone"),
        ("-nan < x", 6, "value != value holds for nan alone"),
        ("exp(1)", 1, "no function; there are if, sin"),
        ("atan2(1)", 1, "takes 2 arguments, not 1"),
        ("min(1)", 1, "takes 2 to 20 arguments, not 1"),
        ("if(1, 2)", 1, "takes 3 arguments, not 2"),
        ("sin()", 5, r"missing before '\)'"),
        ("sin(1", 6, "do not end"),
        ("1 & 2", 3, "belongs in no expression"),
        ("x = 2", 3, "belongs in no expression"),
        ("'x'", 1, "belongs in no expression"),
        ("not", 4, "missing before the end"),
        ("1e999", 1, "too large"),
        ("(" * 100 + "1" + ")" * 100, DEEPEST + 2, "too deeply"),
        ("-" * 500 + "1", DEEPEST + 2, "too deeply"),
        ("1" + "+1" * 200, 1, "within each other"),
        ("1" * (LONGEST + 1), LONGEST, "more than"),
    ],
)
def test_no_expression(text, column, message):
    with pytest.raises(ExpressionError, match=message) as caught:
        parse_expression(text)
    assert caught.value.column == column


@given(st.text(max_size=80))
def test_any_text_is_an_expression_or_an_error(text):
    column = 1
    try:
        parse_expression(text)
    except ExpressionError as error:
        column = error.column
    assert 1 <= column <= len(text) + 1


TOKENS = "x 1 ( ) + - * / ^ < and or not if( , sin( min( ` . [0]"


@given(st.lists(st.sampled_from(TOKENS.split())))
def test_any_tokens_are_an_expression_or_an_error(parts):
    try:
        expression = parse_expression(" ".join(parts))
        evaluate(expression, {"x": 0.5})
    except (ExpressionError, EvaluationError, KeyError):
        pass


# --------------------------------------------------------------- names of sources


def test_names_of_sources():
    assert source_names(["twist.linear.x"]) == {
        "x": 0,
        "linear.x": 0,
        "twist.linear.x": 0,
        "value": 0,
    }
    two = source_names(["twist.linear.x", "twist.angular.x"])
    assert two == {
        "linear.x": 0,
        "twist.linear.x": 0,
        "value1": 0,
        "angular.x": 1,
        "twist.angular.x": 1,
        "value2": 1,
    }
    assert source_names(["x", "pose.x"])["x"] == 0
    assert source_names(["."]) == {"value": 0}
    absolute = source_names(["/angle_min", "codes[1]"])
    assert absolute == {"angle_min": 0, "codes[1]": 1, "value1": 0, "value2": 1}


# --------------------------------------------------------------- bounds


def bounds(text, **intervals):
    return interval(parse_expression(text), intervals)


@for_each(
    ("text", "expected"),
    [
        ("x", (-1.0, 2.0)),
        ("-x", (-2.0, 1.0)),
        ("x + 1", (0.0, 3.0)),
        ("1 - x", (-1.0, 2.0)),
        ("100 * x", (-100.0, 200.0)),
        ("x / 2", (-0.5, 1.0)),
        ("1 / x", (-INF, INF)),
        ("1 / (x + 1)", (1 / 3, INF)),
        ("1 / (x - 2)", (-INF, -1 / 3)),
        ("1 / 0", None),
        ("sqrt(x)", (0.0, math.sqrt(2.0))),
        ("sqrt(x - 3)", None),
        ("abs(x)", (0.0, 2.0)),
        ("min(x, 1)", (-1.0, 1.0)),
        ("max(x, 0)", (0.0, 2.0)),
        ("min(max(x, 0), 1)", (0.0, 1.0)),
        ("floor(x / 4)", (-1.0, 0.0)),
        ("sign(x)", (-1.0, 1.0)),
        ("x < 3", (1.0, 1.0)),
        ("x < 0", (0.0, 1.0)),
        ("x > 2", (0.0, 0.0)),
        ("x >= 2", (0.0, 1.0)),
        ("x == 5", (0.0, 0.0)),
        ("x != 5", (1.0, 1.0)),
        ("x < 3 and x > 2", (0.0, 0.0)),
        ("x > 5 or x < 3", (1.0, 1.0)),
        ("not x < 3", (0.0, 0.0)),
        ("if(x > 5, 100, 1)", (1.0, 1.0)),
        ("if(x < 5, 100, 1)", (100.0, 100.0)),
        ("if(x < 0, 100, 1)", (1.0, 100.0)),
        ("if(x < 0, sqrt(-4), 1)", (1.0, 1.0)),
        ("fmod(x, 4)", (-1.0, 2.0)),
        ("fmod(100 * x, 3)", (-3.0, 3.0)),
        ("remainder(x, 3)", (-1.5, 1.5)),
        ("remainder(x, 5)", (-1.0, 2.0)),
        ("remainder(x, 0)", None),
        ("sin(100 * x)", (-1.0, 1.0)),
        ("if(isfinite(x), x, nan)", (-1.0, 2.0)),
        ("nan + x", None),
    ],
    ids=lambda pair: pair[0],
)
def test_bounds(text, expected):
    assert bounds(text, x=(-1.0, 2.0)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x ^ 2", (0.0, 4.0)),
        ("x ^ 3", (-1.0, 8.0)),
        ("x ^ 0.5", (0.0, math.sqrt(2.0))),
        ("(x + 2) ^ -2", (1 / 16, 1.0)),
        ("2 ^ x", (0.5, 4.0)),
        ("sin(x)", (math.sin(-1.0), 1.0)),
        ("cos(x)", (math.cos(2.0), 1.0)),
        ("tan(x / 2)", (math.tan(-0.5), math.tan(1.0))),
        ("tan(x)", (-INF, INF)),
        ("atan2(x, 1)", (-math.pi / 4, math.atan(2.0))),
        ("atan2(x, -1)", (-math.pi, math.pi)),
        ("atan2(max(x, 0), -1)", (-math.pi, math.pi)),  # 0 may be -0
        ("hypot(x, 1)", (1.0, math.sqrt(5.0))),
        ("asin(x)", (-math.pi / 2, math.pi / 2)),
        ("acos(x)", (0.0, math.pi)),
    ],
)
def test_bounds_to_the_last_bits(text, expected):
    low, high = bounds(text, x=(-1.0, 2.0))
    assert low <= expected[0]
    assert high >= expected[1]
    assert (low, high) == pytest.approx(expected, abs=1e-12)


def test_bounds_of_what_is_unbounded():
    everything = (-INF, INF)
    assert bounds("x - y", x=everything, y=everything) == everything
    assert bounds("x * y", x=everything, y=(0.0, 0.0)) == (0.0, 0.0)
    assert bounds("x / y", x=everything, y=(1.0, INF)) == everything
    assert bounds("min(max(x, 0), 255)", x=everything) == (0.0, 255.0)


ENDS = st.one_of(
    st.integers(-20, 20).map(float),
    st.floats(-10, 10),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([0.0, -0.0, 1.0, -1.0, math.pi, math.pi / 2, 1e-300, 1e300, 5e-324]),
)


@st.composite
def boxes(draw):
    """Intervals of x and y, and a point within."""
    known, point = {}, {}
    for name in ("x", "y"):
        low, high = sorted([draw(ENDS) + 0.0, draw(ENDS) + 0.0])
        point[name] = draw(st.one_of(st.sampled_from([low, high]), st.floats(low, high)))
        open_ends = draw(st.sampled_from([(), (), (0,), (1,)]))
        known[name] = (-INF if 0 in open_ends else low, INF if 1 in open_ends else high)
    return known, point


OPERATORS = ["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or"]
LEAVES = st.sampled_from(["x", "y", "0", "1", "2", "0.5", "3", "pi", "(nan + 0)"])


def _compound(inner):
    calls = [
        st.builds(lambda f, args: f"{f}({', '.join(args)})", st.just(name), st.lists(
            inner, min_size=function.fewest, max_size=min(function.most, 3)
        ))
        for name, function in FUNCTIONS.items()
    ]  # fmt: skip
    return st.one_of(
        st.builds(lambda a, o, b: f"(({a}) {o} ({b}))", inner, st.sampled_from(OPERATORS), inner),
        st.builds(lambda a, o: f"({o} ({a}))", inner, st.sampled_from(["-", "not"])),
        st.builds(lambda a, b, c: f"if({a}, {b}, {c})", inner, inner, inner),
        *calls,
    )


TEXTS = st.recursive(LEAVES, _compound, max_leaves=5)


@given(TEXTS, boxes())
def test_no_value_lies_outside_its_bounds(text, box):
    known, point = box
    expression = parse_expression(text)
    try:
        found = evaluate(expression, point)
    except EvaluationError:
        return
    if math.isnan(found):  # of the infinite, which has no place in an interval
        return
    bound = interval(expression, known)
    assert bound is not None
    assert bound[0] <= found <= bound[1]


@pytest.mark.parametrize("operation", [*OPERATORS, *FUNCTIONS])
def test_each_operation_keeps_its_bounds(operation):
    """The same for single operations, so that each of them meets many intervals."""
    if operation in FUNCTIONS:
        arguments = ", ".join("xy"[: FUNCTIONS[operation].fewest])
        text = f"{operation}({arguments})"
    else:
        text = f"x {operation} y"

    @settings(max_examples=12)
    @given(boxes())
    def holds(box):
        test_no_value_lies_outside_its_bounds.hypothesis.inner_test(text, box)

    holds()
