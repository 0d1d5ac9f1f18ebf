"""Findings in a user's file that does not fit the model, and the fixes that are certain."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import groupby
from pathlib import Path

from jausml.generation.contract.interface import module_of
from jausml.generation.contract.symbols import Module
from jausml.generation.contract.syntax import last_name
from jausml.generation.writer import replace_file
from jausml.language.model.diagnostics import Diagnostic, Location, RuleInfo, Severity
from jausml.language.model.files import read_input


class FindingKind(Enum):
    """Kinds of faults in a user's file, by the rule that reports them."""

    SYNTAX = "JML902"
    NO_CLASS = "JML903"
    NO_BASE = "JML904"
    IMPORT = "JML905"
    USE = "JML906"
    SIGNATURE = "JML907"
    ORPHAN = "JML908"
    RENAMED = "JML909"
    MISSING = "JML910"


STALE = "JML901"
"""The rule of files that are not what the model makes of them."""

CODE_RULES: Mapping[str, RuleInfo] = {
    STALE: RuleInfo(
        "code: generated file out of date",
        "A generated file is not there, is not what the model makes of it, or was edited by hand. "
        "Good: `jausml generate`, and commit what it writes.",
    ),
    FindingKind.SYNTAX.value: RuleInfo(
        "code: file that is no Python",
        "A file of yours cannot be read or parsed, so nothing is known of it.",
    ),
    FindingKind.NO_CLASS.value: RuleInfo(
        "code: class that is missing",
        "The program makes an object of the class of your skeleton, which the file does not have. "
        "Good: give the class its name again, or delete the file, and generate.",
    ),
    FindingKind.NO_BASE.value: RuleInfo(
        "code: class without its base",
        "The class of your skeleton derives from no generated base, so nothing calls its handlers. "
        "Bad: `class Boom:`. Good: `class Boom(BoomBase):`.",
        Severity.WARNING,
    ),
    FindingKind.IMPORT.value: RuleInfo(
        "code: import of what is not there",
        "A file of yours imports a name or module that the generated code does not have, so the "
        "program ends with an ImportError. It is a warning where type checkers alone read it.",
    ),
    FindingKind.USE.value: RuleInfo(
        "code: use of what is not there",
        "A file of yours uses an enumerator, field, class, method or parameter that the generated "
        "code does not have, so the line raises an exception. It is a warning where type checkers "
        "alone read it.",
    ),
    FindingKind.SIGNATURE.value: RuleInfo(
        "code: handler with other parameters",
        "The generated base calls a handler of yours with other parameters, or in another order. "
        "Bad: `def on_stop(self):`. Good: `def on_stop(self, message, sender):`.",
    ),
    FindingKind.ORPHAN.value: RuleInfo(
        "code: handler that nothing calls",
        "A handler of yours has the name of an element that the model does not have any more. What "
        "it does is not done: a stop that nobody calls stops nothing.",
        Severity.WARNING,
    ),
    FindingKind.RENAMED.value: RuleInfo(
        "code: handler that is called by another name",
        "The element of a handler has been renamed, and the base calls the handler by its new "
        "name. With a question mark, it is only likely.",
        Severity.WARNING,
    ),
    FindingKind.MISSING.value: RuleInfo(
        "code: handler that is not defined",
        "The base has a default for a handler that your class does not define.",
        Severity.INFO,
    ),
}
"""The rules of users' files and of generated ones by id."""


@dataclass(frozen=True)
class Finding:
    """One difference between a user's file and the model.

    Attributes:
        stub: Ready text of the method that the model expects, or empty.
        column: Column in the line, in characters from 1.
        is_fatal: Whether the program ends or raises there.
        edits: What makes the file fit for certain; empty when that is for the user to decide.
    """

    kind: FindingKind
    path: str
    line: int
    message: str
    stub: str = ""
    column: int = 1
    is_fatal: bool = False
    edits: tuple[Edit, ...] = ()

    @property
    def severity(self) -> Severity:
        """The gravity: an error where the program ends or raises."""
        if self.is_fatal:
            return Severity.ERROR
        return Severity.INFO if self.kind is FindingKind.MISSING else Severity.WARNING

    def diagnostic(self, out: Path) -> Diagnostic:
        """Returns the finding as a diagnostic of a file in a folder."""
        place = Location(str(out / self.path), self.line, self.column)
        return Diagnostic(self.kind.value, self.severity, place, self.message)


@dataclass(frozen=True)
class Fix:
    """An edit that was made."""

    path: str
    edit: Edit


def fix_files(out: Path, findings: Sequence[Finding]) -> list[Fix]:
    """Makes the edits of findings, and returns them; a file that they do not fit stays."""
    fixed: list[Fix] = []
    for path, path_findings in groupby(
        sorted(findings, key=lambda finding: finding.path), key=lambda finding: finding.path
    ):
        edits = sorted({edit for finding in path_findings for edit in finding.edits})
        data = read_input(out / path) if edits else b""
        new = edited(data, edits) if edits else None
        if new is not None and new != data:
            replace_file(out, path, data, new)
            fixed += [Fix(path, edit) for edit in edits]
    return fixed


_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")


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
        # Alone on its lines, the statement takes its line end along.
        if not is_alone and not before.strip() and not after.strip():
            edit = text.replaced((start[0], 0), (end[0] + 1, 0), "")
        # Comments, and what shares the last line, are left to the user.
        return () if "#" in edit.old or (not is_alone and edit.end) else (edit,)
    edits = []
    last = max(
        position
        for position, imported_name in enumerate(statement.names)
        if imported_name not in unused
    )
    for index, alias in enumerate(statement.names):
        if alias in unused and index < last:
            edits.append(text.replaced(_start(alias), _start(statement.names[index + 1]), ""))
    if last + 1 < len(statement.names):
        edits.append(text.replaced(_end(statement.names[last]), _end(statement.names[-1]), ""))
    return () if any("#" in cut.old for cut in edits) else tuple(edits)


def edited(data: bytes, edits: Iterable[Edit]) -> bytes | None:
    """Returns the bytes of a file after edits; None when one of them does not fit any more."""
    text = Lines(data)
    if not text.is_exact:
        return None
    lines, former = text.lines, (len(text.lines) + 1, 0)
    # From the end to the beginning, so that the places before stay right.
    for edit in sorted(set(edits), reverse=True):
        if (edit.end_line, edit.end) > former:
            return None
        former = (edit.line, edit.start)
        if text.between(former, (edit.end_line, edit.end)) != edit.old:
            return None
        first = lines[edit.line - 1].encode()[: edit.start]
        rest = lines[edit.end_line - 1].encode()[edit.end :] if edit.end_line <= len(lines) else b""
        lines[edit.line - 1 : edit.end_line] = [(first + edit.new.encode() + rest).decode()]
    try:
        result = text.encoded(lines)
        # A file that is no Python any more is worse than the finding.
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
            # detect_encoding knows line feeds alone.
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
        """Returns the text from one place to another."""
        taken = [line.encode() for line in self.lines[start[0] - 1 : end[0]]]
        if end[0] == start[0] + len(taken) - 1:
            taken[-1] = taken[-1][: end[1]]
        if taken:
            taken[0] = taken[0][start[1] :]
        return b"".join(taken).decode(errors="replace")

    def around(self, start: tuple[int, int], end: tuple[int, int]) -> tuple[str, str]:
        """Returns the texts before and after two places in their lines."""
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
        """The module of the file; its name is empty outside of packages."""
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
        return frozenset(node.id for node in self.nodes if isinstance(node, ast.Name))

    @cached_property
    def stored(self) -> frozenset[str]:
        """The attributes that are set of whatever object."""
        attributes = (node for node in self.nodes if isinstance(node, ast.Attribute))
        return frozenset(
            attribute.attr for attribute in attributes if isinstance(attribute.ctx, ast.Store)
        )

    @cached_property
    def derived(self) -> frozenset[str]:
        """The names of classes from which others derive."""
        classes = (node for node in self.nodes if isinstance(node, ast.ClassDef))
        return frozenset(last_name(base) for definition in classes for base in definition.bases)

    @cached_property
    def asked(self) -> frozenset[str]:
        """The attributes that are asked for or set by a text, as by `getattr`."""
        return frozenset(
            argument.value
            for node in self.nodes
            if isinstance(node, ast.Call) and last_name(node) in _BY_TEXT
            for argument in node.args
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
        )

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of texts, docstrings left out."""
        return frozenset(word for text in self._texts() for word in re.findall(r"\w+", text))

    def _texts(self) -> Iterator[str]:
        documentation = {
            node.value
            for node in self.nodes
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        }
        for node in self.nodes:
            match node:
                case ast.Constant(value=str(text)) if node not in documentation:
                    yield text

    def is_alone(self, statement: ast.stmt) -> bool:
        """Tells whether a block would be empty without a statement."""
        for node in self.nodes:
            if isinstance(node, ast.Module):
                continue
            for block in _BLOCKS:
                if getattr(node, block, None) == [statement]:
                    return True
        return False
