"""Text for people of what was observed."""

from __future__ import annotations

from datetime import datetime, timezone
from typing import TYPE_CHECKING

from jausml.live.messages import text as messages
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Priority

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.traffic.observing import Observation
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.transports.packets.packet import Packet


_SHOWN_OCTETS = 64
_PRIORITIES = {
    Priority.LOW: "low priority",
    Priority.HIGH: "high priority",
    Priority.SAFETY_CRITICAL: "safety critical",
}
_BROADCASTS = {Broadcast.LOCAL: "local broadcast", Broadcast.GLOBAL: "global broadcast"}
_ACKNOWLEDGEMENTS = {
    AckNak.REQUESTED: "acknowledgement wanted",
    AckNak.NAK: "negative acknowledgement",
    AckNak.ACK: "acknowledgement",
}
_DATA_FLAGS = {
    DataFlags.FIRST: "first packet",
    DataFlags.MIDDLE: "middle packet",
    DataFlags.LAST: "last packet",
}


def lines(observation: Observation) -> Iterator[str]:
    """Yields the lines of an observation; the fields are indented."""
    packet, message = observation.packet, observation.message
    head = [*_place(observation), *(_header(packet) if packet is not None else ())]
    if message is not None:
        head.append(messages.title(message))
    if observation.error:
        head.append(f"[{observation.error}]")
    yield "  ".join(head)
    if message is not None:
        yield from (f"  {line}" for line in messages.lines(message))
    elif observation.error:
        data = packet.payload if packet is not None else observation.datagram.data
        if data:
            rest = "..." if len(data) > _SHOWN_OCTETS else ""
            yield f"  {data[:_SHOWN_OCTETS].hex(' ')}{rest}"


def _place(observation: Observation) -> Iterator[str]:
    """Yields when and between which endpoints a datagram was seen, where that is known."""
    datagram = observation.datagram
    if datagram.time is not None:
        yield _clock(datagram.time)
    if datagram.source is not None:
        yield f"{datagram.source} > {datagram.destination}"


def _clock(time: float) -> str:
    """Returns the time of day in UTC; the time itself when no calendar holds it."""
    try:
        return f"{datetime.fromtimestamp(time, timezone.utc):%H:%M:%S.%f}"
    except (OverflowError, ValueError, OSError):
        return str(time)


def _header(packet: Packet) -> Iterator[str]:
    yield f"{_address(packet.source)} > {_address(packet.destination)}"
    yield f"#{packet.sequence}"
    flags = (
        _PRIORITIES.get(packet.priority),
        _BROADCASTS.get(packet.broadcast),
        _ACKNOWLEDGEMENTS.get(packet.acknowledge),
        _DATA_FLAGS.get(packet.data_flags),
    )
    yield from filter(None, flags)


def _address(address: JausAddress) -> str:
    """Returns an address with `*` for parts that mean all."""
    everyone = (65535, 255, 255)
    parts = (address.subsystem, address.node, address.component)
    shown = ("*" if part == wild else str(part) for part, wild in zip(parts, everyone, strict=True))
    return ".".join(shown)
