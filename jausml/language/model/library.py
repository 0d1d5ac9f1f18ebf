"""The shipped library: its files, each found once in a process, and the copies that projects have.

What the files say is read by `jausml.language.project`.
"""

from __future__ import annotations

import os
import re
from functools import cache
from importlib.resources import files
from pathlib import Path

from jausml.language.model.files import read_input

LIBRARY_URI = "http://www.jausml.org/library/"

TEXT, XMI = ".ros2jaus", ".xmi"
SUFFIXES = (XMI, TEXT)
"""The endings of model files."""

_SCHEMA_LOCATION = re.compile(rb' xsi:schemaLocation="[^"<]*"')


@cache
def library_root() -> Path:
    """Returns the folder of the shipped library."""
    return Path(str(files("jausml.models"))) / "library"


def library_paths(kind: str = "", suffixes: tuple[str, ...] = SUFFIXES) -> tuple[Path, ...]:
    """Returns the model files of the library, in order.

    Args:
        kind: The folder that is meant: `jaus`, `ros` or `mappings`; empty for all of them.
    """
    root = library_root()
    paths = (root / place for place in _places(root) if place.endswith(suffixes))
    return tuple(path for path in paths if not kind or path.is_relative_to(root / kind))


@cache
def _places(root: Path) -> tuple[str, ...]:
    # No path has parts before its folder: they are in order of their parts, as paths are.
    paths = sorted(path.relative_to(root) for path in root.rglob("*") if path.suffix in SUFFIXES)
    return tuple(path.as_posix() for path in paths)


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
    library = library_root()
    if path.parent.parent.name != library.name:
        return None
    shipped = Path(os.path.realpath(library)) / path.parent.name / path.name
    try:
        copied = _SCHEMA_LOCATION.sub(b"", read_input(path), count=1)
        return shipped if read_input(shipped) == copied else None
    except (OSError, ValueError):
        return None


def copy_in_project(place: str, folder: Path, root: Path) -> Path | None:
    """Returns the copy of a file of the shipped library that a project has, None without one."""
    for path in (folder, *folder.parents):
        if not path.is_relative_to(root):
            return None
        copy = path / "library" / place
        if shipped_as(copy) is not None:
            return copy
    return None
