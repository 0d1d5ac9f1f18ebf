"""Renaming: what a text declares gets another name, wherever it is named."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import EditError, Rename
from jausml.authoring.editing.drafts import Draft
from jausml.authoring.editing.executing import execute
from jausml.authoring.editing.reading import Reader, can_be_parsed, stored
from jausml.authoring.editor.definition import declaration_at
from jausml.authoring.editor.positions import is_within, start_of
from jausml.authoring.editor.workbench import names_in
from jausml.language.model import refs
from jausml.language.model.library import library_root
from jausml.language.text.reading.document import TextDocument
from jausml.language.text.tree import Span

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.editor.names import Declaration
    from jausml.authoring.editor.positions import Place
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref


class RenameError(ValueError):
    """A name cannot be given."""


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of a text."""

    path: Path
    span: Span
    text: str


def renamed_span(bench: Workbench, path: Path, place: Place) -> Span | None:
    """Returns the name at a place that can be changed, None when there is none."""
    if declaration_at(bench, path, place) is None:
        return None
    names = names_in(bench.text(path))
    spans = [each.name.span for each in names.declarations]
    spans += [each.name.span for each in names.references]
    return next(each for each in spans if is_within(each, place))


def rename(bench: Workbench, path: Path, place: Place, name: str) -> list[Edit]:
    """Returns the changes that give an element another name, wherever a text names it.

    Args:
        name: The new name, without back quotes.

    Raises:
        RenameError: No text of the user declares what is at the place, the name is taken or empty,
            or a text that would change cannot be read.
    """
    found = declaration_at(bench, path, place)
    if found is None:
        raise RenameError("only what a text declares can be renamed here")
    home, declaration = found
    if home not in bench.texts and _is_shipped(home):
        raise RenameError(f"'{declaration.name.text}' belongs to the shipped library")
    if not name.strip() or any(not each.isprintable() for each in name):
        raise RenameError("a name has printable characters")
    _check_free(bench, home, declaration, name)
    texts = {each: bench.text(each) for each in bench.related(home) if not _is_shipped(each)}
    held = Unsaved({each: text.encode() for each, text in texts.items()})
    try:
        element = held.ref(home, partial(_declared, declaration=declaration))
        changes = held.rename(element, name)
    except EditError as error:
        raise RenameError(str(error)) from error
    return [_edit(file, texts[file], each) for file, made in changes.items() for each in made]


def _is_shipped(path: Path) -> bool:
    return path.is_relative_to(library_root().resolve())


def _declared(model: Model, declaration: Declaration) -> EObject | None:
    """Returns the element of a declaration in the model of its text."""
    document = model.documents[0]
    written = document.written
    pending = list(document.root_nodes)
    while pending and isinstance(written, TextDocument):
        node = pending.pop()
        pending += node.children
        source = written.source_of(node)
        is_there = source is not None and start_of(source.span) == start_of(declaration.item.span)
        if is_there and model.metamodels.class_of(node.obj) in declaration.table.subtypes:
            return cast("EObject", node.obj)
    return None


def _edit(path: Path, text: str, splice: Splice) -> Edit:
    data = text.encode()
    before = data[: splice.start].decode(), data[: splice.end].decode()
    (line, column), (end_line, end_column) = (
        (each.count("\n") + 1, len(each) - each.rfind("\n")) for each in before
    )
    return Edit(path, Span(line, column, end_line, end_column), splice.new.decode())


def _check_free(bench: Workbench, home: Path, declaration: Declaration, name: str) -> None:
    for other in names_in(bench.text(home)).declarations:
        is_beside = list(map(id, other.owners)) == list(map(id, declaration.owners))
        is_beside = is_beside and other.table is declaration.table
        if is_beside and other.name.text == name and other is not declaration:
            line = other.name.span.line
            raise RenameError(f"line {line} declares another element of the name '{name}'")


class Unsaved:
    """Some model files as somebody holds them.

    Args:
        contents: The files by real path. What they refer to besides is read where it is stored.
    """

    def __init__(self, contents: Mapping[Path, bytes]) -> None:
        self._root = Path(os.path.commonpath([each.parent for each in contents]))
        names = {path: path.relative_to(self._root).as_posix() for path in contents}
        self._names = names
        files = {name: stored(name, contents[path], 0) for path, name in names.items()}
        self._draft = Draft(self._root, files, Reader(self._root), 1)

    def ref(self, path: Path, find: Callable[[Model], EObject | None]) -> Ref:
        """Returns the ref of an element of a file, empty where there is none."""
        model = self._draft.read(self._names[path]).model
        return refs.ref_of(find(model), model, self._root)

    def rename(self, element: Ref, name: str) -> Mapping[Path, Sequence[Splice]]:
        """Returns what another name of an element changes in each file."""
        home, _ = refs.split(element)
        if not can_be_parsed(home, self._draft.files[home].data):
            raise EditError(f"{home} cannot be parsed as it is: fix it first")
        execute([Rename(element, name)], self._draft)
        changed = {each.file: each.steps for each in self._draft.changes()}
        return {
            path: [splice for step in changed[name] for splice in step]
            for path, name in self._names.items()
            if name in changed
        }
