"""What is found in a user's file that does not fit the model, and the fixes that are certain."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import groupby
from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.generation.contract.files import Edit, edited
from jausml.generation.writer import replace_file
from jausml.language.model.diagnostics import Diagnostic, Location, RuleInfo, Severity
from jausml.language.model.inputs import read_input

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


class FindingKind(Enum):
    """What is wrong with a user's file, by the rule that says so."""

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

_RULES = {
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

CODE_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
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
        """Returns the finding as reports have it, its file being in a folder."""
        place = Location(str(out / self.path), self.line, self.column)
        return Diagnostic(self.kind.value, self.severity, place, self.message)


@dataclass(frozen=True)
class Fix:
    """An edit that was made."""

    path: str
    edit: Edit


def fix_files(out: Path, findings: Sequence[Finding]) -> list[Fix]:
    """Makes the edits of findings, and returns them; a file in which they do not fit stays."""
    fixed: list[Fix] = []
    for path, found in groupby(sorted(findings, key=lambda f: f.path), key=lambda f: f.path):
        edits = sorted({edit for finding in found for edit in finding.edits})
        data = read_input(out / path) if edits else b""
        new = edited(data, edits) if edits else None
        if new is not None and new != data:
            replace_file(out, path, data, new)
            fixed += [Fix(path, edit) for edit in edits]
    return fixed
