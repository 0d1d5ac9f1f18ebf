"""Conversions of numbers, computed a second time and independently of the runtime."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.languages.expressions import EvaluationError, evaluate, parse_expression, source_names
from jausml.semantics.units import unit_step

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


def _heading(value: float) -> float:
    turned = math.pi / 2 - value
    return math.atan2(math.sin(turned), math.cos(turned))


def _mean_square(*variances: float) -> float:
    if min(variances) < 0 or max(variances) == 0:
        return math.nan
    return math.hypot(*(variance**0.5 for variance in variances)) / math.sqrt(3)


_FORWARD: dict[str, Callable[..., float]] = {
    "negate": lambda value: -1 * value,
    "scale": lambda value, factor: factor * value,
    "linear": lambda value, factor, offset: offset + factor * value,
    "clamp": lambda value, low, high: sorted((low, value, high))[1],
    "deadband": lambda value, width: value if abs(value) >= width else 0.0,
    "square": lambda value: value * value,
    "square_root": lambda value: math.hypot(0.0, value**0.5) if value >= 0 else math.nan,
    "covariance_to_rms": _mean_square,
    "degrees_to_radians": lambda value: value * math.pi / 180,
    "radians_to_degrees": lambda value: value * 180 / math.pi,
    "ned_heading_to_enu_yaw": _heading,
    "enu_yaw_to_ned_heading": _heading,
    "wrap_angle": lambda value: math.atan2(math.sin(value), math.cos(value)),
    "value_to_percent": lambda value, maximum: 100 * value / maximum,
    "percent_to_value": lambda value, maximum: value * maximum / 100,
    "with_units": lambda value: value,
}
# Of those that give each value once, what leads back.
_BACK: dict[str, Callable[..., float]] = {
    "negate": lambda value: -1 * value,
    "scale": lambda value, factor: value / factor,
    "linear": lambda value, factor, offset: (value - offset) / factor,
    "degrees_to_radians": _FORWARD["radians_to_degrees"],
    "radians_to_degrees": _FORWARD["degrees_to_radians"],
    "value_to_percent": _FORWARD["percent_to_value"],
    "percent_to_value": _FORWARD["value_to_percent"],
    "with_units": _FORWARD["with_units"],
}
ANGLES = {"ned_heading_to_enu_yaw", "enu_yaw_to_ned_heading", "wrap_angle"}
"""Conversions of one angle to one angle, in which whole turns do not count."""


@dataclass(frozen=True)
class Chain:
    """The conversions of a FieldAssignment.

    Args:
        map: The `bridge.AttributeMap`.
        assignment: The `bridge.FieldAssignment`.
        to_ros: Whether it fills the ROS type.
        quantities: Values of quantities that the bridge states, by name.
    """

    map: Any
    assignment: Any
    to_ros: bool
    quantities: Mapping[str, float]

    @property
    def sources(self) -> list[str]:
        """The source paths."""
        return [path.strip() for path in self.assignment.source.split(",")]

    @property
    def targets(self) -> list[str]:
        """The target paths."""
        return [path.strip() for path in self.assignment.target.split(",")]

    @property
    def kinds(self) -> list[str]:
        """Names of the conversions."""
        return [conversion.kind.name for conversion in self.assignment.conversions]

    @property
    def is_numeric(self) -> bool:
        """Whether `forward` knows all of its conversions."""
        return all(kind in _FORWARD or kind == "expression" for kind in self.kinds)

    @property
    def leads_back(self) -> bool:
        """Whether `back` knows all of its conversions, each value of which has one source."""
        return len(self.sources) == 1 and all(
            kind in _BACK and 0.0 not in self._factors(conversion)
            for kind, conversion in zip(self.kinds, self.assignment.conversions, strict=True)
        )

    def forward(self, values: Sequence[float]) -> float | None:
        """Returns what becomes of the values of the sources; None when they have no result.

        Args:
            values: One for each source.
        """
        current = list(values)
        for conversion in self.assignment.conversions:
            try:
                current = [self._converted(conversion, current)]
            except (EvaluationError, ArithmeticError, KeyError, ValueError):
                return None
        if len(current) != 1:
            return None
        factor, offset = self._unit_step
        return current[0] * factor + offset

    def back(self, value: float) -> float:
        """Returns the value of the source that gives a value of the target."""
        factor, offset = self._unit_step
        value = (value - offset) / factor
        for conversion in reversed(self.assignment.conversions):
            value = _BACK[conversion.kind.name](value, *self._arguments(conversion))
        return value

    @property
    def has_unit_step(self) -> bool:
        """Whether the unit of the result is not that of the target."""
        return self._unit_step != (1.0, 0.0)

    @property
    def _unit_step(self) -> tuple[float, float]:
        step = unit_step(self.map, self.assignment, to_ros=self.to_ros)
        return (1.0, 0.0) if step is None else step

    def _converted(self, conversion: Any, values: Sequence[float]) -> float:
        kind = conversion.kind.name
        if kind != "expression":
            return _FORWARD[kind](*values, *self._arguments(conversion))
        paths = self.sources if len(values) == len(self.sources) else ["."]
        names = source_names(paths)
        known = {name: values[index] for name, index in names.items()}
        return evaluate(parse_expression(conversion.expression or ""), known)

    def _arguments(self, conversion: Any) -> list[float]:
        quantity = conversion.quantity
        if quantity is None:
            return [float(each) for each in conversion.arguments]
        return [self.quantities.get(str(quantity.name), float(quantity.value))]

    def _factors(self, conversion: Any) -> list[float]:
        return self._arguments(conversion)[:1]


def quantities_of(bridge: Any) -> dict[str, float]:
    """Returns the values of the quantities that a bridge states.

    Args:
        bridge: The `bridge.Bridge`.
    """
    return {str(each.name): float(each.value) for each in bridge.quantities}
