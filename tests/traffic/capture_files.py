"""Capture files and frames, made by hand."""

import socket
import struct

ETHERNET, NULL, RAW, LINUX_COOKED, LINUX_COOKED_2 = 1, 0, 101, 113, 276
QUERY_STATUS = bytes.fromhex("02 00 1000 01 0201c800 01016500 0220 0700")
"""A JUDP datagram: QueryStatus from 101.1.1 to 200.1.2, number 7."""


def udp(data, source=3794, destination=3794):
    return struct.pack(">HHHH", source, destination, 8 + len(data), 0) + data


def ipv4(content, *, offset=0, more=False, identity=1, protocol=17, options=b"", length=None):
    size = 20 + len(options) + len(content) if length is None else length
    fragment = offset // 8 | (0x2000 if more else 0)
    head = 0x40 | (20 + len(options)) // 4
    return (
        struct.pack(">BBHHHBBH", head, 0, size, identity, fragment, 16, protocol, 0)
        + socket.inet_aton("10.9.0.1")
        + socket.inet_aton("239.255.0.1")
        + options
        + content
    )


def ipv6(content, following=17):
    hosts = socket.inet_pton(socket.AF_INET6, "fe80::1") + socket.inet_pton(
        socket.AF_INET6, "ff02::1"
    )
    return struct.pack(">IHBB", 6 << 28, len(content), following, 64) + hosts + content


def ethernet(packet, tags=()):
    kind = 0x86DD if packet[0] >> 4 == 6 else 0x0800
    return (
        bytes(12)
        + b"".join(struct.pack(">HH", tag, 5) for tag in tags)
        + struct.pack(">H", kind)
        + packet
    )


def pcap(frames, link_type=ETHERNET, order="<", magic=0xA1B2C3D4, kept=None):
    """Returns a file with a frame each second, from second 100 and fraction 250000."""
    data = struct.pack(f"{order}IHHiIII", magic, 2, 4, 0, 0, 262144, link_type)
    for number, frame in enumerate(frames):
        part = frame[:kept]
        data += struct.pack(f"{order}IIII", 100 + number, 250000, len(part), len(frame)) + part
    return data


def block(kind, body, order="<"):
    body += bytes(-len(body) % 4)
    length = struct.pack(f"{order}I", 12 + len(body))
    return struct.pack(f"{order}I", kind) + length + body + length


def section(order="<"):
    return block(0x0A0D0D0A, struct.pack(f"{order}IHHq", 0x1A2B3C4D, 1, 0, -1), order)


def interface(link_type=ETHERNET, order="<", options=b"", snap_length=0):
    return block(1, struct.pack(f"{order}HHI", link_type, 0, snap_length) + options, order)


def option(code, value, order="<"):
    return struct.pack(f"{order}HH", code, len(value)) + value + bytes(-len(value) % 4)


def packet(frame, ticks=0, order="<", number=0, kept=None, length=None):
    size = len(frame) if kept is None else kept
    whole = len(frame) if length is None else length
    head = struct.pack(f"{order}IIIII", number, ticks >> 32, ticks & 0xFFFFFFFF, size, whole)
    return block(6, head + frame, order)
