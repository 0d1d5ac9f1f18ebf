"""Files of the user: what they are, what their text mentions, and exact edits of it."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.generation.contract.interface import module_of
from jausml.generation.contract.scopes import last_name
from jausml.generation.contract.symbols import Module

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
_BOM = "\N{ZERO WIDTH NO-BREAK SPACE}"


@dataclass(frozen=True, order=True)
class Edit:
    """Text that takes the place of another.

    Attributes:
        line: Line of the first character, from 1.
        start: Its offset in the line in bytes of UTF-8, as syntax trees have it.
        end_line: Line of the first character that stays.
        end: Its offset.
    """

    line: int
    start: int
    end_line: int
    end: int
    old: str
    new: str


def name_edit(line: int, start: int, old: str, new: str) -> Edit:
    """Returns the edit that replaces a name."""
    return Edit(line, start, line, start + len(old.encode()), old, new)


def attribute_edit(node: ast.Attribute, new: str) -> Edit:
    """Returns the edit that replaces the name of an attribute."""
    end = node.end_col_offset or 0
    return name_edit(node.end_lineno or node.lineno, end - len(node.attr.encode()), node.attr, new)


def removal(
    text: Lines, statement: ast.ImportFrom, unused: Sequence[ast.alias], *, is_alone: bool
) -> tuple[Edit, ...]:
    """Returns edits that take names out of an import; none where a comment would go with them."""
    if not unused or not text.is_exact:
        return ()
    if len(unused) == len(statement.names):
        start, end = _start(statement), _end(statement)
        edit = text.replaced(start, end, "pass" if is_alone else "")
        before, after = text.around(start, end)
        if not is_alone and not before.strip() and not after.strip():
            edit = text.replaced((start[0], 0), (end[0] + 1, 0), "")
        return () if "#" in edit.old or (not is_alone and edit.end) else (edit,)
    edits = []
    last = max(i for i, each in enumerate(statement.names) if each not in unused)
    for index, alias in enumerate(statement.names):
        if alias in unused and index < last:
            edits.append(text.replaced(_start(alias), _start(statement.names[index + 1]), ""))
    if last + 1 < len(statement.names):
        edits.append(text.replaced(_end(statement.names[last]), _end(statement.names[-1]), ""))
    return () if any("#" in each.old for each in edits) else tuple(edits)


def edited(data: bytes, edits: Iterable[Edit]) -> bytes | None:
    """Returns the bytes of a file after edits; None when one of them does not fit any more."""
    text = Lines(data)
    if not text.is_exact:
        return None
    lines, former = text.lines, (len(text.lines) + 1, 0)
    for each in sorted(set(edits), reverse=True):
        if (each.end_line, each.end) > former:
            return None
        former = (each.line, each.start)
        if text.between(former, (each.end_line, each.end)) != each.old:
            return None
        first = lines[each.line - 1].encode()[: each.start]
        rest = lines[each.end_line - 1].encode()[each.end :] if each.end_line <= len(lines) else b""
        lines[each.line - 1 : each.end_line] = [(first + each.new.encode() + rest).decode()]
    try:
        result = text.encoded(lines)
        ast.parse(result)
    except (SyntaxError, ValueError):
        return None
    return result


class Lines:
    """The lines of a file, as Python counts them.

    Attributes:
        is_exact: Whether the lines say all that the bytes say.
    """

    def __init__(self, data: bytes) -> None:
        try:
            first = io.BytesIO(data.replace(b"\r", b"\n"))
            self._encoding, _ = tokenize.detect_encoding(first.readline)
            self.lines = _LINE.findall(data.decode(self._encoding))
            self.is_exact = self.encoded(self.lines) == data
        except (SyntaxError, ValueError, LookupError):
            self.lines, self.is_exact = [], False

    def encoded(self, lines: Sequence[str]) -> bytes:
        """Returns the bytes of lines in the encoding of the file."""
        return "".join(lines).encode(self._encoding)

    def column(self, line: int, offset: int) -> int:
        """Returns a column in characters, from 1, of an offset in bytes of UTF-8."""
        text = "".join(self.lines[line - 1 : line]).encode()
        return len(text[:offset].decode(errors="replace")) + 1 if text else offset + 1

    def between(self, start: tuple[int, int], end: tuple[int, int]) -> str:
        """Returns what stands from one place to another."""
        taken = [each.encode() for each in self.lines[start[0] - 1 : end[0]]]
        if end[0] == start[0] + len(taken) - 1:
            taken[-1] = taken[-1][: end[1]]
        if taken:
            taken[0] = taken[0][start[1] :]
        return b"".join(taken).decode(errors="replace")

    def around(self, start: tuple[int, int], end: tuple[int, int]) -> tuple[str, str]:
        """Returns what stands before and after two places in their lines."""
        before = self.lines[start[0] - 1].encode()[: start[1]]
        return before.decode(), self.lines[end[0] - 1].encode()[end[1] :].decode()

    def replaced(self, start: tuple[int, int], end: tuple[int, int], new: str) -> Edit:
        """Returns the edit that puts a text between two places."""
        return Edit(*start, *end, self.between(start, end), new)


def _start(node: ast.stmt | ast.alias) -> tuple[int, int]:
    return node.lineno, node.col_offset


def _end(node: ast.stmt | ast.alias) -> tuple[int, int]:
    return node.end_lineno or node.lineno, node.end_col_offset or 0


_BY_TEXT = ("getattr", "hasattr", "setattr", "delattr")
_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")


@dataclass(frozen=True)
class File:
    """A file of the user."""

    path: str
    data: bytes
    tree: ast.Module

    @cached_property
    def module(self) -> Module:
        """The module that it is; its name is empty outside of packages."""
        is_package = self.path.endswith("/__init__.py")
        return Module(module_of(self.path), self.tree, is_package, is_generated=False)

    @cached_property
    def lines(self) -> Lines:
        """Its lines."""
        return Lines(self.data)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        """All nodes of its tree."""
        return list(ast.walk(self.tree))

    @cached_property
    def names(self) -> frozenset[str]:
        """The names that are read, written or deleted; an import is no mention."""
        return frozenset(each.id for each in self.nodes if isinstance(each, ast.Name))

    @cached_property
    def stored(self) -> frozenset[str]:
        """The attributes that are set of whatever object."""
        attributes = (each for each in self.nodes if isinstance(each, ast.Attribute))
        return frozenset(each.attr for each in attributes if isinstance(each.ctx, ast.Store))

    @cached_property
    def derived(self) -> frozenset[str]:
        """The names of classes from which others derive."""
        classes = (each for each in self.nodes if isinstance(each, ast.ClassDef))
        return frozenset(last_name(base) for each in classes for base in each.bases)

    @cached_property
    def asked(self) -> frozenset[str]:
        """The attributes that are asked for or set by a text, as by `getattr`."""
        return frozenset(
            argument.value
            for each in self.nodes
            if isinstance(each, ast.Call) and last_name(each) in _BY_TEXT
            for argument in each.args
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
        )

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of texts, docstrings left out."""
        return frozenset(word for text in self._texts() for word in re.findall(r"\w+", text))

    def _texts(self) -> Iterator[str]:
        documentation = {
            each.value
            for each in self.nodes
            if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant)
        }
        for each in self.nodes:
            match each:
                case ast.Constant(value=str(text)) if each not in documentation:
                    yield text

    def is_alone(self, statement: ast.stmt) -> bool:
        """Tells whether a block would be empty without a statement."""
        for each in self.nodes:
            if isinstance(each, ast.Module):
                continue
            for block in _BLOCKS:
                if getattr(each, block, None) == [statement]:
                    return True
        return False
