"""Somebody whom nobody knows: a bare socket that says what it likes."""

import contextlib
import socket
import threading
from collections.abc import Iterator
from typing import Any

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import CreateEvent, QueryStatus
from jausml.runtime.transports.packets.packet import AckNak, Packet, parse_datagram

_MOST_AT_ONCE = 1000

ROBOT = JausAddress(100, 1, 1)


def event(rate: float) -> bytes:
    """Returns a request of the status at a rate."""
    return CreateEvent(1, CreateEvent.EventType.PERIODIC_SC, rate, QueryStatus().encode()).encode()


class Stranger:
    """A socket on another host that says what it likes, and acknowledges if it likes."""

    def __init__(self, port: int, host: str, *, acknowledges: bool) -> None:
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.bind((host, 0))
        self.sock.settimeout(0.01)
        self._to = ("127.0.0.1", port)
        self._acknowledges = acknowledges
        self.sent = self.received = 0
        self.numbers: list[int] = []
        self.payloads: list[bytes] = []

    def send(self, source: JausAddress, payload: bytes, number: int = 1, **marks: Any) -> None:
        data = Packet(ROBOT, source, payload, number, **marks).encode()
        self.sent += len(data)
        self.sock.sendto(data, self._to)

    def take(self) -> None:
        """Takes what has come, and acknowledges."""
        for _ in range(_MOST_AT_ONCE):
            try:
                data = self.sock.recv(65535)
            except TimeoutError:
                return
            self.received += len(data)
            for packet in parse_datagram(data, Counters()):
                self.payloads.append(packet.payload)
                if packet.acknowledge == AckNak.REQUESTED:
                    self.numbers.append(packet.sequence)
                    if self._acknowledges:
                        self.send(packet.destination, b"", packet.sequence, acknowledge=AckNak.ACK)

    @contextlib.contextmanager
    def taking(self) -> Iterator[None]:
        """Takes what comes on a thread of its own, as another process would."""
        ended = threading.Event()

        def run() -> None:
            while not ended.is_set():
                self.take()

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
