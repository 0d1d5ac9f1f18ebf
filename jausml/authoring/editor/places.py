"""Places in a text: as the parser counts, and as editors do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.tree import Span

UTF_16 = "utf-16"
"""The units that editors count in unless they ask for others."""

_WIDTHS: Mapping[str, Callable[[str], int]] = {
    UTF_16: lambda character: 2 if ord(character) > 0xFFFF else 1,
    "utf-8": lambda character: len(character.encode("utf-8", "surrogatepass")),
    "utf-32": lambda character: 1,  # noqa: ARG005 - one shape for all
}


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A place as the parser counts: line and column in characters, from 1."""

    line: int
    column: int


class Columns:
    """A text with the columns of an editor, and its changes.

    `text`: the text; a carriage return that ends a line alone becomes a line feed. `encoding`:
    units in which the editor counts: `utf-8`, `utf-16` or `utf-32`.
    """

    def __init__(self, text: str | Iterable[str], encoding: str = UTF_16) -> None:
        self._lines = with_line_feeds(text).split("\n") if isinstance(text, str) else list(text)
        self._encoding = encoding
        self._width = _WIDTHS[encoding]

    @cached_property
    def text(self) -> str:
        """The whole text."""
        return "\n".join(self._lines)

    def edited(self, start: tuple[int, int], end: tuple[int, int], new: str) -> Columns:
        """Returns the text with a new stretch in place of another.

        `start`, `end`: line and units as the editor counts them.
        """
        behind = Place(len(self._lines), len(self._lines[-1]) + 1)
        first, last = sorted(min(self.place(*position), behind) for position in (start, end))
        head = self._lines[first.line - 1][: first.column - 1]
        tail = self._lines[last.line - 1][last.column - 1 :]
        # With its line end, for the line may have the first half of one.
        line_end = "\n" if last.line < len(self._lines) else ""
        changed = with_line_feeds(f"{head}{new}{tail}{line_end}").removesuffix(line_end).split("\n")
        return Columns(
            (*self._lines[: first.line - 1], *changed, *self._lines[last.line :]), self._encoding
        )

    def place(self, line: int, units: int) -> Place:
        """Returns the place that an editor means; one behind the end is the end.

        `line`: line, counted from 0.
        """
        text = self._line(line)
        taken = 0
        for column, character in enumerate(text, 1):
            if taken >= units:
                return Place(line + 1, column)
            taken += self._width(character)
        return Place(line + 1, len(text) + 1)

    def units(self, line: int, column: int) -> tuple[int, int]:
        """Returns line and units as an editor counts them.

        `line`: line, counted from 1. `column`: column in characters, counted from 1.
        """
        before = self._line(line - 1)[: column - 1]
        return line - 1, sum(map(self._width, before))

    def end(self) -> tuple[int, int]:
        """Returns the end of the text, as an editor counts it."""
        return self.units(len(self._lines), len(self._lines[-1]) + 1)

    def _line(self, line: int) -> str:
        return self._lines[line].rstrip("\r") if 0 <= line < len(self._lines) else ""


def start_of(span: Span) -> Place:
    """Returns where a stretch begins."""
    return Place(span.line, span.column)


def end_of(span: Span) -> Place:
    """Returns where a stretch ends: the place behind its last character."""
    return Place(span.end_line, span.end_column)


def is_within(span: Span, place: Place) -> bool:
    """Tells whether a place touches a stretch; the place behind its last character does."""
    return start_of(span) <= place <= end_of(span)
