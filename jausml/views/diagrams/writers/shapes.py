"""Colours, texts and sizes of what a picture shows, before a layout places it."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from textwrap import wrap

from jausml.views.diagrams.graph import (
    ADDED,
    CHANGED,
    REMOVED,
    Edge,
    Finding,
    Graph,
    Node,
    Port,
    severity,
)
from jausml.views.diagrams.layout.sheet import Box, Frame, Line, Row, Sheet

TITLE, SMALL, ROW = 13, 10, 11
"""Font sizes in pixels."""

ROW_HEIGHT, LINE_HEIGHT, PADDING, INDENT, GAP = 18, 13, 10, 12, 12
LONGEST_TITLE, _LONGEST_LABEL, _LONGEST_NOTE, _LONGEST_LINE = 48, 96, 72, 44
_MOST_LINES, _MOST_FINDINGS = 7, 4
_WRAPPED = 30  # signs of a line of a label, behind which it goes on in the next one
_ACROSS = ("to_ros", "to_jaus")
"""Kinds of edges between rows that stand close: their labels have one line."""
_SIGNS = {"error": "\N{MULTIPLICATION SIGN} ", "warning": "! ", "info": "i "}


@dataclass(frozen=True)
class RowText:
    """The texts of a row: name, remark, and a word at the right end."""

    label: str
    note: str
    mark: str
    severity: str
    indent: int


def title_of(node: Node) -> str:
    """Returns the title of a box."""
    return cut(node.title, LONGEST_TITLE) or "?"


def subtitles(node: Node) -> list[tuple[str, str]]:
    """Returns the lines below the title of a box, each with a severity or an empty text."""
    # Of an initial state a dot says that it is one.
    is_told = node.subtitle and not node.is_initial
    lines = [(cut(node.subtitle, _LONGEST_NOTE), "")] if is_told else []
    lines += [
        (finding_text(finding), finding.severity) for finding in node.findings[:_MOST_FINDINGS]
    ]
    more = len(node.findings) - _MOST_FINDINGS
    return lines + ([(f"and {more} more", "")] if more > 0 else [])


def finding_text(finding: Finding) -> str:
    """Returns a finding in words, with a sign and a word for its severity."""
    sign = _SIGNS.get(finding.severity, "")
    return cut(f"{sign}{finding.severity}: {finding.message}", _LONGEST_NOTE)


def row_text(port: Port) -> RowText:
    """Returns the texts of a row."""
    grave = severity(port.findings)
    words = [f"{_SIGNS[grave]}{grave}"] if grave else []
    words += [port.mark] if port.mark else []
    return RowText(
        cut(port.label, _LONGEST_LABEL),
        cut(port.note, _LONGEST_NOTE),
        cut(", ".join(words), _LONGEST_LABEL),
        grave,
        port.depth * INDENT,
    )


def label_lines(edge: Edge) -> list[str]:
    """Returns the lines of the label of an edge."""
    grave = severity(edge.findings)
    lines = [f"{_SIGNS[grave]}{grave}"] if grave else []
    lines += [
        cut(line, _LONGEST_LINE)
        for label in edge.labels
        for line in wrap(label, _WRAPPED, break_long_words=False, break_on_hyphens=False)
    ]
    if edge.kind in _ACROSS:
        return [cut(", ".join(lines), _LONGEST_LINE)] if lines else []
    if len(lines) > _MOST_LINES:
        lines[_MOST_LINES - 1 :] = [f"and {len(lines) - _MOST_LINES + 1} more"]
    return lines


def sheet_of(graph: Graph, *, packed: bool) -> Sheet:
    """Returns the sheet that a layout is to place."""
    return Sheet(
        tuple(box_of(node) for node in graph.nodes),
        tuple(
            Frame(group.id, group.parent,
                  math.ceil(width(cut(group.title, LONGEST_TITLE), ROW)) + 8, LINE_HEIGHT + 5)
            for group in graph.groups
        ),
        tuple(_line(edge, is_labelled=not packed) for edge in graph.edges),
        graph.downwards,
        packed,
    )  # fmt: skip


def box_of(node: Node) -> Box:
    """Returns a box with its size."""
    widest = max(_widths(node))
    rows = tuple(Row(port.id, ROW_HEIGHT) for port in node.ports)
    width, head = math.ceil(widest) + 2 * PADDING, TITLE + 13 + LINE_HEIGHT * len(subtitles(node))
    return Box(node.id, width, head, rows, node.group, node.column)


def _widths(node: Node) -> Iterator[float]:
    yield width(title_of(node), TITLE, bold=True)
    for text, _ in subtitles(node):
        yield width(text, SMALL)
    for port in node.ports:
        row = row_text(port)
        row_width = row.indent + width(row.label, ROW)
        row_width += sum(GAP + width(remark, SMALL) for remark in (row.note, row.mark) if remark)
        yield row_width


def _line(edge: Edge, *, is_labelled: bool) -> Line:
    # Bundles have no room for labels: their boxes say what is wrong, and details the rest.
    lines = label_lines(edge) if is_labelled else []
    return Line(
        edge.id,
        (edge.source.node, edge.source.port),
        (edge.target.node, edge.target.port),
        label_width(lines),
        label_height(lines),
    )


def label_width(lines: Sequence[str]) -> int:
    """Returns the width of a label of some lines, 0 without any."""
    return math.ceil(max(width(line, SMALL) for line in lines)) + 8 if lines else 0


def label_height(lines: Sequence[str]) -> int:
    """Returns the height of a label of some lines, 0 without any."""
    return LINE_HEIGHT * len(lines) + 3 if lines else 0


# The advance widths of Helvetica, which Arial and Liberation Sans share, in thousandths of the font
# size: the same on each machine. Texts are drawn with the width that this gives, so that one in
# another font keeps within its box.
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
_BOLD_WIDTHS = (
    *(278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278),
    *((556,) * 10),
    *(333, 333, 584, 584, 584, 611, 975),
    *(722, 722, 722, 722, 667, 611, 778, 722, 278, 556, 722, 611, 833),
    *(722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611),
    *(333, 278, 333, 584, 556, 333),
    *(556, 611, 556, 611, 556, 333, 611, 611, 278, 278, 556, 278, 889),
    *(611, 611, 611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500),
    *(389, 280, 389, 584),
)
_OTHER, _WIDE = 722, 1000
_MOST_TEXTS = 1 << 14  # texts that are remembered: each edit of a page asks for the same ones


@lru_cache(maxsize=_MOST_TEXTS)
def width(text: str, size: float, *, bold: bool = False) -> float:
    """Returns the width of a text in pixels.

    `size`: font size in pixels.
    """
    widths = _BOLD_WIDTHS if bold else _WIDTHS
    return round(sum(_advance(character, widths) for character in text) * size / 1000, 1)


@lru_cache(maxsize=_MOST_TEXTS)
def cut(text: str, longest: int) -> str:
    """Returns a text on one line, cut to a length; unprintable characters are replaced."""
    flat = "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}"
        for character in " ".join(text.split())
    )
    return flat if len(flat) <= longest else f"{flat[: longest - 1]}\N{HORIZONTAL ELLIPSIS}"


def _advance(sign: str, widths: Sequence[int]) -> int:
    index = ord(sign) - _FIRST
    if 0 <= index < len(widths):
        return widths[index]
    if unicodedata.combining(sign):
        return 0
    is_wide = unicodedata.east_asian_width(sign) in "WF" or unicodedata.category(sign) == "Sm"
    return _WIDE if is_wide else _OTHER


SIDES = {"component": "jaus", "message": "jaus", "bridge": "bridge", "node": "ros", "type": "ros"}
"""The sides of kinds of boxes; others have the colour of lines."""

_LIGHT = {
    "ground": "#FFFFFF",
    "body": "#FFFFFF",
    "ink": "#1B1B1B",
    "muted": "#6B6B6B",
    "line": "#6B6B6B",
    "frame": "#F5F5F5",
    "jaus": "#0072B2",
    "bridge": "#A8447F",
    "ros": "#00795A",
    "error": "#B34700",
    "warning": "#7A5300",
    "added": "#0072B2",
    "added_body": "#D6EBFA",
    "removed": "#B34700",
    "removed_body": "#FBE0CC",
    "changed": "#7A5300",
    "changed_body": "#FFF4BF",
}
_DARK = {
    "ground": "#1E1E1E",
    "body": "#262626",
    "ink": "#EEEEEE",
    "muted": "#A0A0A0",
    "line": "#A0A0A0",
    "frame": "#232323",
    "jaus": "#56B4E9",
    "bridge": "#E5A4C6",
    "ros": "#4CC9A0",
    "error": "#FF8A3D",
    "warning": "#F0C44C",
    "added": "#56B4E9",
    "added_body": "#123A52",
    "removed": "#FF8A3D",
    "removed_body": "#55290F",
    "changed": "#F0C44C",
    "changed_body": "#4A3F10",
}
STATES = (ADDED, REMOVED, CHANGED)
"""What parts may be where two states are compared: blue, orange and yellow can be told apart by
whoever sees red and green as one; signs and dashes say the same."""

_SHARED = (
    ".diagram{font-family:Helvetica,Arial,'Liberation Sans',sans-serif}"
    ".edge{fill:none;stroke-width:1.2}.control,.owns{stroke-dasharray:5 4}"
    ".bridge .body{stroke-width:3}.body{stroke-width:1.5}.frame rect{stroke-width:1}"
    ".doubled{fill:none;stroke-width:1.5}.rule{stroke-width:.6;fill:none}"
    ".label text{paint-order:stroke;stroke-width:3px;stroke-linejoin:round}"
)


def style(theme: str, *, compares: bool = False) -> str:
    """Returns the style sheet of a picture.

    `theme`: `light`, `dark`, or `auto` for that of whoever looks.
    """
    light, dark = (
        _rules(palette) + (_compared(palette) if compares else "") for palette in (_LIGHT, _DARK)
    )
    if theme == "auto":
        return f"{_SHARED}{light}@media(prefers-color-scheme:dark){{{dark}}}"
    return _SHARED + (dark if theme == "dark" else light)


def outline(kind: str, severity: str = "") -> str:
    """Returns the colour of the outline of a box, on light ground.

    `severity`: how grave what is wrong with it is, empty for nothing.
    """
    return _LIGHT["error"] if severity == "error" else _LIGHT[SIDES.get(kind, "line")]


def variables() -> str:
    """Returns the colours as properties for the style sheet of a page, light and dark."""
    light, dark = (
        "".join(f"--{name}:{value};" for name, value in colours.items())
        for colours in (_LIGHT, _DARK)
    )
    return (
        f":root{{color-scheme:light dark;{light}}}"
        f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
    )


def _rules(colours: dict[str, str]) -> str:
    rules = [
        ".ground{fill:%(ground)s}.body{fill:%(body)s;stroke:%(line)s}",
        ".label text{stroke:%(ground)s}",
        "text{fill:%(ink)s}.muted{fill:%(muted)s}.mark{fill:%(ink)s}.flow{fill:%(ink)s}",
        ".frame rect{fill:%(frame)s;stroke:%(muted)s}",
        ".frame.subject rect{stroke:%(ink)s;stroke-width:2.5}",
        ".rule{stroke:%(muted)s}",
        ".edge{stroke:%(line)s}.head{fill:%(line)s}",
        *(f".box.{kind} .body{{stroke:%({side})s}}" for kind, side in SIDES.items()),
        ".edge.message,.edge.to_ros{stroke:%(jaus)s}.edge.topic,.edge.to_jaus{stroke:%(ros)s}",
        ".edge.call{stroke:%(bridge)s}",
        ".doubled,.edge.error{stroke:%(error)s}text.error{fill:%(error)s}",
        "text.warning,text.info{fill:%(warning)s}",
    ]
    return "".join(rules) % colours


def _compared(colours: dict[str, str]) -> str:
    rules = [".removed .body,.frame.removed rect,.edge.removed{stroke-dasharray:6 4}"]
    for state in STATES:
        rules += [
            f".box.{state} .body,.frame.{state} rect{{fill:%({state}_body)s}}",
            f".edge.{state}{{stroke:%({state})s;stroke-width:2.6}}",
            f"text.{state}{{fill:%({state})s;font-weight:bold}}",
        ]
    return "".join(rules) % colours
