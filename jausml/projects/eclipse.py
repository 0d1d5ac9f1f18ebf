"""What makes Eclipse open a model: where its metamodels are, and copies of what is no XMI."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.model.identifiers import name_identifiers
from jausml.model.reading.reader import read_models
from jausml.model.uris import LIBRARY_URI, copy_in_project
from jausml.model.xmi.writer import to_xmi
from jausml.text.notation import NOTATIONS

if TYPE_CHECKING:
    from pathlib import Path

METAMODELS = "metamodels"
_LANGUAGES = ("jaus", "ros", "bridge", "system")
_ROOT = re.compile(r'<\w+:\w+(?:\s+(?:\w+:version|xmlns(?::\w+)?)="[^"]*")+')
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_HREF = re.compile(rf'(?<=href="){re.escape(LIBRARY_URI)}([^"#]+)')


def metamodels_for(path: Path, root: Path) -> str:
    """Returns the folder of metamodels of a project, relative to a model; empty without one.

    Args:
        path: The model.
        root: The folder of the project.
    """
    for each in path.parents:
        if not each.is_relative_to(root):
            break
        if (each / METAMODELS / "system.ecore").is_file():
            return posixpath.relpath((each / METAMODELS).as_posix(), path.parent.as_posix())
    return ""


def with_schema_location(xmi: str, metamodels: str) -> str:
    """Returns a model that tells Eclipse where the metamodels are.

    Args:
        xmi: The model, which says nothing of it.
        metamodels: Folder of the metamodels, relative to the model; empty for none.
    """
    root = _ROOT.search(xmi)
    if root is None or not metamodels:
        return xmi
    places = " ".join(
        f"http://www.jausml.org/{each}/1.0 {metamodels}/{each}.ecore" for each in _LANGUAGES
    )
    declared = "" if _XSI in root.group() else f' xmlns:xsi="{_XSI}"'
    end = root.end()
    return f'{xmi[:end]}{declared} xsi:schemaLocation="{places}"{xmi[end:]}'


def as_xmi_beside(source: Path, target: Path, root: Path) -> str:
    """Returns a text of the library as XMI that Eclipse opens.

    Args:
        source: The text.
        target: The file that is to hold it.
        root: The folder of the project.
    """
    model = read_models([source], notations=NOTATIONS).model
    roots = model.documents[0].roots
    name_identifiers(roots, model)
    return localized(to_xmi(roots, model, target), target, root)


def localized(xmi: str, target: Path, root: Path) -> str:
    """Returns a model that leads Eclipse to the copies that a project has for it.

    Args:
        xmi: The model, which names the library by its URI.
        target: The file that is to hold it.
        root: The folder of the project.
    """
    folder = target.parent

    def local(match: re.Match[str]) -> str:
        copy = copy_in_project(match[1], folder, root)
        if copy is None:
            return match.group()
        return quote(posixpath.relpath(copy.as_posix(), folder.as_posix()))

    return with_schema_location(_HREF.sub(local, xmi), metamodels_for(target, root))
