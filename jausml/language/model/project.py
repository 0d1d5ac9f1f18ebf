"""What a project is: its folder, the root that references may not leave, and its model files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model.library import SUFFIXES, library_root, shipped_as

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

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
    return next((each for each in path.parents if any((each / m).exists() for m in marks)), None)


def made_project(folder: Path) -> Path | None:
    """Returns the project around a folder that `jausml init` made: what nobody has to name.

    A checkout alone may hold models of all kinds, which do not belong together.
    """
    found = project_folder(Path(os.path.realpath(folder)) / "any")
    return found if found is not None and (found / MARKER).is_file() else None


def enclosing_project(path: Path) -> Path | None:
    """Returns the nearest folder above a file that is an Eclipse project, None without one."""
    return next((each for each in path.parents if (each / MARKER).is_file()), None)


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
        if (folder / _CHECKOUT).exists():
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
    folder: str,
    suffixes: tuple[str, ...],
    onerror: Callable[[OSError], None] | None = _raise,
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
    if os.path.exists(real) and not os.path.isfile(real):  # noqa: PTH110, PTH113 -- many
        return False
    library = os.path.realpath(library_root()) + os.sep
    if not real.startswith(f"{root}{os.sep}") or real.startswith(library):
        return False
    return shipped_as(Path(real)) is None


def _is_shown(name: str) -> bool:
    return not name.startswith(".") and name not in _BUILT
