"""Each conversion is one object, and what it computes is what the runtime computes."""

import ast
import inspect
import math
import re
from datetime import datetime, timezone
from functools import partial

import conversions_another_way as another_way
import pytest
from for_each import for_each
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sources import ROOT, modules_below

from jausml.language.attributes.expressions import parse_expression
from jausml.language.metamodel import documentation, load_metamodels
from jausml.language.semantics.conversions import CONVERSIONS, ArgumentKind, Effect, NoValueError
from jausml.language.semantics.conversions.authored import Formula
from jausml.runtime import conversions as runtime

FEWER = settings(max_examples=max(1, settings().max_examples // 3))

GUARDS = (
    "metamodels/bridge.ecore",
    "jausml/language/semantics/conversions",
    "jausml/runtime/conversions",
)

LITERALS = load_metamodels().package_named("bridge").enumerations["ConversionKind"].literals
WRITTEN = (ArgumentKind.TEXT, ArgumentKind.FORMULA, ArgumentKind.METHOD)
CALLED = [
    conversion
    for conversion in CONVERSIONS.values()
    if conversion.own_argument is None or conversion.own_argument.kind not in WRITTEN
]
EVERY_CONVERSION = for_each(
    "conversion", CONVERSIONS.values(), ids=lambda conversion: conversion.name
)

# ------------------------------------------------------------ one of each, wherever it is told


def test_each_literal_has_its_class():
    assert set(CONVERSIONS) == set(LITERALS)
    assert len({type(conversion) for conversion in CONVERSIONS.values()}) == len(LITERALS)


@EVERY_CONVERSION
def test_literal_and_class_say_the_same(conversion):
    assert documentation(LITERALS[conversion.name]) == conversion.documentation
    assert conversion.documentation.endswith(".")


@EVERY_CONVERSION
def test_the_documentation_names_each_argument(conversion):
    words = re.findall(r"[a-z]+", conversion.documentation.lower())
    assert [argument.name for argument in conversion.arguments if argument.name not in words] == []


@EVERY_CONVERSION
def test_an_argument_that_is_no_number_has_a_feature_of_its_own(conversion):
    features = load_metamodels().classes["bridge.Conversion"].features
    assert {argument.feature for argument in conversion.arguments} <= set(features)


@EVERY_CONVERSION
def test_a_conversion_has_no_state(conversion):
    assert vars(conversion) == {}


PARAMETERS = {
    "number": "float",
    "numbers": "Sequence[Cell]",
    "value": "Key",
    "text": "str",
    "octets": "Sequence[int]",
    "geometry_msgs/Quaternion": "QuaternionLike",
    "builtin_interfaces/Time": "TimeLike",
    "TimeStamp": "TimeStampLike",
}
RESULTS = {
    ("number",): "float",
    ("number", "number", "number"): "Angles",
    ("numbers",): "list[Cell]",
    ("value",): "Value",
    ("octets",): "bytes",
    ("number", "number", "text", "number", "number", "octets"): "Pixels",
    ("geometry_msgs/Quaternion",): "Quaternion",
    ("builtin_interfaces/Time",): "Time",
    ("TimeStamp",): "TimeStamp",
}


@for_each("conversion", CALLED, ids=lambda case: case.name)
def test_each_class_has_its_function_in_the_runtime(conversion):
    signature = inspect.signature(getattr(runtime, conversion.name))
    inputs, arguments = conversion.inputs, conversion.arguments
    positional = [p for p in signature.parameters.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
    named = {p.name for p in signature.parameters.values() if p.kind is p.KEYWORD_ONLY}
    assert [p.name for p in positional[len(inputs) :]] == [argument.name for argument in arguments]
    types = {ArgumentKind.NUMBER: "float", ArgumentKind.TABLE: "Mapping[Key, Value]"}
    wanted = [PARAMETERS[input_kind] for input_kind in inputs] + [
        types[argument.kind] for argument in arguments
    ]
    assert [p.annotation for p in positional] == wanted
    assert signature.return_annotation == RESULTS[conversion.outputs]
    assert named == ({"near"} if conversion.needs_clock else set())


def test_each_function_of_the_runtime_has_its_class():
    functions = {name for name, _ in inspect.getmembers(runtime, inspect.isfunction)}
    assert functions == {conversion.name for conversion in CALLED}


# These words mean something else too, such as a feature or a policy.
AMBIGUOUS = {"scale", "clamp", "limit", "square", "expression", "user", "linear"}


def test_no_other_file_lists_names_of_conversions():
    found = {}
    names = set(CONVERSIONS) - AMBIGUOUS
    for path in modules_below():
        place = path.relative_to(ROOT)
        if {"runtime", "conversions"} & set(place.parts[:-1]):
            continue
        text = path.read_text(encoding="utf-8")
        if not any(name in text for name in names):  # to parse all takes five seconds
            continue
        tree = ast.parse(text)
        texts = {syntax.value for syntax in ast.walk(tree) if isinstance(syntax, ast.Constant)}
        if named := texts & names:
            found[place.as_posix()] = named
    assert found == {}


# ------------------------------------------------------------ the same by two computations


NUMBERS = st.floats(-1e6, 1e6)
ANGLES = st.floats(-50.0, 50.0)
POSITIVE = st.floats(1e-3, 1e6)
PARTS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(
    lambda quaternion: math.hypot(*quaternion) > 1e-2
)
SECONDS = st.integers(-(2**31), 2**31 - 1)
INSTANTS = st.tuples(SECONDS, st.integers(0, 10**9 - 1))
STAMPS = st.tuples(
    st.integers(0, 1023),
    st.integers(0, 63),
    st.integers(0, 63),
    st.integers(0, 31),
    st.integers(0, 31),
)
INPUTS = {
    "number": NUMBERS,
    "numbers": st.lists(st.integers(-128, 127), max_size=24),
    "value": st.sampled_from([0.0, 1.0, 2.0, "on"]),
    "octets": st.binary(max_size=16),
    "geometry_msgs/Quaternion": PARTS,
    "builtin_interfaces/Time": INSTANTS,
    "TimeStamp": STAMPS,
}
TABLE = [(0.0, "off"), (1.0, "on"), ("on", 1.0)]
ARGUMENTS = {
    "clamp": st.tuples(NUMBERS, NUMBERS).map(sorted),
    "limit": st.tuples(POSITIVE),
    "deadband": st.tuples(st.floats(0.0, 1e3)),
    "scale": st.tuples(st.floats(-1e3, 1e3)),
    "linear": st.tuples(st.floats(-1e3, 1e3), NUMBERS),
    "value_to_percent": st.tuples(POSITIVE),
    "percent_to_value": st.tuples(POSITIVE),
    "look_up": st.just((TABLE,)),
}
ENCODINGS = st.sampled_from(["mono8", "mono16", "rgb8", "bgr8", "rgba8", ""])
SIDES = st.integers(0, 3)
# Of a header, mostly whole, and pixels of it, mostly as many as there should be.
HEADERS = st.tuples(
    st.sampled_from(["P5", "P6", "P4", "p5"]),
    *[st.sampled_from([" ", "\n", "\r\n", "\t # 9 8\n", "#\r", ""])] * 2,
    *[st.sampled_from(["1", "2", "02", "0", "1234567890", "x", "-1"])] * 2,
    st.sampled_from([" ", "\n#\n"]),
    st.sampled_from(["255", "65535", "254", ""]),
    st.sampled_from(["\n", " ", "#9\n", "", "x"]),
).map(
    lambda header: (
        f"{header[0]}{header[1]}{header[3]}{header[2]}{header[4]}{header[5]}{header[6]}{header[7]}"
    )
)
# Where the usual numbers would only ever miss.
OWN_INPUTS = {
    "occupancy_to_cost": st.tuples(st.integers(-1, 101)),
    "cost_to_occupancy": st.tuples(st.integers(-1, 256)),
    "reverse_rows": st.tuples(
        INPUTS["numbers"], st.sampled_from([1.0, 2.0, 3.0, 2.5, 0.0, math.inf])
    ),
    "covariance_to_rms": st.tuples(*[st.floats(-1.0, 1e6)] * 3),
    "pixels_to_pnm": st.tuples(
        SIDES, SIDES, ENCODINGS, st.booleans(), st.integers(0, 9), st.binary(max_size=27)
    ).map(lambda image: (*image[:5], (image[5] * 27)[: image[0] * image[4]] if image[5] else b"a")),
    "pnm_to_pixels": st.tuples(HEADERS, st.sampled_from([1, 2, 3, 4, 6, 8, 12]), st.binary()).map(
        lambda image: (image[0].encode() + (image[2] * 12)[: image[1]],)
    ),
}
KINDS = {
    "geometry_msgs/Quaternion": runtime.Quaternion,
    "builtin_interfaces/Time": runtime.Time,
    "TimeStamp": runtime.TimeStamp,
}


def is_of_angles(conversion):
    return isinstance(conversion.units, tuple) and "radian" in conversion.units


def inputs_of(conversion):
    if conversion.name in OWN_INPUTS:
        return OWN_INPUTS[conversion.name]
    numbers = ANGLES if is_of_angles(conversion) else NUMBERS
    return st.tuples(*[numbers if k == "number" else INPUTS[k] for k in conversion.inputs])


def computed(conversion, values, arguments, named):
    """What the runtime gives, as the classes say it; None where it refuses."""
    given_values = [
        KINDS[kind](*value) if kind in KINDS else value
        for kind, value in zip(conversion.inputs, values, strict=True)
    ]
    numbers = [dict(argument) if argument is TABLE else argument for argument in arguments]
    near = {name: runtime.Time(*value) for name, value in named.items()}
    try:
        return getattr(runtime, conversion.name)(*given_values, *numbers, **near)
    except runtime.ConversionError:
        return None


def parts_of(result):
    return list(result) if isinstance(result, tuple | list) else [result]


def same(conversion, found, expected):
    """Whether two results are the same; of a tilt only the sine is exact near the vertical."""
    if isinstance(expected, str | bytes):
        return found == expected
    if math.isnan(expected):
        return math.isnan(found)
    apart = found - expected
    if is_of_angles(conversion) and "geometry_msgs/Quaternion" in conversion.inputs:
        return abs(math.remainder(apart, math.tau)) < 1e-7
    if conversion.is_of_turns:
        return abs(math.remainder(apart, math.tau)) < 1e-9
    return abs(apart) <= 1e-9 * max(1.0, abs(expected))


def is_steep(conversion, values):
    """Whether roll and yaw nearly turn about the same axis, so that rounding decides of them."""
    if conversion.inputs != ("geometry_msgs/Quaternion",) or not conversion.frames:
        return False
    x, y, z, w = values[0]
    length = math.hypot(x, y, z, w)
    return abs(2 * (w * y - z * x)) / length**2 > 1 - 1e-6


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in CALLED])
@FEWER
@given(data=st.data())
def test_both_compute_the_same(conversion, data):
    values = data.draw(inputs_of(conversion))
    arguments = data.draw(ARGUMENTS.get(conversion.name, st.just(())))
    named = {"near": data.draw(INSTANTS)} if conversion.needs_clock else {}
    assume(not is_steep(conversion, values))
    expected = computed(conversion, values, arguments, named)
    if expected is None:
        with pytest.raises(NoValueError):
            conversion.forward(*values, *arguments, **named)
        return
    found = conversion.forward(*values, *arguments, **named)
    pairs = zip(parts_of(found), parts_of(expected), strict=True)
    assert all(same(conversion, *pair) for pair in pairs), (found, expected)


@pytest.mark.parametrize("name", another_way.ORIENTATIONS)
@given(data=st.data())
def test_orientations_are_products_of_turns(name, data):
    conversion = CONVERSIONS[name]
    values = data.draw(inputs_of(conversion))
    assume(not is_steep(conversion, values))
    expected = parts_of(another_way.ORIENTATIONS[name](*values))
    found = parts_of(conversion.forward(*values))
    assert all(map(partial(same, conversion), found, expected)), (found, expected)


@given(stamp=STAMPS, near=INSTANTS)
def test_times_are_those_of_the_calendar(stamp, near):
    conversion, expected = (
        CONVERSIONS["timestamp_to_time"],
        another_way.timestamp_to_time(stamp, near),
    )
    if expected is None:
        with pytest.raises(NoValueError):
            conversion.forward(stamp, near=near)
    else:
        assert conversion.forward(stamp, near=near) == expected
    assert CONVERSIONS["time_to_timestamp"].forward(near) == another_way.time_to_timestamp(near)


MOMENT = (int(datetime(2024, 3, 1, 0, 0, 5, tzinfo=timezone.utc).timestamp()), 0)
LEAP_DAY = (int(datetime(2024, 2, 29, 23, 59, 58, tzinfo=timezone.utc).timestamp()), 987_000_000)
HALF = math.sqrt(0.5)
QUARTER = math.pi / 2
NAN = math.nan


@pytest.mark.parametrize(
    ("name", "given_values", "expected"),
    [
        ("negate", (2.5,), [-2.5]),
        ("scale", (3.0, -0.5), [-1.5]),
        ("linear", (20.0, 1.8, 32.0), [68.0]),
        ("clamp", (-5.0, -1.0, 2.0), [-1.0]),
        ("clamp", (9.0, -1.0, 2.0), [2.0]),
        ("clamp", (NAN, -1.0, 2.0), [NAN]),
        ("limit", (-5.0, 2.0), [-2.0]),
        ("limit", (5.0, 2.0), [2.0]),
        ("limit", (-1.5, 2.0), [-1.5]),
        ("limit", (NAN, 2.0), [NAN]),
        ("deadband", (-0.05, 0.1), [0.0]),
        ("deadband", (0.1, 0.1), [0.1]),
        ("square", (-3.0,), [9.0]),
        ("square_root", (6.25,), [2.5]),
        ("square_root", (-1.0,), [NAN]),
        ("covariance_to_rms", (1.0, 4.0, 4.0), [math.sqrt(3.0)]),
        ("covariance_to_rms", (0.0, 0.0, 0.0), [NAN]),
        ("covariance_to_rms", (1.0, 1.0, NAN), [NAN]),
        ("value_to_percent", (2.0, 8.0), [25.0]),
        ("percent_to_value", (25.0, 8.0), [2.0]),
        ("degrees_to_radians", (180.0,), [math.pi]),
        ("radians_to_degrees", (-QUARTER,), [-90.0]),
        # North, and a right turn from there to the east.
        ("ned_heading_to_enu_yaw", (0.0,), [QUARTER]),
        ("ned_heading_to_enu_yaw", (QUARTER,), [0.0]),
        ("enu_yaw_to_ned_heading", (0.0,), [QUARTER]),
        ("enu_yaw_to_ned_heading", (QUARTER,), [0.0]),
        ("wrap_angle", (math.pi + 0.5,), [0.5 - math.pi]),
        ("wrap_angle", (math.inf,), [NAN]),
        # Right turn, nose up and right side down, each about its axis alone.
        ("frd_yaw_to_flu_quaternion", (QUARTER,), [0, 0, -HALF, HALF]),
        ("frd_angles_to_flu_quaternion", (0, 0, QUARTER), [0, 0, -HALF, HALF]),
        ("frd_angles_to_flu_quaternion", (0, QUARTER, 0), [0, -HALF, 0, HALF]),
        ("frd_angles_to_flu_quaternion", (QUARTER, 0, 0), [HALF, 0, 0, HALF]),
        ("flu_quaternion_to_frd_yaw", ((0, 0, -HALF, HALF),), [QUARTER]),
        ("flu_quaternion_to_frd_pitch", ((0, -HALF, 0, HALF),), [QUARTER]),
        ("flu_quaternion_to_frd_roll", ((HALF, 0, 0, HALF),), [QUARTER]),
        ("flu_quaternion_to_frd_angles", ((0, -HALF, 0, HALF),), [0, QUARTER, 0]),
        # Roll is taken as zero where it turns about the same axis as yaw.
        ("flu_quaternion_to_frd_angles", ((0.5, -0.5, 0.5, 0.5),), [0, QUARTER, -QUARTER]),
        ("flu_quaternion_to_frd_angles", ((0, 0, 0, 0),), [NAN, NAN, NAN]),
        # Facing north is a turn to the left from east.
        ("ned_angles_to_enu_quaternion", (0, 0, 0), [0, 0, HALF, HALF]),
        ("ned_heading_to_enu_quaternion", (0,), [0, 0, HALF, HALF]),
        ("enu_quaternion_to_ned_heading", ((0, 0, HALF, HALF),), [0.0]),
        ("enu_quaternion_to_ned_angles", ((0, 0, 0, 1),), [0, 0, QUARTER]),
        ("occupancy_to_cost", (-1,), [255]),
        ("occupancy_to_cost", (100,), [254]),
        ("occupancy_to_cost", (25,), [64]),
        ("cost_to_occupancy", (255,), [-1]),
        ("cost_to_occupancy", (127,), [50]),
        ("reverse_rows", ([1, 2, 3, 4], 2.0), [3, 4, 1, 2]),
        ("look_up", (1.0, TABLE), ["on"]),
        ("time_to_timestamp", (LEAP_DAY,), [987, 58, 59, 23, 29]),
    ],
)
def test_absolute_figures_of_both(name, given_values, expected):
    conversion = CONVERSIONS[name]
    count = len(conversion.inputs)
    values, arguments = given_values[:count], given_values[count:]
    for found in (conversion.forward(*given_values), computed(conversion, values, arguments, {})):
        assert (
            parts_of(found) == pytest.approx(expected, abs=1e-7, nan_ok=True) or found in expected
        )


def test_a_stamp_of_the_last_of_the_month_on_the_first():
    conversion = CONVERSIONS["timestamp_to_time"]
    stamp = (987, 58, 59, 23, 29)
    assert conversion.forward(stamp, near=MOMENT) == LEAP_DAY
    assert computed(conversion, [stamp], (), {"near": MOMENT}) == LEAP_DAY


# ------------------------------------------------------------ ranges, ways back, signs


NUMERIC = [
    conversion
    for conversion in CALLED
    if set(conversion.inputs) == {"number"} and not conversion.frames
]


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in NUMERIC])
@FEWER
@given(data=st.data())
def test_results_lie_in_the_range(conversion, data):
    values = data.draw(inputs_of(conversion))
    others = data.draw(inputs_of(conversion))
    arguments = data.draw(ARGUMENTS.get(conversion.name, st.just(())))
    known = [tuple(sorted(map(float, pair))) for pair in zip(values, others, strict=True)]
    try:
        results = parts_of(conversion.forward(*values, *arguments))
    except NoValueError:
        return
    for found, (low, high) in zip(results, conversion.ranges(known, arguments), strict=True):
        slack = 2.0**-40 * max(1.0, abs(found))
        assert math.isnan(found) or low - slack <= found <= high + slack


LIMITED = [conversion for conversion in CALLED if conversion.limits]


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in LIMITED])
@given(data=st.data())
def test_results_lie_in_stated_limits(conversion, data):
    try:
        results = parts_of(conversion.forward(*data.draw(inputs_of(conversion))))
    except NoValueError:
        return
    for found, (low, high) in zip(results, conversion.limits, strict=True):
        assert low <= found <= high


UNDONE = [conversion for conversion in CALLED if conversion.inverse and not conversion.needs_clock]


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in UNDONE])
@FEWER
@given(data=st.data())
def test_the_inverse_leads_back(conversion, data):
    inverse = CONVERSIONS[conversion.inverse]
    assert inverse.inverse == conversion.name
    assert (inverse.inputs, inverse.outputs) == (conversion.outputs, conversion.inputs)
    if conversion.name == "time_to_timestamp" or conversion.inputs == ("geometry_msgs/Quaternion",):
        return
    values = data.draw(inputs_of(conversion))
    if len(values) == 3:
        values = [math.remainder(value, math.pi) / 1.1 for value in values]
    arguments = data.draw(ARGUMENTS.get(conversion.name, st.just(())))
    result = conversion.forward(*values, *arguments)
    back = parts_of(inverse.forward(result, *arguments))
    for found, expected in zip(back, values, strict=True):
        apart = found - expected
        if is_of_angles(conversion) and conversion.effect is Effect.OTHER:
            apart = math.remainder(apart, math.tau)
        assert abs(apart) <= 1e-9 * max(1.0, abs(expected))


@pytest.mark.parametrize("name", ["scale", "linear"])
@given(data=st.data())
def test_what_has_no_inverse_computes_the_way_back(name, data):
    conversion = CONVERSIONS[name]
    (value,) = data.draw(inputs_of(conversion))
    arguments = data.draw(ARGUMENTS[name])
    assume(abs(arguments[0]) > 1e-3)
    assert conversion.leads_back(*arguments)
    back = conversion.back(conversion.forward(value, *arguments), *arguments)
    assert back == pytest.approx(value, rel=1e-6, abs=1e-6)


SIGNED = [
    conversion
    for conversion in NUMERIC
    if conversion.name != "wrap_angle" and len(conversion.inputs) == 1
]


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in SIGNED])
@given(data=st.data())
def test_signs(conversion, data):
    (value,) = data.draw(inputs_of(conversion))
    arguments = data.draw(ARGUMENTS.get(conversion.name, st.just(())))
    if conversion.loses(value, *arguments):
        return
    sign = conversion.sign(*arguments)
    if sign is not None:
        assert conversion.forward(value, *arguments) * sign * value >= 0


@pytest.mark.parametrize("conversion", [pytest.param(case, id=case.name) for case in CALLED])
@given(data=st.data())
def test_integers_are_kept(conversion, data):
    if not conversion.keeps_integers:
        return
    value = data.draw(st.integers(-(2**53), 2**53))
    arguments = [
        round(argument) for argument in data.draw(ARGUMENTS.get(conversion.name, st.just(())))
    ]
    found = conversion.forward(value, *arguments)
    assert found == int(found)
    assert not conversion.keeps_size or abs(found) <= max(abs(value), *map(abs, arguments), 0)


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("clamp", (2.0, 1.0), "clamp has minimum 2 above maximum 1"),
        ("clamp", (1.0, 1.0), ""),
        ("limit", (-1.0,), "limit has the maximum -1, which is not above 0"),
        ("deadband", (-1.0,), "deadband has the negative width -1"),
        ("value_to_percent", (0.0,), "value_to_percent has the maximum 0, which is not above 0"),
        ("percent_to_value", (1.0,), ""),
        ("scale", (0.0,), ""),
    ],
)
def test_faults_of_arguments(name, arguments, expected):
    assert CONVERSIONS[name].fault(*arguments) == expected


def test_what_stands_in_the_model():
    formula = Formula(parse_expression("x / y"), {"x": 0, "y": 1})
    expression = CONVERSIONS["expression"]
    assert expression.forward(6.0, 4.0, formula) == 1.5
    assert expression.interval((1.0, 2.0), (2.0, 4.0), formula) == pytest.approx((0.25, 1.0))
    for values in ((6.0, 0.0), (6.0,)):
        with pytest.raises(NoValueError):
            expression.forward(*values, formula)
    with pytest.raises(NoValueError):
        CONVERSIONS["look_up"].forward(7.0, TABLE)
    with pytest.raises(NoValueError):
        CONVERSIONS["user"].forward(1.0)
    assert CONVERSIONS["with_units"].forward(0.1, "m") == 0.1
