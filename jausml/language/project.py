"""Projects: models that are named, read in one call; the index of a project; the library.

Whoever looks for an element finds it in one order: in the file that asks and what it refers to, in
the other files of the project, in the library.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from threading import Lock
from typing import TypeVar

from jausml.language.metamodel import load_jaus_metamodel
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.files import read_input
from jausml.language.model.library import (
    SUFFIXES,
    XMI,
    library_paths,
    library_root,
    place_in_library,
    shipped_as,
)
from jausml.language.model.model import Model
from jausml.language.model.notation import Notation
from jausml.language.model.project import (
    InputError,
    Reading,
    files_at,
    made_project,
    model_files,
    project_folder,
    shown,
    walk,
)
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.refs import file_of
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import NOTATIONS, SUFFIX, Ros2Jaus

ElementT = TypeVar("ElementT", bound="EObject")

_KEPT = 2
_FEW = 5
_SYSTEM = re.compile(rb"<\w+:System\b|^\s*(?:system|bridge|component|node)\s+[\w`]", re.MULTILINE)
"""The mark of a file with a system, in either notation; a text need not name its system."""

_MESSAGES = re.compile(rb"ServiceSet\b|serviceSets\b|\bservice\b|\bservice_set\b|^\s*JAUS\s")
"""The mark of a file with messages of its own."""


@dataclass(frozen=True, slots=True)
class _Kept:
    """A model that was read, and of what."""

    result: ReadResult
    files: tuple[str, ...]
    contents: Mapping[str, bytes]
    names: frozenset[str]

    def is_of(self, files: tuple[str, ...], contents: Mapping[str, bytes]) -> bool:
        """Tells whether it was read of files with the same contents as now."""
        is_same_project = self.files == files and self.names == contents.keys()
        return is_same_project and all(
            contents[file] == data for file, data in self.contents.items()
        )


class Models:
    """Models of the files of a project; one is read again when one of its files has changed."""

    def __init__(
        self,
        root: Path,
        notations: Sequence[Notation] = NOTATIONS,
        cache: LibraryCache | None = None,
    ) -> None:
        self._root = root
        self._notations = notations
        self._kept: dict[str, list[_Kept]] = {}
        self._cache = cache or LibraryCache()

    def read(self, files: tuple[str, ...], contents: Mapping[str, bytes]) -> ReadResult:
        """Returns the model of files and of all that they refer to."""
        # Of models of several files few are kept, whichever these are.
        kept = self._kept.setdefault(files[0] if len(files) == 1 else "", [])
        for entry in kept:
            if entry.is_of(files, contents):
                return entry.result
        result = self._read(files, contents)
        held = {
            file_of(document, self._root) for document in result.model.documents
        } & contents.keys()
        said = {path: contents[path] for path in held}
        kept.insert(0, _Kept(result, files, said, frozenset(contents)))
        del kept[_KEPT:]
        return result

    def _read(self, files: tuple[str, ...], contents: Mapping[str, bytes]) -> ReadResult:
        return read_models(
            [self._root / file for file in files],
            project_root=self._root,
            notations=self._notations,
            contents={self._root / path: data for path, data in contents.items()},
            cache=self._cache,
        )


class Index:
    """The files of a project, and the models of them.

    Args:
        contents: What its model files hold, by their paths relative to it; None for what is
            stored.
    """

    def __init__(
        self, root: Path, contents: Mapping[str, bytes] | None = None, models: Models | None = None
    ) -> None:
        self.root = root
        self.contents = stored_files(root) if contents is None else contents
        self._models = models or Models(root)

    @classmethod
    def here(cls) -> Index | None:
        """Returns the index of the current folder's project, None where `init` has made none."""
        root = made_project(Path.cwd())
        return None if root is None else cls(root)

    def model(self, file: str) -> Model:
        """Returns the model of a file and of all that it refers to."""
        return self._models.read((file,), self.contents).model

    def whole(self) -> Model:
        """Returns the model of all files."""
        return self._models.read(tuple(sorted(self.contents)), self.contents).model

    def beside(self, file: str, model: Model | None = None) -> Model:
        """Returns the model of the files outside of the model of a file.

        Args:
            model: That of the file, from whoever has read it.
        """
        used = {file_of(document, self.root) for document in (model or self.model(file)).documents}
        others = tuple(content for content in sorted(self.contents) if content not in used)
        return self._models.read(others, self.contents).model

    @cached_property
    def files_with_messages(self) -> tuple[Path, ...]:
        """The files that define messages."""
        return self._files_with(_MESSAGES)

    @cached_property
    def files_with_systems(self) -> tuple[Path, ...]:
        """The files that have a system."""
        return self._files_with(_SYSTEM)

    def only_system(self, option: str = "") -> Path:
        """Returns the one file that has a system.

        Raises:
            InputError: There is none, or more than one.
        """
        files = self.files_with_systems
        choice = f"name one by {option}" if option else "name one"
        if not files:
            raise InputError(
                f"no model in {self.root} has a system: {choice}, or make a project by jausml init"
            )
        if len(files) > 1:
            names = ", ".join(str(path.relative_to(self.root)) for path in files[:_FEW])
            raise InputError(f"several models have a system: {choice} ({names})")
        return files[0]

    def _files_with(self, pattern: re.Pattern[bytes]) -> tuple[Path, ...]:
        # Every other byte of UTF-16 is nought.
        held = ((file, data.replace(b"\0", b"")) for file, data in sorted(self.contents.items()))
        return tuple(self.root / file for file, data in held if pattern.search(data))


def index_around(folder: Path) -> Index:
    """Returns the index of the project that a folder is in, else of the folder itself."""
    return Index(project_folder(folder / "any") or folder)


def own_instances(models: Iterable[Model], kind: type[ElementT]) -> list[ElementT]:
    """Returns the elements of a class in models of one project, in order.

    Each file counts once: models that were read apart have elements of their own for it.
    """
    elements: list[ElementT] = []
    seen: set[Path] = set()
    for model in models:
        new = {document.path for document in model.documents if not document.is_library} - seen
        of_model = (
            (instance, model.document_of(instance))
            for instance in model.instances(kind, library=False)
        )
        elements += [
            instance for instance, place in of_model if place is not None and place.path in new
        ]
        seen |= new
    return elements


def stored_files(root: Path) -> dict[str, bytes]:
    """Returns the bytes of the model files of a project, without those that cannot be read."""
    contents = {}
    for file in model_files(root):
        try:
            contents[file] = read_input(root / file)
        except OSError:
            continue
    return contents


_ADDRESS = re.compile(r"\d+\.\d+\.\d+")


def read_project(
    paths: Iterable[str | os.PathLike[str]], reading: Reading | None = None, *, is_one: bool = False
) -> ReadResult:
    """Reads models with all that they refer to: files, and those below folders.

    Raises:
        InputError: A path cannot be read, a folder holds no model, or there can be no such bridge.
    """
    reading = reading or Reading()
    named = [os.fspath(path) for path in paths]
    files = [_one_model(path) for path in named] if is_one else find_models(named)
    return read_models(
        files,
        project_root=reading.project_root,
        allow_outside=reading.allow_outside,
        projects=reading.projects,
        notations=_notations(files, reading),
    )


def find_models(paths: Iterable[str]) -> list[str]:
    """Returns model files: files as they are, and the *.xmi and *.ros2jaus files below folders.

    Hidden folders are left out, and the shipped library with its copies in projects, unless a
    folder holds nothing else.
    """
    hint = "; 'jausml init DIR' makes a project of models"
    return [file for path in paths for file in _own_models(files_at(path, SUFFIXES, hint))]


def _own_models(files: Sequence[str]) -> Sequence[str]:
    """Returns the files that are no copies of the shipped library; all where all are copies."""
    if len(files) == 1:
        return files
    own = [file for file in files if shipped_as(Path(os.path.realpath(file))) is None]
    return own or files


def _one_model(path: str) -> str:
    if Path(path).is_dir():
        there = min(walk(path, SUFFIXES), default=None)
        such = f", such as {shown(there)}" if there else ""
        raise InputError(f"{shown(path)} is a folder; name one model file{such}")
    return files_at(path, SUFFIXES)[0]


def _notations(files: Sequence[str], reading: Reading) -> Sequence[Notation]:
    """Returns the notations of files that are no XMI, with a bridge of maps where it is wanted."""
    address = reading.bridge_address
    if address is None:
        return NOTATIONS
    if not _ADDRESS.fullmatch(address):
        raise InputError("--bridge-address is a JAUS id such as 100.1.20")
    if len(files) != 1:
        raise InputError("--bridge-address takes one file of maps")
    if not files[0].endswith(SUFFIX):
        raise InputError(f"--bridge-address takes the maps of a {SUFFIX} file")
    # The parser is loaded by whoever reads text.
    from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps  # noqa: PLC0415

    return (Ros2Jaus(BridgeOfMaps(Path(files[0]).resolve(), address, reading.frequency)),)


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
        """Reads the document, with its part of the installed library."""
        own = {self.path: self.text.encode("utf-8")} if self.text else {}
        return read_models(
            [*own, *(library_root() / path for path in self.library)],
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
    roots = [
        root for document in model.documents if not document.is_library for root in document.roots
    ]
    named = [
        document.path for document in model.documents if document.is_library and document.is_input
    ]
    text = to_xmi(roots, model, path) if roots else ""
    return OneDocument(path, text, tuple(map(place_in_library, named)))


_READING = Lock()


def library(kind: str = "", *, with_maps: bool = True) -> Model:
    """Returns the shipped library, read at the first call; all threads get the same.

    Elements of the library with its ready maps are others than those of the one without.

    Args:
        with_maps: Whether ready maps are wanted: they are text, and half of reading the library.
    """
    with _READING:
        return _library(kind, SUFFIXES if with_maps else (XMI,))


@cache
def _library(kind: str, suffixes: tuple[str, ...]) -> Model:
    paths = library_paths(kind, suffixes)
    model = read_models(paths, project_root=library_root(), notations=NOTATIONS).model
    for document in model.documents:
        document.is_input = False
    return model


def services_alone() -> Model:
    """Returns the service sets of the library in a model that knows of nothing but JAUS.

    The metamodels of the rest take as long to load as these sets to read.
    """
    with _READING:
        return _services_alone()


@cache
def _services_alone() -> Model:
    return read_models(library_paths("jaus"), metamodels=load_jaus_metamodel()).model
