"""Frames of numbers: the axis that a number lies along, and what conversions make of it.

Body, local and earth axes are three families. Within one, each frame has the same directions, some
of them with the opposite sign: left of forward-left-up is right of forward-right-down. Between
east-north-up and north-east-down x and y change places, and angles about z have another zero.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from jausml.language.semantics.assignments.steps import Step
from jausml.language.semantics.assignments.units import attribute_measure
from jausml.language.semantics.conversions import CONVERSIONS, Conversion
from jausml.language.semantics.conversions.conversion import DOWN, ENU, FLU, FRD, NED, UP
from jausml.language.semantics.paths.attributes import NUMBER, Attribute

BODY, LOCAL, EARTH = "body", "local", "earth"

FAMILIES = {FLU: BODY, FRD: BODY, UP: LOCAL, DOWN: LOCAL, ENU: EARTH, NED: EARTH}
IS_DOWN = {FLU: False, FRD: True, UP: False, DOWN: True, ENU: False, NED: True}

ALTITUDE = "altitude"

_AXES = {"x": "x", "roll": "x", "y": "y", "pitch": "y"}
_AXES |= dict.fromkeys(("z", "yaw", "heading", "bearing"), "z")
_ANGLES = frozenset({"roll", "pitch", "yaw", "heading", "bearing"})
_NOT_ANGLES = frozenset({"rate", "velocity", "acceleration", "effort", "torque"})
_WITHOUT_SIGN = frozenset({"rms", "variance", "covariance", "tolerance", "error", "limit"})
_RADIANS = (("rad", Fraction(1)),)
_METRES = (("m", Fraction(1)),)
_GEODETIC = "geodetic"
_COORDINATES = frozenset({"latitude", "longitude", ALTITUDE})


@dataclass(frozen=True, slots=True)
class Axis:
    """The direction of a number.

    Attributes:
        frame: One of `FAMILIES`.
        name: `x`, `y` or `z`; empty for a whole orientation.
        is_angle: Whether it is an angle about the axis, and no rate or length.
        sign: -1 behind conversions that turn the number round.
    """

    frame: str
    name: str
    is_angle: bool
    sign: int = 1


@dataclass(frozen=True, slots=True)
class Passage:
    """The axes of the sources of an assignment, and what conversions make of them.

    Attributes:
        conversion: The one between two frames; None without one.
        sign: 1, or -1 where the other conversions turn the number round.
    """

    sources: tuple[Axis | None, ...]
    conversion: Conversion | None
    sign: int


def axis_of(attribute: Attribute) -> Axis | None:
    """Returns the axis of a number, or of the angles that a quaternion stands for."""
    if attribute.frame not in FAMILIES:
        return None
    if attribute.kind == "geometry_msgs/Quaternion":
        return Axis(attribute.frame, "", is_angle=True)
    owner = attribute.field.eContainer() if attribute.field is not None else None
    # A number of a quaternion is no angle about x, y or z, in spite of its name.
    if getattr(owner, "name", None) == "Quaternion":
        return None
    words = _words(attribute.label)
    name = _axis_name(words)
    if not name:
        return None
    return Axis(attribute.frame, name, is_angle=_is_angle(attribute, words))


def geodetic(attribute: Attribute) -> str:
    """Returns `latitude`, `longitude` or `altitude`, if a number is one; else an empty text."""
    name = attribute.label.lower().rpartition("_")[2]
    return name if attribute.frame == _GEODETIC and name in _COORDINATES else ""


def is_coordinate(attribute: Attribute) -> bool:
    """Tells whether a number is one of a place: on the earth, or in metres along an axis."""
    known = attribute_measure(attribute)
    is_length = known is not None and known.unit.dimension == _METRES
    return bool(geodetic(attribute)) or (is_length and bool(_axis_name(_words(attribute.label))))


def passage(steps: Iterable[Step], sources: Iterable[Attribute]) -> Passage | None:
    """Returns the axes of sources after conversions; None when a conversion hides them."""
    axes = tuple(axis_of(source) for source in sources)
    between, sign = None, 1
    for step in steps:
        if step.conversion.frames:
            # Which axes lie between two conversions of frames is not followed.
            if between is not None:
                return None
            between = step.conversion
            continue
        factor = step.sign
        if factor is None:
            return None
        sign *= factor
    return Passage(axes, between, sign)


def counterpart(conversion: Conversion) -> Conversion | None:
    """Returns the same conversion between two other frames, as local ones for body ones."""
    conversions = (
        candidate
        for candidate in CONVERSIONS.values()
        if candidate is not conversion
        and candidate.frames
        and IS_DOWN[candidate.frames[0]] == IS_DOWN[conversion.frames[0]]
        and _shape(candidate) == _shape(conversion)
    )
    return next(conversions, None)


def angle_conversion(source_frame: str, target_frame: str) -> Conversion | None:
    """Returns the conversion of an angle from one frame to another."""
    conversions = (
        conversion
        for conversion in CONVERSIONS.values()
        if conversion.frames == (source_frame, target_frame)
        and conversion.inputs == conversion.outputs == (NUMBER,)
    )
    return next(conversions, None)


def direction(axis: Axis) -> tuple[str, int]:
    """Returns the direction of an axis within its family, and its sign there."""
    if FAMILIES[axis.frame] == EARTH and not axis.is_angle and axis.name != "z":
        # x of east-north-up is y of north-east-down.
        is_east = (axis.name == "x") == (axis.frame == ENU)
        return ("east" if is_east else "north"), axis.sign
    # Frames with z down are turned about x, which stays as it is.
    turned = IS_DOWN[axis.frame] and axis.name != "x"
    return axis.name, -axis.sign if turned else axis.sign


def with_sign(axis: Axis, sign: int) -> Axis:
    """Returns an axis after conversions of its number."""
    return replace(axis, sign=axis.sign * sign)


def _shape(conversion: Conversion) -> tuple[tuple[str, ...], ...]:
    return (conversion.inputs, conversion.outputs, conversion.takes_axes, conversion.gives_axes)


@lru_cache(maxsize=1024)
def _words(label: str) -> tuple[str, ...]:
    # "rollRate", "ROLL_RATE" and "Roll2" are words and numbers.
    parts = re.findall("[A-Z]+(?![a-z])|[A-Z][a-z]*|[a-z]+|[0-9]+", label)
    return tuple(part.lower() for part in parts)


@lru_cache(maxsize=1024)
def _axis_name(words: tuple[str, ...]) -> str:
    if not words or not _WITHOUT_SIGN.isdisjoint(words):
        return ""
    turning = [word for word in words if word in _ANGLES]
    if turning:
        return _AXES[turning[0]]
    return words[-1] if words[-1] in ("x", "y", "z") else ""


def _is_angle(attribute: Attribute, words: tuple[str, ...]) -> bool:
    known = attribute_measure(attribute)
    if known is not None:
        return known.unit.dimension == _RADIANS
    return not _ANGLES.isdisjoint(words) and _NOT_ANGLES.isdisjoint(words)
