"""What a report warns of: rates and times that do not go together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics import stops
from jausml.language.semantics.freshness import freshness_of
from jausml.views.analysis.constants import runtime_constants
from jausml.views.analysis.streams import ASSUMED, is_to_ros

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import bridge, jaus
    from jausml.views.analysis.streams import Stream

FEWEST_PERIODS = 2
"""Periods that a silence time-out must hold: one message may be lost."""


def warnings_of(
    connection: bridge.Connection, streams: list[Stream], topic_rate: float
) -> Iterator[str]:
    """Yields what does not go together in a connection.

    Args:
        topic_rate: Messages each second of its topics, where these are the source.
    """
    yield from _rates(connection)
    yield from _times(connection, streams, topic_rate)
    held = runtime_constants().held_by_peers
    for stream in streams:
        if stream.packets > held:
            yield (
                f"{stream.message} takes {stream.packets} packets; some peers hold no more than "
                f"{held} of an unfinished message"
            )


def _rates(connection: bridge.Connection) -> Iterator[str]:
    owner = connection.eContainer()
    if not is_to_ros(connection) or connection.exchange.name != "periodicEvent" or owner is None:
        return
    rate = float(connection.rate or owner.frequency)
    for peer in connection.peers:
        yield from asked_rate(peer, rate)


def asked_rate(provider: jaus.Component, rate: float) -> Iterator[str]:
    """Yields what is wrong with the rate that a client asks of a provider."""
    constants = runtime_constants()
    if rate > constants.highest_event_rate:
        yield f"{rate:g} Hz is more than an event can have, {constants.highest_event_rate:g} Hz"
    elif not provider.external and rate < constants.event_rate_min:
        lowest = constants.event_rate_min
        yield f"{provider.name} gives {lowest:g} Hz at least, {rate:g} Hz are asked"


def _times(
    connection: bridge.Connection, streams: list[Stream], topic_rate: float
) -> Iterator[str]:
    arriving = [each for each in streams if each.kind in ("message", "event", "report")]
    if not is_to_ros(connection):
        rate, is_assumed = topic_rate, True
    elif arriving:
        slowest = min(arriving, key=lambda each: each.hertz)
        rate, is_assumed = slowest.hertz, slowest.basis == ASSUMED
    else:
        return
    how = f"{'assumed ' if is_assumed else ''}period of {1 / rate:g} s"
    timeout = stops.silence_timeout(connection)
    if 0 < timeout < FEWEST_PERIODS / rate:
        yield f"silence time-out of {timeout:g} s is shorter than {FEWEST_PERIODS} times the {how}"
    freshness = freshness_of(connection)
    if 0 < freshness < 1 / rate:
        yield f"freshness of {freshness:g} s is shorter than the {how}"
