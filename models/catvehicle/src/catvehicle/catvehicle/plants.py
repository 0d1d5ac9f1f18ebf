"""The plants by name, of which the environment of a vehicle chooses one."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from .dynamic import DynamicPlant
from .plant import BicyclePlant

if TYPE_CHECKING:
    from .parameters import VehicleParameters

PLANT_VARIABLE = "CATVEHICLE_PLANT"
"""Environment variable that names the plant; the kinematic one without it."""

DELAY_VARIABLE = "CATVEHICLE_DELAY"
"""Environment variable: seconds that a command waits before the drive by wire obeys; 0 without."""

UNDERSTEER = 0.0015
"""Understeer K in s^2/m^2 (catvehicle: distanceEstimatorSteeringBased.cpp)."""

PLANTS = ("kinematic", "understeer", "dynamic")
"""Names of the plants: a kinematic bicycle, one whose tyres act as at a smaller angle the faster it
is, and a dynamic bicycle whose tyres slip."""


def plant_of(name: str, parameters: VehicleParameters) -> BicyclePlant:
    """Returns a plant at rest in the origin.

    Raises:
        ValueError: No plant has the name.
    """
    if name not in PLANTS:
        raise ValueError(f"{PLANT_VARIABLE}: {name!r} is none of {', '.join(PLANTS)}")
    if name == "dynamic":
        return DynamicPlant(parameters)
    if name == "understeer":
        return BicyclePlant(replace(parameters, understeer_coefficient=UNDERSTEER))
    return BicyclePlant(parameters)


def plant_from_environment(parameters: VehicleParameters) -> BicyclePlant:
    """Returns the plant that the environment names.

    Raises:
        ValueError: It names none.
    """
    return plant_of(os.environ.get(PLANT_VARIABLE, "kinematic"), parameters)


def delay_from_environment() -> float:
    """Returns the seconds that a command waits.

    Raises:
        ValueError: The environment says no such number.
    """
    text = os.environ.get(DELAY_VARIABLE, "0")
    try:
        delay = float(text)
    except ValueError:
        delay = -1.0
    if not 0.0 <= delay < 10.0:
        raise ValueError(f"{DELAY_VARIABLE}: {text!r} is no number of seconds from 0 to 10")
    return delay
