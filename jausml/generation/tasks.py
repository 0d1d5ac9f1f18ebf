"""Tasks: what a target wants to have made, as data.

A target returns tasks; rendering carries them out.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeAlias, TypeVar

from jausml.generation.artifact import Kind, SkeletonContract

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from jausml.generation.languages.python import Imports


class View(Protocol):
    """What a target's views module offers about one model element.

    A template asks it (as `view`) and computes nothing.
    """

    @property
    def element_id(self) -> str:
        """Identity of the model element, e.g. `component:vehicle`."""

    @property
    def source(self) -> str:
        """Model file it comes from, relative path."""


ViewT = TypeVar("ViewT", bound=View)


@dataclass(frozen=True)
class FileTask(Generic[ViewT]):
    """One file for each view, made from a template.

    Attributes:
        path: Path of the file for a view, relative to the output folder.
        imports: For Python, what a file may import; its template has no import statements then.
        words: For Python, names in which functions and methods of a file may differ alone; where
            it has many that do, it is made faster.
    """

    template: str
    views: Sequence[ViewT]
    path: Callable[[ViewT], str]
    _: KW_ONLY
    kind: Kind = Kind.GENERATED
    executable: bool = False
    contract: Callable[[ViewT], SkeletonContract] | None = None
    imports: Callable[[ViewT], Imports] | None = None
    words: Callable[[ViewT], Collection[str]] | None = None

    def label(self, view: ViewT) -> str:
        """Returns what an error names when no template line is known."""
        return f"{self.template} for {view.element_id}"


@dataclass(frozen=True)
class TextFile:
    """A file whose text is not made by a template, e.g. a copied module or a diagram.

    Attributes:
        path: Path relative to the output folder.
    """

    path: str
    content: str
    element_id: str
    source: str


@dataclass(frozen=True)
class TextTask:
    """Files of ready text.

    Attributes:
        is_copied: What is copied from modules that run here need not be read to be believed.
    """

    views: Sequence[TextFile]
    _: KW_ONLY
    is_copied: bool = False
    kind: Kind = Kind.GENERATED
    executable: bool = False
    contract: Callable[[TextFile], SkeletonContract] | None = None

    @staticmethod
    def path(view: TextFile) -> str:
        """Returns the path of a file, relative to the output folder."""
        return view.path

    @staticmethod
    def label(view: TextFile) -> str:
        """Returns what an error names."""
        return view.element_id


Task: TypeAlias = FileTask[Any] | TextTask


def templates_beside(module_file: str) -> Path:
    """Returns the folder `templates` beside a target's module."""
    return Path(module_file).resolve().parent / "templates"
