"""The definition of each conversion, in Python, gives what the runtime gives, to the last bit."""

import math
import random
import struct
from datetime import datetime, timezone
from functools import partial

from for_each import for_each

from jausml.language.attributes.expressions import variables
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import PARTS, Definition, NoArithmetic
from jausml.runtime import conversions as runtime
from jausml.runtime.conversions import arithmetic
from jausml_generators.python.expressions import python_condition, python_expression

GUARDS = (
    "jausml/language/semantics/conversions",
    "jausml/language/attributes/expressions.py",
    "jausml/language/attributes/expression_tree.py",
    "jausml/runtime/conversions",
)

CASES = 2000
ROWS = 20
DEFINED = [
    conversion
    for conversion in CONVERSIONS.values()
    if isinstance(conversion.definition, Definition)
]
CALLED = [conversion for conversion in DEFINED if not conversion.changes_nothing]
EVERY_DEFINITION = for_each("conversion", DEFINED, ids=lambda conversion: conversion.name)
EVERY_CALLED = for_each("conversion", CALLED, ids=lambda conversion: conversion.name)

# ------------------------------------------------------------ what definitions are made of


def test_all_but_six_have_arithmetic_of_their_own():
    others = {e.name: e.definition for e in CONVERSIONS.values() if e not in DEFINED}
    assert others == {
        "reverse_rows": NoArithmetic.ORDER,
        "pixels_to_pnm": NoArithmetic.PICTURE,
        "pnm_to_pixels": NoArithmetic.PICTURE,
        "look_up": NoArithmetic.TABLE,
        "expression": NoArithmetic.AUTHORED,
        "user": NoArithmetic.USER,
    }


@EVERY_DEFINITION
def test_a_definition_takes_and_gives_what_the_conversion_does(conversion):
    definition, given = conversion.definition, []
    for kind in conversion.inputs:
        at = len(given)
        given += PARTS.get(kind, definition.parameters[at : at + 1])
    if not conversion.changes_nothing:
        given += [argument.name for argument in conversion.arguments]
    given += ["near_sec", "near_nanosec"] if conversion.needs_clock else []
    assert list(definition.parameters) == given
    results = [len(PARTS.get(kind, "1")) for kind in conversion.outputs]
    assert len(definition.results) == sum(results)


@EVERY_DEFINITION
def test_each_name_stands_for_a_part_or_an_earlier_step(conversion):
    definition = conversion.definition
    known = set(definition.parameters)
    assert definition.refusal is None or set(variables(definition.refusal)) <= known
    for name, value in definition.steps.items():
        assert name not in known
        assert set(variables(value)) <= known, name
        known.add(name)
    assert all(set(variables(result)) <= known for result in definition.results)


def test_what_the_library_decides():
    of_library = {
        conversion.name for conversion in DEFINED if not conversion.definition.is_portable
    }
    turns = {
        conversion.name
        for conversion in DEFINED
        if "geometry_msgs/Quaternion" in conversion.signature
    }
    assert of_library == turns


# ------------------------------------------------------------ the same by two texts


def python_function(conversion):
    """The definition as a function of Python."""
    definition = conversion.definition
    names = {parameter: parameter for parameter in (*definition.parameters, *definition.steps)}
    lines = [f"def function({definition.takes}):"]
    if definition.refusal is not None:
        condition = python_condition(definition.refusal, names)
        lines += [f" if {condition}: raise Refused({definition.reason!r})"]
    for name, value in definition.steps.items():
        lines += [f" {name} = {python_expression(value, names)}"]
    results = (python_expression(result, names) for result in definition.results)
    space = {"arithmetic": arithmetic, "Refused": runtime.ConversionError}
    exec("\n".join([*lines, f" return {', '.join(results)},"]), space)  # noqa: S102 - ours
    return space["function"]


KINDS = {
    "geometry_msgs/Quaternion": runtime.Quaternion,
    "builtin_interfaces/Time": runtime.Time,
    "TimeStamp": runtime.TimeStamp,
}


def called(function, conversion, parts):
    """What a function of the runtime makes of parts."""
    rest, values = list(parts), []
    for kind in conversion.inputs:
        size = len(PARTS.get(kind, "1"))
        values.append(KINDS[kind](*rest[:size]) if kind in PARTS else rest[0])
        del rest[:size]
    near = {"near": runtime.Time(*rest[-2:])} if conversion.needs_clock else {}
    arguments = rest[:-2] if near else rest
    found = function(*values, *arguments, **near)
    return found if isinstance(found, tuple) else (found,)


def bits(value):
    """The bits of a real number; all that are none are one."""
    value = float(value)
    return "nan" if math.isnan(value) else struct.pack("d", value)


def outcome(function, parts, conversion):
    """The bits of the results, or why there are none."""
    try:
        return [*map(bits, function(*parts))]
    except runtime.ConversionError as error:
        reason = conversion.definition.reason
        return reason if reason and reason in str(error) else f"without a value: {error}"


ODD = [0.0, -0.0, 1.0, -1.0, math.nan, math.inf, -math.inf, 5e-324, -5e-324, 1e308, -1e308]
ODD += [math.pi * factor for factor in (-3, -2, -1, -0.5, 0.5, 1, 2, 3, 5, 7)]
ODD += [2.5, 99.5, 100.0, 100.5, 254.0, 255.0, 256.0, math.nextafter(255.0, 0.0), 1e-170]
SECONDS = [0, -1, 86399, 2**31 - 1, -(2**31)]
# Around the end of February of years that leap and of years that do not.
SECONDS += [
    int(datetime(year, 3, 1, tzinfo=timezone.utc).timestamp()) + apart
    for year in (1900, 1999, 2000, 2024, 2026, 2100, 2400)
    for apart in (-86401, -86400, -1, 0, 43200)
]


def number(chance):
    return chance.choice(
        [
            chance.choice(ODD),
            chance.uniform(-1, 1),
            chance.uniform(-4, 4),
            chance.uniform(-300, 300),
            float(chance.randrange(-2, 260)),
            chance.uniform(-1, 1) * 10.0 ** chance.randrange(-300, 300),
        ]
    )


def orientation(chance):
    """Any, one of odd parts, or one that points nearly up or down."""
    way = chance.randrange(4)
    if way == 0:
        return [number(chance) for _ in range(4)]
    if way == 1:
        return [chance.choice([*ODD, chance.uniform(-1, 1)]) for _ in range(4)]
    length = chance.choice([1.0, -1.0, 0.5, 100.0])
    if way == 2:
        return [length * chance.uniform(-1, 1) for _ in range(4)]
    tilt = chance.choice([1.0, -1.0]) * chance.choice([0.0, 1e-9, 1e-7, 1e-6, 1.1e-6, 2e-6])
    pitch = chance.choice([-1.0, 1.0]) * math.pi / 2 + tilt
    turn = runtime.frd_angles_to_flu_quaternion(chance.uniform(-4, 4), pitch, chance.uniform(-4, 4))
    return [length * coordinate for coordinate in turn]


def seconds(chance):
    any_day = chance.randrange(-(2**31), 2**31) // 86400 * 86400
    near_midnight = any_day + chance.choice([0, 1, -1, 43200, 86399])
    return chance.choice([chance.choice(SECONDS), near_midnight, chance.randrange(-(2**31), 2**31)])


def instant(chance):
    return [seconds(chance), chance.choice([0, 999_999_999, chance.randrange(2**32)])]


def stamp(chance):
    legal = chance.random() < 0.9
    sizes = (1000, 60, 60, 24, 32) if legal else (1024, 64, 64, 32, 32)
    return [chance.choice([0, size - 1, chance.randrange(size)]) for size in sizes]


DRAWN = {
    "geometry_msgs/Quaternion": orientation,
    "builtin_interfaces/Time": instant,
    "TimeStamp": stamp,
}


def drawn(conversion, chance):
    """Parts of inputs and arguments."""
    parts = []
    for kind in conversion.inputs:
        parts += DRAWN.get(kind, lambda chance: [number(chance)])(chance)
    parts += [number(chance) for _ in conversion.arguments]
    if conversion.name in {"clamp", "limit", "deadband"}:
        at = {"clamp": (1, 2), "limit": (1,), "deadband": (1,)}[conversion.name]
        parts[0] = chance.choice([*parts, *(-parts[i] for i in at)])
    return parts + (instant(chance) if conversion.needs_clock else [])


@EVERY_CALLED
def test_the_runtime_computes_the_definition(conversion):
    chance = random.Random(conversion.name)
    defined = python_function(conversion)
    computed = partial(called, getattr(runtime, conversion.name), conversion)
    ends = set()
    for _ in range(CASES):
        parts = drawn(conversion, chance)
        expected = outcome(lambda *given: computed(given), parts, conversion)
        found = outcome(defined, [*map(float, parts)], conversion)
        assert found == expected, parts
        ends.add(str(found))
    assert len(ends) > 1
    assert (conversion.definition.reason in ends) is (conversion.definition.refusal is not None)


def test_each_day_crosses_and_returns():
    """All days of the months of leap years and others, from each day near by."""
    to_stamp, to_time = (python_function(CONVERSIONS[name]) for name in
                         ("time_to_timestamp", "timestamp_to_time"))  # fmt: skip
    for year_day in (*range(-800, 800), *range(10800, 11800), *range(-24855, -24700)):
        noon = year_day * 86400 + 43200.0
        for apart in (-13, 0, 13):
            near = noon + apart * 86400
            assert to_time(*to_stamp(noon, 0.0), near, 0.0) == (noon, 0.0)
