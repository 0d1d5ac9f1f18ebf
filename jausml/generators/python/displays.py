"""Nested calls and tuples laid out as ruff's formatter lays them out."""

from __future__ import annotations

from dataclasses import dataclass

from jausml.generation.literals import LINE_WIDTH

_INDENT = "    "


@dataclass(frozen=True)
class Display:
    """A call or a tuple of expressions.

    Attributes:
        opening: Text up to and with the bracket, e.g. `State(` or `do=(`.
        items: What stands between the brackets.
        is_tuple: Whether it is a tuple, which keeps its comma and never shares lines.
    """

    opening: str
    items: tuple[str | Display, ...]
    is_tuple: bool = False

    def __str__(self) -> str:
        comma = "," if self.is_tuple and len(self.items) == 1 else ""
        return f"{self.opening}{', '.join(map(str, self.items))}{comma})"


def call(function: str, *items: str | Display) -> Display:
    """Returns a call.

    Args:
        function: What is called.
        *items: The arguments.
    """
    return Display(f"{function}(", items)


def tuple_of(before: str, *items: str | Display) -> Display:
    """Returns a tuple.

    Args:
        before: Text before it, e.g. `do=`.
        *items: Its items.
    """
    return Display(f"{before}(", items, is_tuple=True)


def lines(item: str | Display, column: int, before: str = "", after: str = "") -> list[str]:
    """Returns the lines of an expression.

    Args:
        item: The expression.
        column: Column at which it will stand; the lines themselves begin at 0.
        before: Text before it, e.g. `return `.
        after: Text after it, e.g. a comma.
    """
    line = f"{before}{item}{after}"
    if isinstance(item, str) or len(line) + column <= LINE_WIDTH or not item.items:
        return [line]
    inner = column + len(_INDENT)
    together = ", ".join(map(str, item.items))
    if not item.is_tuple and len(together) + inner <= LINE_WIDTH:
        return [f"{before}{item.opening}", f"{_INDENT}{together}", f"){after}"]
    found = [f"{before}{item.opening}"]
    for each in item.items:
        found += [_INDENT + text for text in lines(each, inner, "", ",")]
    return [*found, f"){after}"]
