"""Unpacking of compressed parts of recordings in bounded memory."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import BinaryIO, cast

MOST_UNPACKED = 256 << 20  # bytes that a chunk or a message of a recording may have, unpacked

_STEP = 1 << 20
_LARGEST_HEAD = 18  # bytes of the head of a frame at most (RFC 8878)

# Bytes that one byte of a compressed file may become: no recording is packed as well.
_LARGEST_RATIO = 1000


class DamageError(Exception):
    """A part of a recording that cannot be read; the text has the reason and the place."""


def unpacked(data: bytes, compression: str, most: int = MOST_UNPACKED) -> bytes:
    """Returns data without its compression.

    Args:
        compression: Its name in MCAP: empty, `lz4` or `zstd`.
        most: Greatest number of unpacked bytes.

    Raises:
        DamageError: There are more bytes, or the compression is another.
    """
    if not compression:
        return data
    return b"".join(_pieces(io.BytesIO(data), compression, most))


def unpack_file(source: BinaryIO, target: BinaryIO) -> None:
    """Writes the unpacked contents of a zstd file.

    Raises:
        DamageError: It is no such file, or unpacks to too many bytes.
    """
    most = max(MOST_UNPACKED, source.seek(0, io.SEEK_END) * _LARGEST_RATIO)
    source.seek(0)
    for piece in _pieces(source, "zstd", most):
        target.write(piece)


def _pieces(source: BinaryIO, compression: str, most: int) -> Iterator[bytes]:
    """Yields the unpacked bytes, piece by piece."""
    left = most
    try:
        reader, stated = _opened(source, compression)
        if stated > most:
            raise DamageError(f"unpacks to {stated:,} bytes, and {most:,} are read at most")
        while piece := reader.read(min(_STEP, left + 1)):
            left -= len(piece)
            if left < 0:
                raise DamageError(f"unpacks to more than {most:,} bytes")
            yield piece
    except (DamageError, ImportError):
        raise
    except Exception as error:  # the libraries raise anything on such bytes
        raise DamageError(f"is not compressed by {compression}") from error
    if 0 <= stated != most - left:
        raise DamageError(f"unpacks to {most - left:,} of {stated:,} bytes")


def _opened(source: BinaryIO, compression: str) -> tuple[BinaryIO, int]:
    """Returns a reader of the unpacked bytes, and their stated number, -1 for unknown."""
    if compression == "zstd":
        import zstandard  # noqa: PLC0415 - an extra

        stated = zstandard.frame_content_size(source.read(_LARGEST_HEAD))
        source.seek(0)
        return cast("BinaryIO", zstandard.ZstdDecompressor().stream_reader(source)), stated
    if compression == "lz4":
        import lz4.frame  # noqa: PLC0415 - an extra

        return cast("BinaryIO", lz4.frame.open(source)), -1
    raise DamageError(f"is compressed by '{compression[:20]}', which is not read")
