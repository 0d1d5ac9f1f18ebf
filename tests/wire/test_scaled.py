"""Scaled integers (AS5684, scale_range): 0 means the lower limit, the largest integer the upper."""

from __future__ import annotations

import math

import pytest

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.jaus_paths import JausPlace
from jausml.live.messages.definitions import rows_of

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
def test_integers_mean_these_values(
    type_name: str, lower: float, upper: float, integer: int, value: float
) -> None:
    scaled = wire.Scaled(wire.INTEGERS[type_name], lower, upper, "round")
    assert scaled.value_of(integer) == pytest.approx(value, rel=1e-14)
    assert scaled.integer_of(value) == integer


@pytest.mark.parametrize("rounding", ["round", "floor", "ceiling"])
@LIMITS
def test_a_value_comes_back_from_every_integer(rounding: str, lower: float, upper: float) -> None:
    scaled = wire.Scaled(wire.INTEGERS["uint8"], lower, upper, rounding)
    assert [scaled.integer_of(scaled.value_of(raw)) for raw in range(256)] == list(range(256))
    between = scaled.value_of(7) + 0.6 * scaled.step
    assert scaled.integer_of(between) == {"round": 8, "floor": 7, "ceiling": 8}[rounding]
    assert (scaled.integer_of(lower), scaled.integer_of(upper)) == (0, 255)


@LIMITS
def test_values_outside_of_the_limits_have_no_integer(lower: float, upper: float) -> None:
    scaled = wire.Scaled(wire.INTEGERS["uint8"], lower, upper, "round")
    outside = (lower - scaled.step, upper + scaled.step, math.nan, math.inf, -math.inf, 10**400)
    for value in outside:
        with pytest.raises(ValueError, match="is not within"):
            scaled.integer_of(value)


def test_paths_and_pages_tell_the_step() -> None:
    model = read_models([library_root() / "jaus" / "mobility.xmi"]).model
    wrench = next(e for e in model.instances(jaus.MessageDef) if e.name == "SetWrenchEffort")
    place = JausPlace("SetWrenchEffort", message=wrench).follow("ResistiveLinearEffortX")
    assert isinstance(place, JausPlace)
    assert place.attribute().step == 100.0 / 255.0
    legal = {row.name: row.legal for row in rows_of(wrench)}
    assert legal["ResistiveLinearEffortX"] == "0.0 .. 100.0, step 0.392"
