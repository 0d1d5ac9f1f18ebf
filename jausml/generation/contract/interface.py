"""The generated Python modules of a workspace that code of users may import."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from jausml.generation.artifact import Artifact, Kind
from jausml.generation.contract.symbols import UNKNOWN, Modules, Unknown
from jausml.generation.manifest import Manifest
from jausml.language.model.files import read_input

_FEWEST_PARTS = 3  # package folder, package, module


class Interface:
    """The modules that code of users may import, those of this run from memory.

    Args:
        artifacts: The files of this run; without any, the interface is that on the disk.
    """

    def __init__(
        self,
        artifacts: Sequence[Artifact],
        out: Path,
        manifest: Manifest,
        deleted: frozenset[str] = frozenset(),
    ) -> None:
        self._out = out
        self._deleted = deleted
        self._texts = {
            artifact.path: artifact.text
            for artifact in artifacts
            if artifact.kind is Kind.GENERATED
        }
        self._shared = {artifact.path for artifact in artifacts if artifact.is_shared}
        listed = {path for path, entry in manifest.files.items() if entry.kind is Kind.GENERATED}
        self._generated = listed | self._texts.keys()
        live = self._generated - deleted
        self._live_packages = {_package(path) for path in live if path.endswith(".py")}
        packages = {_package(path) for path in {*manifest.files, *live} if path.endswith(".py")}
        self._package_names = {package.encode() for package in packages if package}
        self.modules = Modules(self.read, packages - {""}, self.is_generated)

    def is_generated(self, path: str) -> bool:
        """Whether jausml generates a file, in this run or an earlier one."""
        return path in self._generated

    def is_inside(self, path: str) -> bool:
        """Whether a file is in a package of the interface."""
        return _package(path) in self.modules.packages

    def changed_modules(self, before: Interface) -> list[str]:
        """Returns the modules of the model, without shared ones, whose text was another before."""
        return [
            module
            for path, text in self._texts.items()
            if path.endswith(".py")
            and path not in self._shared
            and (module := module_of(path))
            and before.read(path) not in (None, UNKNOWN, text, text.encode())
        ]

    def may_import(self, path: str, data: bytes) -> bool:
        """Whether a file may import from the interface; not one that the model left behind."""
        if self.is_inside(path):
            return _package(path) in self._live_packages
        return any(name in data for name in self._package_names)

    def read(self, path: str) -> str | bytes | Unknown | None:
        """Returns the text of a path; None for none, UNKNOWN for what is there and is no text."""
        if path in self._texts or path in self._deleted:
            return self._texts.get(path)
        place = self._out / path
        try:
            if not path.endswith(".py"):
                return UNKNOWN if self._is_importable_otherwise(place) else None
            return read_input(place) if place.is_file() else None
        except OSError:
            return UNKNOWN

    def _is_importable_otherwise(self, place: Path) -> bool:
        """Whether a library or another non-Python module can be imported from a place."""
        if any(path.suffix in (".so", ".pyd") for path in place.parent.glob(f"{place.name}.*")):
            return True
        inside = (path.relative_to(self._out).as_posix() for path in place.rglob("*.py"))
        return any(relative_path not in self._deleted for relative_path in inside)


def _package(path: str) -> str:
    return module_of(path).partition(".")[0]


def module_of(path: str) -> str:
    """Returns the dotted name of a module, empty for a file outside of a package."""
    parts = PurePosixPath(path).with_suffix("").parts
    if len(parts) < _FEWEST_PARTS or parts[0] != parts[1]:
        return ""
    return ".".join(parts[1:]).removesuffix(".__init__")
