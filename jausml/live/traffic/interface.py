"""Capture of an interface of this host, in the process: what tcpdump does, for UDP. Linux alone.

It needs the capability CAP_NET_RAW, as tcpdump does.
"""

from __future__ import annotations

import ctypes
import socket
import struct
import time
from typing import TYPE_CHECKING

from jausml.live.traffic.captures import RAW_IP, CapturedFrame, TrafficError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from typing_extensions import Self

_ALL_PROTOCOLS, _IPV4, _IPV6 = 0x0003, 0x0800, 0x86DD
_OUTGOING, _LOOPBACK = 4, 772  # PACKET_OUTGOING, ARPHRD_LOOPBACK
_SOL_PACKET, _PACKET_STATISTICS = 263, 6
_SO_ATTACH_FILTER, _SO_TIMESTAMPNS = 26, 35
_ADDRESS_OF_INTERFACE = 0x8915  # SIOCGIFADDR
_LARGEST = 1 << 16
_BUFFER = 1 << 24
_TURN = 0.1
_EVERYWHERE = "0.0.0.0"  # noqa: S104 - what the user says for all interfaces
_NANO = 10**9

# UDP over IPv4; IPv6, whose headers the reader of frames looks through.
_FILTER = (
    (0x30, 0, 0, 0),  # the first byte
    (0x74, 0, 0, 4),  # its upper half, the version
    (0x15, 0, 2, 4),
    (0x30, 0, 0, 9),  # the protocol
    (0x15, 1, 2, 17),
    (0x15, 0, 1, 6),
    (0x06, 0, 0, 0x40000),
    (0x06, 0, 0, 0),
)


class InterfaceCapture:
    """Sees what passes an interface, that of others included, and takes no part in it."""

    def __init__(self, interface: str) -> None:
        """Begins to listen.

        Args:
            interface: IPv4 address of the interface, 0.0.0.0 for all.

        Raises:
            TrafficError: It cannot be captured here; the text says why.
        """
        try:
            kind = socket.SOCK_DGRAM  # without headers of the link
            self._socket = socket.socket(socket.AF_PACKET, kind, socket.htons(_ALL_PROTOCOLS))
        except AttributeError as error:
            raise TrafficError("captures in the process need Linux") from error
        except OSError as error:
            reason = f"{error.strerror}: that needs CAP_NET_RAW, as tcpdump does"
            raise TrafficError(f"cannot capture: {reason}") from error
        try:
            self._configure(interface)
        except OSError as error:
            self._socket.close()
            raise TrafficError(f"cannot capture {interface}: {error.strerror}") from error

    def _configure(self, interface: str) -> None:
        _attach_filter(self._socket)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        if interface != _EVERYWHERE:
            self._socket.bind((_name_of(interface), 0))
        self._socket.settimeout(_TURN)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def frames(self) -> Iterator[CapturedFrame | None]:
        """Yields frames as they pass, and None while none does, so that one can end."""
        number = 0
        while True:
            try:
                data, told, _, address = self._socket.recvmsg(_LARGEST, 64)
            except TimeoutError:
                yield None
                continue
            _, protocol, direction, hardware, *_ = address
            # What leaves by the loopback interface comes in there again.
            is_double = hardware == _LOOPBACK and direction == _OUTGOING
            if protocol in (_IPV4, _IPV6) and not is_double:
                number += 1
                now = _time_of(told)
                yield CapturedFrame(number, now / _NANO, RAW_IP, data, nanoseconds=now)

    def lost(self) -> int:
        """Returns how many frames the system had to drop since the last call."""
        told = self._socket.getsockopt(_SOL_PACKET, _PACKET_STATISTICS, 8)
        return int(struct.unpack("II", told)[1])


def _attach_filter(sock: socket.socket) -> None:
    """Has the system pass on what may be JUDP alone: ROS too speaks over UDP, and much."""
    code = b"".join(struct.pack("HBBI", *each) for each in _FILTER)
    kept = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("HL", len(_FILTER), ctypes.addressof(kept))
    sock.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, program)


def _time_of(told: list[tuple[int, int, bytes]]) -> int:
    """Returns when the system saw a frame, in nanoseconds since 1970."""
    for level, kind, data in told:
        if (level, kind) == (socket.SOL_SOCKET, _SO_TIMESTAMPNS):
            seconds, rest = struct.unpack("ll", data[:16])
            return int(seconds * _NANO + rest)
    return time.time_ns()


def _name_of(address: str) -> str:
    """Returns the name of the interface that has an address."""
    import fcntl  # noqa: PLC0415 - Windows has none

    wanted = socket.inet_aton(address)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode())
            try:
                found = fcntl.ioctl(probe, _ADDRESS_OF_INTERFACE, request)
            except OSError:  # it has no address
                continue
            if found[20:24] == wanted:
                return name
    raise OSError(0, "no interface has this address")
