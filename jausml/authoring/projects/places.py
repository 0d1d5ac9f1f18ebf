"""Where new elements go: a model file, and the project around it."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from jausml.authoring.editing.project import Project
from jausml.authoring.editing.reading import can_be_parsed
from jausml.authoring.projects.eclipse_xmi import metamodels_for
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.texts import empty_services, empty_xmi, text_of
from jausml.authoring.proposals.elements import Scope
from jausml.language.metamodel.classes import jaus, system
from jausml.language.model.files import replace_file
from jausml.language.model.library import SUFFIXES
from jausml.language.model.project import InputError, project_folder
from jausml.language.project import index_around
from jausml.language.semantics.names import system_name
from jausml.language.text.notation import SUFFIX

RootT = TypeVar("RootT", system.System, jaus.ServiceSet)


@dataclass(frozen=True)
class Place:
    """A model file that gets new elements.

    `root`: the folder of the project, links followed.
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

    `ProjectError`: no model can have that name.
    """
    if not path.name.endswith(SUFFIXES):
        raise ProjectError(f"{path} must end in {' or '.join(SUFFIXES)}")
    real = Path(os.path.realpath(path))
    root = project_folder(real) or real.parent
    return Place(root, real.relative_to(root).as_posix())


def system_in(folder: Path) -> Place:
    """Returns the place of the one model of a project that has a system.

    `ProjectError`: there is none, or more than one.
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
    created: tuple[Path, ...] = ()

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
        root = self._root(system.System)
        if root is None:
            raise ProjectError(f"{self.place.file} has no system that could have new elements")
        return root

    def _root(self, kind: type[RootT]) -> RootT | None:
        read = self.project.model(self.place.file)
        if not can_be_parsed(self.place.file, self.project.text(self.place.file)):
            fault = read.diagnostics[0]
            raise ProjectError(f"{fault.location}: {fault.message}")
        roots = read.model.documents[0].roots
        return next((root for root in roots if isinstance(root, kind)), None)

    def forget(self) -> None:
        """Takes away the files that were made."""
        for path in self.created:
            path.unlink(missing_ok=True)


def opened(place: Place, *, is_of_services: bool = False) -> Opened:
    """Opens a model file; one that is missing is made, with an empty root of its name.

    `OSError`: the file cannot be read or written.
    """
    if place.path.exists():
        return Opened(place, Project(place.root))
    name = system_name(place.path)
    beside = "" if place.is_text else metamodels_for(place.path, place.root)
    text = empty_services(name, beside) if is_of_services else empty_xmi(name, beside)
    text = text_of(text, name) if place.is_text else text
    place.path.parent.mkdir(parents=True, exist_ok=True)
    replace_file(place.path, text.encode())
    return Opened(place, Project(place.root), (place.path,))
