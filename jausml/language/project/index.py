"""The index of a project: its files, their models, and what has a name in them.

Whoever looks for an element finds it in one order: in the file that asks and what it refers to, in
the other files of the project, in the library.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from jausml.language.model.inputs import read_input
from jausml.language.model.project import InputError, made_project, model_files, project_folder
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.refs import file_of
from jausml.language.text.notation import NOTATIONS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.notation import Notation

ElementT = TypeVar("ElementT", bound="EObject")

_KEPT = 2
_FEW = 5
_SYSTEM = re.compile(rb"<\w+:System\b|^\s*(?:system|bridge|component|node)\s+[\w`]", re.MULTILINE)
"""What a file with a system has, in either notation; a text need not name its system."""

_MESSAGES = re.compile(rb"ServiceSet\b|serviceSets\b|\bservice\b|\bservice_set\b|^\s*JAUS\s")
"""What a file with messages of its own has."""


@dataclass(frozen=True, slots=True)
class _Kept:
    """A model that was read, and of what."""

    result: ReadResult
    files: tuple[str, ...]
    contents: Mapping[str, bytes]
    names: frozenset[str]

    def is_of(self, files: tuple[str, ...], contents: Mapping[str, bytes]) -> bool:
        """Tells whether it is what would be read of files now."""
        is_same = self.files == files and self.names == contents.keys()
        return is_same and all(contents[each] == data for each, data in self.contents.items())


class Models:
    """Models of the files of a project; one is read again when what it was read of has changed.

    Args:
        root: The folder that files are relative to, links followed.
    """

    def __init__(self, root: Path, notations: Sequence[Notation] = NOTATIONS) -> None:
        self._root = root
        self._notations = notations
        self._kept: dict[str, list[_Kept]] = {}
        self._cache = LibraryCache()

    def read(self, files: tuple[str, ...], contents: Mapping[str, bytes]) -> ReadResult:
        """Returns the model of files and of all that they refer to.

        Args:
            contents: What the files of the project hold, by their paths.
        """
        # Of models of several files few are kept, whichever these are.
        kept = self._kept.setdefault(files[0] if len(files) == 1 else "", [])
        found = next((each for each in kept if each.is_of(files, contents)), None)
        if found is not None:
            return found.result
        result = read_models(
            [self._root / each for each in files],
            project_root=self._root,
            notations=self._notations,
            contents={self._root / each: data for each, data in contents.items()},
            cache=self._cache,
        )
        held = {file_of(each, self._root) for each in result.model.documents} & contents.keys()
        said = {each: contents[each] for each in held}
        kept.insert(0, _Kept(result, files, said, frozenset(contents)))
        del kept[_KEPT:]
        return result


class Index:
    """The files of a project, and the models of them.

    Args:
        root: The folder of the project, links followed.
        contents: What its model files hold, by their paths relative to it; None for what is
            stored.
        models: Where models are kept that were read before.
    """

    def __init__(
        self,
        root: Path,
        contents: Mapping[str, bytes] | None = None,
        models: Models | None = None,
    ) -> None:
        self.root = root
        self.contents = stored_files(root) if contents is None else contents
        self._models = models or Models(root)

    @classmethod
    def here(cls) -> Index | None:
        """Returns that of the project of the current folder, None where `init` has made none."""
        root = made_project(Path.cwd())
        return None if root is None else cls(root)

    def model(self, file: str) -> Model:
        """Returns the model of a file and of all that it refers to."""
        return self._models.read((file,), self.contents).model

    def whole(self) -> Model:
        """Returns the model of all files."""
        return self._models.read(tuple(sorted(self.contents)), self.contents).model

    def beside(self, file: str) -> Model:
        """Returns the model of the files that a file does not refer to, and of what these do."""
        used = {file_of(each, self.root) for each in self.model(file).documents}
        others = tuple(each for each in sorted(self.contents) if each not in used)
        return self._models.read(others, self.contents).model

    @cached_property
    def files_with_messages(self) -> tuple[Path, ...]:
        """The files that define messages."""
        return self._files_with(_MESSAGES)

    @cached_property
    def files_with_systems(self) -> tuple[Path, ...]:
        """The files that have a system."""
        return self._files_with(_SYSTEM)

    def only_system(self, option: str = "") -> Path:
        """Returns the one file that has a system.

        Args:
            option: The option by which a user names one.

        Raises:
            InputError: There is none, or more than one.
        """
        found = self.files_with_systems
        choice = f"name one by {option}" if option else "name one"
        if not found:
            raise InputError(
                f"no model in {self.root} has a system: {choice}, or make a project by jausml init"
            )
        if len(found) > 1:
            names = ", ".join(str(each.relative_to(self.root)) for each in found[:_FEW])
            raise InputError(f"several models have a system: {choice} ({names})")
        return found[0]

    def _files_with(self, pattern: re.Pattern[bytes]) -> tuple[Path, ...]:
        # Every other byte of UTF-16 is nought.
        held = ((file, data.replace(b"\0", b"")) for file, data in sorted(self.contents.items()))
        return tuple(self.root / file for file, data in held if pattern.search(data))


def index_around(folder: Path) -> Index:
    """Returns the index of the project that a folder is in, or of the folder where it is in none.

    Args:
        folder: The folder, links followed.
    """
    return Index(project_folder(folder / "any") or folder)


def own_instances(models: Iterable[Model], kind: type[ElementT]) -> list[ElementT]:
    """Returns the elements of a class in models of one project, in order.

    Each file counts once: models that were read apart have elements of their own for it.
    """
    found: list[ElementT] = []
    seen: set[Path] = set()
    for model in models:
        new = {each.path for each in model.documents if not each.is_library} - seen
        of_model = (
            (each, model.document_of(each)) for each in model.instances(kind, library=False)
        )
        found += [each for each, place in of_model if place is not None and place.path in new]
        seen |= new
    return found


def stored_files(root: Path) -> dict[str, bytes]:
    """Returns what the model files of a project hold; one that cannot be read is left out."""
    found = {}
    for file in model_files(root):
        try:
            found[file] = read_input(root / file)
        except OSError:
            continue
    return found
