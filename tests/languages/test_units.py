"""Units: what texts mean, in figures found elsewhere, and what is refused."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from jausml.language.attributes.units import (
    LONGEST,
    Unit,
    UnitError,
    conversion_between,
    nearest_units,
    parse_unit,
)

LIBRARY = Path(__file__).resolve().parents[2] / "models" / "library"


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("m/s^2", "m/s²"),
        ("m/s^2", "m s^-2"),
        ("m/s", "m s-1"),
        ("m/s^2", "m·s⁻²"),
        ("m/s^2", "m/s/s"),
        ("W/(m*K)", "W/m K"),
        ("W*K/m", "W/m*K"),
        ("m/s^2", "meter per second squared"),
        ("m/s^2", "meters per second per second"),
        ("kg/(m*s^2)", "pascal"),
        ("N m", "newton meter"),
        ("N*m", "newton-meter"),
        ("m^3/s", "cubic meter per second"),
        ("m2", "square metre"),
        ("1/s", "hertz"),
        ("°C", "degree Celsius"),
        ("°C", "deg C"),
        ("°F", "degrees F"),
        ("deg", "degrees"),
        ("deg", "°"),
        ("%", "percent"),
        ("1", "one"),
        ("km/h", "kilometers per hour"),
        ("rpm", "revolutions per minute"),
        ("W h", "Wh"),
        ("ohm", "Ω"),
        ("us", "µs"),
    ],
)
def test_texts_of_one_unit(one, other):
    a, b = parse_unit(one), parse_unit(other)
    assert a.dimension == b.dimension
    assert (a.factor, a.offset) == pytest.approx((b.factor, b.offset), rel=1e-15)


@pytest.mark.parametrize(
    ("value", "source", "target", "expected"),
    [
        (180.0, "degree", "radian", math.pi),
        (36.0, "km/h", "m/s", 10.0),
        (1.0, "kn", "m/s", 0.514444),
        (25.0, "degree Celsius", "K", 298.15),
        (212.0, "°F", "°C", 100.0),
        (0.5, "1", "percent", 50.0),
        (60.0, "rpm", "rad/s", math.tau),
        (1.0, "bar", "Pa", 100000.0),
        (1.0, "Ah", "coulomb", 3600.0),
        (2.0, "mm", "cm", 0.2),
        (1.5, "liter", "cubic meter", 0.0015),
        (90.0, "minute", "hour", 1.5),
        (1.0, "mi", "ft", 5280.0),
        (7.0, "newton", "N", 7.0),
    ],
)
def test_absolute_figures(value, source, target, expected):
    factor, offset = conversion_between(parse_unit(source), parse_unit(target))
    assert value * factor + offset == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("one", "other"),
    [("rad", "1"), ("deg", "%"), ("m", "s"), ("rad/s", "Hz"), ("m", "m^2"), ("m/s", "m/s^2")],
)
def test_units_of_different_things(one, other):
    assert not parse_unit(one).is_compatible(parse_unit(other))
    with pytest.raises(ValueError, match="different dimensions"):
        conversion_between(parse_unit(one), parse_unit(other))


def test_squares_and_roots():
    assert parse_unit("deg").squared() == parse_unit("deg^2")
    assert parse_unit("m^2/s^2").root() == parse_unit("m/s")
    assert parse_unit("m").root().squared() == parse_unit("m")
    # The square of a temperature that starts elsewhere than at zero is one of its steps.
    assert parse_unit("°C").squared() == parse_unit("K^2")


def test_a_scale_with_its_own_zero_keeps_it_alone_only():
    assert parse_unit("°C").offset == 273.15
    assert parse_unit("J/°C") == parse_unit("J/K")


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 1, "missing"),
        ("  ", 1, "missing"),
        ("m/", 3, "missing before the end"),
        ("m^", 2, "belongs in no unit"),
        ("m^0", 2, "no power"),
        ("m^99", 2, "no power"),
        ("(m", 1, "not closed"),
        ("m)", 2, "should end"),
        ("m/furlong", 3, "'furlong' is no known unit"),
        ("5 m", 1, "missing before '5'"),
        ("m$", 2, "belongs in no unit"),
        ("per", 4, "missing"),
        ("(" * 50 + "m" + ")" * 50, 12, "nested too deeply"),
        ("m" * (LONGEST + 1), LONGEST, "more than"),
    ],
)
def test_no_unit(text, column, message):
    with pytest.raises(UnitError, match=message) as caught:
        parse_unit(text)
    assert caught.value.column == column


@pytest.mark.parametrize(
    ("text", "first"),
    [("metr per second", "metre"), ("radain", "radian"), ("Newton metr", "metre"), ("Rad", "rad")],
)
def test_suggestions(text, first):
    assert nearest_units(text)[0] == first


def test_a_unit_has_no_suggestions():
    assert nearest_units("m/s") == []


def test_each_unit_of_the_library_is_one():
    texts = {
        text
        for path in sorted(LIBRARY.rglob("*.xmi"))
        for text in etree.parse(path).getroot().xpath("//@units")
    }
    assert len(texts) > 15
    for text in texts:
        assert isinstance(parse_unit(text), Unit)


@given(st.text(max_size=60))
def test_any_text_is_a_unit_or_an_error(text):
    column = 1
    try:
        parse_unit(text)
    except UnitError as error:
        column = error.column
        nearest_units(text)
    assert 1 <= column <= len(text) + 1
