"""Scaled integers (AS5684, scale_range): 0 means the lower limit, the largest integer the upper."""

import math

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.live.messages.text import rows_of
from jausml.runtime.wire import EncodeError, scaled, scaled_down, scaled_up

LIMITS = pytest.mark.parametrize(
    ("lower", "upper"), [(0.0, 1.0), (-math.pi, math.pi), (-10000.0, 35000.0)]
)


@pytest.mark.parametrize(
    ("type_name", "lower", "upper", "integer", "value"),
    [
        ("uint8", 0.0, 255.0, 255, 255.0),
        ("uint8", -100.0, 155.0, 7, -93.0),
        ("uint16", -100.0, 100.0, 0, -100.0),
        ("uint16", -100.0, 100.0, 65535, 100.0),
        ("uint16", 0.0, 655.35, 12345, 123.45),
        ("uint32", -90.0, 90.0, 4294967295, 90.0),
        ("uint32", 0.0, 4294.967295, 1000000, 1.0),
        ("uint64", 0.0, 1.0, 18446744073709551615, 1.0),
    ],
)
def test_integers_mean_these_values(type_name, lower, upper, integer, value):
    kind = wire.Scaled(wire.INTEGERS[type_name], lower, upper, "round")
    assert kind.value_of(integer) == pytest.approx(value, rel=1e-14)
    assert kind.integer_of(value) == integer


@pytest.mark.parametrize("rounding", ["round", "floor", "ceiling"])
@LIMITS
def test_a_value_comes_back_from_every_integer(rounding, lower, upper):
    kind = wire.Scaled(wire.INTEGERS["uint8"], lower, upper, rounding)
    assert [kind.integer_of(kind.value_of(raw)) for raw in range(256)] == list(range(256))
    between = kind.value_of(7) + 0.6 * kind.step
    assert kind.integer_of(between) == {"round": 8, "floor": 7, "ceiling": 8}[rounding]
    assert (kind.integer_of(lower), kind.integer_of(upper)) == (0, 255)


@LIMITS
def test_values_outside_of_the_limits_have_no_integer(lower, upper):
    kind = wire.Scaled(wire.INTEGERS["uint8"], lower, upper, "round")
    outside = (lower - kind.step, upper + kind.step, math.nan, math.inf, -math.inf, 10**400)
    for value in outside:
        with pytest.raises(ValueError, match="is not within"):
            kind.integer_of(value)


ROUNDED = {"round": scaled, "floor": scaled_down, "ceiling": scaled_up}


@given(
    st.sampled_from(sorted(wire.UNSIGNED)),
    st.sampled_from(sorted(ROUNDED)),
    st.floats(-1e6, 1e6),
    st.floats(1e-3, 1e6),
    st.floats(-1e-9, 1 + 1e-9) | st.sampled_from([-1e-17, 0.0, 1.0, 1 + 3e-16]),
)
@example("uint64", "floor", 0.0, 1.0, -1e-17)  # once a negative integer
@settings(deadline=None)
def test_generated_codecs_round_alike(type_name, rounding, lower, span, share):
    kind = wire.Scaled(wire.INTEGERS[type_name], lower, lower + span, rounding)
    assume(kind.upper > kind.lower)
    value = lower + share * span
    try:
        integer = kind.integer_of(value)
    except ValueError:
        with pytest.raises(EncodeError, match="is outside"):
            ROUNDED[rounding](value, lower, kind.step, kind.type.upper, "x")
        return
    assert 0 <= integer <= kind.type.upper
    assert ROUNDED[rounding](value, lower, kind.step, kind.type.upper, "x") == integer


def test_paths_and_pages_tell_the_step():
    model = read_models([library_root() / "jaus" / "mobility.xmi"]).model
    wrench = next(e for e in model.instances(jaus.MessageDef) if e.name == "SetWrenchEffort")
    place = JausPlace("SetWrenchEffort", message=wrench).follow("ResistiveLinearEffortX")
    assert isinstance(place, JausPlace)
    assert place.attribute().step == 100.0 / 255.0
    legal = {row.name: row.legal for row in rows_of(wrench)}
    assert legal["ResistiveLinearEffortX"] == "0.0 .. 100.0, step 0.392"
