"""What a connection of a bridge counts, and the limits that it puts on values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field


class OutOfRangeError(ValueError):
    """A value that the target field cannot carry."""


class AbsentFieldError(ValueError):
    """An optional JAUS field that a translation cannot do without."""


@dataclass(slots=True)
class Statistics:
    """Counts of one connection. Times are those of a steady clock.

    Attributes:
        arrivals: Messages taken from the source.
        passed: Messages given to the target side.
        safe_values: Safe values sent because the source was silent.
        limited: Values that were moved into the range of their target field.
        drops: Messages not passed on, by reason.
        last_arrival: Seconds, None before the first message.
        handling_total: Nanoseconds spent from arrival to hand-over, all passed messages.
        handling_longest: The longest of these.
    """

    arrivals: int = 0
    passed: int = 0
    safe_values: int = 0
    limited: int = 0
    drops: dict[str, int] = field(default_factory=dict)
    last_arrival: float | None = None
    handling_total: int = 0
    handling_longest: int = 0

    def handled(self, nanoseconds: int) -> None:
        """Notes that a message was passed on, and how long that took."""
        self.passed += 1
        self.handling_total += nanoseconds
        self.handling_longest = max(self.handling_longest, nanoseconds)

    @property
    def handling_mean(self) -> float:
        """Nanoseconds that a message took on the average; 0 before the first."""
        return self.handling_total / self.passed if self.passed else 0.0


class Limit:
    """Keeps values within the range of their target field.

    Attributes:
        clamp: True to use the nearest legal value, False to refuse the message.
    """

    def __init__(self, statistics: Statistics, *, clamp: bool) -> None:
        """Prepares the limits of one connection.

        Args:
            statistics: Where moved values are counted.
            clamp: True to use the nearest legal value, False to refuse the message.
        """
        self._statistics = statistics
        self.clamp = clamp

    def __call__(self, name: str, value: float, minimum: float, maximum: float) -> float:
        """Returns the value, moved into minimum .. maximum when the model says so.

        Args:
            name: The target field, for the log.
            value: What the conversions gave.
            minimum: Least value that the field carries.
            maximum: Greatest value that the field carries.

        Raises:
            OutOfRangeError: The value is outside and shall not be moved, or is not a number.
        """
        if minimum <= value <= maximum:
            return value
        if math.isnan(value):
            # No legal value is nearest to it.
            raise OutOfRangeError(f"{name} is not a number")
        if not self.clamp:
            raise OutOfRangeError(f"{name} is {value}, outside {minimum} .. {maximum}")
        self._statistics.limited += 1
        return minimum if value < minimum else maximum

    def integer(self, name: str, value: float, minimum: int, maximum: int) -> int:
        """Returns the nearest integer within minimum .. maximum, as the call itself does.

        Raises:
            OutOfRangeError: The value is outside and shall not be moved, or is not a number.
        """
        # First the range: an infinite value has no integer.
        return round(self(name, value, minimum, maximum))
