"""A plugin: the tests of a process share what they read of the library, which none may change.

Half of what it takes to read an example is the library. Programs that tests start read all of it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import warm

from jausml.authoring.editing.reading import Reader
from jausml.language import project
from jausml.language.model import read_models
from jausml.language.model.library import library_root
from jausml.language.model.project import Reading
from jausml.language.model.reading.reader import ReadResult
from jausml.language.project import read_project

if TYPE_CHECKING:
    _Read = Callable[[Reader, str], ReadResult]

TESTS = Path(__file__).resolve().parents[1]
OF_THE_READER = ("model",)
"""Folders of tests that judge reading itself, or change what was read."""
IN_THREADS = ("studio/server", "studio/browser", "editor")
"""Folders of tests that read in several threads at once, which each need a cache."""

_FILES = pytest.StashKey["dict[tuple[Path, str], ReadResult]"]()
"""Files of the library that were looked at by themselves."""
_MODELS = pytest.StashKey["dict[tuple[object, ...], ReadResult]"]()
"""What was read of the library alone, such as all ready maps."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Lets a test and its fixtures read with the library that earlier ones have read."""
    if _is_in(item.path, OF_THE_READER):
        return (yield)
    cache = warm.library_cache()
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(read_models.__kwdefaults__, "cache", cache)
        if not _is_in(item.path, IN_THREADS):
            patch.setattr(project, "LibraryCache", warm.library_cache)
            patch.setattr(Reader, "library", _shared(item.config.stash.setdefault(_FILES, {})))
            known = item.config.stash.setdefault(_MODELS, {})
            patch.setattr(project, "read_project", _read_once(known))
        return (yield)


def _shared(known: dict[tuple[Path, str], ReadResult], read: _Read = Reader.library) -> _Read:
    """Returns what reads a file of the library, unless it is known."""

    def library(reader: Reader, file: str) -> ReadResult:
        key = library_root(), file
        if key not in known:
            known[key] = read(reader, file)
        return known[key]

    return library


def _read_once(
    known: dict[tuple[object, ...], ReadResult], read: Callable[..., ReadResult] = read_project
) -> Callable[..., ReadResult]:
    """Returns what reads models of the library alone, unless they are known, and others anew."""

    def read_project(
        paths: Iterable[str], reading: Reading | None = None, **options: Any
    ) -> ReadResult:
        names = tuple(map(os.fspath, paths))
        if not all(Path(name).is_relative_to(library_root()) for name in names):
            return read(names, reading, **options)
        # The library leads out of no folder, so the root of a project is no matter.
        said = replace(reading or Reading(), project_root=None)
        key = (*names, repr(said), *options.items())
        if key not in known:
            known[key] = read(names, said, **options)
        return known[key]

    return read_project


def _is_in(path: Path, folders: tuple[str, ...]) -> bool:
    return any(path.is_relative_to(TESTS / folder) for folder in folders)
