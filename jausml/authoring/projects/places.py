"""Where new elements go: a model file, which is made if need be, and the project around it."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

from jausml.authoring.editing.project import Project
from jausml.authoring.editing.reading import can_be_parsed
from jausml.authoring.projects.eclipse import metamodels_for, with_schema_location
from jausml.authoring.proposals.elements import Scope
from jausml.language.metamodel.classes import jaus, system
from jausml.language.model.library import LIBRARY_URI, SUFFIXES, library_root
from jausml.language.model.project import InputError, project_folder
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import replace_file
from jausml.language.project import index_around
from jausml.language.text.notation import SUFFIX
from jausml.language.text.writing.unparsing import to_text

RootT = TypeVar("RootT", system.System, jaus.ServiceSet)

_EXAMPLE = "minimal"

_EMPTY = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"\
 xmlns:system="http://www.jausml.org/system/1.0" xmi:id="minimal" name="minimal"/>
"""

_EMPTY_SET = """\
<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="minimal" version="1.0"/>
"""


@dataclass(frozen=True)
class Place:
    """A model file that gets new elements.

    Attributes:
        root: The folder of the project, links followed.
    """

    root: Path
    file: str

    @property
    def path(self) -> Path:
        """The file."""
        return self.root / self.file

    @property
    def is_text(self) -> bool:
        """Whether it is text and no XMI."""
        return self.file.endswith(SUFFIX)


def place_of(path: Path) -> Place:
    """Returns the place of a model file, which may be missing.

    Raises:
        ProjectError: No model can have that name.
    """
    if not path.name.endswith(SUFFIXES):
        raise ProjectError(f"{path} must end in {' or '.join(SUFFIXES)}")
    real = Path(os.path.realpath(path))
    root = project_folder(real) or real.parent
    return Place(root, real.relative_to(root).as_posix())


def system_in(folder: Path) -> Place:
    """Returns the place of the one model of a project that has a system.

    Raises:
        ProjectError: There is none, or more than one.
    """
    index = index_around(Path(os.path.realpath(folder)))
    try:
        path = index.only_system("--model")
    except InputError as error:
        raise ProjectError(str(error)) from error
    return Place(index.root, path.relative_to(index.root).as_posix())


@dataclass(frozen=True)
class Opened:
    """A model file that is being edited."""

    place: Place
    project: Project
    made: tuple[Path, ...] = ()

    @property
    def scope(self) -> Scope:
        """The model as proposals see it."""
        file = self.place.file
        model = self.project.model(file).model
        return Scope(model, self.place.root, lambda: self.project.beside(file))

    @property
    def scope_without_maps(self) -> Scope:
        """The same for what needs no ready maps, which take most of the time to read."""
        return replace(self.scope, with_maps=False)

    @property
    def home_of_services(self) -> system.System | jaus.ServiceSet:
        """The system of the file, or its service set where it has no system."""
        return self._root(system.System) or self._root(jaus.ServiceSet) or self.system

    @property
    def system(self) -> system.System:
        """The system of the file."""
        found = self._root(system.System)
        if found is None:
            raise ProjectError(f"{self.place.file} has no system that could have new elements")
        return found

    def _root(self, kind: type[RootT]) -> RootT | None:
        read = self.project.model(self.place.file)
        if not can_be_parsed(self.place.file, self.project.text(self.place.file)):
            fault = read.diagnostics[0]
            raise ProjectError(f"{fault.location}: {fault.message}")
        roots = read.model.documents[0].roots
        return next((each for each in roots if isinstance(each, kind)), None)

    def forget(self) -> None:
        """Takes away the files that were made."""
        for each in self.made:
            each.unlink(missing_ok=True)


def opened(place: Place, *, is_of_services: bool = False) -> Opened:
    """Opens a model file; one that is missing is made, with an empty root of its name.

    Raises:
        OSError: The file cannot be read or written.
    """
    if place.path.exists():
        return Opened(place, Project(place.root))
    name = place.path.name.partition(".")[0]
    beside = "" if place.is_text else metamodels_for(place.path, place.root)
    text = empty_services(name, beside) if is_of_services else empty_xmi(name, beside)
    text = text_of(text, name) if place.is_text else text
    place.path.parent.mkdir(parents=True, exist_ok=True)
    replace_file(place.path, text.encode())
    return Opened(place, Project(place.root), (place.path,))


class ProjectError(Exception):
    """A project or an element of one cannot be made; the message says why."""


def as_xmi(name: str, metamodels: str) -> str:
    """Returns the example as XMI that Eclipse opens, below a folder beside the library."""
    path = library_root().parent / _EXAMPLE / f"{_EXAMPLE}.xmi"
    return with_schema_location(_named(path.read_text(encoding="utf-8"), name), metamodels)


def empty_xmi(name: str, metamodels: str) -> str:
    """Returns an empty system as XMI.

    Args:
        metamodels: Folder of the metamodels, relative to the model; empty where there is none.
    """
    return with_schema_location(_named(_EMPTY, name), metamodels)


def empty_services(name: str, metamodels: str) -> str:
    """Returns an empty service set as XMI."""
    named = _EMPTY_SET.replace('name="minimal"', f'name="{name}"')
    return with_schema_location(named, metamodels)


def empty_text(name: str) -> str:
    """Returns an empty system as ros2jaus text."""
    return text_of(empty_xmi(name, ""), name)


def text_of(xmi: str, name: str) -> str:
    """Returns a model as ros2jaus text."""
    with TemporaryDirectory(prefix="jausml-init-") as folder:
        path = Path(folder) / f"{name}.xmi"
        path.write_text(xmi.replace("../library/", LIBRARY_URI), encoding="utf-8")
        model = read_models([path]).model
        return to_text(model.documents[0].roots, model, path.with_suffix(".ros2jaus"))


def _named(xmi: str, name: str) -> str:
    own = f'xmi:id="{_EXAMPLE}" name="{_EXAMPLE}"'
    return xmi.replace(own, f'xmi:id="{name}" name="{name}"', 1)
