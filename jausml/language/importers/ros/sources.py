"""Definition files of packages: installed ones, folders and single files."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.interfaces.parsing import PARTS, definition_files
from jausml.language.model.inputs import read_input
from jausml.language.model.xmi.parsing import parse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

SUFFIXES = tuple(f".{kind}" for kind in PARTS)
"""Endings of the names of definition files."""


@dataclass(frozen=True, slots=True)
class InterfaceFile:
    """A definition file."""

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
        idl: Interfaces that it defines in IDL alone, as the paths of their files.
    """

    name: str
    files: list[InterfaceFile] = field(default_factory=list)
    idl: list[str] = field(default_factory=list)


def package_sources(paths: Iterable[str]) -> list[PackageSource]:
    """Returns the packages that files and folders belong to, in the order of first mention.

    A package is named by the package.xml beside its folders `msg`, `srv` and `action`, else by the
    folder that holds these.

    Args:
        paths: Definition files, folders of packages, and folders with such folders below them.
    """
    packages: dict[str, PackageSource] = {}
    seen: set[str] = set()
    for folder, files in (found for path in paths for found in _found(Path(path))):
        name = _package_name(folder)
        package = packages.setdefault(name, PackageSource(name))
        package.files += [load(each) for each in files if not _is_known(each, seen)]
        package.idl += [each for each in _idl_alone(folder) if each not in package.idl]
    return list(packages.values())


def installed_source(name: str, folder: Path) -> PackageSource:
    """Returns an installed package."""
    return PackageSource(
        name, [load(each) for each in definition_files(folder)], _idl_alone(folder)
    )


def load(path: Path) -> InterfaceFile:
    """Reads a definition file."""
    try:
        return InterfaceFile(str(path), read_input(path))
    except OSError as error:
        return InterfaceFile(str(path), None, error.strerror or str(error))


def _found(path: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Yields folders of packages, each with its files that a path means."""
    if not path.is_dir():
        yield _package_folder(path), [path]
        return
    direct = sorted(each for each in path.iterdir() if each.suffix in SUFFIXES and each.is_file())
    if direct:
        yield _package_folder(direct[0]), direct
    for folder in _package_folders(path):
        yield folder, definition_files(folder)


def _package_folders(path: Path) -> list[Path]:
    """Returns a folder that holds the folders of a package, else those below it that do."""
    if any((path / kind).is_dir() for kind in PARTS):
        return [path]
    found: list[Path] = []
    for folder, names, _ in os.walk(path):
        names[:] = sorted(name for name in names if not name.startswith("."))
        if any(name in PARTS for name in names) and definition_files(Path(folder)):
            found.append(Path(folder))
            names.clear()
    return found


def _package_folder(path: Path) -> Path:
    folder = path.parent.resolve()
    return folder.parent if folder.name in PARTS else folder


def _package_name(folder: Path) -> str:
    manifest = folder / "package.xml"
    root = parse(read_input(manifest)).root if manifest.is_file() else None
    children = root.children if root is not None else []
    stated = [child.text.strip() for child in children if child.tag == "name"]
    return stated[0] if stated and stated[0] else folder.resolve().name


def _is_known(path: Path, seen: set[str]) -> bool:
    real = os.path.realpath(path)
    is_known = real in seen
    seen.add(real)
    return is_known


def _idl_alone(folder: Path) -> list[str]:
    """Returns the IDL files of a package from which no definition file makes the interface."""
    made = {(path.parent.name, path.stem) for path in definition_files(folder)}
    found = (path for kind in PARTS for path in sorted((folder / kind).glob("*.idl")))
    return [str(path) for path in found if (path.parent.name, path.stem) not in made]
