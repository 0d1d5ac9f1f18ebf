"""Models as values: one XMI document of all that is not of the library, which any process reads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.model.library import library_root, place_in_library
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import NOTATIONS

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.language.model.model import Model
    from jausml.language.model.reading.library_cache import LibraryCache
    from jausml.language.model.reading.reader import ReadResult


@dataclass(frozen=True)
class OneDocument:
    """A model without its files.

    Attributes:
        path: What the document is called; no such file has to be there.
        library: The files of the library that were named themselves, by their places in it.
    """

    path: Path
    text: str
    library: tuple[str, ...] = ()

    def read(self, cache: LibraryCache | None = None) -> ReadResult:
        """Reads it, with what it needs of the library that is installed."""
        own = {self.path: self.text.encode("utf-8")} if self.text else {}
        return read_models(
            [*own, *(library_root() / each for each in self.library)],
            project_root=self.path.parent,
            notations=NOTATIONS,
            contents=own,
            cache=cache,
        )


def one_document(model: Model) -> OneDocument:
    """Returns a model as one document.

    Raises:
        UnwritableError: XMI has no form for a value of it.
    """
    path = model.documents[0].path.with_suffix(".xmi")
    roots = [each for one in model.documents if not one.is_library for each in one.roots]
    named = [each.path for each in model.documents if each.is_library and each.given]
    text = to_xmi(roots, model, path) if roots else ""
    return OneDocument(path, text, tuple(map(place_in_library, named)))
