"""Widths of texts, by a table: the same on each machine, whatever its fonts.

The figures are the advance widths of Helvetica, which Arial and Liberation Sans share, in
thousandths of the font size. Texts are drawn with the width that this gives, so that one in
another font keeps within its box.
"""

from __future__ import annotations

import unicodedata

_FIRST = 32
_WIDTHS = (
    *(278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278),
    *((556,) * 10),
    *(278, 278, 584, 584, 584, 556, 1015),
    *(667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833),
    *(722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611),
    *(278, 278, 278, 469, 556, 333),
    *(556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833),
    *(556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500),
    *(334, 260, 334, 584),
)
_OTHER, _WIDE = 667, 1000
_BOLD = 1.07


def width(text: str, size: float, *, bold: bool = False) -> float:
    """Returns the width of a text in pixels.

    Args:
        size: Font size in pixels.
    """
    thousandths = sum(_advance(each) for each in text)
    return round(thousandths * size / 1000 * (_BOLD if bold else 1), 1)


def cut(text: str, longest: int) -> str:
    """Returns a text on one line, cut where it is too long; what cannot be shown is replaced."""
    flat = "".join(
        each if each.isprintable() else "\N{REPLACEMENT CHARACTER}"
        for each in " ".join(text.split())
    )
    return flat if len(flat) <= longest else f"{flat[: longest - 1]}\N{HORIZONTAL ELLIPSIS}"


def _advance(sign: str) -> int:
    index = ord(sign) - _FIRST
    if 0 <= index < len(_WIDTHS):
        return _WIDTHS[index]
    if unicodedata.combining(sign):
        return 0
    is_wide = unicodedata.east_asian_width(sign) in "WF" or unicodedata.category(sign) == "Sm"
    return _WIDE if is_wide else _OTHER
