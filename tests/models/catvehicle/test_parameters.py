"""Every parameter says what it is, in which unit, and where it comes from."""

import dataclasses
import math

import pytest
from catvehicle import VehicleParameters
from for_each import for_each


def test_every_parameter_has_meaning_unit_and_source():
    rows = VehicleParameters().describe()

    assert [row.name for row in rows] == [
        entry.name for entry in dataclasses.fields(VehicleParameters)
    ]
    for row in rows:
        assert row.meaning.endswith("."), row
        assert row.unit in {
            *("m", "s", "rad", "rad/s", "m/s", "m/s^2", "s^2/m^2", "1/s", "1", "Hz"),
            *("kg", "kg m^2", "N/rad"),
        }
        assert row.source.startswith(("catvehicle: ", "computed from catvehicle", "assumption"))


def test_published_numbers_are_not_assumptions():
    sources = {row.name: row.source for row in VehicleParameters().describe()}

    published = {name for name, source in sources.items() if "assumption" not in source}
    assert published == {
        "wheelbase",
        "track",
        "steering_limit",
        "speed_lag_up",
        "speed_lag_down",
        "speed_max",
        "steering_gain",
        "mass",
        "yaw_inertia",
        "deadman_timeout",
    }


def test_steering_limit_follows_from_the_inside_tyre():
    parameters = VehicleParameters()
    inside_radius = parameters.wheelbase / math.tan(0.6)
    simulator_track = 1.29

    bicycle = math.atan(parameters.wheelbase / (inside_radius + simulator_track / 2))

    assert parameters.steering_limit == pytest.approx(bicycle, abs=1e-4)


def test_a_changed_value_loses_its_source():
    rows = {row.name: row for row in VehicleParameters(turn_radius=36.6).describe()}

    assert rows["turn_radius"].value == 36.6
    assert rows["turn_radius"].source == "override"
    assert rows["wheelbase"].source.startswith("catvehicle")


@for_each(
    ("name", "value"),
    [
        ("wheelbase", 0.0),
        ("wheelbase", math.nan),
        ("speed_lag_up", -1.0),
        ("acceleration_min", 3.0),
        ("acceleration_max", math.inf),
        ("comfort_margin", 1.1),
        ("steering_limit", 1.6),
        ("understeer_coefficient", -0.001),
    ],
)
def test_meaningless_values_are_refused(name, value):
    with pytest.raises(ValueError, match=name):
        VehicleParameters(**{name: value})
