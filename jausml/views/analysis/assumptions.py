"""Assumptions: what a model cannot say, such as how often a topic delivers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel.classes import bridge, jaus

Value = TypeVar("Value", int, float)

DEFAULT_RATE = 10.0
"""Messages each second of a topic or of a sender of which nothing is said."""

DEFAULT_LENGTH = 100
"""Elements of a list whose length is open."""


@dataclass(frozen=True)
class Assumptions:
    """What stands in where a model says nothing.

    Attributes:
        length: Elements of lists and bytes of octets.
        rates: Rates of some connections, by `connection` or `bridge.connection`.
    """

    rate: float = DEFAULT_RATE
    length: int = DEFAULT_LENGTH
    rates: Mapping[str, float] = field(default_factory=dict)
    lengths: Mapping[str, int] = field(default_factory=dict)

    def rate_of(self, connection: bridge.Connection | jaus.ServiceConnection) -> float:
        """Returns the messages each second of the source of a connection."""
        return _chosen(self.rates, connection, self.rate)

    def length_of(self, connection: bridge.Connection | jaus.ServiceConnection) -> int:
        """Returns the elements of lists in the messages of a connection."""
        return _chosen(self.lengths, connection, self.length)

    @property
    def names(self) -> frozenset[str]:
        """The connections of which something is said."""
        return frozenset({*self.rates, *self.lengths})


def names_of(connection: bridge.Connection | jaus.ServiceConnection) -> tuple[str, str]:
    """Returns the names by which assumptions know a connection, the more exact one first."""
    owner = connection.eContainer()
    around = owner.name if owner is not None else ""
    return f"{around}.{connection.name}", str(connection.name)


def _chosen(
    known: Mapping[str, Value],
    connection: bridge.Connection | jaus.ServiceConnection,
    otherwise: Value,
) -> Value:
    return next((known[name] for name in names_of(connection) if name in known), otherwise)
