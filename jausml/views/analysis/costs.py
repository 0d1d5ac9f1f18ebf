"""What messages cost the processor of a bridge (docs/adr/0023-costs-of-a-bridge.md).

The figures are rounded up from those that `make bench` writes (docs/performance.md): they tell
bridges apart, and promise nothing about a computer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge
    from jausml.views.analysis.sizes import Size
    from jausml.views.analysis.streams import Stream

MESSAGE = 65e-6
"""Seconds for a message to come in, be translated and go out: a bridge carries 15,000 a second."""

PACKET = 15e-6
"""Seconds for each further packet, acknowledgement or topic: a grid of 40 kB has ten."""

BYTE = 1.5e-9
"""Seconds for each byte of a ROS message besides: 60 kB take a tenth of a millisecond."""


def seconds_of(
    connection: bridge.Connection, streams: list[Stream], ros_size: Size, arriving: float
) -> float:
    """Returns the processor time of a connection in each second: the share of one processor."""
    topics = sum(each.join is None for each in connection.topics)
    packets = sum(
        each.hertz * each.packets * (2 if each.is_acknowledged else 1) for each in streams
    )
    each = MESSAGE + topics * PACKET + ros_size.expected * BYTE
    return arriving * each + packets * PACKET


def seconds_of_message(streams: list[Stream], ros_size: Size) -> float:
    """Returns how long one message of a connection keeps the loop of its bridge busy."""
    packets = max((each.packets for each in streams), default=1) * max(len(streams), 1)
    return MESSAGE + packets * PACKET + ros_size.expected * BYTE
