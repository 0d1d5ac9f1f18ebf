"""Conversions of the cells of grids, and of the pixels of images and PNM files.

PGM files have grey pixels, PPM files coloured ones; PNM is the name of both (Netpbm). Numbers of 16
bits begin with the more significant octet.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TypeVar

from .types import ConversionError, Pixels

Cell = TypeVar("Cell")

_UNKNOWN_OCCUPANCY = -1.0
_UNKNOWN_COST = 255.0
_COST_PER_OCCUPANCY = 254.0 / 100.0


def occupancy_to_cost(value: float) -> float:
    """Occupancy 0..100, -1 for unknown (nav_msgs/OccupancyGrid), to cost 0..254, 255 for unknown.

    Raises:
        ConversionError: The value is no occupancy.
    """
    if value == _UNKNOWN_OCCUPANCY:
        return _UNKNOWN_COST
    if not 0.0 <= value <= 100.0:
        raise ConversionError(f"{value} is no occupancy")
    return float(round(value * _COST_PER_OCCUPANCY))


def cost_to_occupancy(value: float) -> float:
    """Cost 0..254, 255 for unknown, to occupancy 0..100, -1 for unknown (nav_msgs/OccupancyGrid).

    Raises:
        ConversionError: The value is no cost.
    """
    if value == _UNKNOWN_COST:
        return _UNKNOWN_OCCUPANCY
    if not 0.0 <= value < _UNKNOWN_COST:
        raise ConversionError(f"{value} is no cost")
    return float(round(value / _COST_PER_OCCUPANCY))


def reverse_rows(cells: Sequence[Cell], columns: float) -> list[Cell]:
    """The cells of a grid, row by row, with the rows in the opposite order.

    Raises:
        ConversionError: The cells do not fill rows of `columns` cells.
    """
    starts = row_starts(len(cells), columns)
    return [cell for start in starts for cell in cells[start : start + int(columns)]]


def row_starts(count: int, columns: float) -> range:
    """Returns the index of each row's first cell, from the last row to the first.

    Raises:
        ConversionError: The cells do not fill rows of `columns` cells.
    """
    if not count:
        return range(0)
    if not (columns >= 1.0 and columns % 1.0 == 0.0 and count % columns == 0.0):
        raise ConversionError(f"{count} cells do not fill rows of {columns}")
    return range(count - int(columns), -1, -int(columns))


_SIZES = {"mono8": 1, "mono16": 2, "rgb8": 3, "bgr8": 3}  # octets of a pixel by encoding
# Encodings by the number in the header and the greatest value of a file.
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
        ConversionError: The image is empty, its encoding is none of PNM, or its data do not fill
            its rows.
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
        pixels = _reverse_octets(pixels, size)
    kind, greatest = 6 if size == 3 else 5, 65535 if encoding == "mono16" else 255
    return b"P%d %d %d %d\n%b" % (kind, width, height, greatest, pixels)


def pnm_to_pixels(file: Sequence[int]) -> Pixels:
    """The pixels of a file of PGM or PPM.

    Raises:
        ConversionError: The file is none of PGM of 8 or 16 bits or PPM of 8 bits, or is not whole.
    """
    octets = bytes(file)
    match = _HEADER.match(octets)
    if match is None:
        raise ConversionError("no file of PGM or PPM")
    width, height, greatest = map(int, match.groups()[1:])
    encoding = _ENCODINGS.get((match[1], greatest))
    if encoding is None:
        raise ConversionError(f"no encoding of P{match[1].decode()} has numbers up to {greatest}")
    pixels, step = octets[match.end() :], width * _SIZES[encoding]
    if not pixels or len(pixels) != height * step:
        raise ConversionError(f"{len(pixels)} octets are not {height} rows of {width} pixels")
    if encoding == "mono16":
        pixels = _reverse_octets(pixels, 2)
    return Pixels(height, width, encoding, 0, step, pixels)


def _reverse_octets(pixels: bytes, size: int) -> bytes:
    """The octets of each pixel in the opposite order."""
    turned = bytearray(len(pixels))
    for part in range(size):
        turned[part::size] = pixels[size - 1 - part :: size]
    return bytes(turned)
