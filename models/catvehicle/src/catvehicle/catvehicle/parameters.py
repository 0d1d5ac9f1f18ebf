"""Parameters of the vehicle, its controllers and the scenario, each with unit and source."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

ASSUMPTION = "assumption"

_MAY_BE_ZERO = frozenset({"understeer_coefficient", "steering_gain"})
_MUST_BE_NEGATIVE = frozenset({"acceleration_min"})


def _about(meaning: str, unit: str, source: str) -> Mapping[str, str]:
    return {"meaning": meaning, "unit": unit, "source": source}


class ParameterRow(NamedTuple):
    """One row of a report on parameters.

    Attributes:
        name: Field name of `VehicleParameters`.
        value: Value in `unit`.
        unit: SI unit, "1" for a pure number.
        source: Public source of the default; "assumption" where none is known; "override" where the
            value was changed from its default.
        meaning: What the parameter is, in one sentence.
    """

    name: str
    value: float
    unit: str
    source: str
    meaning: str


@dataclass(frozen=True)
class VehicleParameters:
    """Numbers of the CAT Vehicle (a Ford Escape Hybrid) and of the right-turn scenario.

    Each field documents itself: its metadata holds the meaning, the unit and the source, and
    `describe` returns them. A source that starts with "assumption" marks a number that nobody has
    published; it must not be taken for a measurement or for a number of the original experiment.

    Raises:
        ValueError: A value is not finite or has the wrong sign, or the comfort margin exceeds 1.
    """

    wheelbase: float = field(
        default=2.62,
        metadata=_about("Distance between the axles.", "m", "catvehicle: cmdvel2gazebo.py, self.L"),
    )
    track: float = field(
        default=1.55,
        metadata=_about(
            "Distance between the tyres of one axle.", "m", "catvehicle: cmdvel2gazebo.py"
        ),
    )
    steering_limit: float = field(
        default=0.5297,
        metadata=_about(
            "Largest tyre angle of the bicycle model, either side.",
            "rad",
            "computed from catvehicle: inside tyre limit 0.6 rad (xacro), simulator track 1.29 m",
        ),
    )
    understeer_coefficient: float = field(
        default=0.0,
        metadata=_about(
            "Understeer K: the tyres act like steering_angle / (1 + K v^2).",
            "s^2/m^2",
            "assumption: nominal; 0.0015 in catvehicle: distanceEstimatorSteeringBased.cpp",
        ),
    )
    speed_lag_up: float = field(
        default=1.333,
        metadata=_about(
            "Time constant of the speed when speeding up.",
            "s",
            "catvehicle: cmdvel2gazebo.slx, 0.75/(s+0.75)",
        ),
    )
    speed_lag_down: float = field(
        default=0.667,
        metadata=_about(
            "Time constant of the speed when slowing down.",
            "s",
            "catvehicle: cmdvel2gazebo.slx, 1.5/(s+1.5)",
        ),
    )
    acceleration_min: float = field(
        default=-3.0, metadata=_about("Hardest braking.", "m/s^2", ASSUMPTION)
    )
    acceleration_max: float = field(
        default=2.0, metadata=_about("Hardest speeding up.", "m/s^2", ASSUMPTION)
    )
    speed_max: float = field(
        default=8.94,
        metadata=_about(
            "Speed that 100 percent of propulsive effort asks for.",
            "m/s",
            "catvehicle: car_speed_tested.slx, saturation (20 mph)",
        ),
    )
    steering_lag: float = field(
        default=0.25, metadata=_about("Time constant of the steering.", "s", ASSUMPTION)
    )
    steering_rate_limit: float = field(
        default=0.6, metadata=_about("Largest rate of the tyre angle.", "rad/s", ASSUMPTION)
    )
    lateral_acceleration_limit: float = field(
        default=2.0,
        metadata=_about("Boundary of the safe (comfort) region.", "m/s^2", ASSUMPTION),
    )
    comfort_margin: float = field(
        default=0.85,
        metadata=_about("Share of the safe speed that the limiter allows.", "1", ASSUMPTION),
    )
    steering_gain: float = field(
        default=0.7,
        metadata=_about(
            "Gain k of the cross-track error in the steering law.",
            "1/s",
            "catvehicle: hoffmannFollower.slx",
        ),
    )
    steering_speed_floor: float = field(
        default=0.5,
        metadata=_about("Smallest speed that the steering law divides by.", "m/s", ASSUMPTION),
    )
    reference_speed: float = field(
        default=6.0,
        metadata=_about(
            "Speed wanted on the straights.",
            "m/s",
            "assumption: upper speed of the cruise profile in catvehicle: car_speed_tested.slx",
        ),
    )
    stopping_gain: float = field(
        default=0.5,
        metadata=_about(
            "Speed allowed per metre that is left to the path's end.",
            "1/s",
            ASSUMPTION,
        ),
    )
    straight_length: float = field(
        default=25.0, metadata=_about("Length of each straight of the path.", "m", ASSUMPTION)
    )
    turn_radius: float = field(
        default=12.0, metadata=_about("Radius of the arc of the path.", "m", ASSUMPTION)
    )
    report_rate: float = field(
        default=25.0, metadata=_about("Rate of the vehicle's reports.", "Hz", ASSUMPTION)
    )
    mass: float = field(
        default=1883.2,
        metadata=_about(
            "Mass, for the dynamic plant.",
            "kg",
            "computed from catvehicle: body 1703.2 kg, 4 wheels of 20 kg, 2 links of 50 kg (xacro)",
        ),
    )
    yaw_inertia: float = field(
        default=2529.4,
        metadata=_about(
            "Moment of inertia about z, for the dynamic plant.",
            "kg m^2",
            "catvehicle: Izz of the body (xacro)",
        ),
    )
    rear_axle_distance: float = field(
        default=1.31,
        metadata=_about(
            "Distance from the rear axle to the centre of mass, for the dynamic plant.",
            "m",
            "assumption: half the wheelbase",
        ),
    )
    front_cornering_stiffness: float = field(
        default=70_500.0,
        metadata=_about(
            "Side force of the front axle per slip angle, for the dynamic plant.",
            "N/rad",
            "assumption: with the rear axle's, understeer in a steady turn is K = 0.0015 s^2/m^2",
        ),
    )
    rear_cornering_stiffness: float = field(
        default=100_000.0,
        metadata=_about(
            "Side force of the rear axle per slip angle, for the dynamic plant.",
            "N/rad",
            "assumption: a passenger car's",
        ),
    )
    deadman_timeout: float = field(
        default=0.2,
        metadata=_about(
            "Silence of the commands after which the vehicle stops.",
            "s",
            "catvehicle: cmdvel2gazebo.py",
        ),
    )

    def __post_init__(self) -> None:
        """Refuses values with which the equations have no meaning."""
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not _acceptable(entry.name, value):
                raise ValueError(
                    f"{entry.name} = {value!r} {entry.metadata['unit']} is out of range"
                )

    def describe(self) -> tuple[ParameterRow, ...]:
        """Returns a row (name, value, unit, source, meaning) per parameter, as declared."""
        rows = []
        for entry in fields(self):
            value = getattr(self, entry.name)
            about = entry.metadata
            source = about["source"] if value == entry.default else "override"
            rows.append(ParameterRow(entry.name, value, about["unit"], source, about["meaning"]))
        return tuple(rows)


def _acceptable(name: str, value: float) -> bool:
    if not math.isfinite(value):
        return False
    if name in _MUST_BE_NEGATIVE:
        return value < 0.0
    if name in _MAY_BE_ZERO:
        return value >= 0.0
    if name == "comfort_margin":
        return 0.0 < value <= 1.0
    if name == "steering_limit":
        return 0.0 < value < math.pi / 2
    return value > 0.0
