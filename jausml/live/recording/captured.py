"""JAUS messages of a capture: whole ones, with reports out of their events."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from jausml.live.recording.translating import JausMessage
from jausml.live.traffic.observing import Observer
from jausml.runtime.messages import Event
from jausml.runtime.wire.message import DecodeError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.live.traffic.frames import Datagram
    from jausml.runtime.transports.packets.packet import Packet

_LEAST = 2
_EVENT = Event.CODE.to_bytes(2, "little")


class CapturedMessages:
    """The messages in datagrams, in their order."""

    def __init__(self) -> None:
        """Starts without packets."""
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
                if seen.is_problem:
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
