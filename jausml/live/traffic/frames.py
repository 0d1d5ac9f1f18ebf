"""UDP datagrams in frames, over IPv4 and IPv6 with fragments, and frames of datagrams.

JUDP on other ports is found, too: of processes that share the port of a host, one owns it; the
others have a port of a known range, or any port, which peers learn from their datagrams (AS5669A).
Multicast shows these ports, since it goes to the known one.
"""

from __future__ import annotations

import socket
import struct
from collections import Counter, OrderedDict
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

from jausml.live.traffic.captures import RAW_IP, CapturedFrame

_JUDP_VERSION = 2
_LEAST_SIZE = 14
_HEADER = struct.Struct("<BH")
_MESSAGE_TYPE = 0x3F
_MOST_ENDPOINTS = 4096
_ETHERNET, _NULL, _LOOP, _LINUX_COOKED, _LINUX_COOKED_2 = 1, 0, 108, 113, 276
_RAW_IP = (12, 14, 101, 228, 229)
_IPV4, _IPV6 = 0x0800, 0x86DD
_VLAN_TAGS = (0x8100, 0x88A8, 0x9100)
_UDP = 17
_IPV6_FRAGMENT = 44
_IPV6_EXTENSIONS = (0, 43, 60)  # hop by hop, routing, destination options
_MAXIMUM_PENDING = 64
_LARGEST_DATAGRAM = 65535
_PCAP_IN_NANOSECONDS = 0xA1B23C4D
_LARGEST_FRAME = 1 << 18
_NANO = 10**9
_TIME_TO_LIVE = 16


class Endpoint(NamedTuple):
    """An IP address and a UDP port."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


class OtherPorts:
    """Endpoints that are known to speak JUDP by their datagrams.

    Attributes:
        unclaimed: Number of datagrams in the form of JUDP between unknown endpoints.
    """

    def __init__(self, port: int) -> None:
        self.unclaimed = 0
        # Imported here, as hexadecimal text does not need the runtime.
        from jausml.runtime.transports.ports import neighbour_ports  # noqa: PLC0415

        self._neighbours = neighbour_ports(port)
        self._known: set[Endpoint] = set()

    def learn(self, *endpoints: Endpoint) -> None:
        """Adds endpoints that speak JUDP, up to a limit."""
        if len(self._known) < _MOST_ENDPOINTS:
            self._known.update(endpoints)

    def takes(self, source: Endpoint, destination: Endpoint) -> bool:
        """Returns whether one end of a datagram in the form of JUDP is known; else counts it."""
        if source in self._known or destination in self._known:
            return True
        if source.port in self._neighbours or destination.port in self._neighbours:
            return True
        self.unclaimed += 1
        return False


def is_judp(data: bytes) -> bool:
    """Returns whether all bytes of a datagram have the form of JUDP."""
    offset = 1
    if data[:1] != bytes([_JUDP_VERSION]) or len(data) < 1 + _LEAST_SIZE:
        return False
    while offset + _LEAST_SIZE <= len(data):
        kind, size = _HEADER.unpack_from(data, offset)
        if kind & _MESSAGE_TYPE or size < _LEAST_SIZE:
            return False
        offset += size
    return offset == len(data)


@dataclass(frozen=True)
class Datagram:
    """A UDP datagram.

    Attributes:
        time: Seconds since 1970, None if unknown.
        number: Number of the frame or line that completed it, from 1.
        nanoseconds: The exact time in nanoseconds, None if unknown.
    """

    data: bytes
    source: Endpoint | None = None
    destination: Endpoint | None = None
    time: float | None = None
    number: int | None = None
    nanoseconds: int | None = None


class _Cut(Exception):  # noqa: N818 - it is no error of ours: the capture kept too few bytes
    """A frame that ends within a header or within the datagram."""


@dataclass
class _Fragments:
    """The fragments of one IP packet."""

    parts: dict[int, bytes] = field(default_factory=dict)
    size: int | None = None

    def whole(self) -> bytes | None:
        """Returns the content of the packet, None while a fragment is missing."""
        if self.size is None:
            return None
        data = bytearray()
        for offset in sorted(self.parts):
            if offset > len(data):
                return None
            data[offset:] = self.parts[offset]
        return bytes(data) if len(data) == self.size else None


class UdpReader:
    """Finds the UDP datagrams of a port in frames, and JUDP on other ports.

    Attributes:
        skipped: Numbers of skipped frames and packets, by reason.
    """

    def __init__(self, port: int) -> None:
        self.skipped: Counter[str] = Counter()
        self.other_ports = OtherPorts(port)
        self._port = port
        self._pending: OrderedDict[tuple[bytes, bytes, int], _Fragments] = OrderedDict()

    def read(self, frame: CapturedFrame) -> Datagram | None:
        """Returns the datagram that a frame holds or completes, None without one."""
        try:
            packet = self._ip_packet(frame)
            if packet is None:
                return None
            if packet[0] >> 4 == 4:
                return self._ipv4(packet, frame)
            return self._ipv6(packet, frame) if packet[0] >> 4 == 6 else None
        except (_Cut, struct.error, IndexError):
            self.skipped["frames that were cut" if frame.is_cut else "malformed frames"] += 1
            return None

    @property
    def unfinished(self) -> int:
        """Number of IP packets with missing fragments."""
        return len(self._pending)

    def _ip_packet(self, frame: CapturedFrame) -> bytes | None:
        """Returns the IP packet in a frame, None for another protocol."""
        data, link = frame.data, frame.link_type
        if link in _RAW_IP:
            return data or None
        if link in (_NULL, _LOOP):
            return data[4:] or None  # without the address family, as IP has its version itself
        if link == _ETHERNET:
            at = 12
        elif link == _LINUX_COOKED:
            at = 14
        elif link == _LINUX_COOKED_2:
            at = 0
        else:
            self.skipped[f"frames of link type {link}, which is not supported"] += 1
            return None
        (protocol,) = struct.unpack_from(">H", data, at)
        at = 20 if link == _LINUX_COOKED_2 else at + 2
        while protocol in _VLAN_TAGS:
            (protocol,) = struct.unpack_from(">H", data, at + 2)
            at += 4
        return data[at:] or None if protocol in (_IPV4, _IPV6) else None

    def _ipv4(self, packet: bytes, frame: CapturedFrame) -> Datagram | None:
        length, identity, fragment, protocol = struct.unpack_from(">2xHHHxB", packet)
        if protocol != _UDP:
            return None
        hosts = packet[12:16], packet[16:20]
        start = 4 * (packet[0] & 0xF)
        # The length is 0 if the network card divides packets (TCP segmentation offload).
        content = packet[start : length or None]
        if start < 20 or len(packet) < length:
            # Datagrams of other ports do not matter.
            if fragment & 0x1FFF or not self._is_ours(content):
                return None
            raise _Cut
        whole = self._joined(
            (*hosts, identity), content, 8 * (fragment & 0x1FFF), last=not fragment & 0x2000
        )
        return self._udp(whole, socket.AF_INET, hosts, frame) if whole is not None else None

    def _ipv6(self, packet: bytes, frame: CapturedFrame) -> Datagram | None:
        length, following = struct.unpack_from(">4xHB", packet)
        hosts = packet[8:24], packet[24:40]
        content, at = packet[40 : 40 + length], 0
        offset, identity, last = 0, 0, True
        while following in _IPV6_EXTENSIONS or following == _IPV6_FRAGMENT:
            if following == _IPV6_FRAGMENT:
                following, bits, identity = struct.unpack_from(">BxHI", content, at)
                offset, last = bits & 0xFFF8, not bits & 1
                at += 8
            else:
                following, size = struct.unpack_from(">BB", content, at)
                at += 8 * (size + 1)
        if following != _UDP:
            return None
        if len(packet) < 40 + length:
            if offset or not self._is_ours(content[at:]):
                return None
            raise _Cut
        whole = self._joined((*hosts, identity), content[at:], offset, last=last)
        return self._udp(whole, socket.AF_INET6, hosts, frame) if whole is not None else None

    def _joined(
        self, key: tuple[bytes, bytes, int], content: bytes, offset: int, *, last: bool
    ) -> bytes | None:
        """Returns the content of a packet, None while a fragment is missing."""
        if last and not offset:
            return content
        fragments = self._pending.setdefault(key, _Fragments())
        if offset + len(content) > _LARGEST_DATAGRAM:
            del self._pending[key]
            self.skipped["IP packets whose fragments are too long"] += 1
            return None
        fragments.parts[offset] = content
        if last:
            fragments.size = offset + len(content)
        whole = fragments.whole()
        if whole is not None:
            del self._pending[key]
        elif len(self._pending) > _MAXIMUM_PENDING:
            self._pending.popitem(last=False)
            self.skipped["IP packets with missing fragments"] += 1
        return whole

    def _is_ours(self, content: bytes) -> bool:
        return len(content) >= 4 and self._port in struct.unpack_from(">HH", content)

    def _udp(
        self, content: bytes, family: int, hosts: tuple[bytes, bytes], frame: CapturedFrame
    ) -> Datagram | None:
        source, destination, length = struct.unpack_from(">HHH", content)
        is_ours = self._port in (source, destination)
        if length < 8 or length > len(content):
            if not is_ours:
                return None
            raise _Cut
        data = content[8:length]
        has_form = is_judp(data)
        if not is_ours and not has_form:
            return None
        names = [socket.inet_ntop(family, host) for host in hosts]
        ends = Endpoint(names[0], source), Endpoint(names[1], destination)
        if not is_ours and not self.other_ports.takes(*ends):
            return None
        if has_form:
            self.other_ports.learn(*ends)
        return Datagram(data, *ends, frame.time, frame.number, frame.nanoseconds)


class PcapWriter:
    """Writer of pcap files with frames of raw IP and times in nanoseconds."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        stream.write(
            struct.pack("<IHHiIII", _PCAP_IN_NANOSECONDS, 2, 4, 0, 0, _LARGEST_FRAME, RAW_IP)
        )

    def write(self, frame: CapturedFrame) -> None:
        """Writes a frame of raw IP that has a time."""
        seconds, rest = divmod(frame.nanoseconds or 0, _NANO)
        size = len(frame.data)
        self._stream.write(struct.pack("<IIII", seconds, rest, size, size) + frame.data)


def frame_of(datagram: Datagram) -> CapturedFrame:
    """Returns an IPv4 frame with a datagram (`ValueError`: its endpoints are unknown)."""
    source, destination = datagram.source, datagram.destination
    if source is None or destination is None:
        raise ValueError("nobody told where the datagram came from")
    size = 8 + len(datagram.data)
    head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + size, 0, 0, _TIME_TO_LIVE, _UDP, 0)
    hosts = socket.inet_aton(source.host) + socket.inet_aton(destination.host)
    udp = struct.pack(">HHHH", source.port, destination.port, size, 0)
    data = head + hosts + udp + datagram.data
    return CapturedFrame(
        datagram.number or 0, datagram.time, RAW_IP, data, nanoseconds=datagram.nanoseconds
    )
