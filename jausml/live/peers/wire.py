"""Bare JUDP endpoint: datagrams as they are, sent and received in the caller's own time."""

from __future__ import annotations

import select
import time
from typing import TYPE_CHECKING, NamedTuple

from jausml.runtime.transports.udp.shared_port import SharedPort

if TYPE_CHECKING:
    import socket
    from types import TracebackType

    from jausml.runtime.base.settings import Endpoint, TransportSettings

_LARGEST_DATAGRAM = 65535
_NEIGHBOUR_FRAME = b"\0"


class Arrival(NamedTuple):
    """One datagram as it arrived.

    Attributes:
        time: Monotonic time of its arrival in seconds.
    """

    time: float
    sender: Endpoint
    data: bytes


class Wire:
    """The sockets of a tool on the JUDP port, without any protocol (AS5669A).

    Takes the well-known port when it is free; otherwise another one, which peers learn from our
    datagrams. Nothing is acknowledged, repeated or put together here.
    """

    def __init__(self, settings: TransportSettings) -> None:
        """Open the sockets.

        Raises:
            OSError: The interface or the group cannot be used.
        """
        self._port = SharedPort(settings)
        self._port.open()

    def __enter__(self) -> Wire:
        """Return the wire; it is closed when the block ends."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close the sockets."""
        self.close()

    def close(self) -> None:
        """Close the sockets."""
        self._port.close()

    @property
    def group(self) -> Endpoint:
        """The multicast group, which reaches whoever listens."""
        return self._port.group

    @property
    def well_known(self) -> Endpoint:
        """The JUDP port of our interface, where the first stack of this host is reached."""
        return self._port.well_known

    def put(self, datagram: bytes, endpoint: Endpoint) -> None:
        """Send one datagram.

        Raises:
            OSError: The network refuses it.
        """
        if self._port.unicast is not None:
            self._port.unicast.sendto(datagram, endpoint)

    def receive(self, deadline: float) -> Arrival | None:
        """Return the next datagram of another process, or None when the time has come.

        Args:
            deadline: Monotonic time in seconds; what has arrived by then is still returned.
        """
        while True:
            wait = max(0.0, deadline - time.monotonic())
            readable, _, _ = select.select(self._sockets(), [], [], wait)
            for sock in readable:
                arrival = self._read(sock)
                if arrival is not None:
                    return arrival
            if not readable and time.monotonic() >= deadline:
                return None

    def _sockets(self) -> list[socket.socket]:
        both = (self._port.unicast, self._port.multicast)
        return [sock for sock in both if sock is not None]

    def _read(self, sock: socket.socket) -> Arrival | None:
        try:
            data, sender = sock.recvfrom(_LARGEST_DATAGRAM)
        except OSError:
            return None  # an earlier datagram reached nobody; the kernel says so here
        if sender in self._port.endpoints or data[:1] == _NEIGHBOUR_FRAME:
            return None  # our own multicast, or what processes sharing the port tell its owner
        return Arrival(time.monotonic(), sender, data)
