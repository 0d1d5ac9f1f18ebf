"""Arguments of safety cases as pictures in Goal Structuring Notation.

Goals are rectangles, strategies parallelograms, evidence (solutions) circles, contexts rounded
rectangles, justifications ellipses; a diamond marks a goal that is undeveloped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import ceil, hypot

from jausml.safety_case.argument import (
    SUPPORTED,
    UNDEVELOPED,
    HazardCase,
    SafetyCase,
    counted,
)
from jausml.views.diagrams.layout.graphviz import place
from jausml.views.diagrams.layout.sheet import Box, Course, Line, Places, Point, Sheet
from jausml.views.diagrams.writers.shapes import LINE_HEIGHT, ROW, SMALL, cut, style, width
from jausml.views.diagrams.writers.svg import MARGIN, TOP, curve, opening, text_element

_GOAL, _STRATEGY, _SOLUTION = "goal", "strategy", "solution"
_CONTEXT, _JUSTIFICATION = "context", "justification"
_ROOM = {_GOAL: 170, _STRATEGY: 160, _SOLUTION: 92, _CONTEXT: 170, _JUSTIFICATION: 150}
"""Width of texts, in pixels."""

_LEGEND = "diamond: undeveloped · dashed circle: evidence against · ellipse: reason of a person"
_AT_ONCE = 4  # goals of a picture, as many as can be read on a page

_PADDING, _ROUND_PADDING, _SLANT, _DIAMOND, _CORNER = 9, 6, 14, 9, 16  # pixels
_ROOT_OF_2 = 1.42  # rounded up: an ellipse around a rectangle is so much wider and higher
_TITLE_SIZE, _LEGEND_BASE, _DESCENT = 16, 41, 3  # pixels; the last of letters below their base
_LONGEST_TITLE, _LONGEST_TEXT, _MOST_LINES = 90, 400, 8  # of characters, and lines of a shape
_FILE_DIGITS, _EVIDENCE_DIGITS = 12, 8  # of digests, enough to tell files apart
STYLE = style("light") + (
    ".against .body{stroke-dasharray:6 4}.hollow{fill:#FFFFFF;stroke:#6B6B6B}"
    ".undeveloped{fill:none;stroke:#6B6B6B;stroke-width:1.5}"
)
_ARROWS = {"supported": "head", "context": "hollow"}


@dataclass(frozen=True)
class _Shape:
    kind: str
    title: str
    lines: list[str]
    is_open: bool
    is_against: bool

    @property
    def size(self) -> tuple[int, int]:
        """Width and height without the diamond."""
        texts = [width(line, SMALL) for line in self.lines]
        wide = ceil(max((width(self.title, ROW, bold=True), *texts)))
        high = LINE_HEIGHT * (len(self.lines) + 1)
        if self.kind == _SOLUTION:
            across = ceil(hypot(wide, high)) + _ROUND_PADDING
            return across, across
        if self.kind == _JUSTIFICATION:
            wide, high = ceil(wide * _ROOT_OF_2), ceil(high * _ROOT_OF_2)
            return wide + _ROUND_PADDING, high + _ROUND_PADDING
        slant = 2 * _SLANT if self.kind == _STRATEGY else 0
        return wide + 2 * _PADDING + slant, high + 2 * _PADDING


@dataclass
class _Argument:
    title: str
    shapes: dict[str, _Shape] = field(default_factory=dict)
    lines: dict[str, Line] = field(default_factory=dict)

    def add(
        self, id_: str, kind: str, text: str, above: str = "", course: Course = "down",
        *, is_open: bool = False, is_against: bool = False,
    ) -> None:  # fmt: skip
        """Adds a shape below another one, or beside it, unless it is there."""
        # Of a reference such as `E1!G2.3` only the part before the mark is shown.
        title = id_.partition("!")[0]
        shape = _Shape(kind, title, _wrapped(text, _ROOM[kind]), is_open, is_against)
        self.shapes.setdefault(id_, shape)
        if above:
            line = Line(f"{above}>{id_}", (above, ""), (id_, ""), course=course)
            self.lines.setdefault(line.id, line)


def pictures(case: SafetyCase) -> dict[str, str]:
    """Returns pictures in SVG by their names: `case` of all hazards, and `names_of` of each.

    Raises:
        LayoutError: Graphviz is missing or failed; the message says which.
    """
    arguments_by_name = {"case": _overview(case)}
    for hazard in case.hazards:
        for at, name in enumerate(names_of(hazard)):
            some = hazard.goals[at * _AT_ONCE : (at + 1) * _AT_ONCE]
            arguments_by_name[name] = _hazard(case, replace(hazard, goals=some))
    return {name: _drawn(argument) for name, argument in arguments_by_name.items()}


def names_of(hazard: HazardCase) -> list[str]:
    """Returns the names of the pictures of a hazard, which has as many as can be read."""
    count = ceil(len(hazard.goals) / _AT_ONCE)
    return [f"case-{hazard.id}{f'-{at}' if at > 1 else ''}" for at in range(1, count + 1)]


def _overview(case: SafetyCase) -> _Argument:
    argument = _Argument(f"safety case of {case.system}")
    argument.add("G0", _GOAL, f"{case.system} does no harm by what its messages cause or lack")
    files = "; ".join(f"{name} {digest[:_FILE_DIGITS]}" for name, digest in case.model.items())
    argument.add("C1", _CONTEXT, f"model: {files}", "G0", "left")
    assumed = f"assumptions, in the document; jausml {case.jausml}"
    argument.add("C2", _CONTEXT, assumed, "G0", "right")
    argument.add("S0", _STRATEGY, "over each hazard", "G0")
    for hazard in case.hazards:
        text = f"{hazard.title}: {counted(hazard.goals) if hazard.goals else 'concerns nothing'}"
        argument.add(hazard.number, _GOAL, text, "S0", is_open=not hazard.answered)
    return argument


def _hazard(case: SafetyCase, hazard: HazardCase) -> _Argument:
    argument = _Argument(f"{case.system}: {hazard.title.lower()}")
    evidence = {item.id: item for item in case.evidence}
    over = f"S{hazard.number[1:]}"
    argument.add(hazard.number, _GOAL, f"{hazard.title} is answered")
    argument.add(over, _STRATEGY, "over each element", hazard.number)
    for goal in hazard.goals:
        standing = [] if goal.standing in (SUPPORTED, UNDEVELOPED) else [goal.standing]
        text = "; ".join((goal.claim, *(f"OPEN: {gap}" for gap in goal.gaps), *standing))
        argument.add(goal.number, _GOAL, text, over, is_open=not goal.answered)
        by = f"S{goal.number[1:]}"
        if goal.answers:
            argument.add(
                by, _STRATEGY, "; ".join(answer.text for answer in goal.answers), goal.number
            )
        if reason := "; ".join(answer.reason for answer in goal.answers if answer.reason):
            argument.add(f"J{goal.number[1:]}", _JUSTIFICATION, reason, by, "right")
        for support in goal.supports:
            one = evidence[support.evidence]
            text = f"{one.kind} {one.path.rpartition('/')[2]} {one.sha256[:_EVIDENCE_DIGITS]}"
            above = by if goal.answers else goal.number
            if not support.holds:
                # It speaks of this goal alone.
                argument.add(f"{one.id}!{goal.number}", _SOLUTION, text, above, is_against=True)
            elif goal.answers:
                argument.add(one.id, _SOLUTION, text, above)
    return argument


def _drawn(argument: _Argument) -> str:
    boxes = tuple(
        Box(id_, shape.size[0], shape.size[1] + 2 * _DIAMOND * shape.is_open, (), "", 0)
        for id_, shape in argument.shapes.items()
    )
    sheet = Sheet(boxes, (), tuple(argument.lines.values()), downwards=True)
    return "\n".join(_svg(argument, place(sheet))) + "\n"


def _svg(argument: _Argument, places: Places) -> Iterator[str]:
    title = cut(argument.title, _LONGEST_TITLE)
    least = max(places.width, width(title, _TITLE_SIZE, bold=True), width(_LEGEND, SMALL))
    wide, high = round(least + 2 * MARGIN, 1), round(places.height + TOP + MARGIN, 1)
    yield from opening((wide, high), title, STYLE, _ARROWS)
    yield text_element(MARGIN, _LEGEND_BASE, _LEGEND, SMALL, "muted")
    yield f'<g transform="translate({MARGIN} {TOP})">'
    for line in argument.lines.values():
        marker = "supported" if line.course == "down" else "context"
        # From the middle of the shape, which covers it: a layout knows rectangles alone.
        (x, y), source = places.boxes[line.source[0]], argument.shapes[line.source[0]].size
        way = f"M{x + source[0] / 2:g} {y + source[1] / 2:g}L{curve(places.lines[line.id])[1:]}"
        yield f'<path class="edge" d="{way}" marker-end="url(#{marker})"/>'
    for id_, shape in argument.shapes.items():
        yield from _shape(shape, places.boxes[id_])
    yield "</g>\n</svg>"


def _shape(shape: _Shape, corner: Point) -> Iterator[str]:
    (x, y), (wide, high) = corner, shape.size
    middle = x + wide / 2
    yield f'<g class="box {shape.kind}{" against" if shape.is_against else ""}">'
    if shape.kind in (_SOLUTION, _JUSTIFICATION):
        radii = f'rx="{wide / 2:g}" ry="{high / 2:g}"'
        yield f'<ellipse class="body" cx="{middle:g}" cy="{y + high / 2:g}" {radii}/>'
    elif shape.kind == _STRATEGY:
        top = f"M{x + _SLANT:g} {y:g}H{x + wide:g}"
        yield f'<path class="body" d="{top}l-{_SLANT} {high}H{x:g}Z"/>'
    else:
        size = f'width="{wide}" height="{high}" rx="{_CORNER if shape.kind == _CONTEXT else 0}"'
        yield f'<rect class="body" x="{x:g}" y="{y:g}" {size}/>'
    if shape.is_open:
        sides = f"l{_DIAMOND} {_DIAMOND}l-{_DIAMOND} {_DIAMOND}l-{_DIAMOND} -{_DIAMOND}Z"
        yield f'<path class="undeveloped" d="M{middle:g} {y + high:g}{sides}"/>'
    base = y + (high - LINE_HEIGHT * (len(shape.lines) + 1)) / 2 + LINE_HEIGHT - _DESCENT
    left = middle - width(shape.title, ROW, bold=True) / 2
    yield text_element(left, base, shape.title, ROW, "title", bold=True)
    for at, text in enumerate(shape.lines, start=1):
        left = middle - width(text, SMALL) / 2
        yield text_element(left, base + at * LINE_HEIGHT, text, SMALL, "")
    yield "</g>"


def _wrapped(text: str, room: int) -> list[str]:
    """Returns a text in lines, cut where it is too long for them."""
    lines: list[str] = []
    for word in cut(text, _LONGEST_TEXT).split():
        if lines and width(f"{lines[-1]} {word}", SMALL) <= room:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    if len(lines) > _MOST_LINES:
        lines[_MOST_LINES - 1 :] = [f"{lines[_MOST_LINES - 1]} \N{HORIZONTAL ELLIPSIS}"]
    return lines
