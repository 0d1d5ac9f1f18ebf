"""Compressed parts of recordings, unpacked step by step, so that none fills the memory."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import BinaryIO

MOST_UNPACKED = 256 << 20  # bytes that a chunk or a message of a recording may have, unpacked

_STEP = 1 << 20  # unpacked bytes that are read of lz4 at once
_FEED = 1 << 10  # compressed bytes that are unpacked at once; zstd makes 32 MiB of them at most

# Bytes that one byte of a compressed file may become; recordings are compressed less.
_LARGEST_RATIO = 1000


class DamageError(Exception):
    """A part of a recording that cannot be read.

    The text says what it does or has, e.g. `unpacks to more than 5 bytes`; whoever knows the place
    puts the place before it.
    """


def unpacked(data: bytes, compression: str, most: int = MOST_UNPACKED) -> bytes:
    """Returns the unpacked bytes.

    Args:
        data: The bytes as they are recorded.
        compression: As MCAP names it: `lz4`, `zstd`, or empty for bytes that are returned as they
            are.
        most: How many bytes compressed ones may become.

    Raises:
        DamageError: They become more, end too early, or are not compressed in this way.
        ImportError: The library of the compression is not installed.
    """
    if not compression:
        return data
    return b"".join(_limited(io.BytesIO(data), compression, most))


def unpack_file(source: BinaryIO, target: BinaryIO) -> None:
    """Writes the unpacked contents of a file that zstd compressed.

    Raises:
        DamageError: It is no such file, ends too early, or becomes out of proportion large.
        OSError: The file cannot be read, or the target not be written.
    """
    most = max(MOST_UNPACKED, source.seek(0, io.SEEK_END) * _LARGEST_RATIO)
    source.seek(0)
    for piece in _limited(source, "zstd", most):
        target.write(piece)


def _limited(source: BinaryIO, compression: str, most: int) -> Iterator[bytes]:
    """Yields the unpacked bytes piece by piece, `most` of them at most."""
    unpack = _READERS.get(compression)
    if unpack is None:
        raise DamageError(f"is compressed by '{compression[:20]}', which is not read")
    left = most
    try:
        for piece in unpack(source):
            left -= len(piece)
            if left < 0:
                raise DamageError(f"unpacks to more than {most:,} bytes")
            yield piece
    except (DamageError, ImportError, OSError):
        raise
    except Exception as error:  # the libraries raise anything on such bytes
        raise DamageError(f"is not compressed by {compression}") from error


def _unpack_zstd(source: BinaryIO) -> Iterator[bytes]:
    """Yields the contents of the frames, one after the other (RFC 8878, 3)."""
    import zstandard  # noqa: PLC0415 - an extra

    frame = zstandard.ZstdDecompressor().decompressobj()
    data = source.read(_FEED)
    while data:
        if frame.eof:
            frame = zstandard.ZstdDecompressor().decompressobj()
        yield frame.decompress(data)
        data = frame.unused_data or source.read(_FEED)
    # The library checks the size that a frame states, but not all frames state one.
    if not frame.eof:
        raise DamageError("ends in the midst of a frame of zstd")


def _unpack_lz4(source: BinaryIO) -> Iterator[bytes]:
    import lz4.frame  # noqa: PLC0415 - an extra

    reader = lz4.frame.open(source)
    while piece := reader.read(_STEP):
        yield piece


_READERS = {"zstd": _unpack_zstd, "lz4": _unpack_lz4}
