"""Layout by Graphviz, as graphviz-pure brings it: `dot`, on boxes of given sizes.

It is told no text, so that no font has a say.
"""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace
from importlib import metadata
from math import dist
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml import installing
from jausml.views.diagrams.graph import nested
from jausml.views.diagrams.layout.columns import Block, packed
from jausml.views.diagrams.layout.facing import can_face, face
from jausml.views.diagrams.layout.labels import cleared
from jausml.views.diagrams.layout.settling import chain
from jausml.views.diagrams.layout.sheet import LayoutError, Places, Route
from jausml.views.diagrams.layout.ways import spaced

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.views.diagrams.layout.sheet import Box, Line, Point, Sheet

PACKAGE = "graphviz-pure"
"""The distribution, and the program that it installs."""

MISSING = f"pictures need {PACKAGE}: {installing.command('diagram')}"
LONGEST = 120
"""Seconds that a layout may take."""

_FEW_PARTS = 2
"""Parts that stand above each other."""

_TABLE = '<table fixedsize="true" border="0" cellborder="0" cellspacing="0" cellpadding="0"'


def program() -> Path | None:
    """Returns the program of the layout as it is installed for this Python; None without it."""
    try:
        files = metadata.files(PACKAGE) or ()
    except metadata.PackageNotFoundError:
        return None
    places = (Path(str(file.locate())) for file in files if file.stem == PACKAGE)
    return next((place for place in places if place.is_file()), None)


class Graphviz:
    """An engine that runs `dot` in a process of its own."""

    def place(self, sheet: Sheet) -> Places:
        """Returns where everything stands; what needs no search is placed without Graphviz."""
        if can_face(sheet):
            return cleared(sheet, face(sheet))
        parts = [sheet] if sheet.packed else _parts(sheet)
        layouts = _run("\n".join(line for part in parts for line in _graph(part)))
        return cleared(
            sheet,
            _beside(
                [spaced(part, _places(part, its)) for part, its in zip(parts, layouts, strict=True)]
            ),
        )


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


def _graph(sheet: Sheet) -> Iterator[str]:
    yield "digraph {"
    yield (
        '  graph [rankdir="TB", nodesep=0.4, ranksep=0.5]'
        if sheet.downwards
        else ('  graph [rankdir="LR", nodesep=0.3, ranksep=1.1]')
    )
    if sheet.packed:
        yield '  graph [pack=24, packmode="array_c3"]'
    yield "  node [shape=plain]"
    yield "  edge [dir=none]"
    for what, number, _ in nested(sheet.boxes, sheet.frames):
        match what:
            case "box":
                yield f"  {_box(number, sheet.boxes[number])}"
            case "begin":
                label = _cell(sheet.frames[number].width, sheet.frames[number].height)
                yield f"  subgraph cluster_{number} {{ label={label}; labeljust=l; margin=12"
            case "end":
                yield "  }"
    yield from _lines(sheet)
    yield "}"


def _parts(sheet: Sheet) -> list[Sheet]:
    """Returns the parts of a sheet that no line and no frame joins; few ones stay together.

    `dot` sets all parts above each other, and packed by itself leaves no room for labels.
    """
    parents = {frame.id: frame.parent for frame in sheet.frames}
    outer = {parent: list(chain(parent, parents))[-1] for parent in parents}
    whole = {box.id: {box.id} for box in sheet.boxes}
    first: dict[str, str] = {}
    pairs = [(line.source[0], line.target[0]) for line in sheet.lines]
    pairs += [
        (box.id, first.setdefault(outer[box.group], box.id)) for box in sheet.boxes if box.group
    ]
    pairs += _below_first(sheet)
    for one, other in pairs:
        if whole[one] is not whole[other]:
            joined = whole[one] | whole[other]
            whole |= dict.fromkeys(joined, joined)
    parts = {id(part): part for part in whole.values()}.values()
    if len(parts) <= _FEW_PARTS:
        return [sheet]
    return [_part(sheet, part, outer) for part in parts]


def _part(sheet: Sheet, names: set[str], outer: Mapping[str, str]) -> Sheet:
    boxes = tuple(box for box in sheet.boxes if box.id in names)
    frames = {outer.get(box.group) for box in boxes}
    return replace(
        sheet,
        boxes=boxes,
        frames=tuple(frame for frame in sheet.frames if outer[frame.id] in frames),
        lines=tuple(line for line in sheet.lines if line.source[0] in names),
    )


def _beside(parts: Sequence[Places]) -> Places:
    """Returns the places of parts that stand beside each other."""
    if len(parts) == 1:
        return parts[0]
    blocks = [Block(e.width, e.height, {str(n): (0, 0)}) for n, e in enumerate(parts)]
    whole = packed(blocks)
    places = Places(whole.width, whole.height, {}, {}, {})
    for number, part in enumerate(parts):
        moved = part.moved(*whole.corners[str(number)])
        places.boxes.update(moved.boxes)
        places.frames.update(moved.frames)
        places.lines.update(moved.lines)
    return places


def _cell(width: int, height: int) -> str:
    return f'<{_TABLE} width="{width}" height="{height}"><tr><td></td></tr></table>>'


def _box(number: int, box: Box) -> str:
    size = f'fixedsize="true" width="{box.width}"'
    rows = [f'<tr><td port="h" {size} height="{box.head}"></td></tr>']
    rows += [
        f'<tr><td port="p{index}" {size} height="{row.height}"></td></tr>'
        for index, row in enumerate(box.rows)
    ]
    table = f'{_TABLE} width="{box.width}" height="{box.height}">'
    return f"b{number} [label=<{table}{''.join(rows)}</table>>]"


def _lines(sheet: Sheet) -> Iterator[str]:
    names = {box.id: f"b{number}" for number, box in enumerate(sheet.boxes)}
    ports = {
        (box.id, row.id): f"{names[box.id]}:p{index}"
        for box in sheet.boxes
        for index, row in enumerate(box.rows)
    }
    columns = _columns(sheet)
    first = {box.id for box in sheet.boxes if box.column == 0}
    linked = set()
    for number, line in enumerate(sheet.lines):
        ends, options = [line.source, line.target], [f"line={number}"]
        if columns and columns[line.source[0]] > columns[line.target[0]]:
            ends.reverse()
        if sheet.downwards and line.target[0] in first:
            ends.reverse()
        if line.width:
            options.append(f"label={_cell(line.width, line.height)}")
        if line.course == "left":
            ends.reverse()
        sides = _sides(columns, ends[0][0], ends[1][0])
        if sides[0] == sides[1] != "":
            options.append("constraint=false")
        else:
            linked |= {end[0] for end in ends}
        start, end = (
            ports.get(line_end, f"{names[line_end[0]]}:h" if columns else names[line_end[0]]) + side
            for line_end, side in zip(ends, sides, strict=True)
        )
        end += ":n" if line.course == "down" else ""
        yield f"  {start} -> {end} [{', '.join(options)}]"
        if line.course in ("left", "right"):
            yield f"  {{ rank=same; {start}; {end} }}"
    yield from _strays(sheet, columns, names, linked)
    for one, other in _below_first(sheet):
        yield f"  {names[one]} -> {names[other]} [style=invis]"


def _below_first(sheet: Sheet) -> Iterator[tuple[str, str]]:
    """Yields what is above what where a sheet goes downwards: the first box of each frame."""
    first = {box.group: box.id for box in reversed(sheet.boxes) if box.column == 0}
    for box in sheet.boxes if sheet.downwards else ():
        if box.column and box.group in first:
            yield first[box.group], box.id


def _sides(columns: dict[str, int], start: str, end: str) -> tuple[str, str]:
    """Returns the sides of boxes at which a line starts and ends, empty for any."""
    if not columns:
        return "", ""
    outer = {min(columns.values()): ":w", max(columns.values()): ":e"}
    if columns[start] == columns[end] and columns[start] in outer:
        side = outer[columns[start]]
        return side, side
    return ":e", ":w"


def _columns(sheet: Sheet) -> dict[str, int]:
    """Returns the columns of boxes, none where all stand in one and lines alone decide."""
    columns = {box.id: box.column for box in sheet.boxes}
    return columns if len(set(columns.values())) > 1 and not sheet.downwards else {}


def _strays(
    sheet: Sheet, columns: dict[str, int], names: dict[str, str], linked: set[str]
) -> Iterator[str]:
    """Yields what keeps boxes in their columns that no line keeps there."""
    for box in sheet.boxes if columns else ():
        others = [neighbour for neighbour in sheet.boxes if neighbour.column != box.column]
        if box.id not in linked and not sheet.packed:
            other = min(others, key=lambda neighbour: abs(neighbour.column - box.column))
            pair = (box, other) if box.column < other.column else (other, box)
            yield f"  {names[pair[0].id]} -> {names[pair[1].id]} [style=invis]"


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
    ends = _ends(sheet, boxes)
    for edge in layout.get("edges", ()):
        if "line" in edge:
            line = sheet.lines[int(edge["line"])]
            points = tuple(point(text) for text in edge["pos"].split(" ") if text[0] not in "es")
            label = point(edge["lp"]) if "lp" in edge else None
            lines[line.id] = Route(_from_source(points, line, ends), label)
    return Places(width, height, boxes, frames, lines)


def _ends(sheet: Sheet, boxes: dict[str, Point]) -> dict[tuple[str, str], Point]:
    """Returns the middles of boxes and rows, where lines end nearby."""
    return {
        (box.id, row): (boxes[box.id][0] + box.width / 2, boxes[box.id][1] + down)
        for box in sheet.boxes
        for row, down in {**box.middles(), "": box.height / 2}.items()
    }


def _from_source(
    points: tuple[Point, ...], line: Line, ends: dict[tuple[str, str], Point]
) -> tuple[Point, ...]:
    """Returns the way from the source to the target: `dot` has some the other way round."""
    source, target = ends[line.source], ends[line.target]
    forwards = dist(points[0], source) + dist(points[-1], target)
    backwards = dist(points[-1], source) + dist(points[0], target)
    return points[::-1] if backwards < forwards else points
