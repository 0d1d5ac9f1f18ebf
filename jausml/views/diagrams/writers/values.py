"""Graphs as plain values for a page that draws them itself: texts, sizes and places.

All lengths are pixels; y grows downwards. Corners are upper left ones; those of boxes and frames
count from the origin of the drawing, `y` of a port from the top of its box. A route is a start,
then three points for each cubic Bezier curve; it is empty where the ends of an edge were moved.
Texts are as pictures have them, cut where they are too long: titles of 13, rows of 11, all else
of 10 pixels. Findings are not in the texts; each line has room for a sign of them, so that no box
grows by them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from jausml.views.diagrams.folding import CLOSED, folded
from jausml.views.diagrams.graph import Edge, Finding, Graph, Group, Node, Port
from jausml.views.diagrams.layout import graphviz
from jausml.views.diagrams.layout.columns import corners_in_columns
from jausml.views.diagrams.layout.labels import anchored
from jausml.views.diagrams.layout.settling import Area, area_of, label_area, settle, surrounding
from jausml.views.diagrams.layout.sheet import Box, Line, Places, Point, Route, Sheet
from jausml.views.diagrams.ordering import ordered
from jausml.views.diagrams.writers import shapes
from jausml.views.diagrams.writers.shapes import cut

SIGN_ROOM = 18
"""Room for the sign of a finding at the right end of each line of a box."""

PartT = TypeVar("PartT", "Node", "Port", "Edge")

SYSTEM = "system"
LIVE_WIDTH = 128
"""Room for what is told of a line while the system runs, above its label: pages cut the rest."""

_Keys = tuple[str, ...]


@dataclass(frozen=True)
class Placed:
    """Where boxes, frames and lines of a sheet stand.

    Attributes:
        known: Where boxes stood before.
        fixed: Ids of the boxes that users placed.
    """

    sheet: Sheet
    known: Mapping[str, Point]
    fixed: Collection[str]
    corners: Mapping[str, Point]
    frames: Mapping[str, Area]
    routes: Mapping[str, Route | None]


@dataclass
class Standing:
    """The last places of the parts of a view.

    Boxes that are gone are kept: what undo brings back stands where it stood. `rows`: the rows of
    each box by its key, in the order of the model and in that of the picture. `shown`: kinds and
    corners of the boxes of the last picture by their keys, in its order. `routes`: ways of lines,
    by the places of their ends. Whether it is crowded, and whether its frames may be closed, is
    decided when its boxes get their places: no edit moves them.
    """

    boxes: dict[str, Point] = field(default_factory=dict)
    shown: dict[str, tuple[str, Point]] = field(default_factory=dict)
    routes: dict[str, Route] = field(default_factory=dict)
    rows: dict[str, tuple[_Keys, _Keys]] = field(default_factory=dict)
    is_crowded: bool = False
    is_large: bool = False


@dataclass(frozen=True)
class Settled:
    """A graph whose parts have their places, whether they are told or not."""

    graph: Graph
    places: Placed

    def values(self, opened: Collection[str] | None = None) -> dict[str, Any]:
        """Returns the picture as JSON has values.

        `opened`: keys of the frames of which the inside is told; None for all.
        """
        graph, places = self.graph, self.places
        corners, frames = places.corners, places.frames
        boxes = {box.id: box for box in places.sheet.boxes}
        lines = {line.id: line for line in places.sheet.lines}
        areas = [*frames.values(), *(area_of(box, corners[name]) for name, box in boxes.items())]
        shown = graph if opened is None else folded(graph, opened)
        return {
            "view": graph.view,
            "title": graph.title,
            "element": graph.element,
            "downwards": graph.downwards,
            "crowded": graph.is_crowded,
            "folded": opened is not None,
            "width": round(max((area.right for area in areas), default=0)),
            "height": round(max((area.bottom for area in areas), default=0)),
            "nodes": [
                _closed(node, frames[node.id])
                if node.kind == CLOSED
                else _node(node, boxes[node.id], corners[node.id])
                for node in shown.nodes
            ],
            "groups": [
                _group(group, frames[group.id]) for group in shown.groups if group.id in frames
            ],
            "edges": [
                _edge(edge, lines.get(edge.id), places.routes.get(edge.id)) for edge in shown.edges
            ],
        }


def settled(
    graph: Graph,
    moved: Mapping[str, tuple[int, int]] | None = None,
    standing: Standing | None = None,
    place: Callable[[Sheet], Places] = graphviz.place,
    last: Placed | None = None,
) -> Settled:
    """Returns a graph with sizes and places.

    The layout places what is drawn for the first time. Later what stands stays, and what is new
    comes beside what it is joined with. `standing`: where its parts stood; it is told where they
    stand now. `place`: the layout. `last`: where its parts stood in the last picture; most edits
    change no size, so that they stand there again.
    """
    moved = moved or {}
    standing = standing if standing is not None else Standing()
    keys = {node.id: node.key or node.id for node in graph.nodes}
    fixed = {name for name, key in keys.items() if key in moved}
    _take_over(graph, keys, standing)
    if standing.shown:
        graph = _with_rows(graph, graph, standing)
        sheet = _sheet(graph)
    else:
        arranged = ordered(graph)
        graph = _with_rows(graph, arranged, standing)
        sheet = _sheet(arranged)
        # Of so many lines each page draws those that it shows.
        drawn = None if graph.is_crowded else place(sheet)
        exact = corners_in_columns(sheet) if drawn is None else drawn.boxes
        corners: Mapping[str, Point] = {
            identifier: (round(x), round(y)) for identifier, (x, y) in exact.items()
        }
        boxes = {box.id: box for box in sheet.boxes}
        sheet = replace(sheet, boxes=tuple(boxes[node.id] for node in graph.nodes))
        for name, corner in corners.items():
            standing.boxes.setdefault(keys[name], corner)
        # Ways are those between the places of the engine, where others may be known.
        routes = drawn.lines if drawn is not None else {}
        ends = _ways(sheet, corners) if routes else ()
        standing.routes = {way: routes[name] for name, way in ends if name in routes}
    stood = {**standing.boxes, **moved}
    known = {name: stood[key] for name, key in keys.items() if key in stood}
    if last is not None and (last.sheet, last.known, last.fixed) == (sheet, known, fixed):
        places = last
    else:
        places = _placed(sheet, known, fixed, standing)
    corners = places.corners
    # A box that users moved goes back to where it stood when they undo that.
    standing.boxes |= {
        keys[identifier]: corner
        for identifier, corner in corners.items()
        if identifier not in fixed
    }
    standing.shown = {keys[node.id]: (node.kind, corners[node.id]) for node in graph.nodes}
    return Settled(graph, places)


def _with_rows(graph: Graph, arranged: Graph, standing: Standing) -> Graph:
    """Returns a graph whose rows keep their order: new ones come last, renamed ones stay."""
    first = arranged.by_id
    nodes = []
    for node in graph.nodes:
        ports = {port.key or port.id: port for port in node.ports}
        own = tuple(ports)
        before, order = standing.rows.get(node.key or node.id, (own, own))
        if not standing.shown:
            order = tuple(port.key or port.id for port in first[node.id].ports)
        elif len(before) == len(own):
            # Names change no order, so that one that is new stands for one that is gone.
            gone = [key for key in before if key not in ports]
            new = [key for key in own if key not in before]
            names = dict(zip(gone, new, strict=True))
            order = tuple(names.get(key, key) for key in order)
        kept = [key for key in order if key in ports]
        order = (*kept, *(key for key in own if key not in kept))
        standing.rows[node.key or node.id] = own, order
        nodes.append(replace(node, ports=tuple(ports[key] for key in order)))
    return replace(graph, nodes=tuple(nodes))


def _placed(
    sheet: Sheet, known: Mapping[str, Point], fixed: Collection[str], standing: Standing
) -> Placed:
    corners = settle(sheet, known, fixed)
    routes: dict[str, Route | None] = dict.fromkeys(line.id for line in sheet.lines)
    if standing.routes:
        routes |= {name: standing.routes.get(way) for name, way in _ways(sheet, corners)}
    return Placed(sheet, known, fixed, corners, surrounding(sheet, corners, routes), routes)


def _sheet(graph: Graph) -> Sheet:
    """Returns the sheet to place, of sizes that do not depend on findings."""
    nodes, edges = map(_without_findings, graph.nodes), map(_plain, graph.edges)
    plain = replace(graph, nodes=tuple(nodes), edges=tuple(edges))
    sheet = shapes.sheet_of(plain, packed=graph.is_crowded)
    return replace(
        sheet,
        boxes=tuple(replace(box, width=box.width + SIGN_ROOM) for box in sheet.boxes),
        lines=tuple(
            _with_live_text(line) if graph.view == SYSTEM and edge.kind != "topic" else line
            for line, edge in zip(sheet.lines, graph.edges, strict=True)
        ),
    )


def _with_live_text(line: Line) -> Line:
    """Returns a line whose label has room for values of the running system."""
    if not line.width:
        return line
    width, height = max(line.width, LIVE_WIDTH), line.height + shapes.LINE_HEIGHT
    return replace(line, width=width, height=height)


def _without_findings(node: Node) -> Node:
    """Returns a box without findings, also of its rows."""
    is_wrong = any(port.findings for port in node.ports)
    return _plain(replace(node, ports=tuple(map(_plain, node.ports))) if is_wrong else node)


def _plain(part: PartT) -> PartT:
    """Returns a part without findings."""
    return replace(part, findings=()) if part.findings else part


def _take_over(graph: Graph, keys: Mapping[str, str], standing: Standing) -> None:
    """Gives boxes that were renamed the places that they had, and their rows.

    Names change no order: they are found where a picture has as many boxes of a kind as before.
    """
    for kind in {node.kind for node in graph.nodes} if standing.shown else ():
        old = [(key, corner) for key, (its, corner) in standing.shown.items() if its == kind]
        new = [keys[node.id] for node in graph.nodes if node.kind == kind]
        for (before, corner), key in zip(old, new, strict=False) if len(old) == len(new) else ():
            if before not in new and key not in standing.boxes:
                standing.boxes[key] = corner
                standing.rows[key] = standing.rows[before]


def _ways(sheet: Sheet, corners: Mapping[str, Point]) -> Iterator[tuple[str, str]]:
    """Yields lines, and the places of their ends; those that share both are numbered."""
    boxes = {box.id: box for box in sheet.boxes}
    rows = {
        (box.id, name): corners[box.id][1] + down
        for box in sheet.boxes
        for name, down in box.tops().items()
    }
    counts: Counter[str] = Counter()
    for line in sheet.lines:
        way: list[float] = []
        for name, row in (line.source, line.target):
            area = area_of(boxes[name], corners[name])
            way += [area.left, area.right, rows.get((name, row), area.top)]
        text = " ".join(f"{number:.9g}" for number in way)
        counts[text] += 1
        yield line.id, f"{text} {counts[text]}"


def _closed(node: Node, area: Area) -> dict[str, Any]:
    height = round(area.bottom - area.top)
    return {
        **_texts(node),
        "x": round(area.left),
        "y": round(area.top),
        "width": round(area.right - area.left),
        "height": height,
        "head": height,
        "initial": False,
        "ports": [],
    }


def _node(node: Node, box: Box, corner: Point) -> dict[str, Any]:
    tops = box.tops()
    return {
        **_texts(node),
        "x": corner[0],
        "y": corner[1],
        "width": box.width,
        "height": box.height,
        "head": box.head,
        "initial": node.is_initial,
        "ports": [_port(port, tops[port.id]) for port in node.ports],
    }


def _texts(node: Node) -> dict[str, Any]:
    return {
        "id": node.id,
        "element": node.element,
        "key": node.key,
        "kind": node.kind,
        "title": shapes.title_of(node),
        "subtitle": [text for text, _ in shapes.subtitles(_plain(node))],
        "group": node.group,
        "column": node.column,
        "details": list(map(list, node.details)),
        "findings": _findings(node.findings),
    }


def _port(port: Port, top: float) -> dict[str, Any]:
    texts = shapes.row_text(_plain(port))
    return {
        "id": port.id,
        "element": port.element,
        "key": port.key,
        "label": texts.label,
        "note": texts.note,
        "mark": texts.mark,
        "depth": port.depth,
        "y": top,
        "height": shapes.ROW_HEIGHT,
        "details": list(map(list, port.details)),
        "findings": _findings(port.findings),
    }


def _group(group: Group, area: Area) -> dict[str, Any]:
    return {
        "id": group.id,
        "element": group.element,
        "key": group.key,
        "kind": group.kind,
        "title": cut(group.title, shapes.LONGEST_TITLE),
        "parent": group.parent,
        "x": round(area.left),
        "y": round(area.top),
        "width": round(area.right - area.left),
        "height": round(area.bottom - area.top),
    }


def _edge(edge: Edge, line: Line | None, route: Route | None) -> dict[str, Any]:
    texts = shapes.label_lines(_plain(edge))
    anchor, label = "middle", None
    if line is not None and route is not None and route.label is not None:
        room = label_area(line, route.label)
        anchor, x = anchored(room, shapes.label_width(texts), route)
        # What is told of it while the system runs comes above it.
        label = [x, room.bottom - shapes.label_height(texts) / 2]
    return {
        "id": edge.id,
        "element": edge.element,
        "key": edge.key,
        "source": {"node": edge.source.node, "port": edge.source.port},
        "target": {"node": edge.target.node, "port": edge.target.port},
        "kind": edge.kind,
        "title": edge.title,
        "labels": texts,
        "count": edge.count,
        "findings": _findings(edge.findings),
        "route": [list(point) for point in route.points] if route is not None else [],
        "label": label,
        "anchor": anchor,
    }


def _findings(findings: tuple[Finding, ...]) -> list[dict[str, str]]:
    return [{"severity": finding.severity, "message": finding.message} for finding in findings]
