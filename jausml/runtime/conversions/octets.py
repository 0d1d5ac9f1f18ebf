"""Lists of small numbers as bytes, for translations from bytes to bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.errors import JausError
from .types import ConversionError

if TYPE_CHECKING:
    from collections.abc import Callable


class Table:
    """What becomes of each octet.

    Attributes:
        octets: The octet for each of the 256, as `bytes.translate` takes them.
        odd: What those become that have none: an octet that stands for no other, to be looked for
            in the result, as a limit says what is done with them. None where all have one.
    """

    def __init__(
        self, function: Callable[[int], float], lower: int, upper: int, *, is_signed: bool
    ) -> None:
        """Asks a function for the value of each octet.

        Args:
            function: Gives the value for a number, or raises an error of the runtime.
            lower: Least value that fits.
            upper: Greatest value that fits.
            is_signed: Whether the octets are numbers of -128 .. 127.
        """
        found: dict[int, int] = {}
        for octet in range(256):
            try:
                value = function(octet - 256 if is_signed and octet > 127 else octet)
            except JausError:
                continue
            if lower <= value <= upper:
                found[octet] = round(value) & 0xFF
        unused = set(range(256)).difference(found.values())
        self.odd = min(unused) if len(found) < 256 else None
        self.octets = bytes(found.get(octet, self.odd or 0) for octet in range(256))


def reverse_rows(cells: bytes, columns: float) -> bytes:
    """The octets of a grid, row by row, with the rows in the opposite order.

    Raises:
        ConversionError: The octets do not fill rows of `columns` octets.
    """
    if not cells:
        return b""
    if not (columns >= 1.0 and columns % 1.0 == 0.0 and len(cells) % columns == 0.0):
        raise ConversionError(f"{len(cells)} cells do not fill rows of {columns}")
    width = int(columns)
    return b"".join(cells[start : start + width] for start in range(len(cells) - width, -1, -width))
