"""Passive listeners to a network: to the multicast group of JAUS, or to all of an interface.

The capture of an interface works like tcpdump, for UDP on Linux, and needs CAP_NET_RAW, too.
"""

from __future__ import annotations

import ctypes
import errno
import socket
import struct
import time
from collections.abc import Iterator

from jausml.live.traffic.captures import RAW_IP, CapturedFrame, TrafficError
from jausml.live.traffic.frames import Datagram, Endpoint
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.ports import group_socket, join_again, who_holds

_ALL_PROTOCOLS, _IPV4, _IPV6 = 0x0003, 0x0800, 0x86DD
_OUTGOING, _LOOPBACK = 4, 772  # PACKET_OUTGOING, ARPHRD_LOOPBACK
_SOL_PACKET, _PACKET_STATISTICS = 263, 6
_SO_ATTACH_FILTER, _SO_TIMESTAMPNS = 26, 35
_ADDRESS_OF_INTERFACE = 0x8915  # SIOCGIFADDR
_LARGEST = 1 << 16
_BUFFER = 1 << 24
_TURN = 0.1
_EVERYWHERE = "0.0.0.0"  # noqa: S104 - the option for all interfaces
_NANO = 10**9

_LARGEST_DATAGRAM = 65535
_CHECK = 1.0  # seconds without a datagram after which an interface may have been removed
# A filter of the kernel for UDP over IPv4, and IPv6, whose headers `frames` reads.
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
    """Capture of all UDP frames of an interface (its IPv4 address), also of other hosts.

    Attributes:
        outages: How often the interface went down.
    """

    def __init__(self, interface: str) -> None:
        self.outages = 0
        self._interface = interface
        try:
            kind = socket.SOCK_DGRAM  # without headers of the link
            self._socket = socket.socket(socket.AF_PACKET, kind, socket.htons(_ALL_PROTOCOLS))
        except AttributeError as error:
            raise TrafficError("captures in the process need Linux") from error
        except OSError as error:
            reason = f"{error.strerror}: that needs CAP_NET_RAW, as tcpdump does"
            raise TrafficError(f"cannot capture: {reason}") from error
        try:
            self._configure()
        except OSError as error:
            self._socket.close()
            raise TrafficError(f"cannot capture {interface}: {error.strerror}") from error

    def _configure(self) -> None:
        _attach_filter(self._socket)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        self._socket.settimeout(_TURN)
        self._bind()

    def _bind(self) -> None:
        if self._interface != _EVERYWHERE:
            self._socket.bind((_name_of(self._interface), 0))

    def __enter__(self) -> InterfaceCapture:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def frames(self) -> Iterator[CapturedFrame | None]:
        """Yields frames as they pass, and None after a while without one, so that one can end."""
        number, is_down = 0, False
        while True:
            try:
                if is_down:
                    self._bind()  # to another device, if it was removed and has come back
                data, ancillary_data, _, address = self._socket.recvmsg(_LARGEST, 64)
            except TimeoutError:
                is_down = False
                yield None
                continue
            except OSError:
                self.outages += not is_down
                is_down = True
                yield None
                time.sleep(_TURN)
                continue
            is_down = False
            _, protocol, direction, hardware, *_ = address
            # Each frame of the loopback interface is both outgoing and incoming.
            is_double = hardware == _LOOPBACK and direction == _OUTGOING
            if protocol in (_IPV4, _IPV6) and not is_double:
                number += 1
                now = _time_of(ancillary_data)
                yield CapturedFrame(number, now / _NANO, RAW_IP, data, nanoseconds=now)

    def lost(self) -> int:
        """Returns the number of frames that the system dropped since the last call."""
        statistics = self._socket.getsockopt(_SOL_PACKET, _PACKET_STATISTICS, 8)
        return int(struct.unpack("II", statistics)[1])


def _attach_filter(sock: socket.socket) -> None:
    """Has the kernel drop frames that cannot be UDP."""
    code = b"".join(struct.pack("HBBI", *instruction) for instruction in _FILTER)
    kept = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("HL", len(_FILTER), ctypes.addressof(kept))
    sock.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, program)


def _time_of(ancillary_data: list[tuple[int, int, bytes]]) -> int:
    """Returns the time of a frame by the kernel, in nanoseconds since 1970."""
    for level, kind, data in ancillary_data:
        if (level, kind) == (socket.SOL_SOCKET, _SO_TIMESTAMPNS):
            seconds, rest = struct.unpack("ll", data[:16])
            return int(seconds * _NANO + rest)
    return time.time_ns()


def _name_of(address: str) -> str:
    """Returns the name of the interface with an address (`OSError`: there is none)."""
    import fcntl  # noqa: PLC0415 - Windows has none

    wanted = socket.inet_aton(address)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode())
            try:
                reply = fcntl.ioctl(probe, _ADDRESS_OF_INTERFACE, request)
            except OSError:  # it has no address
                continue
            if reply[20:24] == wanted:
                return name
    raise OSError(0, "no interface has this address")


class MulticastListener:
    """Listener to the JUDP multicast group of an interface (AS5669A).

    Unicast does not come here, as the host gives it to the process that owns the port; a capture
    of the interface has it.
    """

    def __init__(self, settings: TransportSettings) -> None:
        self._settings = settings
        self._group = Endpoint(settings.multicast_group, settings.port)
        try:
            self._socket = group_socket(settings)
        except OSError as error:
            where = f"{self._group} on interface {settings.interface}"
            reason = f"cannot listen to {where}: {error.strerror}{_remedy(error, settings)}"
            raise TrafficError(reason) from error

    def __enter__(self) -> MulticastListener:
        """Returns the listener, which is closed at the end of the block."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leaves the group."""
        self._socket.close()

    def datagrams(self, duration: float | None = None) -> Iterator[Datagram]:
        """Yields datagrams as they arrive, for `duration` seconds or without end."""
        end = None if duration is None else time.monotonic() + duration
        number = 0
        while True:
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0:
                return
            self._socket.settimeout(_CHECK if left is None else min(left, _CHECK))
            try:
                data, sender = self._socket.recvfrom(_LARGEST_DATAGRAM)
            except TimeoutError:
                join_again(self._socket, self._settings)
                continue
            number += 1
            now = time.time_ns()
            yield Datagram(data, Endpoint(*sender), self._group, now / 1e9, number, now)


def _remedy(error: OSError, settings: TransportSettings) -> str:
    """Returns, for a port in use, its holder and the command of a capture; else empty."""
    if error.errno != errno.EADDRINUSE:
        return ""
    return (
        f" and not shared; {who_holds('udp', settings)}. A capture shows its traffic: "
        f"tcpdump -i any -w - udp | jausml decode --port {settings.port} --pcap -"
    )
