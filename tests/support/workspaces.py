"""Generated workspaces in tests: those that many want, and where Python finds their packages."""

import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from type_support import require_own

from jausml.generation.rendering import render
from jausml.generation.target import Target
from jausml.language.model import Model
from jausml_generators.python.package import FACE
from jausml_generators.runtime.target import TARGET as RUNTIME

_FORGOTTEN = 24 * 3600
"""Seconds after which what another state of the project has generated is removed."""


def packages_of(workspace: Path) -> list[str]:
    """Returns the folders of the packages, for the module path."""
    return [str(path) for path in sorted(workspace.iterdir()) if (path / path.name).is_dir()]


def python_path(workspace: Path) -> str:
    """Returns the value of PYTHONPATH with all packages of a workspace."""
    return os.pathsep.join(packages_of(workspace))


def write(model: Model | None, targets: Sequence[Target[Any]], folder: Path) -> None:
    """Writes what is generated of a model."""
    for artifact in render(model, targets):
        path = folder / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")


def kept(model: Model, targets: Sequence[Target[Any]], *, compiled: bool = False) -> Path:
    """Returns a folder with what is generated of a model, which nobody may change.

    All workers have the same one, and later runs, until a document or anything of the project is
    another. What is compiled in it stays, so that there is one with and one without.
    """
    names = [
        f"{document.path.name} {sha256(document.data).hexdigest()}" for document in model.documents
    ]
    digest = _digest([str(compiled), *(target.name for target in targets), *names])
    return _kept(digest, model, targets)


def share_runtime(workspace: Path) -> None:
    """Gives a workspace the whole runtime, which all such have: it is compiled once."""
    whole = _kept("runtime", None, [RUNTIME.for_whole_library()])
    (workspace / FACE).symlink_to(whole / FACE)


def _kept(name: str, model: Model | None, targets: Sequence[Target[Any]]) -> Path:
    folder = _place() / name
    if not folder.exists():
        new = Path(tempfile.mkdtemp(dir=folder.parent, prefix="new-"))
        write(model, targets, new)
        try:
            new.rename(folder)
        except OSError:  # another worker was first
            shutil.rmtree(new)
    return folder


@cache
def _place() -> Path:
    """Returns the folder for this state of the project; far from it, for tools look upwards."""
    root = Path(tempfile.gettempdir(), f"jausml-workspaces-{os.getuid()}")
    require_own(root)
    for path in root.iterdir():
        if path.stat().st_mtime < time.time() - _FORGOTTEN:
            shutil.rmtree(path, ignore_errors=True)
    place = root / _digest(_state())
    place.mkdir(exist_ok=True)
    os.utime(place)
    return place


def _state() -> Iterator[str]:
    """Yields what tells one state of the project from another: libraries, and all of its files."""
    yield sys.version
    yield from map(version, ("jinja2", "lark", "lxml", "pyecore", "pyecoregen"))
    for package in ("jausml", "jausml_generators", "jausml.metamodels"):
        folder = Path(str(files(package)))
        for path in sorted(folder.rglob("*")):
            if "__pycache__" not in path.parts and path.is_file():
                yield f"{path.relative_to(folder)} {sha256(path.read_bytes()).hexdigest()}"


def _digest(texts: Iterable[str]) -> str:
    return sha256(json.dumps([*texts]).encode()).hexdigest()[:24]
