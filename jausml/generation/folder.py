"""Output folder as it is; no symbolic link inside it is followed."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.generation.artifact import normalize_newlines
from jausml.generation.header import DIGEST_MARK, has_valid_header
from jausml.generation.manifest import MANIFEST_PATH
from jausml.language.model.inputs import open_input, read_input

if TYPE_CHECKING:
    from collections.abc import Iterator

_HEADER_BYTES = 4096


@dataclass(frozen=True)
class FileState:
    """What stands at a path of the output folder.

    Attributes:
        text: Its text with LF line ends; None when there is none or it is not UTF-8.
        obstacle: Why the path cannot be used (symbolic link, folder in the way), or empty.
    """

    exists: bool = False
    text: str | None = None
    obstacle: str = ""


def inspect(out: Path, path: str) -> FileState:
    """Looks at one path."""
    current = out
    segments = path.split("/")
    for depth, segment in enumerate(segments):
        current /= segment
        try:
            mode = current.lstat().st_mode
        except FileNotFoundError:
            return FileState()
        except OSError as error:
            return FileState(obstacle=f"cannot be read: {error.strerror}")
        is_last = depth == len(segments) - 1
        obstacle = _obstacle("/".join(segments[: depth + 1]), mode, is_last=is_last)
        if obstacle:
            return FileState(obstacle=obstacle)
    return _read(current)


def find_generated(out: Path) -> list[str]:
    """Returns the paths of files with a valid header, for a run whose manifest is lost.

    Folders that are hidden, ignored by colcon (its own build, install and log), virtual
    environments and what has a manifest of its own are left out.
    """
    return sorted(
        path.relative_to(out).as_posix()
        for path in _files(out)
        if _may_have_header(path) and has_valid_header(_read(path).text or "")
    )


def find_python(out: Path) -> list[str]:
    """Returns the paths of Python files, in the folders that `find_generated` looks at."""
    found = (path for path in _files(out) if path.suffix == ".py")
    return sorted(path.relative_to(out).as_posix() for path in found)


def _may_have_header(path: Path) -> bool:
    """Looks at the start alone: the folder may hold large files of others."""
    try:
        with open_input(path) as file:
            return DIGEST_MARK.encode() in file.read(_HEADER_BYTES)
    except OSError:
        return False


def _files(out: Path) -> Iterator[Path]:
    for folder, subfolders, names in os.walk(out):
        here = Path(folder)
        subfolders[:] = sorted(
            name
            for name in subfolders
            if not name.startswith(".")
            and not (here / name / "COLCON_IGNORE").exists()
            and not (here / name / MANIFEST_PATH).exists()
            and not (here / name / "pyvenv.cfg").exists()
        )
        yield from (
            here / name
            for name in sorted(names)
            if not (here / name).is_symlink() and (here / name).is_file()
        )


def _obstacle(path: str, mode: int, *, is_last: bool) -> str:
    if stat.S_ISLNK(mode):
        return f"'{path}' is a symbolic link"
    if is_last and not stat.S_ISREG(mode):
        return f"'{path}' is not a regular file"
    if not is_last and not stat.S_ISDIR(mode):
        return f"'{path}' is not a folder"
    return ""


def _read(path: Path) -> FileState:
    try:
        return FileState(exists=True, text=normalize_newlines(read_input(path).decode("utf-8")))
    except UnicodeDecodeError:
        return FileState(exists=True)
    except OSError as error:
        return FileState(obstacle=f"cannot be read: {error.strerror}")
