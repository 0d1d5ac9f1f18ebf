"""JAUS messages in captured datagrams, and their JSON in recordings.

Of an event, the report in it counts as the message.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from jausml.live.messages import Catalogue, MessageError
from jausml.live.messages.values import as_numbers
from jausml.live.recording.mcap_files import McapFile
from jausml.live.traffic.frames import Datagram
from jausml.live.traffic.observing import Observer
from jausml.runtime.messages import Event
from jausml.runtime.transports.packets.packet import Packet
from jausml.runtime.wire.message import DecodeError

_LEAST = 2
_EVENT = Event.CODE.to_bytes(2, "little")


@dataclass(frozen=True)
class JausMessage:
    """A JAUS message of a recording.

    Attributes:
        time: Nanoseconds since 1970.
        source: JAUS id of the sender.
        payload: Message code and body.
    """

    time: int
    source: str
    subsystem: int
    payload: bytes

    @property
    def code(self) -> int:
        """Message code."""
        return int.from_bytes(self.payload[:2], "little")


class CapturedMessages:
    """The messages in datagrams, in their order.

    Attributes:
        count: Number of messages.
        skipped: Numbers of skipped datagrams and packets, by reason.
    """

    def __init__(self) -> None:
        """Begins without a packet."""
        self.count = 0
        self.skipped: Counter[str] = Counter()
        self._observer = Observer()

    def read(self, datagrams: Iterable[Datagram]) -> Iterator[tuple[JausMessage, Packet]]:
        """Yields messages, each with the packet that completes it."""
        for datagram in datagrams:
            if datagram.nanoseconds is None:
                self.skipped["datagrams of which the capture does not tell the time"] += 1
                continue
            for seen in self._observer.observe(datagram):
                if seen.error:
                    self.skipped[seen.error] += 1
                elif seen.packet is not None and len(seen.payload) >= _LEAST:
                    self.count += 1
                    yield self._message(datagram.nanoseconds, seen.packet, seen.payload)

    def _message(self, time: int, packet: Packet, payload: bytes) -> tuple[JausMessage, Packet]:
        source = packet.source
        message = JausMessage(time, str(source), source.subsystem, _report_in(payload))
        return message, packet


def _report_in(payload: bytes) -> bytes:
    """Returns the report of an event (AS5710, Event), or the payload itself."""
    if payload[:_LEAST] != _EVENT:
        return payload
    try:
        return Event.decode(payload).report_message
    except DecodeError:
        return payload


class JausWriter:
    """Writer of JAUS messages as JSON (`undecoded`: numbers of messages left out, by reason)."""

    def __init__(self, catalogue: Catalogue) -> None:
        """Begins without a message."""
        self.undecoded: Counter[str] = Counter()
        self._catalogue = catalogue

    def write(self, file: McapFile, message: JausMessage, packet: Packet) -> None:
        """Writes a message, unless it cannot be decoded (`packet`: the one that completed it)."""
        try:
            decoded_message = self._catalogue.decode(message.payload)
            channel = file.jaus_channel(message.source, decoded_message.entry)
        except MessageError as error:
            self.undecoded[str(error)] += 1
            return
        value = {
            "source": message.source,
            "destination": str(packet.destination),
            "sequence": packet.sequence,
            "payload": message.payload.hex(),
            "fields": as_numbers(decoded_message.entry.shortened(decoded_message.fields)),
        }
        file.write_json(channel, message.time, value)
