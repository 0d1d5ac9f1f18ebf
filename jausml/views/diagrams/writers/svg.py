"""Pictures: graphs as SVG, light and dark, the same bytes for the same graph, and PNG of these."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.util import find_spec
from xml.sax.saxutils import escape, quoteattr

from jausml import installing
from jausml.views.diagrams.bundling import bundled, is_crowded
from jausml.views.diagrams.graph import IDLE, Edge, Graph, Group, Node, Port, severity
from jausml.views.diagrams.layout.graphviz import place
from jausml.views.diagrams.layout.sheet import LayoutError, Places, Point, Route
from jausml.views.diagrams.ordering import ordered
from jausml.views.diagrams.writers import shapes
from jausml.views.diagrams.writers.shapes import cut, style, width

MARGIN, TOP = 16, 54
_ROUND = {"node": 9, "type": 9, "state": 12, "others": 9}
_LONGEST_TITLE = 90
_DOT = 14  # how far the dot of an initial state stands above it, and from its left corner
_SERVICE = "arrows of messages: what answers · dashed: what a service takes and sends"
_LEGENDS = {
    "system": "square: JAUS · thick: bridge · rounded: ROS · dashed: control",
    "map": "left: JAUS · right: ROS · blue: JAUS to ROS · green: ROS to JAUS",
    "service": _SERVICE,
    "bodies": _SERVICE,
    "machine": "dot: entered first · rows: what a state does and stays · all inside: in each state",
}

_STATES = (
    "+ blue: added \N{MIDDLE DOT} \N{MINUS SIGN} orange, dashed: removed "
    "\N{MIDDLE DOT} ~ yellow: changed"
)


def render(graph: Graph, theme: str = "auto") -> str:
    """Returns a graph as a picture.

    `theme`: `light`, `dark`, or `auto` for that of whoever looks.
    """
    shown = ordered(bundled(graph))
    return picture(shown, theme, is_bundled=is_crowded(graph), keys=Keys())


def size_of(picture: str) -> tuple[float, float]:
    """Returns the width and height of a picture of ours."""
    width, height = re.findall(r' (?:width|height)="([\d.]+)"', picture[:400])[:2]
    return float(width), float(height)


class Keys:
    """Short keys of the parts of a picture, by which a page finds their details."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, ...], str] = {}

    def node(self, node: str) -> str:
        """Returns the key of a box."""
        return self._key("box", node)

    def port(self, node: str, port: str) -> str:
        """Returns the key of a row, empty for the box as a whole."""
        return self._key("row", node, port) if port else ""

    def edge(self, edge: str) -> str:
        """Returns the key of an edge."""
        return self._key("edge", edge)

    def _key(self, *names: str) -> str:
        return self._known.setdefault(names, f"k{len(self._known)}")


def picture(graph: Graph, theme: str, *, is_bundled: bool, keys: Keys) -> str:
    """Returns a graph as it is as a picture."""
    return "\n".join(_lines(graph, theme, keys, is_bundled=is_bundled)) + "\n"


def _lines(graph: Graph, theme: str, keys: Keys, *, is_bundled: bool) -> Iterator[str]:
    places = place(shapes.sheet_of(graph, packed=is_bundled))
    title = cut(graph.title, _LONGEST_TITLE)
    notes = _notes(graph)
    least = max(width(title, 16, bold=True), *(width(note, shapes.SMALL) for note, _ in notes))
    top = TOP + shapes.LINE_HEIGHT * (len(notes) - 1)
    size = (round(max(places.width, least) + 2 * MARGIN, 1), round(places.height + top + MARGIN, 1))
    yield from opening(size, title, style(theme, compares=graph.compares), {"arrow": "head"})
    for index, (text, kind) in enumerate(notes):
        down = 41 + shapes.LINE_HEIGHT * index
        yield text_element(MARGIN, down, text, shapes.SMALL, kind or "muted")
    yield f'<g transform="translate({MARGIN} {top})">'
    for group in graph.groups:
        yield from _frame(group, places)
    for edge in graph.edges:
        yield from _edge(edge, places.lines[edge.id], keys)
    for node in graph.nodes:
        yield from _node(node, places, keys)
    for edge in graph.edges:
        yield from _label(edge, places.lines[edge.id], keys)
    yield "</g>\n</svg>"


def opening(
    size: tuple[float, float], title: str, sheet: str, arrows: Mapping[str, str]
) -> Iterator[str]:
    """Yields how a picture begins, up to its title.

    `sheet`: its style sheet; `arrows`: classes of the heads of lines, by the ids of their markers.
    """
    box = f'width="{size[0]}" height="{size[1]}"'
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" {box} '
        f'viewBox="0 0 {size[0]} {size[1]}" role="img" class="diagram">'
    )
    yield f"<title>{escape(title)}</title>"
    yield f"<style>{sheet}</style>"
    markers = (
        f'<marker id="{name}" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" '
        'markerHeight="8" markerUnits="userSpaceOnUse" orient="auto">'
        f'<path class="{kind}" d="M0 0.8 8 4 0 7.2z"/></marker>'
        for name, kind in arrows.items()
    )
    yield f"<defs>{''.join(markers)}</defs>"
    yield f'<rect class="ground" {box}/>'
    yield text_element(MARGIN, 26, title, 16, "title", bold=True)


def _notes(graph: Graph) -> list[tuple[str, str]]:
    """Returns the notes below the title: the legend, and the findings about files."""
    legend = _LEGENDS.get(graph.view.partition(":")[0], graph.view)
    wrong = [(shapes.finding_text(finding), finding.severity) for finding in graph.findings]
    states = [(_STATES, "")] if graph.compares else []
    return [(legend, ""), *states, *wrong]


def _frame(group: Group, places: Places) -> Iterator[str]:
    (left, top), (right, bottom) = places.frames[group.id]
    identity = quoteattr(_data(group.id))
    size = f'width="{round(right - left, 1)}" height="{round(bottom - top, 1)}"'
    yield f'<g class="frame {group.kind}{_behind(group.state)}" data-id={identity}>'
    yield f'<rect x="{left}" y="{top}" {size} rx="6"/>'
    yield text_element(left + 10, top + 17, cut(group.title, 48), shapes.ROW, "muted")
    yield "</g>"


def _node(node: Node, places: Places, keys: Keys) -> Iterator[str]:
    x, y = places.boxes[node.id]
    sheet = shapes.box_of(node)
    grave = severity(node.findings)
    corner = f'rx="{_ROUND[node.kind]}" ' if node.kind in _ROUND else ""
    size = f'width="{sheet.width}" height="{sheet.height}"'
    kind = f"{node.kind} {grave}{_behind(node.state)}"
    yield f'<g class="box {kind}" {_ids(keys.node(node.id), node.id)}>'
    if grave == "error":
        outer = f'width="{sheet.width + 6}" height="{sheet.height + 6}"'
        yield f'<rect class="doubled" x="{_n(x - 3)}" y="{_n(y - 3)}" {corner}{outer}/>'
    yield f'<rect class="body" x="{x}" y="{y}" {corner}{size}/>'
    if node.is_initial:
        dot = f'<circle class="head" cx="{_n(x + _DOT)}" cy="{_n(y - _DOT)}" r="3.5"/>'
        way = f'd="M{_n(x + _DOT)} {_n(y - _DOT)}V{_n(y - 1)}"'
        yield f'{dot}<path class="edge" {way} marker-end="url(#arrow)"/>'
    left, line = x + shapes.PADDING, y + shapes.TITLE + 4
    yield text_element(left, line, shapes.title_of(node), shapes.TITLE, "title", bold=True)
    for text, kind in shapes.subtitles(node):
        line += shapes.LINE_HEIGHT
        yield text_element(left, line, text, shapes.SMALL, kind or "muted")
    if node.ports:
        rule = y + sheet.head - 2
        yield f'<path class="rule" d="M{x} {_n(rule)}h{sheet.width}"/>'
    for index, port in enumerate(node.ports):
        top = y + sheet.head + index * shapes.ROW_HEIGHT
        key = keys.port(node.id, port.id)
        yield from _row(port, key, left, top, x + sheet.width - shapes.PADDING)
    yield "</g>"


def _row(port: Port, key: str, left: float, top: float, right: float) -> Iterator[str]:
    row = shapes.row_text(port)
    base = top + 12.5
    quiet = "muted" if port.mark.endswith(("unmapped", IDLE)) else ""
    yield f'<g class="row" {_ids(key, port.id)}>'
    yield text_element(left + row.indent, base, row.label, shapes.ROW, port.state or quiet)
    if row.note:
        after = left + row.indent + width(row.label, shapes.ROW) + shapes.GAP
        yield text_element(after, base, row.note, shapes.SMALL, "muted")
    if row.mark:
        start = right - width(row.mark, shapes.SMALL)
        yield text_element(start, base, row.mark, shapes.SMALL, row.severity or quiet or "mark")
    yield "</g>"


def _edge(edge: Edge, route: Route, keys: Keys) -> Iterator[str]:
    grave = severity(edge.findings)
    weight = f' stroke-width="{min(1.2 + 0.4 * edge.count, 5):g}"' if edge.count > 1 else ""
    words = ": ".join(part for part in (edge.title, ", ".join(edge.labels)) if part)
    yield (
        f'<path class="edge {edge.kind} {grave}{_behind(edge.state)}" '
        f"{_ids(keys.edge(edge.id), edge.id)}{weight} "
        f'd="{curve(route)}" marker-end="url(#arrow)">'
        f"<title>{escape(cut(words, 400))}</title></path>"
    )


def curve(route: Route) -> str:
    """Returns the way of a line as the data of a path."""
    start, *rest = route.points
    curves = "".join(
        f"C{_pair(rest[at])} {_pair(rest[at + 1])} {_pair(rest[at + 2])}"
        for at in range(0, len(rest) - 2, 3)
    )
    return f"M{_pair(start)}{curves}"


def _label(edge: Edge, route: Route, keys: Keys) -> Iterator[str]:
    lines = shapes.label_lines(edge)
    if not lines or route.label is None:
        return
    x, y = route.label
    grave = severity(edge.findings)
    height = shapes.LINE_HEIGHT * len(lines) + 2
    yield f'<g class="label" data-key="{keys.edge(edge.id)}">'
    for index, text in enumerate(lines):
        base = y - height / 2 + 10.5 + index * shapes.LINE_HEIGHT
        yield text_element(
            x - width(text, shapes.SMALL) / 2,
            base,
            text,
            shapes.SMALL,
            grave or edge.state or "flow",
        )
    yield "</g>"


def _behind(state: str) -> str:
    """Returns a state as one more class of a part."""
    return f" {state}" if state else ""


def text_element(x: float, y: float, text: str, size: int, kind: str, *, bold: bool = False) -> str:
    """Returns a text with the width by the table, whatever the font."""
    if not text:
        return ""
    known = f' class="{kind}"' if kind else ""
    weight = ' font-weight="bold"' if bold else ""
    long = width(text, size, bold=bold)
    # Direction and embedding keep letters that run from right to left within their own text.
    return (
        f'<text x="{_n(x)}" y="{_n(y)}" font-size="{size}"{weight}{known} direction="ltr" '
        f'unicode-bidi="embed" textLength="{long:g}" lengthAdjust="spacingAndGlyphs">'
        f"{escape(text)}</text>"
    )


def _ids(key: str, identifier: str) -> str:
    """Returns the attributes of a part: its key for the page, its id of the model."""
    return f'data-key="{key}" data-id={quoteattr(_data(identifier))}'


def _data(text: str) -> str:
    """Returns an id as data of XML, which has no control characters."""
    return "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text
    )


def _n(number: float) -> str:
    return f"{round(number, 1):g}"


def _pair(point: Point) -> str:
    return f"{point[0]:g} {point[1]:g}"


MISSING = f"PNG needs resvg-py: {installing.command('diagram')}"
FONT_CURE = "apt install fonts-liberation"
NO_FONT = f"PNG needs one of these fonts on this machine: {{}} ({FONT_CURE}); .svg needs none"

ZOOM = 2
"""Dots for each pixel of the picture."""

MOST_DOTS = 64_000_000
"""Dots of a picture at most; one that would have more is drawn smaller."""

FONTS = (
    *("Helvetica", "Arial", "Liberation Sans", "Nimbus Sans", "DejaVu Sans", "Noto Sans"),
    *("Segoe UI", "Verdana", "Ubuntu", "Roboto", "Open Sans", "FreeSans"),
)

_NO_NAME = "a name that no font has"


def render_png(graph: Graph, theme: str = "auto") -> bytes:
    """Returns a graph as a picture: the same bytes on a machine of the same fonts.

    `theme`: `light` or `dark`; `auto` is light. `LayoutError`: there is no layout, nobody who
    draws, or no font.
    """
    font = installed_font()
    picture = render(graph, "light" if theme == "auto" else theme)
    width, height = size_of(picture)
    zoom = min(ZOOM, (MOST_DOTS / (width * height)) ** 0.5)
    return _drawn(picture, zoom, font)


@cache
def installed_font() -> str:
    """Returns the first font that the machine has, of those that pictures are measured for.

    `LayoutError`: it has none, or nobody draws. In place of one that it has not, resvg draws no
    text at all, or takes one with serifs, if there is one.
    """
    if find_spec("resvg_py") is None:
        raise LayoutError(MISSING)
    lacking = [_drawn(_probe(_NO_NAME, text), 1, _NO_NAME) for text in ("", "Ag")]
    for font in FONTS:
        if _drawn(_probe(font, "Ag"), 1, font) not in lacking:
            return font
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
