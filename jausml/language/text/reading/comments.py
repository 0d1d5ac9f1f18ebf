"""Comments, put to the items that they belong to.

A comment belongs to the item behind it, but on the last line of an item to that one. One within an
item that has no list there goes before the item. What stands before a closing bracket stays there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import (
    Item,
    SyntaxTree,
    Vector,
    documentation_text,
    is_documentation,
    lists_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from lark import Token


@dataclass(slots=True)
class _Body:
    """A list of items with the comments before its closing bracket; None where none are kept."""

    items: Sequence[Item]
    closing: list[str] | None
    start: tuple[int, int]
    end: tuple[int, int]


def attach(document: SyntaxTree, comments: Sequence[Token]) -> None:
    """Puts comments to the items of a document, and tells items that stand behind an empty line.

    Args:
        document: The document, without comments.
    """
    far = (1 << 60, 0)
    _distribute(_Body(document.items, document.closing, (1, 1), far), list(comments))


def _ordinary(comment: Token) -> str:
    """Returns a comment as it is kept: further lines as far in as they stand behind its start."""
    text = str(comment)
    if text.startswith("/**") and text[3] not in "*/":
        text = f"/*{text[3:]}"
    first, *further = (line.rstrip() for line in text.split("\n"))
    margin = (comment.column or 1) - 1
    blank = " \t"
    cut = [line[min(margin, len(line) - len(line.lstrip(blank))) :] for line in further]
    return "\n".join([first, *cut])


def _distribute(body: _Body, comments: list[Token]) -> list[Token]:
    """Puts comments to the items of a list.

    Returns:
        Those that the list has no place for.
    """
    pending = list(reversed(comments))
    line = 0
    for item in body.items:
        start, end = _start(item), _end(item)
        leading = _take(pending, start)
        inner = _take(pending, end)
        _lead(item, leading, line)
        line = end[0]
        for comment in _within(item, inner):
            item.comments.append(_ordinary(comment))
        while pending and pending[-1].line == pending[-1].end_line == end[0]:
            item.trailing = f"{item.trailing} {_ordinary(pending.pop())}".lstrip()
    rest = list(reversed(pending))
    if body.closing is None:
        return rest
    for comment in rest:
        if line and (comment.line or 1) > line + 1:
            body.closing.append("")
        body.closing.append(_ordinary(comment))
        line = comment.end_line or 1
    return []


def _take(pending: list[Token], end: tuple[int, int]) -> list[Token]:
    """Takes the comments before a position from a reversed list."""
    taken = []
    while pending and _position(pending[-1]) < end:
        taken.append(pending.pop())
    return taken


def _lead(item: Item, comments: Sequence[Token], line: int) -> None:
    """Puts the comments before an item to it.

    Args:
        line: Where the item before it ends; 0 for the first.
    """
    first = (comments[0].line if comments else item.span.line) or 1
    item.spaced = bool(line) and first > line + 1
    documenting = next((each for each in reversed(comments) if is_documentation(each)), None)
    line = first
    for comment in comments:
        _keep_empty_line(item, line, comment.line or 1)
        line = comment.end_line or 1
        if comment is documenting:
            item.documentation = documentation_text(comment)
        else:
            item.comments.append(_ordinary(comment))
    if comments and comments[-1] is not documenting:
        _keep_empty_line(item, line, item.span.line)


def _keep_empty_line(item: Item, line: int, next_line: int) -> None:
    if next_line > line + 1 and item.comments and item.comments[-1]:
        item.comments.append("")


def _within(item: Item, comments: list[Token]) -> list[Token]:
    """Puts comments to what an item consists of.

    Returns:
        Those that stand between its parts.
    """
    for body in _bodies(item):
        before = [each for each in comments if _position(each) < body.start]
        inside = [each for each in comments if body.start <= _position(each) < body.end]
        behind = comments[len(before) + len(inside) :]
        comments = before + _distribute(body, inside) + behind
    return comments


def _bodies(item: Item) -> Iterator[_Body]:
    """Yields the lists of an item, from the first to the last."""
    for items, closing in lists_of(item):
        if isinstance(items, Items) and items.start is not None:
            start = items.start
            if isinstance(item, Vector) and items is item.expected and item.given:
                # What stands before the arrow, on lines of its own, is about what stands behind it.
                start = _end(item.given[-1])
            yield _Body(items, closing, start, items.end)


def _position(token: Token) -> tuple[int, int]:
    return (token.line or 1, token.column or 1)


def _start(item: Item) -> tuple[int, int]:
    return (item.span.line, item.span.column)


def _end(item: Item) -> tuple[int, int]:
    return (item.span.end_line, item.span.end_column)
