"""Conversions of raw images and files of pictures (Netpbm).

PGM has grey pixels and PPM coloured ones; PNM is what both are called. Numbers of 16 bits begin
with the more significant octet.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from .types import ConversionError, Pixels

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["pixels_to_pnm", "pnm_to_pixels"]

_SIZES = {"mono8": 1, "mono16": 2, "rgb8": 3, "bgr8": 3}
"""The octets of a pixel by encoding."""
_ENCODINGS = {(b"5", 255): "mono8", (b"5", 65535): "mono16", (b"6", 255): "rgb8"}
_BETWEEN = rb"(?:\s|#[^\r\n]*[\r\n])"
_HEADER = re.compile(
    rb"P([56])%b*([0-9]{1,9})%b+([0-9]{1,9})%b+([0-9]{1,9})(?:#[^\r\n]*)?\s"
    % (_BETWEEN, _BETWEEN, _BETWEEN)
)


def pixels_to_pnm(
    height: float,
    width: float,
    encoding: str,
    is_bigendian: float,
    step: float,
    data: Sequence[int],
) -> bytes:
    """The pixels as a file of PGM or PPM.

    Raises:
        ConversionError: The image is empty, has another encoding or other data than its rows.
    """
    size = _SIZES.get(encoding, 0)
    row, pitch, pixels = int(width) * size, int(step), bytes(data)
    if not size:
        raise ConversionError(f"{encoding!a} has no file of pictures")
    if not (height and row) or pitch < row or len(pixels) != height * pitch:
        raise ConversionError(f"{len(pixels)} octets are not {height} rows of {width} pixels")
    if pitch != row:
        pixels = b"".join(pixels[at : at + row] for at in range(0, len(pixels), pitch))
    if encoding == "bgr8" or (encoding == "mono16" and not is_bigendian):
        pixels = _turned(pixels, size)
    kind, greatest = 6 if size == 3 else 5, 65535 if encoding == "mono16" else 255
    return b"P%d %d %d %d\n%b" % (kind, width, height, greatest, pixels)


def pnm_to_pixels(file: Sequence[int]) -> Pixels:
    """The pixels of a file of PGM or PPM.

    Raises:
        ConversionError: It is no such file of 8 bits, or of 16 where it is grey, or is not whole.
    """
    octets = bytes(file)
    found = _HEADER.match(octets)
    if found is None:
        raise ConversionError("no file of PGM or PPM")
    width, height, greatest = map(int, found.groups()[1:])
    encoding = _ENCODINGS.get((found[1], greatest))
    if encoding is None:
        raise ConversionError(f"no encoding of P{found[1].decode()} has numbers up to {greatest}")
    pixels, step = octets[found.end() :], width * _SIZES[encoding]
    if not pixels or len(pixels) != height * step:
        raise ConversionError(f"{len(pixels)} octets are not {height} rows of {width} pixels")
    if encoding == "mono16":
        pixels = _turned(pixels, 2)
    return Pixels(height, width, encoding, 0, step, pixels)


def _turned(pixels: bytes, size: int) -> bytes:
    """The octets of each pixel in the opposite order."""
    turned = bytearray(len(pixels))
    for part in range(size):
        turned[part::size] = pixels[size - 1 - part :: size]
    return bytes(turned)
