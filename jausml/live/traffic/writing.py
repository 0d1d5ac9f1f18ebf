"""Capture files, written: pcap with times in nanoseconds, frames of raw IP."""

from __future__ import annotations

import socket
import struct
from typing import TYPE_CHECKING, BinaryIO

from jausml.live.traffic.captures import RAW_IP, Frame

if TYPE_CHECKING:
    from jausml.live.traffic.frames import Datagram

_MAGIC = 0xA1B23C4D
_LARGEST = 1 << 18
_NANO = 10**9
_TIME_TO_LIVE, _UDP = 16, 17


class PcapWriter:
    """Writes frames of raw IP."""

    def __init__(self, stream: BinaryIO) -> None:
        """Begins a file."""
        self._stream = stream
        stream.write(struct.pack("<IHHiIII", _MAGIC, 2, 4, 0, 0, _LARGEST, RAW_IP))

    def write(self, frame: Frame) -> None:
        """Writes a frame of raw IP that has a time."""
        seconds, rest = divmod(frame.nanoseconds or 0, _NANO)
        size = len(frame.data)
        self._stream.write(struct.pack("<IIII", seconds, rest, size, size) + frame.data)


def frame_of(datagram: Datagram) -> Frame:
    """Returns a frame with a datagram that was heard without one, over IPv4.

    Raises:
        ValueError: It has no ends.
    """
    source, destination = datagram.source, datagram.destination
    if source is None or destination is None:
        raise ValueError("nobody told where the datagram came from")
    size = 8 + len(datagram.data)
    head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + size, 0, 0, _TIME_TO_LIVE, _UDP, 0)
    hosts = socket.inet_aton(source.host) + socket.inet_aton(destination.host)
    udp = struct.pack(">HHHH", source.port, destination.port, size, 0)
    data = head + hosts + udp + datagram.data
    return Frame(
        datagram.number or 0, datagram.time, RAW_IP, data, nanoseconds=datagram.nanoseconds
    )
