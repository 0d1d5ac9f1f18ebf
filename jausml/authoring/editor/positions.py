"""Positions as editors count them: lines from 0, columns in the units of an encoding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

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
    """Translates between the columns of a text and those of an editor.

    `encoding`: units in which the editor counts: `utf-8`, `utf-16` or `utf-32`.
    """

    def __init__(self, text: str, encoding: str = UTF_16) -> None:
        self._lines = text.split("\n")
        self._width = _WIDTHS[encoding]

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
