"""Ranges are never narrower than the truth: what the runtime computes lies within them."""

import math

import pytest
from generated import model_in
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.attributes import intervals
from jausml.language.attributes.expressions import evaluate, parse_expression
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.ranges import sent_through
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.conversions import NoValueError
from jausml.language.semantics.paths.scopes import place
from jausml.runtime import conversions as runtime

NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
FACTORS = st.floats(-1e3, 1e3, allow_nan=False).filter(lambda factor: abs(factor) > 1e-6)
WIDTHS = st.floats(0.0, 100.0)
ANGLES = ("ned_heading_to_enu_yaw", "enu_yaw_to_ned_heading", "wrap_angle")
PLAIN = ("negate", "square", "square_root", "degrees_to_radians", "radians_to_degrees", *ANGLES)


EXPRESSIONS = (
    "hypot(value1, value2)",
    "value1 * value2 - value1",
    "atan2(value2, value1)",
    "if(value1 > value2, value1, -value2)",
)
MODEL = """<bridge:MapLibrary xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" name="numbers"><maps name="numbers">
  <message href="http://www.jausml.org/library/jaus/mobility.xmi#PrimitiveDriver.SetWrenchEffort"/>
  <type href="http://www.jausml.org/library/ros/std_msgs.xmi#Float64"/>
  <toRos xsi:type="bridge:FieldAssignment" target="data" source="PropulsiveLinearEffortX"/>
  <toJaus xsi:type="bridge:FieldAssignment" target="PropulsiveLinearEffortX" source="data, data"/>
</maps></bridge:MapLibrary>"""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return model_in(tmp_path_factory.mktemp("model"), MODEL, "numbers.xmi")


def step(kind, *arguments, expression=None):
    return kind, arguments, expression


def placed(model, chain=(), *, to_ros=True):
    """The assignment of one source to one target, or the one of two sources, with conversions."""
    (attribute_map,) = model.documents[0].roots[0].maps
    (assignment,) = attribute_map.toRos if to_ros else attribute_map.toJaus
    package = model.metamodels.package_named("bridge")
    literals = package.enumerations["ConversionKind"].literals
    assignment.conversions.clear()
    for kind, arguments, expression in chain:
        conversion = model.metamodels.classes["bridge.Conversion"].eclass()
        conversion.kind = literals[kind]
        conversion.arguments.extend([float(argument) for argument in arguments])
        conversion.expression = expression
        assignment.conversions.append(conversion)
    return place(attribute_map, assignment, to_ros=to_ros)


STEPS = st.one_of(
    st.sampled_from(PLAIN).map(step),
    st.builds(step, st.just("scale"), FACTORS),
    st.builds(step, st.just("linear"), FACTORS, NUMBERS),
    st.builds(lambda a, b: step("clamp", min(a, b), max(a, b)), NUMBERS, NUMBERS),
    st.builds(step, st.just("limit"), st.floats(0.01, 1000.0)),
    st.builds(step, st.just("deadband"), WIDTHS),
    st.builds(step, st.just("value_to_percent"), st.floats(0.01, 1000.0)),
    st.builds(step, st.just("percent_to_value"), st.floats(0.01, 1000.0)),
)


@given(chain=st.lists(STEPS, max_size=4), ends=st.tuples(NUMBERS, NUMBERS), part=st.floats(0, 1))
def test_what_the_runtime_computes_lies_in_the_range(model, chain, ends, part):
    low, high = sorted(ends)
    value = min(max(low + part * (high - low), low), high)
    ranges = [(low, high)]
    steps = steps_of(placed(model, chain))
    for chain_step, (kind, arguments, _) in zip(steps, chain, strict=True):
        ranges = chain_step.ranges(ranges)
        value = getattr(runtime, kind)(value, *arguments)
        if math.isnan(value):
            return
        (found,) = ranges
        slack = 2.0**-40 * max(1.0, abs(value))
        assert found[0] - slack <= value <= found[1] + slack
        # The next conversion starts from what the last bits of this one may be.
        value = min(max(value, found[0]), found[1])


@given(
    x=st.tuples(NUMBERS, NUMBERS).map(sorted),
    y=st.tuples(NUMBERS, NUMBERS).map(sorted),
    parts=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    text=st.sampled_from(EXPRESSIONS),
)
def test_what_an_expression_yields_lies_in_the_range(model, x, y, parts, text):
    of_two = placed(model, [step("expression", expression=text)], to_ros=False)
    (of_expression,) = steps_of(of_two)
    (found,) = of_expression.ranges([tuple(x), tuple(y)])
    values = {
        name: min(max(low + part * (high - low), low), high)
        for name, (low, high), part in zip(("value1", "value2"), (x, y), parts, strict=True)
    }
    value = evaluate(parse_expression(text), values)
    slack = 2.0**-40 * max(1.0, abs(value))
    assert found[0] - slack <= value <= found[1] + slack


@given(value=st.floats(-100.0, 100.0), chain=st.lists(STEPS, max_size=4))
def test_numbers_are_sent_through_as_the_runtime_sends_them(model, value, chain):
    expected = value
    for kind, arguments, _ in chain:
        expected = getattr(runtime, kind)(expected, *arguments)
        if math.isnan(expected):
            return
    try:
        found = sent_through(placed(model, chain), value)
    except NoValueError:
        assert {kind for kind, *_ in chain} & {"clamp", "limit", "deadband", "square_root"}
    else:
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_numbers_are_sent_through_to_the_unit_of_the_target(tmp_path):
    model = model_in(
        tmp_path,
        'turn {\n  JAUS Turning ( float32 rate { units: "degree per second" } )\n'
        "  ROS geometry_msgs/Twist\n  JAUS->ROS ( rate -> angular.z )\n}\n",
        "turn.ros2jaus",
    )
    (turn,) = [used for used in model.instances(bridge.AttributeMap) if used.name == "turn"]
    assert sent_through(place(turn, turn.toRos[0], to_ros=True), 180.0) == pytest.approx(math.pi)


@pytest.mark.parametrize(
    ("kind", "arguments", "given_range", "expected"),
    [
        ("negate", (), (-1.0, 3.0), (-3.0, 1.0)),
        ("square", (), (-2.0, 1.0), pytest.approx((0.0, 4.0))),
        ("clamp", (0.0, 1.0), (-5.0, 0.5), (0.0, 0.5)),
        ("clamp", (0.0, 1.0), (3.0, 5.0), (1.0, 1.0)),
        ("limit", (1.0,), (-5.0, 0.5), (-1.0, 0.5)),
        ("limit", (1.0,), (3.0, 5.0), (1.0, 1.0)),
        ("deadband", (1.0,), (0.5, 2.0), (0.0, 2.0)),
        ("deadband", (1.0,), (1.5, 2.0), (1.5, 2.0)),
        ("linear", (-2.0, 1.0), (0.0, 3.0), (-5.0, 1.0)),
        ("square_root", (), (-4.0, 9.0), (0.0, 3.0)),
        ("square_root", (), (-4.0, -1.0), intervals.EMPTY),
        ("occupancy_to_cost", (), (-1.0, 100.0), (0.0, 255.0)),
        ("user", (), (0.0, 1.0), intervals.EVERYTHING),
    ],
)
def test_range_of_a_conversion(model, kind, arguments, given_range, expected):
    (of_one,) = steps_of(placed(model, [step(kind, *arguments)]))
    assert of_one.ranges([given_range]) == [expected]
