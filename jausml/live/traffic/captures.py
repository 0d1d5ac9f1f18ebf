"""Readers of captures: pcap and pcapng streams, also gzipped, and hexadecimal text."""

from __future__ import annotations

import gzip
import re
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO, cast

RAW_IP = 101  # LINKTYPE_RAW: a frame begins with its IP header

_LARGEST_PART = 1 << 27
_NANO = 10**9

# Byte order and ticks each second, by what the file begins with.
_PCAP = {
    b"\xd4\xc3\xb2\xa1": ("<", 10**6),
    b"\xa1\xb2\xc3\xd4": (">", 10**6),
    b"\x4d\x3c\xb2\xa1": ("<", 10**9),
    b"\xa1\xb2\x3c\x4d": (">", 10**9),
}

_GZIP = b"\x1f\x8b"
_MCAP = b"\x89MCA"
_SECTION_HEADER = 0x0A0D0D0A
_INTERFACE = 1
_OLD_PACKET = 2
_SIMPLE_PACKET = 3
_ENHANCED_PACKET = 6
_BYTE_ORDERS = {b"\x4d\x3c\x2b\x1a": "<", b"\x1a\x2b\x3c\x4d": ">"}
_OPTION_RESOLUTION = 9
_OPTION_OFFSET = 14

_COMMENT = re.compile(r"(?:#|//|;).*")
_BYTE_PREFIX = re.compile(r"(?<![0-9A-Fa-f])0[xX]|\\x")
_SEPARATORS = str.maketrans("", "", " \t\r\n:,-_\v\f")
_WRONG = re.compile(r"[^0-9A-Fa-f \t\r\n:,\-_\v\f]")


class TrafficError(ValueError):
    """Traffic that cannot be read; the text has the reason and the place."""


class CaptureError(TrafficError):
    """A capture file that is malformed or ends too early.

    Attributes:
        offset: Byte of the file at which the faulty part begins.
    """

    def __init__(self, reason: str, offset: int) -> None:
        super().__init__(f"{reason} (at byte {offset} of the file)")
        self.offset = offset


@dataclass(frozen=True)
class CapturedFrame:
    """A frame of a capture.

    Attributes:
        number: Its number in the file, from 1 as in Wireshark.
        time: Seconds since 1970; None if the capture has no time.
        is_cut: Whether the capture has only the beginning of the frame.
        nanoseconds: The exact time in nanoseconds; None as `time`.
    """

    number: int
    time: float | None
    link_type: int
    data: bytes
    is_cut: bool = False
    nanoseconds: int | None = None


def read_frames(stream: BinaryIO) -> Iterator[CapturedFrame]:
    """Yields the frames of a capture as they come (`CaptureError`: it is malformed)."""
    file = _File(stream)
    magic = file.read(4, "the file header")
    if magic.startswith(_GZIP):
        rejoined = cast("BinaryIO", _Rejoined(magic, stream))
        file = _File(cast("BinaryIO", gzip.GzipFile(fileobj=rejoined, mode="rb")))
        magic = file.read(4, "the file header")
    if magic in _PCAP:
        yield from _pcap(file, *_PCAP[magic])
    elif magic == _SECTION_HEADER.to_bytes(4, "big"):
        yield from _Pcapng(file).frames()
    elif magic == _MCAP:
        hint = "'jausml record' writes the capture beside it, with the ending .pcap"
        raise CaptureError(f"the file is an MCAP recording, not a capture; {hint}", 0)
    else:
        raise CaptureError(f"neither pcap nor pcapng: it begins with {magic.hex(' ')}", 0)


def is_capture(beginning: bytes) -> bool:
    """Returns whether the first four bytes are those of a capture or a gzip file."""
    is_plain = beginning in _PCAP or beginning == _SECTION_HEADER.to_bytes(4, "big")
    return is_plain or beginning.startswith(_GZIP)


class _Rejoined:
    """A stream whose beginning was read already."""

    def __init__(self, beginning: bytes, stream: BinaryIO) -> None:
        self._beginning = beginning
        self._stream = stream

    def read(self, size: int = -1) -> bytes:
        """Returns bytes of the beginning, then of the stream."""
        if not self._beginning:
            return self._stream.read(size)
        end = len(self._beginning) if size < 0 else size
        piece, self._beginning = self._beginning[:end], self._beginning[end:]
        return piece


class _File:
    """A file that is read from the beginning to the end, with its offset for errors."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.offset = 0

    def read(self, size: int, what: str, begin: int | None = None) -> bytes:
        """Returns exactly `size` bytes (`what`: their name, `begin`: offset, for errors)."""
        start = self.offset if begin is None else begin
        if size > _LARGEST_PART:
            raise CaptureError(f"{what} cannot have {size} bytes", start)
        data = self._read_fully(size)
        if len(data) < size:
            raise CaptureError(f"the file ends within {what}", start)
        return data

    def read_or_end(self, size: int, what: str) -> bytes | None:
        """Returns exactly `size` bytes, None at the end of the file."""
        start = self.offset
        data = self._read_fully(size)
        if data and len(data) < size:
            raise CaptureError(f"the file ends within {what}", start)
        return data or None

    def _read_fully(self, size: int) -> bytes:
        data = self._read(size)
        while 0 < len(data) < size:  # a pipe may return fewer bytes
            more = self._read(size - len(data))
            if not more:
                break
            data += more
        self.offset += len(data)
        return data

    def _read(self, size: int) -> bytes:
        try:
            return self._stream.read(size)
        except (EOFError, zlib.error, gzip.BadGzipFile):
            raise CaptureError("the compressed file is damaged or cut off", self.offset) from None


def _pcap(file: _File, order: str, ticks_each_second: int) -> Iterator[CapturedFrame]:
    header = file.read(20, "the file header", 0)
    (network,) = struct.unpack(f"{order}16xI", header)
    link_type = network & 0xFFFF  # the upper half describes checksums after the frames
    record = struct.Struct(f"{order}IIII")
    number = 0
    while True:
        begin = file.offset
        number += 1
        head = file.read_or_end(record.size, f"the header of frame {number}")
        if head is None:
            return
        seconds, fraction, kept, length = record.unpack(head)
        data = file.read(kept, f"frame {number}", begin)
        time = seconds * _NANO + fraction * _NANO // ticks_each_second
        yield CapturedFrame(number, time / _NANO, link_type, data, kept < length, time)


class _Pcapng:
    """A pcapng file: blocks, in sections with a byte order each."""

    def __init__(self, file: _File) -> None:
        self._file = file
        self._order = "<"
        self._interfaces: list[tuple[int, int, int, int]] = []
        self._number = 0

    def frames(self) -> Iterator[CapturedFrame]:
        begin = 0
        head: bytes | None = _SECTION_HEADER.to_bytes(4, "big")
        while head is not None:
            kind = struct.unpack(f"{self._order}I", head)[0]
            body = self._body(kind, begin)
            frame = self._take(kind, body, begin)
            if frame is not None:
                yield frame
            begin = self._file.offset
            head = self._file.read_or_end(4, "the header of a block")

    def _body(self, kind: int, begin: int) -> bytes:
        """Returns the bytes in a block between its two lengths."""
        what = f"block 0x{kind:X}"
        raw = self._file.read(4, what, begin)
        start = b""
        if kind == _SECTION_HEADER:
            start = self._file.read(4, what, begin)
            if start not in _BYTE_ORDERS:
                raise CaptureError("the section header has no byte order", begin)
            self._order = _BYTE_ORDERS[start]
        (length,) = struct.unpack(f"{self._order}I", raw)
        if length % 4 or length < 12 + len(start):
            raise CaptureError(f"{what} has an impossible length of {length}", begin)
        rest = self._file.read(length - 8 - len(start), what, begin)
        if rest[-4:] != struct.pack(f"{self._order}I", length):
            raise CaptureError(f"the two lengths of {what} differ", begin)
        return start + rest[:-4]

    def _take(self, kind: int, body: bytes, begin: int) -> CapturedFrame | None:
        try:
            if kind == _SECTION_HEADER:
                self._interfaces = []
            elif kind == _INTERFACE:
                self._interfaces.append(self._interface(body))
            elif kind in (_ENHANCED_PACKET, _OLD_PACKET):
                return self._packet(kind, body, begin)
            elif kind == _SIMPLE_PACKET:
                return self._simple_packet(body, begin)
        except struct.error:
            raise CaptureError(f"block 0x{kind:X} is too short", begin) from None
        return None

    def _interface(self, body: bytes) -> tuple[int, int, int, int]:
        """Returns link type, snap length, ticks each second, and offset of the time in seconds."""
        link_type, snap_length = struct.unpack_from(f"{self._order}H2xI", body)
        ticks_each_second, offset, at = 10**6, 0, 8
        while at + 4 <= len(body):
            code, length = struct.unpack_from(f"{self._order}HH", body, at)
            value = body[at + 4 : at + 4 + length]
            at += 4 + (length + 3 & ~3)
            if code == _OPTION_RESOLUTION and length == 1:
                exponent = value[0] & 0x7F
                ticks_each_second = (2 if value[0] & 0x80 else 10) ** exponent
            elif code == _OPTION_OFFSET and length == 8:
                (offset,) = struct.unpack(f"{self._order}q", value)
        return link_type, snap_length, ticks_each_second, offset

    def _packet(self, kind: int, body: bytes, begin: int) -> CapturedFrame:
        layout = "IIIII" if kind == _ENHANCED_PACKET else "H2xIIII"
        interface, high, low, kept, length = struct.unpack_from(f"{self._order}{layout}", body)
        link_type, _, ticks_each_second, offset = self._interface_of(interface, begin)
        time = (high << 32 | low) * _NANO // ticks_each_second + offset * _NANO
        return self._frame(time, link_type, body[20:], kept, length, begin)

    def _simple_packet(self, body: bytes, begin: int) -> CapturedFrame:
        (length,) = struct.unpack_from(f"{self._order}I", body)
        link_type, snap_length, _, _ = self._interface_of(0, begin)
        kept = min(length, snap_length or length)
        return self._frame(None, link_type, body[4:], kept, length, begin)

    def _interface_of(self, number: int, begin: int) -> tuple[int, int, int, int]:
        if number >= len(self._interfaces):
            raise CaptureError(f"a frame is of interface {number}, which is not described", begin)
        return self._interfaces[number]

    def _frame(
        self, time: int | None, link_type: int, data: bytes, kept: int, length: int, begin: int
    ) -> CapturedFrame:
        self._number += 1
        if kept > len(data):
            raise CaptureError(f"frame {self._number} is longer than its block", begin)
        seconds = None if time is None else time / _NANO
        return CapturedFrame(self._number, seconds, link_type, data[:kept], kept < length, time)


def parse_hex(line: str) -> bytes:
    r"""Returns the bytes in a line of hexadecimal text; empty for a blank line or a comment.

    Blanks, colons, commas, hyphens, `0x` and `\x` may stand between bytes; `#`, `;` and `//`
    begin a comment.
    """
    text = _COMMENT.sub("", line)
    # Two blanks keep the columns of what follows a prefix.
    digits = _BYTE_PREFIX.sub("  ", text)
    wrong = _WRONG.search(digits)
    if wrong is not None:
        column = wrong.start() + 1
        raise TrafficError(f"column {column}: {wrong.group()!r} is no hexadecimal digit")
    packed = digits.translate(_SEPARATORS)
    if len(packed) % 2:
        raise TrafficError(f"{len(packed)} hexadecimal digits make no whole number of bytes")
    return bytes.fromhex(packed)
