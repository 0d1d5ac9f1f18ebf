"""Conversions of numbers."""

from __future__ import annotations

import math

from jausml.language.attributes import intervals
from jausml.language.attributes.intervals import Interval
from jausml.language.semantics.conversions.conversion import (
    MAXIMUM,
    OWN,
    PERCENT,
    Argument,
    Conversion,
    Effect,
    UnitEffect,
)
from jausml.language.semantics.conversions.definition import Definition
from jausml.language.semantics.paths.attributes import NUMBER


class Negate(Conversion):
    """The value with the opposite sign.

    It is for y, z, pitch, yaw and their rates between JAUS axes (x forward, y right, z down) and
    ROS axes (REP 103: x forward, y left, z up).
    """

    name = "negate"
    units = UnitEffect.SAME
    inverse = "negate"
    effect = Effect.NEGATED
    definition = Definition("value", "-value")


class Scale(Conversion):
    """The value times a factor."""

    name = "scale"
    arguments = (Argument("factor"),)
    effect = Effect.LINEAR
    definition = Definition("value, factor", "value * factor")

    def back(self, value: float, factor: float) -> float:
        """The quotient."""
        return value / factor

    def leads_back(self, factor: float) -> bool:
        """Unless everything becomes zero."""
        return factor != 0.0

    def sign(self, factor: float) -> int | None:
        """Returns the sign of the factor."""
        return int(math.copysign(1, factor)) if factor != 0.0 else None


class Linear(Conversion):
    """The value times a factor plus an offset."""

    name = "linear"
    arguments = (Argument("factor"), Argument("offset"))
    effect = Effect.LINEAR
    definition = Definition("value, factor, offset", "value * factor + offset")

    def back(self, value: float, factor: float, offset: float) -> float:
        """The quotient of what is left without the offset."""
        return (value - offset) / factor

    def leads_back(self, factor: float, offset: float) -> bool:  # noqa: ARG002
        """Unless everything becomes the offset."""
        return factor != 0.0

    def sign(self, factor: float, offset: float) -> int | None:
        """Returns the sign of the factor, where nothing is added."""
        return int(math.copysign(1, factor)) if factor != 0.0 == offset else None


class Clamp(Conversion):
    """The value limited to a range, from minimum to maximum."""

    name = "clamp"
    arguments = (Argument("minimum"), Argument("maximum"))
    units = UnitEffect.SAME
    effect = Effect.SAME
    definition = Definition(
        "value, minimum, maximum",
        "if(value < minimum, minimum, if(value > maximum, maximum, value))",
    )

    def interval(self, value: Interval, minimum: float, maximum: float) -> Interval:
        """Both ends, limited."""
        return min(max(value[0], minimum), maximum), max(min(value[1], maximum), minimum)

    def loses(self, value: float, minimum: float, maximum: float) -> bool:
        """Whether it is outside of the range."""
        return not minimum <= value <= maximum

    def fault(self, minimum: float, maximum: float) -> str:
        """A range has its ends in order."""
        if minimum > maximum:
            return f"clamp has minimum {minimum:g} above maximum {maximum:g}"
        return ""


class Limit(Conversion):
    """The value limited to a maximum in both directions, from minus the maximum to the maximum."""

    name = "limit"
    arguments = (MAXIMUM,)
    units = (OWN, OWN)
    effect = Effect.SAME
    definition = Definition(
        "value, maximum", "if(value < -maximum, -maximum, if(value > maximum, maximum, value))"
    )

    def interval(self, value: Interval, maximum: float) -> Interval:
        """Both ends, limited."""
        return max(-maximum, min(value[0], maximum)), min(maximum, max(value[1], -maximum))

    def loses(self, value: float, maximum: float) -> bool:
        """Whether its magnitude is above the maximum."""
        return abs(value) > maximum

    def fault(self, maximum: float) -> str:
        """A maximum is above zero."""
        return _maximum_fault(self.name, maximum)


class Deadband(Conversion):
    """Zero when the magnitude is below a width, else the value.

    It hides the half step by which scaled integers miss zero.
    """

    name = "deadband"
    arguments = (Argument("width"),)
    units = UnitEffect.SAME
    effect = Effect.SAME
    definition = Definition("value, width", "if(abs(value) < width, 0, value)")

    def interval(self, value: Interval, width: float) -> Interval:
        """With zero, where the band is touched."""
        reaches = value[0] < width and value[1] > -width
        return intervals.hull(value, (0.0, 0.0)) if reaches else value

    def loses(self, value: float, width: float) -> bool:
        """Whether it lies in the band."""
        return abs(value) < width

    def fault(self, width: float) -> str:
        """A width is not negative."""
        return f"deadband has the negative width {width:g}" if width < 0 else ""


class Square(Conversion):
    """The value squared: root mean square to variance."""

    name = "square"
    units = UnitEffect.SQUARE
    definition = Definition("value", "value * value")

    def interval(self, value: Interval) -> Interval:
        """The squares."""
        return intervals.power(value, (2.0, 2.0))


class SquareRoot(Conversion):
    """The square root of the value: variance to root mean square.

    A negative value has none: ROS marks an unknown variance so.
    """

    name = "square_root"
    units = UnitEffect.ROOT
    definition = Definition("value", "if(value >= 0, sqrt(value), nan)")


class CovarianceToRms(Conversion):
    """The variances along three axes to one root mean square for each of the axes.

    A negative variance, which ROS uses for unknown, gives no number.
    """

    name = "covariance_to_rms"
    inputs = (NUMBER, NUMBER, NUMBER)
    units = UnitEffect.ROOT
    definition = Definition(
        "x, y, z",
        """
        is_known = x >= 0 and y >= 0 and z >= 0 and not (x == 0 and y == 0 and z == 0)
        if(is_known, sqrt((x + y + z) / 3), nan)
        """,
    )


class ValueToPercent(Conversion):
    """The value in percent of a maximum."""

    name = "value_to_percent"
    arguments = (MAXIMUM,)
    units = (OWN, PERCENT)
    inverse = "percent_to_value"
    effect = Effect.LINEAR
    definition = Definition(
        "value, maximum",
        "value / maximum * 100",
        refused="maximum == 0",
        reason="nothing is a percentage of zero",
    )

    def leads_back(self, maximum: float) -> bool:
        """Unless nothing has a percentage."""
        return maximum != 0.0

    def fault(self, maximum: float) -> str:
        """A maximum is above zero."""
        return _maximum_fault(self.name, maximum)


class PercentToValue(Conversion):
    """Percent of a maximum to the value."""

    name = "percent_to_value"
    arguments = (MAXIMUM,)
    units = (PERCENT, OWN)
    inverse = "value_to_percent"
    effect = Effect.LINEAR
    definition = Definition("value, maximum", "value / 100 * maximum")

    def leads_back(self, maximum: float) -> bool:
        """Unless everything becomes zero."""
        return maximum != 0.0

    def fault(self, maximum: float) -> str:
        """A maximum is above zero."""
        return _maximum_fault(self.name, maximum)


def _maximum_fault(name: str, maximum: float) -> str:
    return f"{name} has the maximum {maximum:g}, which is not above 0" if maximum <= 0 else ""
