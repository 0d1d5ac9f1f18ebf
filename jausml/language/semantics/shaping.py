"""How many messages of a connection pass, of those that come."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge


def passed_rate(connection: bridge.Connection, hertz: float) -> float:
    """Returns how many messages pass each second at most."""
    hertz /= max(connection.decimation, 1)
    return min(hertz, connection.maxRate) if connection.maxRate > 0 else hertz
