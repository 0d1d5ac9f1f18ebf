"""Renaming: what a text declares gets another name, wherever it is named."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import EditError, Rename
from jausml.authoring.editor.definition import declaration_at
from jausml.authoring.editor.positions import is_within, start_of
from jausml.authoring.editor.unsaved import is_shipped, unsaved
from jausml.authoring.editor.workbench import names_in
from jausml.language.text.reading.document import TextDocument

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.authoring.editor.names import Declaration
    from jausml.authoring.editor.positions import Place
    from jausml.authoring.editor.unsaved import Edit
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.text.tree import Span


class RenameError(ValueError):
    """A name cannot be given."""


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
    if home not in bench.texts and is_shipped(home):
        raise RenameError(f"'{declaration.name.text}' belongs to the shipped library")
    if not name.strip() or any(not each.isprintable() for each in name):
        raise RenameError("a name has printable characters")
    _check_free(bench, home, declaration, name)
    held = unsaved(bench, home)
    try:
        element = held.ref(home, partial(_declared, declaration=declaration))
        return held.edits(home, [Rename(element, name)])
    except EditError as error:
        raise RenameError(str(error)) from error


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


def _check_free(bench: Workbench, home: Path, declaration: Declaration, name: str) -> None:
    for other in names_in(bench.text(home)).declarations:
        is_beside = list(map(id, other.owners)) == list(map(id, declaration.owners))
        is_beside = is_beside and other.table is declaration.table
        if is_beside and other.name.text == name and other is not declaration:
            line = other.name.span.line
            raise RenameError(f"line {line} declares another element of the name '{name}'")
