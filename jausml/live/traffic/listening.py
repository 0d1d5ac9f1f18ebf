"""Listener on the network that takes no part: nothing is sent, the shared port stays free."""

from __future__ import annotations

import errno
import socket
import sys
import time
from typing import TYPE_CHECKING

from jausml.live.traffic.captures import TrafficError
from jausml.live.traffic.frames import Datagram, Endpoint

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.runtime.base.settings import TransportSettings

_LARGEST_DATAGRAM = 65535
_LONGEST_WAIT = 3600.0  # seconds; a socket does not take any number
_IP_MULTICAST_ALL = 49  # Linux; the socket module does not name it


class MulticastListener:
    """Hears the JUDP multicast group of an interface (AS5669A).

    A host hands unicast to the one process that owns the port, so none of it is heard here; a
    capture shows that.
    """

    def __init__(self, settings: TransportSettings) -> None:
        """Joins the group.

        Raises:
            TrafficError: The interface or the group cannot be used.
        """
        self._group = Endpoint(settings.multicast_group, settings.port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._join(settings)
        except OSError as error:
            self._socket.close()
            where = f"{self._group} on interface {settings.interface}"
            reason = f"cannot listen to {where}: {error.strerror}{_remedy(error, settings)}"
            raise TrafficError(reason) from error

    def _join(self, settings: TransportSettings) -> None:
        sock = self._socket
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if sys.platform == "darwin":
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, settings.receive_buffer)
        sock.bind(self._group)
        membership = socket.inet_aton(self._group.host) + socket.inet_aton(settings.interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        if sys.platform == "linux":
            # Hear the group on our interface only, whatever other processes joined.
            sock.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)

    def __enter__(self) -> MulticastListener:
        """Returns the listener, which is closed at the end of the block."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leaves the group."""
        self._socket.close()

    def datagrams(self, duration: float | None = None) -> Iterator[Datagram]:
        """Yields datagrams as they arrive.

        Args:
            duration: Seconds after which to end, None for never.
        """
        end = None if duration is None else time.monotonic() + duration
        number = 0
        while True:
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0:
                return
            self._socket.settimeout(None if left is None else min(left, _LONGEST_WAIT))
            try:
                data, sender = self._socket.recvfrom(_LARGEST_DATAGRAM)
            except TimeoutError:
                continue
            number += 1
            now = time.time_ns()
            yield Datagram(data, Endpoint(*sender), self._group, now / 1e9, number, now)


def _remedy(error: OSError, settings: TransportSettings) -> str:
    """Returns who has a port that is taken, and how its traffic is seen all the same."""
    if error.errno != errno.EADDRINUSE:
        return ""
    from jausml.runtime.transports.ports import who_holds  # noqa: PLC0415 - for errors alone

    return (
        f" and not shared; {who_holds('udp', settings)}. A capture shows its traffic: "
        f"tcpdump -i any -w - udp | jausml decode --port {settings.port} --pcap -"
    )
