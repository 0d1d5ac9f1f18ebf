"""From JUDP datagrams to messages, as a bystander sees them (AS5669A)."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.messages import MessageError
from jausml.runtime.counters import Counters
from jausml.runtime.packet import (
    EMPTY_MESSAGE_SIZE,
    JUDP_VERSION,
    AckNak,
    DataFlags,
    parse_datagram,
)
from jausml.runtime.reassembly import Reassembly

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.messages import Catalogue, DecodedMessage
    from jausml.runtime.address import JausAddress
    from jausml.runtime.packet import Packet
    from jausml.traffic.frames import Datagram

_REASSEMBLY_TIMEOUT = 10.0
_REASSEMBLY_LIMIT = 4 << 20
_VERSIONS = {
    0: "a frame between the jausml processes of one host, no JUDP",
    1: "JUDP version 1 (AS5669) is not supported, AS5669A has version 2",
    ord("J"): "OPC 2.75 of the JAUS Reference Architecture ('JAUS01.0') is not supported",
}
_REASONS = {
    "judp.truncated": "the data size of a message is larger than the datagram",
    "judp.bad_size": "the data size of a message is too small for its header",
    "judp.bad_message_type": "the message type is reserved",
    "judp.compressed": "the header is compressed, which is not supported",
    "judp.trailing_bytes": "bytes follow the last message",
}
_FRAGMENTS = {
    DataFlags.FIRST: "the first packet of a message of several",
    DataFlags.MIDDLE: "a middle packet of a message of several",
    DataFlags.LAST: "the last packet of a message of several, of which others are missing",
}


@dataclass(frozen=True)
class Observation:
    """A message of the transport as it was seen, or a datagram that cannot be read.

    Attributes:
        datagram: The datagram in which it stood.
        packet: Its header and payload, None when the datagram cannot be read.
        message: The JAUS message; that of several packets stands with the packet that completes it.
        error: Why there is no message, empty when there is one or none is due.
        is_fragment: Whether it is a packet of a message of several.
    """

    datagram: Datagram
    packet: Packet | None = None
    message: DecodedMessage | None = None
    error: str = ""
    is_fragment: bool = False

    @property
    def is_problem(self) -> bool:
        """Whether something cannot be read; a packet that waits for others is none."""
        return bool(self.error) and not self.is_fragment

    def to_json(self) -> dict[str, Any]:
        """Returns header, payload, and the decoded message or what is wrong."""
        found: dict[str, Any] = {}
        datagram, packet = self.datagram, self.packet
        if datagram.source is not None:
            found = {
                "time": datagram.time,
                "number": datagram.number,
                "from": str(datagram.source),
                "to": str(datagram.destination),
            }
        if packet is not None:
            found.update(
                version=JUDP_VERSION,
                data_size=EMPTY_MESSAGE_SIZE + len(packet.payload),
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
            found["message"] = self.message.to_json()
        if self.error:
            found["error"] = self.error
        return found


def _parts(address: JausAddress) -> dict[str, int]:
    return {
        "subsystem": address.subsystem,
        "node": address.node,
        "component": address.component,
    }


class _Reasons(Counters):
    """Keeps why a datagram, or a part of it, cannot be read."""

    def __init__(self) -> None:
        super().__init__()
        self.names: list[str] = []

    def count(
        self,
        name: str,
        detail: str = "",
        *,
        error: BaseException | None = None,
        level: int = logging.WARNING,
    ) -> None:
        """Keeps a reason instead of logging it."""
        del detail, error, level
        self.names.append(name)


class Observer:
    """Reads datagrams in their order and puts messages of several packets together."""

    def __init__(self, catalogue: Catalogue, service: str | None = None) -> None:
        """Starts with no packets.

        Args:
            catalogue: What messages there are.
            service: Service whose messages are meant where a code has several meanings.
        """
        self._catalogue = catalogue
        self._service = service
        self._reasons = _Reasons()
        self._reassembly = Reassembly(_REASSEMBLY_TIMEOUT, _REASSEMBLY_LIMIT, self._reasons)

    def observe(self, datagram: Datagram) -> Iterator[Observation]:
        """Yields the messages of a datagram; one that cannot be read yields what is wrong.

        Args:
            datagram: The datagram.
        """
        now = datagram.time or 0.0
        self._reassembly.expire(now)
        self._reasons.names.clear()
        for packet in parse_datagram(datagram.data, self._reasons):
            yield self._observed(datagram, packet, now)
        for name in self._reasons.names:
            if name in _REASONS or name == "judp.bad_version":
                yield Observation(datagram, error=_reason(name, datagram.data))

    def _observed(self, datagram: Datagram, packet: Packet, now: float) -> Observation:
        if packet.acknowledge >= AckNak.NAK:
            return Observation(datagram, packet)
        payload = packet.payload
        is_fragment = packet.data_flags is not DataFlags.SINGLE
        if is_fragment:
            whole = self._reassembly.add(packet, now)
            if whole is None:
                error = _FRAGMENTS[packet.data_flags]
                return Observation(datagram, packet, error=error, is_fragment=True)
            payload = whole.payload
        try:
            message = self._catalogue.decode(payload, self._service)
        except MessageError as error:
            return Observation(datagram, packet, error=str(error))
        return Observation(datagram, packet, message, is_fragment=is_fragment)


def _reason(name: str, data: bytes) -> str:
    if not data:
        return "the datagram is empty"
    if name == "judp.bad_version":
        return _VERSIONS.get(data[0], f"JUDP version {data[0]} is not supported")
    return f"{_REASONS[name]} ({len(data)} bytes)"
