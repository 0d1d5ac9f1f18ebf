"""Sequence diagrams: who sends what to whom, one below the other, as Mermaid and as SVG."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.views.diagrams.writers.shapes import ROW, SMALL, TITLE, cut, style, width
from jausml.views.diagrams.writers.svg import MARGIN, opening, text_element
from jausml.views.diagrams.writers.text import as_data

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_LONGEST = 90
"""Characters of a text at most; longer ones are cut."""

_ROW_HEIGHT, _HEAD, _GAP, _TIMES = 26, 58, 30, 40
"""Pixels: height of a row, baseline of the heads, room between columns, and for times at least."""

_TO_FIRST_LINE, _TO_END = 34, 22
"""Pixels from the heads to the first line, and from the last line to the end."""

_TITLE = 16
"""Size of the title, as `opening` writes it."""


@dataclass(frozen=True)
class Line:
    """One message between participants, or one event.

    `receiver`: whom the text goes to; empty for what one does alone. `sender`: who does it; empty
    for what happens to all.
    """

    time: str
    text: str
    sender: str = ""
    receiver: str = ""


@dataclass(frozen=True)
class Course:
    """A sequence of events with a title, and the sentence that ends it."""

    title: str
    end: str
    lines: Sequence[Line]

    @property
    def participants(self) -> list[str]:
        """Who sends or receives, in the order of appearance; `time` alone if nobody does."""
        names = (name for line in self.lines for name in (line.sender, line.receiver) if name)
        return list(dict.fromkeys(names)) or ["time"]


def mermaid(course: Course) -> str:
    """Returns a sequence in the language of Mermaid, which GitHub and many editors show."""
    participants = course.participants
    ids = {participant: f"a{number}" for number, participant in enumerate(participants)}
    lines = ["sequenceDiagram", f"  title {as_data(course.title)}"]
    lines += [
        f"  participant {ids[participant]} as {as_data(participant)}"
        for participant in participants
    ]
    all_ids = ",".join(dict.fromkeys([ids[participants[0]], ids[participants[-1]]]))
    for line in course.lines:
        text = as_data(f"{line.time} {line.text}".strip())
        if not line.sender:
            lines.append(f"  Note over {all_ids}: {text}")
        elif line.receiver:
            lines.append(f"  {ids[line.sender]}->>{ids[line.receiver]}: {text}")
        else:
            lines.append(f"  Note over {ids[line.sender]}: {text}")
    lines.append(f"  Note over {all_ids}: {as_data(course.end)}")
    return "\n".join(lines) + "\n"


def svg(course: Course) -> str:
    """Returns a sequence as a picture, light or dark as the viewer prefers."""
    return "\n".join(_parts(course)) + "\n"


def _parts(course: Course) -> Iterator[str]:
    texts = [width(cut(course_line.text, _LONGEST), SMALL) for course_line in course.lines]
    heads = [
        width(cut(participant, _LONGEST), TITLE, bold=True) for participant in course.participants
    ]
    column = round(max([*texts, *heads]) + _GAP, 1)
    times = max([_TIMES, *(width(course_line.time, SMALL) + 6 for course_line in course.lines)])
    first = MARGIN + times + column / 2
    places = {
        participant: round(first + column * n, 1)
        for n, participant in enumerate(course.participants)
    }
    foot = _HEAD + 20 + _ROW_HEIGHT * len(course.lines)
    ends = (
        width(cut(course.title, _LONGEST), _TITLE, bold=True),
        width(cut(course.end, _LONGEST), ROW, bold=True),
    )
    right = max(first + column * len(heads), *(MARGIN + end for end in ends))
    size = (round(right + MARGIN, 1), foot + 2 * MARGIN + 10)
    yield from opening(size, cut(course.title, _LONGEST), style("auto"), {"arrow": "head"})
    for participant, x in places.items():
        text = cut(participant, _LONGEST)
        left = x - width(text, TITLE, bold=True) / 2
        yield text_element(left, _HEAD, text, TITLE, "title", bold=True)
        yield f'<path class="edge owns" d="M{x} {_HEAD + 8}V{foot}"/>'
    for number, line in enumerate(course.lines):
        y = _HEAD + _TO_FIRST_LINE + _ROW_HEIGHT * number
        yield from _line(line, y, places, (round(MARGIN + times, 1), size[0] - MARGIN))
    yield text_element(MARGIN, foot + _TO_END, cut(course.end, _LONGEST), ROW, "error", bold=True)
    yield "</svg>"


def _line(
    line: Line, y: float, places: dict[str, float], sides: tuple[float, float]
) -> Iterator[str]:
    """Yields a row; `sides`: where it begins, behind the times, and where it ends."""
    text = cut(line.text, _LONGEST)
    yield text_element(MARGIN, y, line.time, SMALL, "muted")
    if not line.sender:
        yield f'<path class="rule" d="M{sides[0]} {y - 3}H{sides[1]}"/>'
        yield from _label(sides[0] + 6, y, text, "muted")
        return
    start = places[line.sender]
    if not line.receiver:
        yield from _label(start + 6, y, text, "flow")
        return
    end = places[line.receiver]
    yield f'<path class="edge message" d="M{start} {y}H{end}" marker-end="url(#arrow)"/>'
    middle = (start + end) / 2 - width(text, SMALL) / 2
    yield from _label(middle, y - 5, text, "flow")


def _label(x: float, y: float, text: str, kind: str) -> Iterator[str]:
    wide = width(text, SMALL) + 6
    corner = f'x="{round(x - 3, 1)}" y="{round(y - 9, 1)}"'
    yield f'<rect class="behind" {corner} width="{round(wide, 1)}" height="12" rx="2"/>'
    yield text_element(x, y, text, SMALL, kind)
