"""How the figures look: sizes of a paper, colours that everybody tells apart, files that repeat.

The colours are those of Okabe and Ito; what is compared differs in lightness and in the kind of
line too, so that a print in grey says the same.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.typing import RcStyleType

WIDTH = 7.16
"""Inches across both columns of a page."""
RESOLUTION = 180
"""Dots per inch of the PNG."""
LETTER = 8.5
"""Points of what names a panel."""

BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#F0E442",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
SYSTEM_COLOURS = {"J": BLUE, "R": ORANGE}
SYSTEM_LINES = {"J": "-", "R": (0, (4, 1.2))}
TIME_COLOURS = "viridis"

_PLACES = re.compile(r' (?:d|x|y)="[^"]*"')
_DIGITS = re.compile(r"(\.\d\d)\d+")

SETTINGS: RcStyleType = {
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7,
    "legend.framealpha": 0.9,
    "legend.borderpad": 0.3,
    "legend.handlelength": 2.4,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.linewidth": 0.6,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.4,
    "hatch.linewidth": 0.5,
    # Names of parts inside the SVG come from this and not from chance.
    "svg.hashsalt": "jausml",
    "svg.fonttype": "path",
    "path.simplify_threshold": 0.2,
}


# To load matplotlib takes most of a second, which those need not wait for who draw nothing.
# ruff: noqa: PLC0415


def applied() -> AbstractContextManager[None]:
    """Returns the context in which all figures are drawn."""
    from matplotlib import rc_context

    return rc_context(SETTINGS)


def canvas(height: float, width: float = WIDTH) -> Figure:
    """Returns an empty figure; draw on it and store it while the settings are applied.

    Args:
        height: Inches.
        width: Inches.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def store(figure: Figure, folder: Path, name: str) -> tuple[Path, Path]:
    """Writes a figure as SVG and PNG; equal figures give equal bytes.

    Args:
        figure: What to write.
        folder: Where; made when it is missing.
        name: Name of the files without their ends.

    Returns:
        The files.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    vector, pixels = folder / f"{name}.svg", folder / f"{name}.png"
    with applied():
        figure.savefig(vector, metadata={"Date": None, "Creator": None})
        vector.write_text(_shortened(vector.read_text(encoding="utf-8")), encoding="utf-8")
        figure.savefig(pixels, dpi=RESOLUTION, metadata={"Software": None})
    return vector, pixels


def _shortened(text: str) -> str:
    """Returns an SVG whose places have hundredths of a point: finer ones cost a third of it."""
    return _PLACES.sub(lambda match: _DIGITS.sub(r"\1", match[0]), text)


def look(system: str) -> dict[str, Any]:
    """Returns colour and kind of line of a system."""
    return {
        "color": SYSTEM_COLOURS.get(system, GREEN),
        "linestyle": SYSTEM_LINES.get(system, (0, (1, 1))),
    }


def name_panel(axes: Axes, letter: str, title: str) -> None:
    """Puts the letter of a panel and what it shows above it."""
    axes.set_title(f"({letter}) {title}", loc="left", fontsize=LETTER)


def thinned(points: Sequence[Any], most: int) -> list[Any]:
    """Returns at most so many of the points, evenly taken, the last always among them."""
    if len(points) <= most:
        return list(points)
    step = (len(points) - 1) / (most - 1)
    return [points[round(index * step)] for index in range(most)]
