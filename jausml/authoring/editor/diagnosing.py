"""Diagnostics of a text: its syntax at once, all the rest when it was read as a model."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editor.workbench import parsed_text
from jausml.language.model.diagnostics import Severity
from jausml.language.text.tree import Span

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.authoring.editor.workbench import Workbench

_WORD = re.compile(r"[^\s,(){}\[\]]+|.")


@dataclass(frozen=True, slots=True)
class Problem:
    """Something that is wrong with a text."""

    span: Span
    severity: Severity
    rule: str
    message: str


def syntax_problems(text: str) -> list[Problem]:
    """Returns the syntax errors of a text."""
    return [
        Problem(each.span, Severity.ERROR, "JML701", _with_hint(each.message, each.hint))
        for each in parsed_text(text).faults
    ]


def all_problems(bench: Workbench, path: Path) -> list[Problem]:
    """Reads an open text as a model and returns all that is wrong with it."""
    lines = bench.text(path).split("\n")
    return [
        Problem(
            _span(lines, each.location.line, each.location.column),
            each.severity,
            each.rule,
            _with_hint(each.message, each.hint),
        )
        for each in bench.findings(path)
    ]


def _with_hint(message: str, hint: str) -> str:
    return f"{message} ({hint})" if hint else message


def _span(lines: list[str], line: int, column: int) -> Span:
    """Returns the word at a place, for a finding tells only where it begins."""
    text = lines[line - 1] if line <= len(lines) else ""
    word = _WORD.match(text, column - 1)
    return Span(line, column, line, word.end() + 1 if word is not None else column)
