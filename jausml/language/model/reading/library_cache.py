"""Documents of the shipped library that several readings share.

What the library says does not depend on who refers to it, so it need not be read for each state of
a model that somebody edits.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from jausml.language.model.documents import Document
from jausml.language.model.model import Model, Origins
from jausml.language.model.uris import FileTarget

Opened: TypeAlias = "Mapping[Document, Mapping[str, Document | None]]"
"""The targets of the references of documents, by URI; None for a missing one."""

_MOST = 500  # documents; more are of projects that nobody works with any more


class NotShareableError(Exception):
    """A change of the library by a model that others must not see: it needs its own library."""


@dataclass(frozen=True, slots=True)
class CachedDocument:
    """A document that is kept."""

    document: Document
    uris: tuple[str, ...]
    origins: Origins


class LibraryCache:
    """Documents of the library in XMI that were read without findings, with all they refer to.

    Elements of the library do not know who of another document refers to them, and nobody may
    change them. A document is kept for each name that messages call it by: that of the library, or
    of its copy in a project. One reading uses a cache at a time.
    """

    def __init__(self) -> None:
        self._documents: dict[tuple[Path, str], CachedDocument] = {}
        self._stamps: dict[Path, tuple[int, int]] = {}

    def prepare(self, held: Collection[Path]) -> None:
        """Forgets all documents when a file has changed, since others refer to its elements."""
        paths = {path for path, _ in self._documents}
        is_current = all(self._stamps[path] == _stamp(path) for path in paths)
        # What an editor holds may differ from the file of which the stamp was taken.
        if not is_current or not paths.isdisjoint(held) or len(self._documents) > _MOST:
            self._documents.clear()

    def find(self, target: FileTarget) -> CachedDocument | None:
        """Returns the document of a file, None when it is not there."""
        return self._documents.get((target.path, target.display))

    def note(self, path: Path) -> None:
        """Remembers how the file of a document is, which is read next."""
        self._stamps[path] = _stamp(path)

    def put(self, model: Model, opened: Opened, faulty: Collection[str]) -> None:
        """Puts the documents of a model there that may be shared, if all of them are sound."""
        shared = [document for document in model.documents if document.is_shared]
        # All or none: a sound document may refer to an element of an unsound one.
        if all(_is_sound(document, opened, faulty) for document in shared):
            for document in shared:
                if (key := (document.path, document.display)) not in self._documents:
                    uris = tuple(opened.get(document, ()))
                    self._documents[key] = CachedDocument(
                        document, uris, model.origins_of(document)
                    )


def _is_sound(document: Document, opened: Opened, faulty: Collection[str]) -> bool:
    if not document.readable or document.display in faulty:
        return False
    # An element of the cache must not hold on to the elements of one project.
    return all(other and other.is_shared for other in opened.get(document, {}).values())


def _stamp(path: Path) -> tuple[int, int]:
    """Returns time and size of a file, noughts for one that is not there."""
    try:
        status = path.stat()
    except OSError:
        return (0, 0)
    return (status.st_mtime_ns, status.st_size)
