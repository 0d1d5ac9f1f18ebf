"""Layout of sheets: those that go downwards by Graphviz, all others in columns.

Graphviz is `dot` as graphviz-pure brings it, on boxes of given sizes. It is told no text, so that
no font has a say.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from importlib import metadata
from math import dist
from pathlib import Path
from typing import Any

from jausml import installing
from jausml.views.diagrams.graph import nested
from jausml.views.diagrams.layout.columns import in_columns
from jausml.views.diagrams.layout.labels import cleared, hidden
from jausml.views.diagrams.layout.settling import chain
from jausml.views.diagrams.layout.sheet import LayoutError, Line, Places, Point, Route, Sheet
from jausml.views.diagrams.layout.ways import spaced

PACKAGE = "graphviz-pure"
"""The distribution, and the program that it installs."""

MISSING = f"pictures need {PACKAGE}: {installing.command('diagram')}"
LONGEST = 120
"""Seconds that a layout may take."""

_ROOMS = (0, 26, 48)
"""Pixels beside the label of a line for each border that it crosses, as they are tried."""

_TABLE = '<table fixedsize="true" border="0" cellborder="0" cellspacing="0" cellpadding="0"'


def program() -> Path | None:
    """Returns the installed program of the layout for this Python; None without it."""
    try:
        files = metadata.files(PACKAGE) or ()
    except metadata.PackageNotFoundError:
        return None
    places = (Path(str(file.locate())) for file in files if file.stem == PACKAGE)
    return next((place for place in places if place.is_file()), None)


def place(sheet: Sheet) -> Places:
    """Returns where everything stands, the same for the same sheet.

    What needs no search is placed without Graphviz, which has a process of its own. Where a label
    comes to lie on something, as on the border of a frame, it is asked again with more room there.
    """
    if not sheet.downwards:
        places = in_columns(sheet)
        return cleared(sheet, places) if any(line.width for line in sheet.lines) else places
    tried = (_downwards(sheet, room) for room in _ROOMS)
    best = next(tried)
    while (least := hidden(sheet, best)) and (other := next(tried, None)) is not None:
        best = other if hidden(sheet, other) < least else best
    return best


def _downwards(sheet: Sheet, room: int) -> Places:
    (layout,) = _run("\n".join(_graph(sheet, room)))
    return cleared(sheet, spaced(sheet, _places(sheet, layout)))


def _run(graphs: str) -> list[dict[str, Any]]:
    """Returns the layouts of graphs, which come one after the other."""
    dot = program()
    if dot is None:
        raise LayoutError(MISSING)
    try:
        done = subprocess.run(  # noqa: S603 - what the package has installed
            [dot, "-Kdot", "-Tjson0"],
            input=graphs.encode(),
            capture_output=True,
            timeout=LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise LayoutError(f"Graphviz found no layout within {LONGEST} s") from error
    except OSError as error:
        raise LayoutError(f"Graphviz does not start: {dot}: {error.strerror}") from error
    if done.returncode or not done.stdout:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise LayoutError(f"Graphviz failed: {lines[-1] if lines else f'exit {done.returncode}'}")
    try:
        return list(_layouts(done.stdout.decode()))
    except ValueError as error:
        raise LayoutError("Graphviz failed: its answer is no JSON") from error


def _layouts(text: str) -> Iterator[dict[str, Any]]:
    decoder, end = json.JSONDecoder(), 0
    while (begin := text.find("{", end)) >= 0:
        layout, end = decoder.raw_decode(text, begin)
        yield layout


def _graph(sheet: Sheet, room: int) -> Iterator[str]:
    yield "digraph {"
    yield '  graph [rankdir="TB", nodesep=0.4, ranksep=0.5]'
    yield "  node [shape=plain]"
    yield "  edge [dir=none]"
    frames = [(frame.id, frame.parent) for frame in sheet.frames]
    for what, number, _ in nested([box.group for box in sheet.boxes], frames):
        match what:
            case "box":
                size = _cell(sheet.boxes[number].width, sheet.boxes[number].height)
                yield f"  b{number} [label={size}]"
            case "begin":
                label = _cell(sheet.frames[number].width, sheet.frames[number].height)
                yield f"  subgraph cluster_{number} {{ label={label}; labeljust=l; margin=12"
            case "end":
                yield "  }"
    yield from _lines(sheet, room)
    yield "}"


def _cell(width: int, height: int) -> str:
    return f'<{_TABLE} width="{width}" height="{height}"><tr><td></td></tr></table>>'


def _lines(sheet: Sheet, room: int) -> Iterator[str]:
    names = {box.id: f"b{number}" for number, box in enumerate(sheet.boxes)}
    first = {box.id for box in sheet.boxes if box.column == 0}
    parents = {frame.id: frame.parent for frame in sheet.frames}
    around = {box.id: set(chain(box.group, parents)) for box in sheet.boxes}
    for number, line in enumerate(sheet.lines):
        ends, options = [line.source, line.target], [f"line={number}"]
        if line.target[0] in first:
            ends.reverse()
        if line.width:
            crossed = len(around[line.source[0]] ^ around[line.target[0]])
            options.append(f"label={_cell(line.width + room * crossed, line.height)}")
        if line.course == "left":
            ends.reverse()
        start, end = (names[name] for name, _ in ends)
        end += ":n" if line.course == "down" else ""
        yield f"  {start} -> {end} [{', '.join(options)}]"
        if line.course in ("left", "right"):
            yield f"  {{ rank=same; {start}; {end} }}"
    for one, other in _below_first(sheet):
        yield f"  {names[one]} -> {names[other]} [style=invis]"


def _below_first(sheet: Sheet) -> Iterator[tuple[str, str]]:
    """Yields boxes, upper and lower, of sheets that go downwards: the first of each frame."""
    first = {box.group: box.id for box in reversed(sheet.boxes) if box.column == 0}
    for box in sheet.boxes:
        if box.column and box.group in first:
            yield first[box.group], box.id


def _places(sheet: Sheet, layout: dict[str, Any]) -> Places:
    _, _, width, height = (float(word) for word in layout["bb"].split(","))

    def point(text: str) -> Point:
        x, y = text.split(",")
        return round(float(x), 1), round(height - float(y), 1)

    boxes, frames, lines = {}, {}, {}
    objects = {record["name"]: record for record in layout.get("objects", ())}
    for number, box in enumerate(sheet.boxes):
        x, y = point(objects[f"b{number}"]["pos"])
        boxes[box.id] = round(x - box.width / 2, 1), round(y - box.height / 2, 1)
    for number, frame in enumerate(sheet.frames):
        left, low, right, high = objects[f"cluster_{number}"]["bb"].split(",")
        frames[frame.id] = point(f"{left},{high}"), point(f"{right},{low}")
    middles = {b.id: (boxes[b.id][0] + b.width / 2, boxes[b.id][1] + b.height / 2)
               for b in sheet.boxes}  # fmt: skip
    for edge in layout.get("edges", ()):
        if "line" in edge:
            line = sheet.lines[int(edge["line"])]
            points = tuple(point(text) for text in edge["pos"].split(" ") if text[0] not in "es")
            label = point(edge["lp"]) if "lp" in edge else None
            lines[line.id] = Route(_from_source(points, line, middles), label)
    return Places(width, height, boxes, frames, lines)


def _from_source(
    points: tuple[Point, ...], line: Line, middles: dict[str, Point]
) -> tuple[Point, ...]:
    """Returns the way from the source to the target: `dot` has some the other way round."""
    source, target = middles[line.source[0]], middles[line.target[0]]
    forwards = dist(points[0], source) + dist(points[-1], target)
    backwards = dist(points[-1], source) + dist(points[0], target)
    return points[::-1] if backwards < forwards else points
