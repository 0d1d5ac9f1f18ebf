"""A project: its folder, the root that references may not leave, and files named in it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path

from jausml.language.model.files import leads_out, open_input
from jausml.language.model.library import SUFFIXES, library_root, shipped_as

# Unlike pathlib, os.path says no where nothing may be looked at.
# ruff: noqa: PTH110, PTH112, PTH113

MARKER = ".project"
"""The file that makes a folder a project; `jausml init` writes one, as Eclipse does."""

_CHECKOUT = ".git"
_MOST_FILES = 10_000
_BUILT = frozenset({"build", "install", "log", "node_modules", "__pycache__"})


def project_folder(path: Path) -> Path | None:
    """Returns the folder of the project that holds a file, None where it is in none.

    It is the nearest folder above with the file that `jausml init` makes, which is Eclipse's too;
    none above the checkout, which is the project itself where it has no such file.
    """
    marks = (MARKER, _CHECKOUT)
    return next(
        (parent for parent in path.parents if any(os.path.exists(parent / mark) for mark in marks)),
        None,
    )


def made_project(folder: Path) -> Path | None:
    """Returns the project of `jausml init` around a folder, which needs no name.

    A checkout alone may hold models of all kinds, which do not belong together.
    """
    project = project_folder(Path(os.path.realpath(folder)) / "any")
    return project if project is not None and os.path.isfile(project / MARKER) else None


def enclosing_project(path: Path) -> Path | None:
    """Returns the nearest folder above a file that is an Eclipse project, None without one."""
    return next((parent for parent in path.parents if os.path.isfile(parent / MARKER)), None)


def find_project_root(paths: Iterable[Path]) -> Path:
    """Returns the folder that hrefs may not leave, when the user names none.

    It is the nearest folder above the first file that is a Git checkout; else the Eclipse project
    that holds the file; else the current folder, when all files lie in it; else the folder that all
    files share. It is no narrower than the project: parts of a checkout refer to each other.
    """
    real = [Path(os.path.realpath(path)) for path in paths]
    folders = [path.parent for path in real]
    if not folders:
        return Path.cwd()
    for folder in (folders[0], *folders[0].parents):
        if os.path.exists(folder / _CHECKOUT):
            return folder
    project = enclosing_project(real[0])
    if project is not None:
        return project
    here = Path.cwd()
    if all(folder.is_relative_to(here) for folder in folders):
        return here
    return Path(os.path.commonpath(folders))


def _raise(error: OSError) -> None:
    raise error


def walk(
    folder: str, suffixes: tuple[str, ...], onerror: Callable[[OSError], None] | None = _raise
) -> Iterator[str]:
    """Yields the files with certain endings below a folder, in order: not hidden, not of builds.

    Raises:
        OSError: A folder cannot be read, unless `onerror` is another.
    """
    for parent, subfolders, names in os.walk(folder, onerror=onerror):
        subfolders[:] = sorted(filter(_is_shown, subfolders))
        for name in sorted(names):
            if name.endswith(suffixes) and _is_shown(name):
                yield os.path.normpath(os.path.join(parent, name))  # noqa: PTH118 - many


def model_files(root: Path, suffixes: tuple[str, ...] = SUFFIXES) -> Iterator[str]:
    """Yields the model files of a project, relative to it with `/`, in order; 10,000 at most.

    Args:
        suffixes: The endings of what is meant; what goes along with models has others.
    """
    count = 0
    for path in walk(str(root), suffixes, onerror=None):
        file = os.path.relpath(path, root).replace(os.sep, "/")
        if is_model_file(file, root, suffixes):
            yield file
            count += 1
            if count >= _MOST_FILES:
                return


def is_model_file(file: str, root: Path, suffixes: tuple[str, ...] = SUFFIXES) -> bool:
    """Tells whether a file is one of the models of a project, by its name and place.

    Hidden files and folders and those of builds are left out, links that lead out of the folder,
    and the shipped library with its copies.
    """
    if not file.endswith(suffixes) or not all(map(_is_shown, file.split("/"))):
        return False
    real = os.path.realpath(root / file)
    # A device or pipe would keep its reader waiting.
    if os.path.exists(real) and not os.path.isfile(real):
        return False
    library = os.path.realpath(library_root()) + os.sep
    if not real.startswith(f"{root}{os.sep}") or real.startswith(library):
        return False
    return shipped_as(Path(real)) is None


def _is_shown(name: str) -> bool:
    return not name.startswith(".") and name not in _BUILT


@dataclass(frozen=True, slots=True)
class Reading:
    """How models are read.

    Attributes:
        project_root: Folder that references may not leave; None for the one around the files.
        bridge_address: JAUS id of a bridge that carries all maps of a text; None for none.
        frequency: Messages each second of that bridge; None for the default.
    """

    project_root: str | os.PathLike[str] | None = None
    allow_outside: bool = False
    projects: Mapping[str, str | os.PathLike[str]] = field(default_factory=dict)
    bridge_address: str | None = None
    frequency: float | None = None


class InputError(Exception):
    """An input of the user that cannot be used; the text names it and says why."""


def find_files(paths: Iterable[str], suffixes: tuple[str, ...]) -> list[str]:
    """Returns files as they are, and the files with certain endings below folders.

    Hidden folders and those of builds are left out.
    """
    return [file for path in paths for file in files_at(path, suffixes)]


def files_at(path: str, suffixes: tuple[str, ...], hint: str = "") -> Sequence[str]:
    """Returns a file, or the files with certain endings below a folder, sorted."""
    try:
        if os.path.isdir(path):
            files = sorted(walk(path, suffixes))
            _refuse_links(path, files)
            if not files:
                raise InputError(f"no {' or '.join(suffixes)} files in {shown(path)}{hint}")
            return files
        with open_input(path):
            return [path]
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        near = _near(path, suffixes) if isinstance(error, FileNotFoundError) else ""
        raise InputError(f"{shown(path)}: {reason}{near}") from error


def shown(path: str | Path) -> str:
    """Returns how messages name a path; bytes that are no UTF-8 are replaced by a sign."""
    return os.fsencode(path).decode("utf-8", "replace")


def _refuse_links(folder: str, files: Sequence[str]) -> None:
    """Refuses files of a walk that are links out of the project, as no user named them."""
    links = [path for path in files if os.path.islink(path)]  # noqa: PTH114 - as above
    root = Path(os.path.realpath(find_project_root([Path(folder) / "any"]))) if links else None
    for link in links:
        if root is not None and leads_out(link, root):
            raise InputError(
                f"{shown(link)}: JML209 the link leads out of the project root {root}; "
                "name the file itself to have it read"
            )


def _near(path: str, suffixes: tuple[str, ...]) -> str:
    """Returns a question for the file that may be meant, empty where none is near."""
    wanted = Path(path)
    try:
        there = [
            sibling.name for sibling in wanted.parent.iterdir() if sibling.name.endswith(suffixes)
        ]
    except OSError:
        return ""
    near = get_close_matches(wanted.name, there, n=1)
    return f"; did you mean {shown(wanted.with_name(near[0]))}?" if near else ""
