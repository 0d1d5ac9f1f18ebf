"""Example values for the generated tests, computed here and not by the runtime's conversions.

Each real source attribute gets a value of its own, so that two attributes that are mixed up differ,
as far as its targets can carry it: out-of-range policies would drop the others. Each conversion of
numbers is computed a second time. Conversions of orientations and times are exercised only: their
results are held by the tests of the runtime.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generation.literals import python_literal
from jausml.generators.common.assignments import ros_constant, ros_kind
from jausml.generators.common.jaus_fields import BITS, INTEGER, REAL, jaus_field
from jausml.generators.common.ros_fields import INTEGER_RANGES, ros_field

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.generators.bridge.connections import ConnectionView

_NUMBERS = {REAL, INTEGER}
# Sources to try where the first choice leads out of the range of a target.
_OTHERS = (0.0, 1.0, *range(2, 100), 0.5, *(10.0**-power for power in range(1, 13)))


def _heading(value: float) -> float:
    turned = math.pi / 2 - value
    return math.atan2(math.sin(turned), math.cos(turned))


_CONVERSIONS: dict[str, Callable[..., float]] = {
    "negate": lambda value: -1 * value,
    "scale": lambda value, factor: factor * value,
    "linear": lambda value, factor, offset: offset + factor * value,
    "clamp": lambda value, low, high: sorted((low, value, high))[1],
    "deadband": lambda value, width: value if abs(value) >= width else 0.0,
    "square": lambda value: value**2,
    "degrees_to_radians": lambda value: value * math.pi / 180,
    "radians_to_degrees": lambda value: value * 180 / math.pi,
    "ned_heading_to_enu_yaw": _heading,
    "enu_yaw_to_ned_heading": _heading,
}


@dataclass(frozen=True)
class Example:
    """A source message with what its translation must hold.

    Attributes:
        connection: The connection.
        source_lines: Statements that fill `source`.
        assertions: Statements about `target`.
    """

    connection: ConnectionView
    source_lines: tuple[str, ...]
    assertions: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name of the connection in Python."""
        return self.connection.name

    @property
    def documentation(self) -> str:
        """What the test shows."""
        return f"{self.source_name} becomes {self.target_name}."

    @property
    def source_name(self) -> str:
        """Class of the message that is taken."""
        return self.connection.source_name

    @property
    def target_name(self) -> str:
        """Class of the message that is made."""
        return self.connection.target_name

    @property
    def encodes(self) -> bool:
        """Whether the target is a JAUS message."""
        return not self.connection.to_ros

    @property
    def refuses_absent(self) -> bool:
        """Whether the translation cannot do without some optional field."""
        return ("bridge_statistics", "AbsentFieldError") in self.connection.body.names

    @property
    def safe_encodes(self) -> bool:
        """Whether there is a safe value for JAUS."""
        return self.connection.has_safe_value and not self.connection.to_ros


def example_of(view: ConnectionView) -> Example | None:
    """Returns the example of a connection; None when no source is found that its target carries."""
    build = _ToRos(view) if view.to_ros else _ToJaus(view)
    try:
        for assignment in build.assignments:
            build.add(assignment)
    except _NoExampleError:
        return None
    return Example(view, tuple(build.source_lines), tuple(dict.fromkeys(build.assertions)))


class _NoExampleError(Exception):
    """No value of a source was found that its targets carry."""


class _Builder:
    """Collects the statements of one example."""

    assignments: Sequence[Any]

    def __init__(self, view: ConnectionView) -> None:
        self.view = view
        self.map = view.connection.map
        self.values: dict[str, float] = {}
        self.source_lines: list[str] = []
        self.assertions: list[str] = []

    def add(self, assignment: Any) -> None:
        """Adds what one assignment reads and what it must have stored."""
        kind = assignment.eClass.name
        if kind == "FieldAssignment":
            values = [self.source(path.strip()) for path in assignment.source.split(",")]
            expected = _converted(values, assignment.conversions)
            if expected is not None:
                self.expect(assignment.target, expected)
        elif kind == "ConstantAssignment":
            self.constant(assignment.target, assignment.value)

    def sample(self, path: str, place: str, limits: tuple[float, float], *, whole: bool) -> float:
        """Gives a source attribute its value, once."""
        if place not in self.values:
            number = len(self.values) + 1
            low, high = limits
            middle = (low + high) / 2 if math.isfinite(high - low) else 0.0
            first = (number, low) if whole else (number / 8, middle)
            tried = map(int if whole else float, (*first, *_OTHERS))
            value = next((each for each in tried if self._fits(path, each, limits)), None)
            if value is None:
                raise _NoExampleError(path)
            self.values[place] = value
            self.source_lines.append(f"source.{place} = {python_literal(value)}")
        return self.values[place]

    def _fits(self, path: str, value: float, limits: tuple[float, float]) -> bool:
        """Whether a source may have a value, and all that is made of it alone has a place."""
        if not limits[0] <= value <= limits[1]:
            return False
        for assignment in self.assignments:
            if assignment.eClass.name == "FieldAssignment" and assignment.source.strip() == path:
                result = _converted([value], assignment.conversions)
                if result is not None and not self.carries(assignment.target, result):
                    return False
        return True

    def carries(self, path: str, value: float) -> bool:
        """Whether a target can hold a number."""
        raise NotImplementedError

    def equal(self, place: str, value: float, tolerance: float = 1e-6) -> None:
        """Adds an assertion about a number of the target."""
        absolute = f", abs={python_literal(tolerance)}" if tolerance > 1e-6 else ""
        self.assertions.append(
            f"assert target.{place} == pytest.approx({python_literal(value)}{absolute})"
        )

    def source(self, path: str) -> float | None:
        """Fills a source attribute; None when its value is no number."""
        raise NotImplementedError

    def expect(self, path: str, value: float) -> None:
        """Asserts a number of the target."""
        raise NotImplementedError

    def constant(self, path: str, text: str) -> None:
        """Asserts a constant of the target."""
        raise NotImplementedError


class _ToRos(_Builder):
    def __init__(self, view: ConnectionView) -> None:
        super().__init__(view)
        self.assignments = self.map.toRos

    def source(self, path: str) -> float | None:
        field = jaus_field(self.view.message, path)
        for place, container in field.containers:
            line = f"{place} = {container}"
            if line not in self.source_lines:
                self.source_lines.append(line)
        if field.kind in _NUMBERS:
            return self.sample(path, field.attribute, field.limits, whole=field.kind == INTEGER)
        if field.kind == BITS and field.attribute not in self.values:
            self.values[field.attribute] = 0
            self.source_lines.append(f"source.{field.attribute} = {field.class_name}()")
        return None

    def carries(self, path: str, value: float) -> bool:
        low, high = INTEGER_RANGES.get(ros_field(self.map.type, path).type, (-math.inf, math.inf))
        return low <= value <= high

    def expect(self, path: str, value: float) -> None:
        field = ros_field(self.map.type, path)
        if ros_kind(field) == REAL:
            self.equal(path, value, 1e-6 * max(1.0, abs(value)) if field.type == "float32" else 0)

    def constant(self, path: str, text: str) -> None:
        code = ros_constant(ros_field(self.map.type, path), text).code
        self.assertions.append(f"assert target.{path} == {code}")


class _ToJaus(_Builder):
    def __init__(self, view: ConnectionView) -> None:
        super().__init__(view)
        self.assignments = self.map.toJaus

    def source(self, path: str) -> float | None:
        field = ros_field(self.map.type, path)
        kind = ros_kind(field)
        if kind not in _NUMBERS:
            return None
        return self.sample(path, path, (0, 100), whole=kind == INTEGER)

    def carries(self, path: str, value: float) -> bool:
        field = jaus_field(self.view.message, path)
        return any(low <= value <= high for low, high in field.values or (field.limits,))

    def expect(self, path: str, value: float) -> None:
        field = jaus_field(self.view.message, path)
        low, high = field.limits
        if field.kind == REAL and field.attribute not in self.values and low <= value <= high:
            self.equal(field.attribute, value)

    def constant(self, path: str, text: str) -> None:
        del path, text  # the codec's own round trip holds constants


def _converted(values: Sequence[float | None], conversions: Sequence[Any]) -> float | None:
    if len(values) > 1 or values[0] is None:
        return None
    value = values[0]
    for conversion in conversions:
        convert = _CONVERSIONS.get(conversion.kind.name)
        if convert is None:
            return None
        value = convert(value, *conversion.arguments)
    return value
