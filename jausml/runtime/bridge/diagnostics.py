"""Counts and reports of a connection of a bridge."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..transports.delivery import Double
    from .stops import StopReason

DOUBLE_LIFETIME = 10.0
"""Seconds after which a component with the same address that was heard no more is history."""


@dataclass(slots=True)
class Statistics:
    """Counts of one connection. Times are those of a steady clock.

    Attributes:
        arrivals: Messages taken from the source.
        passed: Messages given to the target side.
        safe_values: Safe values sent because the source was lost.
        stops: How often messages of the source ceased to stand, by reason.
        limited: Values that were moved into the range of their target field.
        out_of_range: Values that their target field could not carry, by policy and field.
        errors: Messages not passed on because of a value whose policy is `error`.
        drops: Messages not passed on, by reason.
        last_arrival: Seconds, None before the first message.
        handling_total: Nanoseconds spent from arrival to hand-over, all passed messages.
        handling_longest: The longest of these.
    """

    arrivals: int = 0
    passed: int = 0
    safe_values: int = 0
    stops: dict[StopReason, int] = field(default_factory=dict)
    limited: int = 0
    out_of_range: dict[tuple[str, str], int] = field(default_factory=dict)
    errors: int = 0
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


@dataclass(frozen=True, slots=True)
class ConnectionStatus:
    """State of a connection for `/diagnostics`.

    Attributes:
        name: Name of the connection.
        level: `ok`, `warning`, `error` or `stale`.
        message: The state in a few words.
        hardware_id: JAUS address of the bridge.
        values: Names and values in the order in which they are shown.
    """

    name: str
    level: str
    message: str
    hardware_id: str
    values: tuple[tuple[str, str], ...]


def double_status(double: Double, now: float) -> ConnectionStatus:
    """Returns the status of a bridge whose address somebody else was heard with.

    Args:
        double: The other one.
        now: Time of the loop.
    """
    age = now - double.last_heard
    values = (("place", double.place), ("age (s)", f"{age:.3f}"))
    level = "error" if age < DOUBLE_LIFETIME else "warning"
    return ConnectionStatus("jaus id", level, str(double), str(double.address), values)
