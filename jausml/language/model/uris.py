"""Targets of hrefs: files under the project root and models of the shipped library.

EMF resolves relative hrefs against the file in which they stand, and percent-decodes them. Here
nothing leads to the network, and nothing out of the project unless allowed. Eclipse projects are
folders with a file `.project`, which tells their name.
"""

from __future__ import annotations

import os
import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote, urlsplit

from jausml.language.model.diagnostics import ReadFault
from jausml.language.model.documents import Document
from jausml.language.model.files import open_input
from jausml.language.model.library import (
    LIBRARY_URI,
    XMI,
    library_paths,
    library_root,
    place_in_library,
    shipped_as,
)
from jausml.language.model.project import MARKER, enclosing_project
from jausml.language.model.values import suggest
from jausml.language.model.xmi.parsing import parse

_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):")
_WINDOWS = re.compile(r"[A-Za-z]:[\\/]|.*\\")
_PLATFORM = "platform:/resource/"


@dataclass(frozen=True, slots=True)
class FileTarget:
    """A file that an href names, and how messages name it."""

    path: Path
    display: str
    is_library: bool


class UriResolver:
    """Resolves the URIs of hrefs, without their fragments.

    Args:
        projects: Folders of Eclipse projects by name, for platform:/resource/ URIs. Projects in the
            root, and beside the one that holds a document, are found by themselves.
    """

    def __init__(
        self, project_root: Path, *, allow_outside: bool, projects: Mapping[str, Path]
    ) -> None:
        self._root = Path(os.path.realpath(project_root))
        self._allow_outside = allow_outside
        self._projects = projects
        self._library = Path(os.path.realpath(library_root()))
        self._known: set[Path] = set()
        self._around: dict[Path, dict[str, Path]] = {}

    def target_of(self, path: str, contents: Container[Path] = ()) -> FileTarget:
        """Returns the target for a file that the user named; hrefs may then lead to it.

        Args:
            contents: Files that an editor holds, by real path: what is stored says nothing of them.
        """
        real = Path(os.path.realpath(path))
        self._known.add(real)
        if real.is_relative_to(self._library):
            return FileTarget(real, path, is_library=True)
        shipped = shipped_as(real) if real not in contents else None
        return FileTarget(shipped or real, path, is_library=shipped is not None)

    def resolve(self, uri: str, base: Document) -> FileTarget | ReadFault:
        """Resolves the URI of an href.

        Returns:
            The file, which need not exist, or the reason why the URI names none.
        """
        if "\0" in unquote(uri):
            return ReadFault("JML211", "the href has a NUL character")
        if uri.startswith(LIBRARY_URI):
            return self._in_library(unquote(uri[len(LIBRARY_URI) :]))
        if _WINDOWS.match(uri):
            return ReadFault(
                "JML211",
                f"'{uri}' is a Windows path, not a URI",
                "write a relative path with forward slashes",
            )
        scheme = _SCHEME.match(uri)
        if scheme is None:
            return self._file(unquote(uri), base)
        return self._with_scheme(scheme.group(1).lower(), uri, base)

    def _with_scheme(self, scheme: str, uri: str, base: Document) -> FileTarget | ReadFault:
        if scheme in ("http", "https", "ftp"):
            return ReadFault(
                "JML208",
                f"'{uri}' is not fetched from the network",
                "refer to a local file by a relative path",
            )
        if scheme == "file":
            try:
                parts = urlsplit(uri)
            except ValueError:
                return ReadFault("JML211", f"'{uri}' is not a URI")
            if parts.netloc not in ("", "localhost"):
                return ReadFault("JML208", f"'{uri}' names a file of another machine")
            return self._file(unquote(parts.path), base)
        if uri.startswith(_PLATFORM):
            return self._in_workspace(unquote(uri[len(_PLATFORM) :]), base)
        # What is of the workspace is followed; what is of a plug-in is not.
        kind = "/".join(uri.split("/")[:2]) if scheme == "platform" else scheme
        return ReadFault(
            "JML211",
            f"'{uri}' is of the unsupported scheme '{kind}'",
            "refer to a file by a relative path, or by platform:/resource/<project>/",
        )

    def _file(self, path: str, base: Document) -> FileTarget | ReadFault:
        # Not by pathlib: `a/../b` must lose its dots before symbolic links are followed.
        display = os.path.normpath(Path(base.display).parent / path)
        return self._checked(display, path, base)

    def _checked(self, display: str, written: str, base: Document) -> FileTarget | ReadFault:
        real = Path(os.path.realpath(display))
        if real.is_relative_to(self._library):
            return FileTarget(real, display, is_library=True)
        allowed = self._allow_outside or real in self._known or real.is_relative_to(self._root)
        if not (allowed or any(map(real.is_relative_to, self._projects_of(base).values()))):
            return ReadFault(
                "JML209",
                f"'{written}' lies outside the project root {self._root}",
                "name another one by --project-root, or use --allow-outside",
            )
        # A copy of the library in a project is the library.
        shipped = shipped_as(real)
        if shipped is not None:
            return FileTarget(shipped, display, is_library=True)
        return FileTarget(real, display, is_library=False)

    def _projects_of(self, base: Document) -> dict[str, Path]:
        """The Eclipse projects that a document may refer to, by name."""
        document = Path(os.path.realpath(base.display))
        if document.parent not in self._around:
            named_projects = {
                name: Path(os.path.realpath(path)) for name, path in self._projects.items()
            }
            projects = {**projects_around(document), **projects_in(self._root), **named_projects}
            self._around[document.parent] = projects
        return self._around[document.parent]

    def _in_workspace(self, path: str, base: Document) -> FileTarget | ReadFault:
        """Finds a file of an Eclipse project, or of a folder of the root that has its name."""
        project, _, rest = path.partition("/")
        projects = self._projects_of(base)
        if project in projects:
            folder = projects[project]
        elif os.path.isdir(self._root / project):  # noqa: PTH112 -- as below
            folder = self._root / project
        elif self._root.name == project:
            folder = self._root
        else:
            return ReadFault(
                "JML210",
                f"no Eclipse project '{project}' is known",
                f"say where it is by --project {project}=FOLDER",
            )
        return self._file(os.path.relpath(folder / rest, Path(base.display).parent), base)

    def _in_library(self, path: str) -> FileTarget | ReadFault:
        real = Path(os.path.realpath(self._library / path))
        if real.is_relative_to(self._library) and os.path.isfile(real):  # noqa: PTH113 -- as above
            return FileTarget(real, _shown(real), is_library=True)
        known = map(place_in_library, library_paths(suffixes=(XMI,)))
        return ReadFault("JML212", f"the library has no model '{path}'", suggest(path, known))


def _shown(path: Path) -> str:
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


_LONGEST_FILE = 1_000_000
_MOST_FOLDERS = 10_000


def projects_around(path: Path) -> dict[str, Path]:
    """Returns the project that holds a file, and those beside it, by name."""
    project = enclosing_project(path)
    return {} if project is None else projects_in(project.parent)


def projects_in(folder: Path) -> dict[str, Path]:
    """Returns the projects among the folders of a folder, and the folder itself, by name.

    A name is that which the file says; it may differ from that of the folder.
    """
    projects: dict[str, Path] = {}
    for path in (folder, *_folders(folder)):
        name = _name_of(path)
        if name:
            projects.setdefault(name, path)
    return projects


def _folders(folder: Path) -> Iterator[Path]:
    try:
        with os.scandir(folder) as entries:
            names = sorted(entry.name for entry in entries if entry.is_dir())
    except OSError:
        return
    for name in names[:_MOST_FOLDERS]:
        yield folder / name


def _name_of(folder: Path) -> str:
    """The name of a project; empty for a folder that is none, or whose file cannot be read."""
    try:
        with open_input(folder / MARKER) as file:
            data = file.read(_LONGEST_FILE)
    except OSError:
        return ""
    root = parse(data).root
    if root is None or root.tag != "projectDescription":
        return ""
    return next((child.text.strip() for child in root.children if child.tag == "name"), "")
