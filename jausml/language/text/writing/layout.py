"""Layout of the syntax tree as text: one way to write each tree, comments and all.

One item stands on a line, four spaces further in than what it is part of. Features, members, pairs
and values share the line of their item while they fit and nothing in them has a comment; elements
and assignments do not. One empty line is kept where the text has any.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from jausml.language.text import tree
from jausml.language.text.writing.spelling import documentation, feature_name, path, quoted, word

WIDTH = 100
"""Columns within which a list may stand on the line of its item."""

_INDENT = "    "
_SPACE = "  "
_SHORT = (tree.Feature, tree.Member, tree.Entry, tree.VectorEntry)
_BOUNDED = re.compile(r"(.+)<=(\d+)")


def lay_out(document: tree.SyntaxTree) -> str:
    """Returns a document as text."""
    lines = _list(document.items, document.closing, WIDTH)
    return "".join(f"{line}\n" for line in lines)


def _list(items: Sequence[tree.Item], closing: Sequence[str], room: int) -> list[str]:
    """Returns the lines of a list of items."""
    return _stacked(items, [_lines(item, room) for item in items], closing, room)


def _stacked(
    items: Sequence[tree.Item], laid_out: Sequence[list[str]], closing: Sequence[str], room: int
) -> list[str]:
    """Returns the lines of items, one below the other, with their comments."""
    lines: list[str] = []
    for item, own_lines in zip(items, laid_out, strict=True):
        if item.spaced and lines:
            lines.append("")
        lines += _comments(item.comments)
        if item.documentation:
            lines += documentation(item.documentation, room)
        lines += own_lines
        if item.trailing:
            lines[-1] += f"  {item.trailing}"
    return lines + _comments(closing)


def _comments(comments: Sequence[str]) -> list[str]:
    return [line for comment in comments for line in comment.split("\n")]


def _lines(item: tree.Item, room: int) -> list[str]:
    """Returns the lines of an item without its comments."""
    return _LAYOUTS[type(item)](item, room)


def _bracketed(
    head: str, brackets: str, items: Sequence[tree.Item], closing: Sequence[str], room: int
) -> list[str]:
    """Returns the lines of a list in brackets, with what stands before it."""
    opening, end = brackets[0], brackets[1]
    if not items and not closing:
        return [f"{head}{opening}{end}"]
    laid_out = [_lines(item, room - len(_INDENT)) for item in items]
    # A comment before the closing bracket needs a line of its own.
    if not closing and _can_share_line(items, laid_out):
        short = f"{head}{opening} {_SPACE.join(lines[0] for lines in laid_out)} {end}"
        if len(short) <= room:
            return [short]
    inner = _stacked(items, laid_out, closing, room - len(_INDENT))
    return [f"{head}{opening}", *_indented(inner), end]


def _can_share_line(items: Sequence[tree.Item], laid_out: Sequence[list[str]]) -> bool:
    """Tells whether items can share a line: short ones without comments."""
    return all(
        isinstance(item, _SHORT) and len(lines) == 1 and not _needs_line(item)
        for item, lines in zip(items, laid_out, strict=True)
    )


def _needs_line(item: tree.Item) -> bool:
    """Tells whether an item needs its own line: it has comments, or no name at its end."""
    if isinstance(item, tree.Member) and item.name is None:
        return True
    return bool(item.documentation or item.comments or item.trailing or item.spaced)


def _indented(lines: Sequence[str]) -> list[str]:
    return [_INDENT + line if line else line for line in lines]


def _import(item: tree.Import, room: int) -> list[str]:
    return [f"import {_value(item.target, room)[0]}"]


def _element(element: tree.Element, room: int) -> list[str]:
    names = [word(name.text) for name in (element.keyword, element.name) if name is not None]
    if len(names) > 1 and not element.items and not element.closing:
        return [" ".join(names)]
    return _bracketed(f"{' '.join(names)} ", "{}", element.items, element.closing, room)


def _feature(feature: tree.Feature, room: int) -> list[str]:
    """Returns the lines of a feature; values that do not fit go on in the next line."""
    lines = [f"{feature_name(feature.name.text)}:"]
    for value in feature.values:
        first, *further = _value(value, room)
        is_first = value is feature.values[0]
        lines[-1] += "" if is_first else ","
        if is_first or len(lines[-1]) + len(first) + len(" ,") <= room:
            lines[-1] += f" {first}"
        else:
            lines.append(f"{_INDENT}{first}")
        lines += further
    return lines


def _value(
    value: tree.Name | tree.Number | tree.Text | tree.Href | tree.Clock | tree.Element, room: int
) -> list[str]:
    """Returns the lines of a value; a block alone can have several."""
    if isinstance(value, tree.Element):
        names = [word(name.text) for name in (value.keyword, value.name) if name is not None]
        head = "".join(f"{part} " for part in (["new", *names] if names else []))
        return _bracketed(head, "{}", value.items, value.closing, room)
    return [simple(value)]


def simple(value: tree.Name | tree.Number | tree.Text | tree.Href | tree.Clock) -> str:
    """Returns a value without a block as it is written."""
    if isinstance(value, tree.Name):
        return path(value.text)
    if isinstance(value, tree.Number):
        return value.text
    if isinstance(value, tree.Text):
        return quoted(value.text)
    return f"@{quoted(value.text)}" if isinstance(value, tree.Href) else "clock"


def _member(member: tree.Member, room: int) -> list[str]:
    rest = f" [{_size(member.size)}]" if member.size else ""
    if member.name is not None:
        rest += f" {word(member.name.text)}"
    if isinstance(member.type, list):
        lines = _bracketed("struct ", "[]", member.type, (), room - len(rest))
        lines[-1] += rest
    else:
        lines = [_type(member.type.text) + rest]
    return _with_features(lines, member.features, room)


def _type(text: str) -> str:
    bounded = _BOUNDED.fullmatch(text)
    return f"{word(bounded.group(1))}<={bounded.group(2)}" if bounded else word(text)


def _size(size: str) -> str:
    if size == tree.UNBOUNDED:
        return ""
    return size if size.removeprefix("<=").isdecimal() else word(size)


def _end(end: tree.End, room: int) -> list[str]:
    lines = [f"{'JAUS' if end.is_jaus else 'ROS'} {word(end.type.text)}"]
    if end.members is not None:
        lines = _bracketed(f"{lines[0]} ", "()", end.members, (), room)
    return _with_features(lines, end.features, room)


def _with_features(lines: list[str], features: Sequence[tree.Feature], room: int) -> list[str]:
    """Appends a block of features to lines."""
    if not features:
        return lines
    return [*lines[:-1], *_bracketed(f"{lines[-1]} ", "{}", features, (), room)]


def _direction(direction: tree.Direction, room: int) -> list[str]:
    head = f"{_shown_way(direction)} "
    return _bracketed(head, "()", direction.assignments, direction.closing, room)


def _shown_way(item: tree.Direction | tree.Vector) -> str:
    """Returns the arrow of a direction or of a test vector."""
    return "JAUS->ROS" if item.to_ros else "ROS->JAUS"


def _assignment(assignment: tree.Assignment, room: int) -> list[str]:
    sources = ", ".join(map(simple, assignment.sources))
    head = f"{sources} -> {', '.join(map(simple, assignment.targets))}"
    if assignment.conversions:
        head += f" : {', '.join(map(_shown_call, assignment.conversions))}"
    if not assignment.items and not assignment.closing:
        return [head]
    return _bracketed(f"{head} ", "{}", assignment.items, assignment.closing, room)


def _shown_call(call: tree.Call) -> str:
    """Returns a conversion as it is written."""
    arguments = ", ".join(map(simple, call.arguments))
    return f"{word(call.name.text)}({arguments})" if call.arguments else word(call.name.text)


def _ignored(ignored: tree.Ignored, room: int) -> list[str]:  # noqa: ARG001 - it always fits
    return [f"ignore {path(ignored.target.text)}"]


def _table(table: tree.Table, room: int) -> list[str]:
    return _bracketed(f"table {word(table.name.text)} ", "()", table.entries, table.closing, room)


def _entry(entry: tree.Entry, room: int) -> list[str]:  # noqa: ARG001 - it always fits
    return [f"{simple(entry.jaus)} <-> {simple(entry.ros)}"]


def _vector(vector: tree.Vector, room: int) -> list[str]:
    head = f"vector {word(vector.name.text)} {_shown_way(vector)} ("
    inner = room - len(_INDENT)
    inputs = [_lines(entry, inner) for entry in vector.given]
    expected = [_lines(entry, inner) for entry in vector.expected]
    entries = [*vector.given, *vector.expected]
    if not vector.closing and _can_share_line(entries, [*inputs, *expected]):
        sides = [_SPACE.join(lines[0] for lines in side) for side in (inputs, expected)]
        short = " ".join(part for part in (head, sides[0], "=>", sides[1], ")") if part)
        if len(short) <= room:
            return [short]
    lines = [*_stacked(vector.given, inputs, (), inner), "=>"]
    lines += _stacked(vector.expected, expected, vector.closing, inner)
    return [head, *_indented(lines), ")"]


def _vector_entry(entry: tree.VectorEntry, room: int) -> list[str]:  # noqa: ARG001 - it always fits
    tolerance = f" ~ {entry.tolerance.text}" if entry.tolerance is not None else ""
    return [f"{path(entry.path.text)} = {simple(entry.value)}{tolerance}"]


_LAYOUTS: dict[type[tree.Item], Callable[[Any, int], list[str]]] = {
    tree.Import: _import,
    tree.Element: _element,
    tree.Feature: _feature,
    tree.Member: _member,
    tree.End: _end,
    tree.Direction: _direction,
    tree.Assignment: _assignment,
    tree.Ignored: _ignored,
    tree.Table: _table,
    tree.Entry: _entry,
    tree.Vector: _vector,
    tree.VectorEntry: _vector_entry,
}

_MUCH = 5  # values from which on a block stands apart


def space(items: Sequence[tree.Item]) -> None:
    """Sets apart what says much, and the elements that follow values."""
    for before, item in pairwise(items):
        # A block of few values that follows a single one reads as part of it.
        follows_values = isinstance(before, tree.Feature) and _values(before) == 1
        if follows_values and (isinstance(item, tree.Feature) or not _says_much(item)):
            item.spaced = bool(item.documentation)
        else:
            item.spaced = _says_much(before) or _says_much(item)


def space_document(items: Sequence[tree.Item]) -> None:
    """Sets all that stands on top level apart, but not imports from each other."""
    for before, item in pairwise(items):
        item.spaced = not (isinstance(before, tree.Import) and isinstance(item, tree.Import))


def _says_much(item: tree.Item) -> bool:
    return _values(item) >= _MUCH


def _values(item: tree.Item) -> int:
    """Returns how many values an item holds, roughly the lines that it takes."""
    if isinstance(item, tree.Element):
        return 1 + sum(map(_values, item.items))
    if isinstance(item, tree.Feature):
        return sum(
            _values(value) if isinstance(value, tree.Element) else 1 for value in item.values[:1]
        )
    return _MUCH if isinstance(item, tree.Direction) else 1
