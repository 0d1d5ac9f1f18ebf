"""The generated interface of a workspace, as a run leaves it or as it was before."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from jausml.generation.artifact import Artifact, Kind
from jausml.generation.contract.renames import renames
from jausml.generation.contract.symbols import UNKNOWN, Class, Module, Modules, Unknown
from jausml.language.model.inputs import read_input

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from jausml.generation.manifest import Manifest

_FEWEST_PARTS = 3  # package folder, package, module


class Interface:
    """The modules that code of users may import, those of this run from memory.

    Args:
        artifacts: The files of this run; without any, the interface is that on the disk.
        deleted: Paths that are there and will not be.
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
        self._texts = {a.path: a.text for a in artifacts if a.kind is Kind.GENERATED}
        self._shared = {a.path for a in artifacts if a.is_shared}
        known = {path for path, entry in manifest.files.items() if entry.kind is Kind.GENERATED}
        self._generated = known | self._texts.keys()
        live = self._generated - deleted
        self._live = {_package(path) for path in live if path.endswith(".py")}
        packages = {_package(path) for path in {*manifest.files, *live} if path.endswith(".py")}
        self._words = {each.encode() for each in packages if each}
        self.modules = Modules(self.read, packages - {""}, self.is_generated)

    def is_generated(self, path: str) -> bool:
        """Whether a file is none of the user."""
        return path in self._generated

    def is_inside(self, path: str) -> bool:
        """Whether a file is in a package of the interface."""
        return _package(path) in self.modules.packages

    def changed_from(self, before: Interface) -> list[str]:
        """Returns the modules of a model whose text was another."""
        return [
            module_of(path)
            for path, text in self._texts.items()
            if path not in self._shared
            and module_of(path)
            and path.endswith(".py")
            and before.read(path) not in (None, UNKNOWN, text, text.encode())
        ]

    def concerns(self, path: str, data: bytes) -> bool:
        """Whether a file may import from the interface; not one that the model left behind."""
        if self.is_inside(path):
            return _package(path) in self._live
        return any(word in data for word in self._words)

    def read(self, path: str) -> str | bytes | Unknown | None:
        """Returns the text of a path; None for none, UNKNOWN for what is there and is no text."""
        if path in self._texts or path in self._deleted:
            return self._texts.get(path)
        place = self._out / path
        try:
            if not path.endswith(".py"):
                return UNKNOWN if self._is_otherwise(place) else None
            return read_input(place) if place.is_file() else None
        except OSError:
            return UNKNOWN

    def _is_otherwise(self, place: Path) -> bool:
        """Whether something else than text of Python can be imported from a place."""
        if any(each.suffix in (".so", ".pyd") for each in place.parent.glob(f"{place.name}.*")):
            return True
        inside = (each.relative_to(self._out).as_posix() for each in place.rglob("*.py"))
        return any(each not in self._deleted for each in inside)


def former_names(before: Interface, after: Interface, known: object = None) -> dict[str, str]:
    """Returns the names that an interface had and has no more, with what each is called now.

    Args:
        known: Those of earlier runs.
    """
    new = renames(before.modules, after.modules, after.changed_from(before))
    former = {**_strings(known), **new}
    followed = {
        name: new.get(f"{name.rpartition('.')[0]}.{successor}", successor)
        for name, successor in former.items()
    }
    return {name: each for name, each in followed.items() if not _has(after.modules, name)}


def _strings(known: object) -> Mapping[str, str]:
    """Returns what the manifest knows, which anybody may have edited."""
    pairs = known.items() if isinstance(known, dict) else ()
    return {k: v for k, v in pairs if isinstance(k, str) and isinstance(v, str)}


def _has(modules: Modules, dotted: str) -> bool:
    """Tells whether there is a name inside a module, or inside a class of it."""
    parts = dotted.split(".")
    for count in range(len(parts) - 1, 0, -1):
        found: object = modules.find(".".join(parts[:count]))
        if isinstance(found, Module):
            for name in parts[count:]:
                if isinstance(found, Module):
                    found = modules.member(found, name)
                elif isinstance(found, Class):
                    found = modules.members(found).get(name)
                else:
                    return False
            return found is not None
    return False


def _package(path: str) -> str:
    return module_of(path).partition(".")[0]


def module_of(path: str) -> str:
    """Returns the dotted name of a module, or nothing for what is outside of a package.

    Args:
        path: Path of the file in the workspace, e.g. `vehicle/vehicle/main.py`.
    """
    parts = PurePosixPath(path).with_suffix("").parts
    if len(parts) < _FEWEST_PARTS or parts[0] != parts[1]:
        return ""
    return ".".join(parts[1:]).removesuffix(".__init__")
