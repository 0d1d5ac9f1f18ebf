"""What is found in a user's file that does not fit the model."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.generation.contract.edits import Edit


class FindingKind(Enum):
    """What is wrong with a user's file."""

    MISSING = "missing-method"
    ORPHAN = "orphan-method"
    SIGNATURE = "signature-differs"
    RENAMED = "renamed-method"
    NO_CLASS = "missing-class"
    NO_BASE = "missing-base"
    IMPORT = "lost-import"
    USE = "lost-use"
    SYNTAX = "syntax-error"


@dataclass(frozen=True)
class Finding:
    """One difference between a user's file and the model.

    Attributes:
        path: The file, relative to the output folder.
        line: Line in the file, from 1.
        stub: Ready text of the method that the model expects, or empty.
        column: Column in the line, from 1; 0 where the whole line is meant.
        is_fatal: Whether the program ends or raises there.
        edits: What makes the file fit for certain; empty when that is for the user to decide.
    """

    kind: FindingKind
    path: str
    line: int
    message: str
    stub: str = ""
    column: int = 0
    is_fatal: bool = False
    edits: tuple[Edit, ...] = ()

    @property
    def severity(self) -> str:
        """`error`, `warning` or `info`."""
        if self.is_fatal:
            return "error"
        return "info" if self.kind is FindingKind.MISSING else "warning"
