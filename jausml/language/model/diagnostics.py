"""Diagnostics: findings with a stable rule id, at a place in a file."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Severity(Enum):
    """The gravity of a finding."""

    ERROR = "error"
    """The model cannot be used."""
    WARNING = "warning"
    """The model can be used, but hardly means what it says."""
    INFO = "info"
    """Worth knowing."""


@dataclass(frozen=True, order=True, slots=True)
class Location:
    """A place in a file; lines and columns, in characters, are counted from 1."""

    path: str
    line: int = 1
    column: int = 1

    def __str__(self) -> str:
        return f"{self.path}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Related:
    """A second place that explains a finding, such as the other holder of a duplicate id."""

    location: Location
    message: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding about a model.

    Attributes:
        unread: The features of the element whose values could not be read; None where it may be any
            of them, or where the finding is not one of a reader.
    """

    rule: str
    severity: Severity
    location: Location
    message: str
    hint: str = ""
    element: str = ""
    fragment: str = ""
    related: tuple[Related, ...] = ()
    unread: frozenset[str] | None = None

    @property
    def sort_key(self) -> tuple[str, int, int, str, str]:
        """Path, line, column, rule and message: the order in which findings are shown."""
        place = self.location
        return (place.path, place.line, place.column, self.rule, self.message)

    def __lt__(self, other: Diagnostic) -> bool:
        return self.sort_key < other.sort_key

    def __str__(self) -> str:
        text = f"{self.location}: {self.severity.value}: {self.rule} {self.message}"
        return f"{text} ({self.hint})" if self.hint else text
