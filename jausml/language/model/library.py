"""The shipped library: its files, found once in a process, and the copies that projects have.

What the files say is read by `jausml.language.project.reading`. It does not depend on who refers to
it: a `LibraryCache` keeps documents that several readings share.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model.inputs import read_input

LIBRARY_URI = "http://www.jausml.org/library/"

TEXT, XMI = ".ros2jaus", ".xmi"
SUFFIXES = (XMI, TEXT)
"""The endings of model files."""

_SCHEMA_LOCATION = re.compile(rb' xsi:schemaLocation="[^"<]*"')


def library_root() -> Path:
    """Returns the folder of the shipped library."""
    return Path(str(files("jausml.models"))) / "library"


def library_paths(kind: str = "", suffixes: tuple[str, ...] = SUFFIXES) -> tuple[Path, ...]:
    """Returns the model files of the library, in order.

    Args:
        kind: The folder that is meant: `jaus`, `ros` or `mappings`; empty for all of them.
    """
    root = library_root()
    found = (root / each for each in _places(root) if each.endswith(suffixes))
    return tuple(each for each in found if not kind or each.is_relative_to(root / kind))


@cache
def _places(root: Path) -> tuple[str, ...]:
    # No path has parts before its folder: they are in order of their parts, as paths are.
    found = sorted(each.relative_to(root) for each in root.rglob("*") if each.suffix in SUFFIXES)
    return tuple(each.as_posix() for each in found)


def place_in_library(path: Path) -> str:
    """Returns the path of a library's file in it, with forward slashes."""
    root = library_root()
    return path.relative_to(root if path.is_relative_to(root) else root.resolve()).as_posix()


def module_of(path: Path) -> str:
    """Returns how texts import a file of the library."""
    return place_in_library(path.with_suffix("")).replace("/", ".")


def has_package(name: str) -> bool:
    """Tells whether the library has a ROS package of interfaces."""
    return bool(name) and library_root() / "ros" / f"{name}.xmi" in library_paths("ros")


def shipped_as(path: Path) -> Path | None:
    """Returns the file of the shipped library of which a file is a copy, None for any other.

    Eclipse needs copies in its workspace; they may say there where the metamodels are.
    """
    library = Path(os.path.realpath(library_root()))
    if path.parent.parent.name != library.name:
        return None
    shipped = library / path.parent.name / path.name
    try:
        copied = _SCHEMA_LOCATION.sub(b"", read_input(path), count=1)
        return shipped if read_input(shipped) == copied else None
    except (OSError, ValueError):
        return None


def copy_in_project(place: str, folder: Path, root: Path) -> Path | None:
    """Returns the copy of a file of the shipped library that a project has, None without one."""
    for each in (folder, *folder.parents):
        if not each.is_relative_to(root):
            return None
        copy = each / "library" / place
        if shipped_as(copy) is not None:
            return copy
    return None


if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model, Origins
    from jausml.language.model.uris import FileTarget

    Opened = Mapping[Document, Mapping[str, Document | None]]
    """What the references of documents led to, by URI; None for nowhere."""


_MOST = 500
"""Documents; more are of projects that nobody works with any more."""


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
    change them. A document is kept for each name that messages call it by: that of the library, or
    of its copy in a project. One reading uses a cache at a time.
    """

    def __init__(self) -> None:
        self._documents: dict[tuple[Path, str], CachedDocument] = {}
        self._stamps: dict[Path, tuple[int, int]] = {}

    def prepare(self, held: Collection[Path]) -> None:
        """Forgets everything when a file has changed: what refers to it has its elements."""
        paths = {path for path, _ in self._documents}
        is_current = all(self._stamps[each] == _stamp(each) for each in paths)
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
        shared = [each for each in model.documents if each.is_shared]
        if all(_is_sound(each, opened, faulty) for each in shared):
            for each in shared:
                uris = tuple(opened.get(each, ()))
                kept = CachedDocument(each, uris, model.origins_of(each))
                self._documents.setdefault((each.path, each.display), kept)


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
