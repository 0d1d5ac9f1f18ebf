"""The messages of the project of a folder, which nobody has to name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from jausml.language.model.diagnostics import Severity
from jausml.language.model.project import shown
from jausml.language.model.reading.reader import read_models
from jausml.language.project import Index
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages.defined import DefinedCatalogue, load_catalogue
from jausml.live.messages.errors import CatalogueError


def project_catalogue(warn: Callable[[str], None]) -> DefinedCatalogue:
    """Returns the messages of the library and those of the current project, if there is one."""
    index = Index.here()
    files = index.files_with_messages if index is not None else ()
    try:
        return load_catalogue(files, notations=NOTATIONS)
    except CatalogueError:
        return load_catalogue(sound_files(files, "messages", warn), notations=NOTATIONS)


def messages_of(path: Path, root: Path) -> DefinedCatalogue:
    """Returns the messages that are known: of a model with errors those of the library alone."""
    try:
        return load_catalogue([path], project_root=root, notations=NOTATIONS)
    except CatalogueError:
        return load_catalogue()


def sound_files(files: Iterable[Path], what: str, warn: Callable[[str], None]) -> list[Path]:
    """Returns the files that can be read, with all that they refer to, without an error.

    `what`: what of the others is left out, which is told.
    """
    readable_files = []
    for file in files:
        diagnostics = read_models([file], notations=NOTATIONS).diagnostics
        fault = next(
            (diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR),
            None,
        )
        if fault is None:
            readable_files.append(file)
        else:
            warn(f"the {what} of {shown(file)} are left out: {fault.location}: {fault.message}")
    return readable_files
