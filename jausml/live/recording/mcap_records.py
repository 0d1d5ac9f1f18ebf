"""Layouts of the records of MCAP files (MCAP format specification, version 0)."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from enum import IntEnum

from jausml.live.recording.unpacking import MOST_UNPACKED, DamageError, unpacked


class Opcode(IntEnum):
    """The opcodes of the records that are used here."""

    HEADER = 0x01
    FOOTER = 0x02
    SCHEMA = 0x03
    CHANNEL = 0x04
    MESSAGE = 0x05
    CHUNK = 0x06
    CHUNK_INDEX = 0x08
    STATISTICS = 0x0B
    DATA_END = 0x0F


MAGIC = b"\x89MCAP0\r\n"  # how files begin and end

HEAD = struct.Struct("<BQ")  # opcode of a record, and the length of what follows

# Where summary and summary offsets begin, and the checksum of the summary.
FOOTER = struct.Struct("<QQI")

# The end of a file without a summary.
END = (
    HEAD.pack(Opcode.DATA_END, 4)
    + bytes(4)
    + HEAD.pack(Opcode.FOOTER, FOOTER.size)
    + FOOTER.pack(0, 0, 0)
    + MAGIC
)

_CHUNK = struct.Struct("<QQQI")


def heads(data: bytes, where: str) -> Iterator[tuple[int, int, int]]:
    """Yields opcode, offset and length of the records in a part of a file.

    Raises:
        DamageError: It has bytes that are no record.
    """
    at = 0
    while at < len(data):
        opcode, length = HEAD.unpack_from(data, at) if at + HEAD.size <= len(data) else (0, 0)
        if not opcode or length > len(data) - at - HEAD.size:
            raise DamageError(f"{where} holds what is no record")
        yield opcode, at, length
        at += HEAD.size + length


def records_of_chunk(content: bytes, where: str) -> bytes:
    """Returns the unpacked records of a chunk (`where`: the chunk in words).

    Raises:
        DamageError: They are too large, or do not fit the stated size or checksum.
    """
    try:
        _, _, size, checksum = _CHUNK.unpack_from(content)
        begin = _CHUNK.size + 4
        end = begin + int.from_bytes(content[begin - 4 : begin], "little")
        (length,) = struct.unpack_from("<Q", content, end)
    except struct.error as error:
        raise DamageError(f"{where} has no head") from error
    if size > MOST_UNPACKED:
        raise DamageError(f"{where} unpacks to {size:,} bytes; {MOST_UNPACKED:,} are read at most")
    compression = content[begin:end].decode("utf-8", "replace")
    try:
        data = unpacked(content[end + 8 : end + 8 + length], compression, size)
    except DamageError as error:
        raise DamageError(f"{where} {error}") from error
    if len(data) != size:
        raise DamageError(f"{where} has {len(data):,} of {size:,} bytes")
    if checksum and zlib.crc32(data) != checksum:
        raise DamageError(f"{where} does not fit its checksum")
    return data
