"""How long the message of a ROS topic stands for a report of a bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge


def is_report(connection: bridge.Connection) -> bool:
    """Whether a connection makes a JAUS report of ROS topics, which queries and events serve."""
    return connection.direction.name == "rosToJaus" and connection.exchange.name != "message"


def holds_state(connection: bridge.Connection) -> bool:
    """Whether the topics hold a state, whose last value is reported for as long as it takes."""
    policy = connection.whenStale.name
    if policy == "asMap" and connection.map is not None:
        policy = connection.map.whenStale.name
    return policy == "keep"


def freshness_of(connection: bridge.Connection) -> float:
    """Returns after how many seconds a message is too old to be reported; 0 for never.

    A silence time-out says the same: with a safe value that stands in, or without.
    """
    if not is_report(connection) or holds_state(connection) or connection.silenceTimeout:
        return 0.0
    stated = connection.freshness
    if not stated and connection.map is not None:
        stated = connection.map.freshness
    return float(stated)


def passed_rate(connection: bridge.Connection, hertz: float) -> float:
    """Returns how many messages pass each second at most."""
    hertz /= max(connection.decimation, 1)
    return min(hertz, connection.maxRate) if connection.maxRate > 0 else hertz
