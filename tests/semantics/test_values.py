"""Constants, paths and flows, one by one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.semantics.paths.attributes import (
    BOOL,
    NUMBER,
    TEXT,
    Attribute,
    constant_fault,
    is_integer,
    is_real,
)
from jausml.language.semantics.paths.scopes import parse_path

BYTE = Attribute(NUMBER, "a number", integral=True, lower=0, upper=255)
LEVEL = Attribute(NUMBER, "a number", integral=True, lower=0, upper=255, values=((1, 1), (5, 9)))
SCALED = Attribute(NUMBER, "a number", lower=-1.5, upper=1.5)
LATIN = Attribute(TEXT, "text", length=3, encoding="latin-1")


@pytest.mark.parametrize(
    ("text", "attribute"),
    [
        ("0", BYTE),
        ("+255", BYTE),
        (" 7 ", BYTE),
        ("5", LEVEL),
        ("-1.5", SCALED),
        ("1e-3", SCALED),
        (".5", SCALED),
        ("true", Attribute(BOOL, "a bool")),
        ("äöü", LATIN),
        ("", LATIN),
        ("any\n{{ text }}", Attribute(TEXT, "text")),
    ],
)
def test_legal_constants(text, attribute):
    assert constant_fault(text, attribute) == ""


@pytest.mark.parametrize(
    ("text", "attribute", "fault"),
    [
        ("256", BYTE, "above 255"),
        ("-1", BYTE, "below 0"),
        ("1.0", BYTE, "not an integer"),
        ("0x10", BYTE, "not an integer"),
        ("1_0", BYTE, "not an integer"),
        ("010", BYTE, "not an integer"),
        ("٣", BYTE, "not an integer"),
        ("9" * 5000, BYTE, "not an integer"),
        ("2", LEVEL, "value set"),
        ("1.6", SCALED, "above 1.5"),
        ("inf", SCALED, "not a number"),
        ("nan", SCALED, "not a number"),
        ("1e999", SCALED, "not a number"),
        ("True", Attribute(BOOL, "a bool"), "true or false"),
        ("abcd", LATIN, "longer than 3"),
        ("€", LATIN, "latin-1"),
        ("1", Attribute("geometry_msgs/Pose", "a geometry_msgs/Pose"), "geometry_msgs/Pose"),
    ],
)
def test_illegal_constants(text, attribute, fault):
    assert fault in constant_fault(text, attribute)


@given(st.text(max_size=20))
def test_what_counts_as_a_number_is_one_to_python(text):
    if is_integer(text):
        assert str(int(text)).lstrip("-").isascii()
    if is_real(text):
        assert math.isfinite(float(text))


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(-(2**63), 2**63))
def test_python_numbers_are_legal(real, integer):
    assert is_real(repr(real))
    assert is_integer(str(integer))


def test_paths_are_compared_by_steps():
    assert parse_path("a.covariance[3]") == ("a", "covariance", "[3]")
    assert parse_path("Velocity_X") == ("Velocity_X",)
