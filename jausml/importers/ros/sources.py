"""Finds the definition files of packages: installed ones, folders and single files."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.interfaces.installed import definition_files
from jausml.interfaces.parsing import PARTS
from jausml.model.parsing import parse

if TYPE_CHECKING:
    from collections.abc import Iterable

SUFFIXES = tuple(f".{kind}" for kind in PARTS)
"""Endings of the names of definition files."""


@dataclass(frozen=True, slots=True)
class Source:
    """A definition file.

    Attributes:
        path: Its name in messages.
        data: Its bytes; None when it cannot be read.
        fault: Why it cannot be read.
    """

    path: str
    data: bytes | None
    fault: str = ""

    @property
    def name(self) -> str:
        """Name of the interface."""
        return Path(self.path).stem

    @property
    def kind(self) -> str:
        """`msg`, `srv` or `action`."""
        return Path(self.path).suffix[1:]


@dataclass(slots=True)
class PackageSource:
    """A package whose interfaces are imported.

    Attributes:
        name: Its name.
        files: Its definition files.
        idl: Interfaces that it defines in IDL alone, as the paths of their files.
    """

    name: str
    files: list[Source] = field(default_factory=list)
    idl: list[str] = field(default_factory=list)


def package_sources(paths: Iterable[str]) -> list[PackageSource]:
    """Returns the packages that files and folders belong to, in the order of first mention.

    A package is named by the package.xml nearest above its files, else by the folder that holds
    its folders `msg`, `srv` and `action`.

    Args:
        paths: Definition files, and folders of packages.
    """
    packages: dict[str, PackageSource] = {}
    seen: set[str] = set()
    for path in paths:
        place = Path(path)
        folder = place if place.is_dir() else _package_folder(place)
        name = _package_name(folder)
        package = packages.setdefault(name, PackageSource(name))
        files = definition_files(place) if place.is_dir() else [place]
        package.files += [load(each) for each in files if not _is_known(each, seen)]
        if place.is_dir():
            package.idl += _idl_alone(place, files)
    return list(packages.values())


def load(path: Path) -> Source:
    """Reads a definition file.

    Args:
        path: The file.
    """
    try:
        return Source(str(path), path.read_bytes())
    except OSError as error:
        return Source(str(path), None, error.strerror or str(error))


def _is_known(path: Path, seen: set[str]) -> bool:
    real = os.path.realpath(path)
    is_known = real in seen
    seen.add(real)
    return is_known


def _package_folder(path: Path) -> Path:
    folder = path.parent
    return folder.parent if folder.name in PARTS or folder.resolve().name in PARTS else folder


def _package_name(folder: Path) -> str:
    resolved = folder.resolve()
    manifest = resolved / "package.xml"
    if manifest.is_file():
        root = parse(manifest.read_bytes()).root
        names = (
            [child.text.strip() for child in root.children if child.tag == "name"] if root else []
        )
        if names and names[0]:
            return names[0]
    return resolved.name


def _idl_alone(folder: Path, files: list[Path]) -> list[str]:
    """Returns the IDL files of a package from which no definition file makes the interface."""
    made = {(path.parent.name, path.stem) for path in files}
    found = (path for kind in PARTS for path in sorted((folder / kind).glob("*.idl")))
    return [str(path) for path in found if (path.parent.name, path.stem) not in made]
