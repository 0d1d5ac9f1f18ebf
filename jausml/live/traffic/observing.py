"""Observed JUDP datagrams (AS5669A): their packets and messages, and the text of these."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from typing import Any

from jausml.live.messages import Catalogue, DecodedMessage, MessageError
from jausml.live.messages import text as messages
from jausml.live.traffic.frames import Datagram
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.packet import (
    EMPTY_MESSAGE_SIZE,
    JUDP_VERSION,
    AckNak,
    Broadcast,
    DataFlags,
    Packet,
    Priority,
    message_size,
    parse_datagram,
)
from jausml.runtime.transports.packets.reassembly import Reassembly
from jausml.runtime.transports.ports import FRAME

_REASSEMBLY_TIMEOUT = 10.0
_REASSEMBLY_LIMIT = 4 << 20
_HEADER_COMPRESSION = (0, 2)  # bytes that it adds to a header
_REASONS = {
    "judp.version_1": "JUDP version 1 (AS5669) is not supported, AS5669A has version 2",
    "judp.reference_architecture": "the JAUS Reference Architecture ('JAUS01.0') is not supported",
    "judp.truncated": "the data size of a message is larger than the datagram",
    "transport.bad_size": "the data size of a message is too small for its header",
    "transport.bad_message_type": "the message type is reserved",
    "transport.compressed": "the header is compressed, which is not supported",
    "judp.trailing_bytes": "bytes follow the last message",
}
_FRAGMENTS = {
    DataFlags.FIRST: "the first packet of a message of several",
    DataFlags.MIDDLE: "a middle packet of a message of several",
    DataFlags.LAST: "the last packet of a message of several, of which others are missing",
}

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


@dataclass(frozen=True)
class Observation:
    """A packet of the transport in a datagram, or a datagram that cannot be read.

    Attributes:
        packet: Header and payload; None when the datagram cannot be read.
        data_size: Bytes of header, payload and sequence number, by the header.
        payload: Code and body of the JAUS message; of a message of several packets, only the last
            received one has it.
        message: The decoded message, None without one.
        error: Why the datagram or the message cannot be read; else empty.
        fragment: Which of several packets it is, while others of the message are missing; else
            empty.
    """

    datagram: Datagram
    packet: Packet | None = None
    data_size: int = 0
    payload: bytes = b""
    message: DecodedMessage | None = None
    error: str = ""
    fragment: str = ""

    def to_json(self) -> dict[str, Any]:
        """Returns header, payload, and decoded message or error, as JSON values."""
        fields: dict[str, Any] = {}
        datagram, packet = self.datagram, self.packet
        if datagram.source is not None:
            fields = {
                "time": datagram.time,
                "number": datagram.number,
                "from": str(datagram.source),
                "to": str(datagram.destination),
            }
        if packet is not None:
            fields.update(
                version=JUDP_VERSION,
                data_size=self.data_size,
                priority=int(packet.priority),
                broadcast=int(packet.broadcast),
                ack_nak=int(packet.acknowledge),
                data_flags=int(packet.data_flags),
                destination=_parts(packet.destination),
                source=_parts(packet.source),
                sequence=packet.sequence,
                payload=packet.payload.hex(),
            )
        if self.message is not None:
            fields["message"] = self.message.to_json()
        if self.fragment:
            fields["fragment"] = self.fragment
        if self.error:
            fields["error"] = self.error
        return fields


def _parts(address: JausAddress) -> dict[str, int]:
    return {"subsystem": address.subsystem, "node": address.node, "component": address.component}


class _Reasons(Counters):
    """Counters that keep the names of the reasons why a datagram cannot be read."""

    def __init__(self) -> None:
        super().__init__()
        self.names: list[str] = []

    def count(self, name: str, *_: object, **__: object) -> None:
        """Keeps the name of a reason, without a log message."""
        self.names.append(name)


class Observer:
    """Reader of datagrams in their order, which joins messages of several packets.

    Without a catalogue messages are not decoded; `service` and `message` narrow which definition
    of a code is meant.

    Attributes:
        host_frames: Number of datagrams that are no JUDP, but pass between jausml processes of one
            host, which share its port in this way.
    """

    def __init__(
        self,
        catalogue: Catalogue | None = None,
        service: str | None = None,
        message: str | None = None,
    ) -> None:
        self.host_frames = 0
        self._catalogue = catalogue
        self._service = service
        self._message = message
        self._reassembly = Reassembly(_REASSEMBLY_TIMEOUT, _REASSEMBLY_LIMIT, _Reasons())

    def observe(self, datagram: Datagram) -> Iterator[Observation]:
        """Yields the messages of a datagram; for one that cannot be read, the fault."""
        if datagram.source is not None and datagram.data.startswith(FRAME):
            self.host_frames += 1
            return
        now = datagram.time or 0.0
        self._reassembly.expire(now)
        reasons = _Reasons()
        sizes = _data_sizes(datagram.data)
        for packet in parse_datagram(datagram.data, reasons):
            # Between the sizes of these messages are those of messages that cannot be read.
            least = EMPTY_MESSAGE_SIZE + len(packet.payload)
            size = next(
                (candidate for candidate in sizes if candidate - least in _HEADER_COMPRESSION),
                least,
            )
            yield self._with_message(Observation(datagram, packet, size), packet, now)
        for name in reasons.names:
            yield Observation(datagram, error=_reason(name, datagram.data))

    def _with_message(self, seen: Observation, packet: Packet, now: float) -> Observation:
        """Returns an observation with its payload and message, or the error."""
        if packet.acknowledge >= AckNak.NAK:
            return seen
        whole: Packet | None = packet
        if packet.data_flags is not DataFlags.SINGLE:
            whole = self._reassembly.add(packet, now)
        if whole is None:
            return replace(seen, fragment=_FRAGMENTS[packet.data_flags])
        seen = replace(seen, payload=whole.payload)
        if self._catalogue is None:
            return seen
        try:
            message = self._catalogue.decode(whole.payload, self._service, self._message)
        except MessageError as error:
            return replace(seen, error=str(error))
        return replace(seen, message=message)


def ends_of(datagram: Datagram) -> set[str]:
    """Returns the JAUS ids of senders and receivers of the readable messages in a datagram."""
    packets = parse_datagram(datagram.data, _Reasons())
    return {str(end) for packet in packets for end in (packet.source, packet.destination)}


def _data_sizes(data: bytes) -> Iterator[int]:
    """Yields the data sizes of the messages of a datagram, up to the first wrong one."""
    offset = 1
    while offset + EMPTY_MESSAGE_SIZE <= len(data):
        size = message_size(data, offset)
        if size < EMPTY_MESSAGE_SIZE:
            return
        yield size
        offset += size


def _reason(name: str, data: bytes) -> str:
    if not data:
        return "the datagram is empty"
    if name == "judp.bad_version":
        if data.startswith(FRAME):
            return "a frame between the jausml processes of one host, no JUDP"
        return f"JUDP version {data[0]} is not supported"
    return f"{_REASONS.get(name, name)} ({len(data)} bytes)"


def lines(observation: Observation) -> Iterator[str]:
    """Yields an observation as lines of text, with indented fields."""
    packet, message = observation.packet, observation.message
    head = [*_place(observation), *(_header(packet) if packet is not None else ())]
    if message is not None:
        head.append(messages.title(message))
    reason = observation.error or observation.fragment
    if reason:
        head.append(f"[{reason}]")
    yield "  ".join(head)
    if message is not None:
        yield from (f"  {line}" for line in messages.lines(message))
    elif reason:
        data = packet.payload if packet is not None else observation.datagram.data
        if data:
            rest = "..." if len(data) > _SHOWN_OCTETS else ""
            yield f"  {data[:_SHOWN_OCTETS].hex(' ')}{rest}"


def _place(observation: Observation) -> Iterator[str]:
    """Yields the time and the endpoints of a datagram, as far as known."""
    datagram = observation.datagram
    if datagram.time is not None:
        yield _clock(datagram.time)
    if datagram.source is not None:
        yield f"{datagram.source} > {datagram.destination}"


def _clock(time: float) -> str:
    """Returns the time of day in UTC; for a time out of range its seconds."""
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
    """Returns an address with `*` for wildcards."""
    everyone = (65535, 255, 255)
    parts = _parts(address).values()
    shown = ("*" if part == wild else str(part) for part, wild in zip(parts, everyone, strict=True))
    return ".".join(shown)
