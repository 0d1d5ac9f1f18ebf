"""XMI as Eclipse opens it: with the places of metamodels, of library copies and of ready maps."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from urllib.parse import quote

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.library import LIBRARY_URI, copy_in_project, library_root
from jausml.language.model.names import name_of, qualified_name
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import name_identifiers, to_xmi
from jausml.language.text.notation import NOTATIONS

METAMODELS = "metamodels"
MAPPINGS = "mappings"

# The opening tag up to its last namespace; a `schemaLocation` must not be there yet.
_ROOT = re.compile(r'<\w+:\w+(?:\s+(?:\w+:version|xmlns(?::\w+)?)="[^"]*")+')
# The namespace of a language, whose prefix and metamodel have its name.
_LANGUAGE = re.compile(r'xmlns:(\w+)="(http://www\.jausml\.org/\1/[^"]+)"')
# The namespace behind which that of instances goes.
_XMI = re.compile(r' xmlns:xmi="[^"]*"')
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
# The path of a file of the library in a reference.
_HREF = re.compile(rf'(?<=href="){re.escape(LIBRARY_URI)}([^"#]+)')
# The path of a text with ready maps in a reference, and the fragment.
_READY_MAP = re.compile(
    rf'(?<=href="){re.escape(LIBRARY_URI)}({MAPPINGS}/[^"#]+\.ros2jaus)#([^"]+)'
)


def metamodels_for(path: Path, root: Path) -> str:
    """Returns the folder of metamodels of a project, relative to a model; empty without one."""
    for parent in path.parents:
        if not parent.is_relative_to(root):
            break
        if (parent / METAMODELS / "system.ecore").is_file():
            return posixpath.relpath((parent / METAMODELS).as_posix(), path.parent.as_posix())
    return ""


def with_schema_location(xmi: str, metamodels: str) -> str:
    """Returns a model that tells Eclipse where the metamodels of its namespaces are, as EMF does.

    `xmi`: the model, which must not tell so yet. `metamodels`: folder of the metamodels, relative
    to the model; empty for none.
    """
    root = _ROOT.search(xmi)
    if root is None or not metamodels:
        return xmi
    declared = root.group()
    places = " ".join(
        f"{uri} {metamodels}/{name}.ecore" for name, uri in _LANGUAGE.findall(declared)
    )
    if _XSI not in declared:
        declared = _XMI.sub(rf'\g<0> xmlns:xsi="{_XSI}"', declared, count=1)
    return f'{xmi[: root.start()]}{declared} xsi:schemaLocation="{places}"{xmi[root.end() :]}'


def as_xmi_beside(source: Path, target: Path, root: Path) -> str:
    """Returns a text of the library as XMI that Eclipse opens.

    `source`: the text, which must be free of errors. `root`: folder of the project.
    """
    model = read_models([source], notations=NOTATIONS).model
    roots = model.documents[0].roots
    name_identifiers(roots, model)
    return localized(to_xmi(roots, model, target), target, root)


def localized(xmi: str, target: Path, root: Path) -> str:
    """Returns a model that leads Eclipse to the copies that a project has for it.

    `root`: folder of the project.
    """
    folder = target.parent

    def local(match: re.Match[str]) -> str:
        copy = copy_in_project(match[1], folder, root)
        if copy is None:
            return match.group()
        return quote(posixpath.relpath(copy.as_posix(), folder.as_posix()))

    return with_schema_location(_HREF.sub(local, xmi), metamodels_for(target, root))


def with_ready_maps(xmi: str, target: Path, root: Path) -> tuple[str, dict[Path, Path]]:
    """Returns a model that refers to ready maps by copies beside it, which Eclipse can read.

    `root`: the folder of the project; without metamodels for Eclipse nothing changes. Returns the
    model, and the copies that are missing, each with the text of which it is to be made.
    """
    missing: dict[Path, Path] = {}
    known: dict[Path, dict[str, str]] = {}

    def local(match: re.Match[str]) -> str:
        source = library_root() / match[1]
        copy = target.parent / MAPPINGS / f"{source.stem}.xmi"
        if copy not in known:
            known[copy] = _copied_fragments(source, copy)
        fragment = known[copy].get(match[2])
        if fragment is None:
            return match.group()
        if not copy.exists():
            missing[copy] = source
        return f"{MAPPINGS}/{quote(copy.name)}#{fragment}"

    if not metamodels_for(target, root):
        return xmi, {}
    return _READY_MAP.sub(local, xmi), missing


def _copied_fragments(source: Path, copy: Path) -> dict[str, str]:
    """Returns the fragment of each named element in the copy, by its fragment in the text."""
    text = read_models([source], notations=NOTATIONS).model
    own = text.elements_of(text.documents[0])
    places = {text.path_of(element): _key(element) for element in own if name_of(element)}
    model = read_models([copy]).model if copy.exists() else text
    if model is text:
        # A copy yet to be written gets these identifiers from `as_xmi_beside`.
        name_identifiers(text.documents[0].roots, text)
    elements = model.elements_of(model.documents[0])
    named = (element for element in elements if name_of(element))
    known = {
        _key(element): model.identifier(element) or model.path_of(element) for element in named
    }
    return {place: known[key] for place, key in places.items() if key in known}


def _key(element: EObject) -> tuple[str, str]:
    """Returns the key that an element and a copy of it have in common."""
    return element.eClass.name, qualified_name(element)
