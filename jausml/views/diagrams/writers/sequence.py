"""Sequence diagrams: who sends what to whom, one below the other, as Mermaid and as SVG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from jausml.views.diagrams.writers.shapes import ROW, SMALL, TITLE, cut, style, width
from jausml.views.diagrams.writers.svg import MARGIN, opening, text_element
from jausml.views.diagrams.writers.text import as_data

_LONGEST = 90  # characters of a text at most; longer ones are cut

_ROW_HEIGHT, _HEAD, _GAP, _TIMES = 26, 58, 30, 40
"""Pixels: height of a row, baseline of the heads, room between columns, and for times at least."""

_TO_FIRST_ROW, _TO_END = 34, 22
"""Pixels from the heads to the first row, and from the last row to the end."""

_TITLE = 16  # size of the title, as `opening` writes it


@dataclass(frozen=True)
class Event:
    """A message between participants, an action of one, or a step of all.

    `receiver`: whom a message goes to; empty for what one does alone. `sender`: who does it; empty
    for what happens to all, as that time passes.
    """

    time: str
    text: str
    sender: str = ""
    receiver: str = ""


@dataclass(frozen=True)
class SequenceDiagram:
    """Consecutive events under a title, and the sentence at their end."""

    title: str
    end: str
    events: Sequence[Event]

    @property
    def participants(self) -> list[str]:
        """The senders and receivers, in the order of appearance; `time` alone if there are none."""
        names = (name for event in self.events for name in (event.sender, event.receiver) if name)
        return list(dict.fromkeys(names)) or ["time"]


def mermaid(diagram: SequenceDiagram) -> str:
    """Returns a diagram in the language of Mermaid, which GitHub and many editors show."""
    participants = diagram.participants
    ids = {participant: f"a{number}" for number, participant in enumerate(participants)}
    lines = ["sequenceDiagram", f"  title {as_data(diagram.title)}"]
    lines += [
        f"  participant {ids[participant]} as {as_data(participant)}"
        for participant in participants
    ]
    all_ids = ",".join(dict.fromkeys([ids[participants[0]], ids[participants[-1]]]))
    for event in diagram.events:
        text = as_data(f"{event.time} {event.text}".strip())
        if not event.sender:
            lines.append(f"  Note over {all_ids}: {text}")
        elif event.receiver:
            lines.append(f"  {ids[event.sender]}->>{ids[event.receiver]}: {text}")
        else:
            lines.append(f"  Note over {ids[event.sender]}: {text}")
    lines.append(f"  Note over {all_ids}: {as_data(diagram.end)}")
    return "\n".join(lines) + "\n"


def svg(diagram: SequenceDiagram) -> str:
    """Returns a diagram as a picture, light or dark as the viewer prefers."""
    events = diagram.events
    columns = _columns(diagram)
    foot = _HEAD + 20 + _ROW_HEIGHT * len(events)
    size = (round(columns.right + MARGIN, 1), foot + 2 * MARGIN + 10)
    lines = [*opening(size, cut(diagram.title, _LONGEST), style("auto"), {"arrow": "head"})]
    for participant, x in columns.places.items():
        lines += _column(participant, x, foot)
    for number, event in enumerate(events):
        lines += _row(event, _HEAD + _TO_FIRST_ROW + _ROW_HEIGHT * number, columns)
    end = cut(diagram.end, _LONGEST)
    lines += [text_element(MARGIN, foot + _TO_END, end, ROW, "error", bold=True), "</svg>"]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class _Columns:
    """Where things stand from left to right, in pixels.

    Attributes:
        left: Where the columns begin, behind the times.
        places: The middle of each participant's column.
        right: Where the last column or the longest sentence ends.
    """

    left: float
    places: Mapping[str, float]
    right: float


def _columns(diagram: SequenceDiagram) -> _Columns:
    """Makes all columns as wide as the longest text, so that none runs into another."""
    participants = diagram.participants
    texts = [width(cut(event.text, _LONGEST), SMALL) for event in diagram.events]
    heads = [width(cut(name, _LONGEST), TITLE, bold=True) for name in participants]
    column = round(max([*texts, *heads]) + _GAP, 1)
    left = MARGIN + max([_TIMES, *(width(event.time, SMALL) + 6 for event in diagram.events)])
    first = left + column / 2
    places = {name: round(first + column * number, 1) for number, name in enumerate(participants)}
    title = width(cut(diagram.title, _LONGEST), _TITLE, bold=True)
    end = width(cut(diagram.end, _LONGEST), ROW, bold=True)
    right = max(first + column * len(heads), MARGIN + title, MARGIN + end)
    return _Columns(round(left, 1), places, right)


def _column(participant: str, x: float, foot: float) -> Iterator[str]:
    """Yields the head of a column, and the line that events stand at."""
    text = cut(participant, _LONGEST)
    left = x - width(text, TITLE, bold=True) / 2
    yield text_element(left, _HEAD, text, TITLE, "title", bold=True)
    yield f'<path class="edge owns" d="M{x} {_HEAD + 8}V{foot}"/>'


def _row(event: Event, y: float, columns: _Columns) -> Iterator[str]:
    """Yields the time and the text of an event, and the arrow of a message."""
    text = cut(event.text, _LONGEST)
    yield text_element(MARGIN, y, event.time, SMALL, "muted")
    if not event.sender:
        yield f'<path class="rule" d="M{columns.left} {y - 3}H{round(columns.right, 1)}"/>'
        yield from _label(columns.left + 6, y, text, "muted")
        return
    start = columns.places[event.sender]
    if not event.receiver:
        yield from _label(start + 6, y, text, "flow")
        return
    end = columns.places[event.receiver]
    yield f'<path class="edge message" d="M{start} {y}H{end}" marker-end="url(#arrow)"/>'
    middle = (start + end) / 2 - width(text, SMALL) / 2
    yield from _label(middle, y - 5, text, "flow")


def _label(x: float, y: float, text: str, kind: str) -> Iterator[str]:
    """Yields a text with a background, so that lines behind it do not cross it."""
    wide = width(text, SMALL) + 6
    corner = f'x="{round(x - 3, 1)}" y="{round(y - 9, 1)}"'
    yield f'<rect class="behind" {corner} width="{round(wide, 1)}" height="12" rx="2"/>'
    yield text_element(x, y, text, SMALL, kind)
