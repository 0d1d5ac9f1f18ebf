"""Pictures as PNG, for what shows no SVG: drawn from our SVG by resvg in fonts of the machine."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING

from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.writers import svg

if TYPE_CHECKING:
    from jausml.views.diagrams.graph import Graph
    from jausml.views.diagrams.layout.sheet import Engine

MISSING = "PNG needs resvg-py: pip install 'jausml[diagram]'"
NO_FONT = "PNG needs one of these fonts on this machine: {}; the ending .svg needs none"

ZOOM = 2
"""Dots for each pixel of the picture."""

MOST_DOTS = 64_000_000
"""Dots of a picture at most; one that would have more is drawn smaller."""

FONTS = (
    *("Helvetica", "Arial", "Liberation Sans", "Nimbus Sans", "DejaVu Sans", "Noto Sans"),
    *("Segoe UI", "Verdana", "Ubuntu", "Roboto", "Open Sans", "FreeSans"),
)


def render(graph: Graph, engine: Engine, theme: str = "auto") -> bytes:
    """Returns a graph as a picture: the same bytes on a machine of the same fonts.

    `theme`: `light` or `dark`; `auto` is light. `LayoutError`: there is no layout, nobody who
    draws, or no font.
    """
    if find_spec("resvg_py") is None:
        raise LayoutError(MISSING)
    font = _font()
    picture = svg.render(graph, engine, "light" if theme == "auto" else theme)
    width, height = svg.size_of(picture)
    zoom = min(ZOOM, (MOST_DOTS / (width * height)) ** 0.5)
    return _drawn(picture, zoom, font)


@cache
def _font() -> str:
    """Returns the first font that the machine has: without one resvg draws no text at all."""
    nothing = _drawn(_probe(FONTS[0], ""), 1, FONTS[0])
    for each in FONTS:
        if _drawn(_probe(each, "Ag"), 1, each) != nothing:
            return each
    raise LayoutError(NO_FONT.format(", ".join(FONTS)))


def _probe(font: str, text: str) -> str:
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">'
        f'<text x="2" y="15" font-family="\'{font}\'">{text}</text></svg>'
    )


def _drawn(picture: str, zoom: float, font: str) -> bytes:
    import resvg_py  # noqa: PLC0415 - an extra

    try:
        return bytes(resvg_py.svg_to_bytes(svg_string=picture, zoom=zoom, sans_serif_family=font))
    except ValueError as error:
        raise LayoutError(f"resvg cannot draw the picture: {error}") from error
