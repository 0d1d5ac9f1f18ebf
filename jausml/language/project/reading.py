"""Models read in one call: those that a user names, the library, and one document of a model."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from jausml.language.metamodel import load_jaus_metamodel
from jausml.language.model.library import (
    SUFFIXES,
    XMI,
    library_paths,
    library_root,
    place_in_library,
    shipped_as,
)
from jausml.language.model.project import InputError, files_at, shown, walk
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import NOTATIONS, SUFFIX, Ros2Jaus
from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.language.model.model import Model
    from jausml.language.model.notation import Notation
    from jausml.language.model.reading.library_cache import LibraryCache
    from jausml.language.model.reading.reader import ReadResult

_ADDRESS = re.compile(r"\d+\.\d+\.\d+")


@dataclass(frozen=True, slots=True)
class Reading:
    """How models are read.

    Attributes:
        project_root: Folder that references may not leave; None for the one around the files.
        projects: Folders of Eclipse projects by name.
        bridge_address: JAUS id of a bridge that carries all maps of a text; None for none.
        frequency: Messages each second of that bridge; None for the default.
    """

    project_root: str | os.PathLike[str] | None = None
    allow_outside: bool = False
    projects: Mapping[str, str | os.PathLike[str]] = field(default_factory=dict)
    bridge_address: str | None = None
    frequency: float | None = None


def read_project(
    paths: Iterable[str | os.PathLike[str]],
    reading: Reading | None = None,
    *,
    is_one: bool = False,
) -> ReadResult:
    """Reads models with all that they refer to: files, and those below folders.

    Raises:
        InputError: A path cannot be read, a folder holds no model, or there can be no such bridge.
    """
    reading = reading or Reading()
    named = [os.fspath(each) for each in paths]
    files = [_one_model(each) for each in named] if is_one else find_models(named)
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

    Raises:
        InputError: A path cannot be read, or a folder holds no model.
    """
    hint = "; 'jausml init DIR' makes a project of models"
    return [file for path in paths for file in _own_models(files_at(path, SUFFIXES, hint))]


def _own_models(files: Sequence[str]) -> Sequence[str]:
    """Returns the files that are no copies of the shipped library; all where all are copies."""
    if len(files) == 1:
        return files
    own = [each for each in files if shipped_as(Path(os.path.realpath(each))) is None]
    return own or files


def _one_model(path: str) -> str:
    if Path(path).is_dir():
        there = min(walk(path, SUFFIXES), default=None)
        such = f", such as {shown(there)}" if there else ""
        raise InputError(f"{shown(path)} is a folder; name one model file{such}")
    return files_at(path, SUFFIXES)[0]


def _notations(files: Sequence[str], reading: Reading) -> Sequence[Notation]:
    """Returns what reads files that are no XMI, with a bridge of maps where one is asked for."""
    address = reading.bridge_address
    if address is None:
        return NOTATIONS
    if not _ADDRESS.fullmatch(address):
        raise InputError("--bridge-address is a JAUS id such as 100.1.20")
    if len(files) != 1:
        raise InputError("--bridge-address takes one file of maps")
    if not files[0].endswith(SUFFIX):
        raise InputError(f"--bridge-address takes the maps of a {SUFFIX} file")
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


_READING = Lock()


def library(kind: str = "", *, with_maps: bool = True) -> Model:
    """Returns the shipped library, read at the first call; all threads get the same.

    Elements of the library with its ready maps are others than those of the one without.

    Args:
        kind: The folder that is wanted: `jaus`, `ros` or `mappings`; empty for all of them.
        with_maps: Whether ready maps are wanted: they are text, and half of reading the library.
    """
    with _READING:
        return _library(kind, SUFFIXES if with_maps else (XMI,))


@cache
def _library(kind: str, suffixes: tuple[str, ...]) -> Model:
    paths = library_paths(kind, suffixes)
    model = read_models(paths, project_root=library_root(), notations=NOTATIONS).model
    for document in model.documents:
        document.given = False
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
