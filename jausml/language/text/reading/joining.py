"""Trees joined of parts that were read by themselves, on lines of their own.

What has moved to other lines is copied when somebody looks at it.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from lark import Token

from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import Span

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.language.text.reading.parsing import Parsed
    from jausml.language.text.tree import Item


@dataclass(eq=False)
class Part:
    """What was read of a piece of a text.

    Attributes:
        line: The line on which it began when it was read.
        has_more: Whether there is something besides items and tokens.
    """

    parsed: Parsed
    line: int
    has_more: bool = False
    _moved: tuple[int, list[Any]] | None = None

    def items(self, by: int) -> list[Any]:
        """Returns its items, moved by lines; those of the last place are kept."""
        if not by:
            return self.parsed.document.items
        held = self._moved
        if held is None or held[0] != by:
            # At once: another thread may look meanwhile.
            held = self._moved = (by, [moved(each, by) for each in self.parsed.document.items])
        return held[1]


ItemT = TypeVar("ItemT", bound="Item")

Placed = tuple[Part, int]
"""A part, and by how many lines it is moved."""


class Joined(Items[Any]):
    """The items of parts, one behind the other."""

    def __init__(self, parts: Sequence[Placed], by: int = 0) -> None:
        super().__init__()
        self._parts = parts
        self._by = by
        self._is_here = False

    def moved(self, by: int) -> Joined:
        """Returns the same on other lines."""
        found = Joined(self._parts, self._by + by)
        if self.start is not None:
            found.start = (self.start[0] + by, self.start[1])
            found.end = (self.end[0] + by, self.end[1])
        return found

    def parts(self) -> list[Placed]:
        """Returns the parts, and by how many lines each is moved."""
        return [(part, by + self._by) for part, by in self._parts]

    def part_at(self, line: int) -> Placed:
        """Returns the part that has a line, the first or the last where none has it."""
        behind = bisect_right(self._parts, line - self._by, key=_line)
        part, by = self._parts[max(behind - 1, 0)]
        return part, by + self._by

    def of(self, kind: type[Any]) -> list[Any]:
        """Returns the items of a class; the others are not looked at."""
        return [
            found
            for part, by in self._parts
            for at, each in enumerate(part.parsed.document.items)
            if isinstance(each, kind)
            for found in part.items(by + self._by)[at : at + 1]
        ]

    def _here(self) -> list[Any]:
        if not self._is_here:
            by = self._by
            self[:] = [each for part, at in self._parts for each in part.items(at + by)]
            self._is_here = True
        return self

    def __iter__(self) -> Iterator[Any]:
        self._here()
        return super().__iter__()

    def __len__(self) -> int:
        if self._is_here:
            return super().__len__()
        return sum(len(part.parsed.document.items) for part, _ in self._parts)

    def __getitem__(self, at: Any) -> Any:
        self._here()
        return super().__getitem__(at)

    def __reversed__(self) -> Iterator[Any]:
        self._here()
        return super().__reversed__()

    def __contains__(self, item: object) -> bool:
        self._here()
        return super().__contains__(item)

    def __eq__(self, other: object) -> bool:
        return list(self) == (list(other) if isinstance(other, list) else other)

    def __repr__(self) -> str:
        self._here()
        return super().__repr__()

    def index(self, *about: Any) -> int:
        """Returns where an item stands, as a list does."""
        self._here()
        return super().index(*about)

    __hash__ = None  # type: ignore[assignment]


class Tokens:
    """The tokens of parts, one behind the other."""

    def __init__(self, parts: Sequence[Placed]) -> None:
        self._parts = parts

    def __iter__(self) -> Iterator[Token]:
        for part, by in self._parts:
            tokens = part.parsed.tokens
            yield from (moved(each, by) for each in tokens) if by else tokens

    def backwards(self, line: int) -> Iterator[Token]:
        """Yields the tokens up to a line, the last one first."""
        for part, by in reversed(self._parts[: bisect_right(self._parts, line, key=_line)]):
            found = backwards(part.parsed.tokens, line - by)
            yield from (moved(each, by) for each in found) if by else found


def _line(placed: Placed) -> int:
    part, by = placed
    return part.line + by


def backwards(tokens: Iterable[Token], line: int) -> Iterator[Token]:
    """Yields the tokens of a text that begin up to a line, the last one first."""
    if isinstance(tokens, Tokens):
        yield from tokens.backwards(line)
    else:
        yield from (each for each in reversed(list(tokens)) if (each.line or 1) <= line)


def near(items: Sequence[Item], line: int) -> Sequence[Item]:
    """Returns the items of a list that a line may have: all where nothing tells."""
    if not isinstance(items, Joined):
        return items
    part, by = items.part_at(line)
    return part.items(by)


def chosen(items: Sequence[Item], kind: type[ItemT]) -> list[ItemT]:
    """Returns the items of a class."""
    if isinstance(items, Joined):
        return items.of(kind)
    return [each for each in items if isinstance(each, kind)]


def moved(value: Any, by: int) -> Any:
    """Returns a part of a tree on other lines."""
    if isinstance(value, Span):
        return Span(value.line + by, value.column, value.end_line + by, value.end_column)
    if isinstance(value, Token):
        places = (value.column, (value.end_line or 1) + by, value.end_column, value.end_pos)
        return Token(value.type, str(value), value.start_pos, (value.line or 1) + by, *places)
    if isinstance(value, Joined):
        return value.moved(by)
    if isinstance(value, Items):
        items: Items[Any] = Items([moved(each, by) for each in value])
        if value.start is not None:
            items.start = (value.start[0] + by, value.start[1])
            items.end = (value.end[0] + by, value.end[1])
        return items
    if isinstance(value, list | tuple):
        return type(value)(moved(each, by) for each in value)
    if is_dataclass(value) and not isinstance(value, type):
        new = object.__new__(type(value))
        for name in _names(type(value)):
            object.__setattr__(new, name, moved(getattr(value, name), by))
        return new
    return value


@cache
def _names(kind: type[Any]) -> tuple[str, ...]:
    return tuple(each.name for each in fields(kind))
