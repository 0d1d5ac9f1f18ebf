"""Conversions of octets: grids and their cells, raw images and files of pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence

from jausml.language.semantics.conversions.conversion import Conversion, NoValueError, UnitEffect
from jausml.language.semantics.conversions.definition import Definition, NoArithmetic
from jausml.language.semantics.paths.attributes import NUMBER, NUMBERS, OCTETS, TEXT

_UNKNOWN_OCCUPANCY, _UNKNOWN_COST = -1, 255


class OccupancyToCost(Conversion):
    """Occupancy of nav_msgs/OccupancyGrid to the cost of a JAUS cost map.

    Occupancy is 0..100, -1 for unknown; cost is 0..254, 255 for unknown.
    """

    name = "occupancy_to_cost"
    limits = ((0.0, 255.0),)
    knows_unknown = True
    definition = Definition(
        "value",
        "if(value == -1, 255, round(value * (254 / 100)))",
        refused="not (value == -1 or value >= 0 and value <= 100)",
        reason="is no occupancy",
    )

    def loses(self, value: float) -> bool:
        """Whether it is unknown."""
        return value == _UNKNOWN_OCCUPANCY


class CostToOccupancy(Conversion):
    """Cost of a JAUS cost map to the occupancy of nav_msgs/OccupancyGrid.

    Cost is 0..254, 255 for unknown; occupancy is 0..100, -1 for unknown.
    """

    name = "cost_to_occupancy"
    limits = ((-1.0, 100.0),)
    definition = Definition(
        "value",
        "if(value == 255, -1, round(value / (254 / 100)))",
        refused="not (value >= 0 and value <= 255)",
        reason="is no cost",
    )

    def loses(self, value: float) -> bool:
        """Whether it is unknown."""
        return value == _UNKNOWN_COST


class ReverseRows(Conversion):
    """Numbers of a grid, row by row, with the rows in the opposite order.

    The second value is the number of columns.
    """

    name = "reverse_rows"
    inputs = (NUMBERS, NUMBER)
    outputs = (NUMBERS,)
    units = UnitEffect.SAME
    definition = NoArithmetic.ORDER

    def forward(self, cells: Sequence[float], columns: float) -> list[float]:
        """The rows from the last to the first."""
        if not cells:
            return []
        if not math.isfinite(columns) or columns < 1 or columns != int(columns):
            raise NoValueError(self.name)
        rows: list[list[float]] = [[] for _ in range(math.ceil(len(cells) / columns))]
        for index, cell in enumerate(cells):
            rows[index // int(columns)].append(cell)
        if len(rows[-1]) != columns:
            raise NoValueError(self.name)
        return [cell for row in reversed(rows) for cell in row]


_IMAGE = (NUMBER, NUMBER, TEXT, NUMBER, NUMBER, OCTETS)
# Where in a pixel of an image the octets of the file stand, and the greatest number of its header.
_FILES = {
    ("mono8", False): ("P5", (0,), 255),
    ("mono8", True): ("P5", (0,), 255),
    ("mono16", False): ("P5", (1, 0), 65535),
    ("mono16", True): ("P5", (0, 1), 65535),
    ("rgb8", False): ("P6", (0, 1, 2), 255),
    ("rgb8", True): ("P6", (0, 1, 2), 255),
    ("bgr8", False): ("P6", (2, 1, 0), 255),
    ("bgr8", True): ("P6", (2, 1, 0), 255),
}
_IMAGES = {
    (b"P5", 255): ("mono8", (0,)),
    (b"P5", 65535): ("mono16", (1, 0)),
    (b"P6", 255): ("rgb8", (0, 1, 2)),
}
_MOST_DIGITS = 9


class PixelsToPnm(Conversion):
    """The pixels of a sensor_msgs/Image to a file of PGM or PPM, which are PNM.

    The values are height, width, encoding, is_bigendian, step and data of the image. Grey pixels
    (mono8, mono16) give PGM, coloured ones (rgb8, bgr8) PPM. An image that is empty, has another
    encoding or other data than its rows drops the message.
    """

    name = "pixels_to_pnm"
    inputs = _IMAGE
    outputs = (OCTETS,)
    definition = NoArithmetic.PICTURE

    def forward(
        self, height: int, width: int, encoding: str, is_big: int, step: int, data: Sequence[int]
    ) -> bytes:
        """The file, pixel by pixel."""
        magic, order, greatest = _FILES.get((encoding, bool(is_big)), ("", (), 0))
        size = len(order)
        is_whole = height and width and step >= width * size and len(data) == height * step
        if not magic or not is_whole:
            raise NoValueError(self.name)
        pixels = [
            data[row * step + column * size + part]
            for row in range(height)
            for column in range(width)
            for part in order
        ]
        return f"{magic} {width} {height} {greatest}\n".encode() + bytes(pixels)


class PnmToPixels(Conversion):
    """A file of PGM or PPM, which are PNM, to the pixels of a sensor_msgs/Image.

    The results are height, width, encoding (mono8, mono16 or rgb8), is_bigendian (0), step and data
    of the image. A file that is empty, has another greatest number than 255 or 65535, or has other
    data than its pixels drops the message, and so does a coloured one of 16 bits.
    """

    name = "pnm_to_pixels"
    inputs = (OCTETS,)
    outputs = _IMAGE
    definition = NoArithmetic.PICTURE

    def forward(self, file: bytes) -> tuple[int, int, str, int, int, bytes]:
        """The image, pixel by pixel."""
        (magic, *words), raster = _header(file)
        if len(words) != 3 or not all(
            word.isdigit() and len(word) <= _MOST_DIGITS for word in words
        ):
            raise NoValueError(self.name)
        width, height, greatest = map(int, words)
        encoding, order = _IMAGES.get((magic, greatest), ("", ()))
        size = len(order)
        if not encoding or not raster or len(raster) != height * width * size:
            raise NoValueError(self.name)
        pixels = [raster[at + part] for at in range(0, len(raster), size) for part in order]
        return height, width, encoding, 0, width * size, bytes(pixels)


def _header(file: bytes) -> tuple[list[bytes], bytes]:
    """Returns the four words of the header, as many as there are, and the bytes behind them."""
    words, word, at = [file[:2]], b"", 2
    while at < len(file) and len(words) < 4:
        if file[at : at + 1] == b"#":
            at += len(file[at:].split(b"\n")[0].split(b"\r")[0])
            continue
        if not file[at : at + 1].isspace():
            word += file[at : at + 1]
        elif word:
            words, word = [*words, word], b""
        at += 1
    return words, file[at:]
