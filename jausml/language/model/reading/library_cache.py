"""Documents of the shipped library that several readings share.

What the library says does not depend on who refers to it, so it need not be read for each state of
a model that somebody edits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping
    from pathlib import Path

    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model, Origins
    from jausml.language.model.uris import FileTarget

    Opened = Mapping[Document, Mapping[str, Document | None]]
    """What the references of documents led to, by URI; None for nowhere."""


class NotShareableError(Exception):
    """A model does to the library what others must not see: it needs a library of its own."""


@dataclass(frozen=True, slots=True)
class CachedDocument:
    """A document that is kept.

    Attributes:
        document: The document, whose elements do not change any more.
        uris: The URIs that its references name, each once, in order.
    """

    document: Document
    uris: tuple[str, ...]
    origins: Origins


class LibraryCache:
    """Documents of the library in XMI that were read without findings, with all they refer to.

    Elements of the library do not know who of another document refers to them, and nobody may
    change them. One reading uses a cache at a time.
    """

    def __init__(self) -> None:
        self._documents: dict[Path, CachedDocument] = {}
        self._stamps: dict[Path, tuple[int, int]] = {}

    def prepare(self, held: Collection[Path]) -> None:
        """Forgets everything when a file has changed: what refers to it has its elements."""
        is_current = all(self._stamps[each] == _stamp(each) for each in self._documents)
        if not is_current or not self._documents.keys().isdisjoint(held):
            self._documents.clear()

    def find(self, target: FileTarget) -> CachedDocument | None:
        """Returns the document of a file, None when it is not there.

        Raises:
            NotShareableError: It is there under another name, by which messages call it.
        """
        found = self._documents.get(target.path)
        if found is not None and found.document.display != target.display:
            raise NotShareableError
        return found

    def note(self, path: Path) -> None:
        """Remembers how the file of a document is, which is read next."""
        self._stamps[path] = _stamp(path)

    def put(self, model: Model, opened: Opened, faulty: Collection[str]) -> None:
        """Puts the documents of a model there that may be shared, if all of them are sound."""
        shared = [each for each in model.documents if each.is_shared]
        if all(_is_sound(each, opened, faulty) for each in shared):
            for each in shared:
                if each.path not in self._documents:
                    uris = tuple(opened.get(each, ()))
                    self._documents[each.path] = CachedDocument(each, uris, model.origins_of(each))


def _is_sound(document: Document, opened: Opened, faulty: Collection[str]) -> bool:
    if not document.readable or document.display in faulty:
        return False
    return all(other and other.is_shared for other in opened.get(document, {}).values())


def _stamp(path: Path) -> tuple[int, int]:
    """Returns time and size of a file, noughts for one that is not there."""
    try:
        found = path.stat()
    except OSError:
        return (0, 0)
    return (found.st_mtime_ns, found.st_size)
