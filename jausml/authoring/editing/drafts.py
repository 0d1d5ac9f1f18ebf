"""Drafts: the files of a project while commands are planned, and the context of planners."""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jausml.authoring.editing.applying import converted, feature_of
from jausml.authoring.editing.commands import Create, EditError, Values
from jausml.authoring.editing.layout import is_layout
from jausml.authoring.editing.reading import (
    Reader,
    can_be_parsed,
    digest,
    is_library,
    is_text,
    stored,
)
from jausml.authoring.editing.records import FileChange, Stored, data_of
from jausml.authoring.editing.working_copy import ElementCopy, WorkingCopy
from jausml.language.metamodel import (
    FeatureKind,
    Metamodels,
    load_metamodels,
)
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import fill, new_object
from jausml.language.model import refs
from jausml.language.model.documents import Document
from jausml.language.model.library import SUFFIXES
from jausml.language.model.model import Model
from jausml.language.model.project import is_model_file
from jausml.language.model.reading.reader import ReadResult
from jausml.language.model.refs import Ref
from jausml.language.model.values import suggest
from jausml.language.model.xmi.printing import UnwritableError
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.notation import SUFFIX
from jausml.language.text.writing.unparsing import to_text


class Draft:
    """The files of a project with changes that are not written yet."""

    def __init__(
        self, root: Path, files: Mapping[str, Stored], reader: Reader, revision: int
    ) -> None:
        self.root = root
        self.files = dict(files)
        self._before = files
        self._reader = reader
        self._revision = revision

    @property
    def models(self) -> list[str]:
        """The model files."""
        return [file for file in self.files if not is_layout(file)]

    def read(self, file: str) -> ReadResult:
        """Returns the model of a file and of all files that it refers to, with the changes."""
        return self._reader.read(file, self.files)

    def referring(self, file: str) -> list[str]:
        """Returns a file, and then those whose models have elements of it."""
        others = [
            other
            for other in self.models
            if other != file and _mentions(self.files[other].good, file)
        ]
        return [file, *(other for other in others if file in self.documents(other))]

    def documents(self, file: str) -> list[str]:
        """Returns the files of the project with elements in the model of a file."""
        return self._reader.documents(file, self.files)

    def editable(self, ref: Ref) -> str:
        """Returns the file of a ref (`EditError`: it cannot be edited)."""
        file, _ = refs.split(ref)
        if is_library(file):
            raise EditError(f"{ref} is part of the library, which cannot be changed")
        if file not in self.models:
            raise EditError(f"{file or ref!r} is no model file of the opened folder")
        self._check_parsed(file)
        return file

    def _check_parsed(self, file: str) -> None:
        """Raises EditError for a file of which an edit would lose what cannot be parsed."""
        held = self.files[file]
        if held.is_stale or not (held.is_printed or can_be_parsed(file, held.data)):
            raise EditError(f"{file} cannot be parsed as it is: fix it first", conflict=True)

    def element(self, ref: Ref) -> tuple[EObject, Model]:
        """Returns an element, and the model of its own file."""
        model = self.read(self.editable(ref)).model
        element = refs.find(ref, model, self.root)
        if element is None:
            raise EditError(f"there is no element {ref} any more", conflict=True)
        return element, model

    def locate(self, ref: Ref) -> tuple[EObject, Model]:
        """Returns an element, also of the library, and a model that has it."""
        file, _ = refs.split(ref)
        if is_library(file):
            model = self._reader.library(file)
        elif file in self.files:
            model = self.read(file).model
        else:
            raise EditError(f"{file or ref!r} is no model file of the opened folder")
        element = refs.find(ref, model, self.root)
        if element is None:
            raise EditError(f"there is no element {ref}", conflict=not is_library(file))
        return element, model

    def apply(self, file: str, data: bytes) -> None:
        """Sets the bytes of a file after commands (`EditError`: it cannot be edited)."""
        if data != self.files[file].data:
            self._check_parsed(file)
            # `check` tries whether it can be parsed.
            self.files[file] = Stored(
                file, data, digest(data), self._revision, data, self._revision, is_printed=True
            )

    def put(self, file: str, data: bytes | None) -> None:
        """Sets the bytes of a file, or makes it; None deletes it."""
        if data is None:
            self.files.pop(file, None)
        elif data != data_of(self.files.get(file)):
            self.files[file] = stored(file, data, self._revision, self._before.get(file))

    def check(self, file: str) -> None:
        """Raises EditError where a changed file cannot be parsed."""
        held = self.files[file]
        if held == self._before.get(file):
            return
        is_good = can_be_parsed(file, held.data) if is_text(file) else self._is_readable(file)
        if held.is_stale or not is_good:
            raise EditError(f"the edit would leave {file} in a state that cannot be read")

    def _is_readable(self, file: str) -> bool:
        return self.read(file).model.documents[0].readable

    def changes(self) -> tuple[FileChange, ...]:
        """Returns the changes so far, in the order of the files."""
        states = {
            file: (self._before.get(file), self.files.get(file))
            for file in sorted(self._before.keys() | self.files.keys())
        }
        return tuple(
            FileChange.between(file, before, after)
            for file, (before, after) in states.items()
            if data_of(before) != data_of(after)
        )


def _mentions(data: bytes, file: str) -> bool:
    """Tells whether a file may refer to another one, without parsing it.

    A reference has the name of the file at the end of a path or URI.
    """
    name = posixpath.basename(file)
    if quote(name) != name:
        return True  # it may be written in several ways
    # Every other byte of UTF-16 is 0.
    return name.encode("ascii") in data.replace(b"\0", b"")


def new_document(command: Create, draft: Draft) -> tuple[bytes, dict[str, Values]]:
    """Returns the bytes of a new file, and references of its root that are still to be set."""
    check_new_file(command.file, draft)
    metamodels = load_metamodels()
    root, later = _root(command, metamodels)
    write = to_text if command.file.endswith(SUFFIX) else to_xmi
    try:
        text = write([root], Model([], metamodels), draft.root / command.file)
    except UnwritableError as error:
        raise EditError(str(error)) from error
    return text.encode("utf-8"), later


def _root(command: Create, metamodels: Metamodels) -> tuple[Any, dict[str, Values]]:
    table = metamodels.classes.get(command.kind)
    if table is None or table.abstract:
        hint = suggest(command.kind, metamodels.classes)
        raise EditError(f"{command.kind} is no class that a file can have {hint}".strip())
    root = new_object(table)
    later: dict[str, Values] = {}
    for name, values in command.values.items():
        feature = feature_of(table, name)
        if feature.kind is FeatureKind.CROSS_REFERENCE:
            later[name] = tuple(values)
        elif feature.kind is FeatureKind.ATTRIBUTE:
            fill(root, feature, converted(tuple(values), feature))
        else:
            raise EditError(f"{name} of a new {table.name} owns elements: add them afterwards")
    return root, later


def check_new_file(file: str, draft: Draft) -> None:
    """Raises EditError where a model file cannot be made, or exists."""
    parts = file.split("/")
    is_plain = posixpath.normpath(file) == file and not file.startswith("/") and "\\" not in file
    if not is_plain or any(part.startswith(".") or "\0" in part for part in parts):
        raise EditError(f"{file!r} is no name of a file below the opened folder")
    if not file.endswith(SUFFIXES):
        raise EditError(f"{file} must end in {' or '.join(SUFFIXES)}")
    if not is_model_file(file, draft.root):
        raise EditError(f"{file} would not be among the models of the opened folder")
    if file in draft.files or (draft.root / file).exists():
        raise EditError(f"there is a {file} already")


@dataclass(frozen=True)
class Context:
    """The file for which changes are planned, and its model.

    In a file without elements of the commands, its references to these change. Elements that are
    removed along with another one are among the commands.

    Attributes:
        root: The opened folder, symbolic links followed.
        working_copy: The elements of all files concerned, after the commands.
        paths: The paths of copies of the working copy before the commands.
    """

    file: str
    root: Path
    model: Model
    working_copy: WorkingCopy
    paths: Mapping[ElementCopy, str]
    locate: Callable[[Ref], tuple[EObject, Model]]

    @property
    def document(self) -> Document:
        """The document of the file."""
        return self.model.documents[0]

    def find(self, ref: Ref) -> EObject | None:
        """Returns the element of a ref, None where the model has none."""
        return refs.find(ref, self.model, self.root)

    def ref(self, copy: ElementCopy) -> Ref:
        """Returns the ref of an element as it was read."""
        return f"{copy.file}#{self.working_copy.identifiers.get(copy) or self.paths[copy]}"

    def is_own(self, obj: EObject | None) -> bool:
        """Tells whether an element stands in the file."""
        return self.model.document_of(obj) is self.document
