"""What the shipped library says, read once in a process."""

from __future__ import annotations

from functools import cache
from threading import Lock
from typing import TYPE_CHECKING

from jausml.language.metamodel import load_jaus_metamodel
from jausml.language.model.library import SUFFIXES, XMI, library_paths, library_root
from jausml.language.model.reading.reader import read_models
from jausml.language.text.notation import NOTATIONS

if TYPE_CHECKING:
    from jausml.language.model.model import Model

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
