"""Eclipse projects: folders with a file `.project`, which tells their name."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from lxml import etree

from jausml.language.model.inputs import open_input

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_FILE = ".project"
_LONGEST_FILE = 1_000_000
_MOST_FOLDERS = 10_000


def enclosing_project(path: Path) -> Path | None:
    """Returns the nearest folder above a file that is an Eclipse project, None without one."""
    return next((each for each in path.parents if (each / _FILE).is_file()), None)


def projects_around(path: Path) -> dict[str, Path]:
    """Returns the project that holds a file, and those beside it, by name.

    Args:
        path: The file, with links resolved.
    """
    project = enclosing_project(path)
    return {} if project is None else projects_in(project.parent)


def projects_in(folder: Path) -> dict[str, Path]:
    """Returns the projects among the folders of a folder, and itself when it is one, by name.

    A name is that which the file says; it may differ from that of the folder.
    """
    found: dict[str, Path] = {}
    for each in (folder, *_folders(folder)):
        name = _name_of(each)
        if name:
            found.setdefault(name, each)
    return found


def _folders(folder: Path) -> Iterator[Path]:
    try:
        with os.scandir(folder) as entries:
            names = sorted(each.name for each in entries if each.is_dir())
    except OSError:
        return
    for name in names[:_MOST_FOLDERS]:
        yield folder / name


def _name_of(folder: Path) -> str:
    """The name of a project; empty for a folder that is none, or whose file cannot be read."""
    try:
        with open_input(folder / _FILE) as file:
            content = file.read(_LONGEST_FILE)
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
        root = etree.fromstring(content, parser)
    except (OSError, etree.XMLSyntaxError, ValueError):
        return ""
    if root.tag != "projectDescription":
        return ""
    return (root.findtext("name") or "").strip()
