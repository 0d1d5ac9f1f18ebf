"""Renaming: what a text declares gets another name, wherever it is named."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.editor.definition import declaration_at, meant
from jausml.editor.positions import is_within
from jausml.editor.workbench import names_in
from jausml.model.uris import library_root
from jausml.text.writing.spelling import path as written_path
from jausml.text.writing.spelling import word as written_word

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jausml.editor.names import Declaration, Reference
    from jausml.editor.positions import Place
    from jausml.editor.workbench import Workbench
    from jausml.text.tree import Span


class RenameError(ValueError):
    """A name cannot be given."""


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of a text.

    Attributes:
        path: The file.
        span: What is replaced.
        text: What by.
    """

    path: Path
    span: Span
    text: str


def renamed_span(bench: Workbench, path: Path, place: Place) -> Span | None:
    """Returns the name at a place that can be changed, None when there is none.

    Args:
        bench: What is open.
        path: The file of the text.
        place: The place.
    """
    if declaration_at(bench, path, place) is None:
        return None
    names = names_in(bench.text(path))
    spans = [each.name.span for each in names.declarations]
    spans += [each.name.span for each in names.references]
    return next(each for each in spans if is_within(each, place))


def rename(bench: Workbench, path: Path, place: Place, name: str) -> list[Edit]:
    """Returns the changes that give an element another name.

    Args:
        bench: What is open.
        path: The file of the text.
        place: A place at the name of the element, or at a reference to it.
        name: The new name, without back quotes.

    Raises:
        RenameError: No text of the user declares what is at the place, or the name is taken or
            empty.
    """
    found = declaration_at(bench, path, place)
    if found is None:
        raise RenameError("only what a text declares can be renamed here")
    home, declaration = found
    if home not in bench.texts and home.is_relative_to(library_root().resolve()):
        raise RenameError(f"'{declaration.name.text}' belongs to the shipped library")
    if not name.strip() or any(not each.isprintable() for each in name):
        raise RenameError("a name has printable characters")
    _check_free(bench, home, declaration, name)
    edits = [Edit(home, declaration.name.span, written_word(name))]
    for file in bench.related(home):
        changes = list(_references(bench, file, home, declaration, name))
        if changes and file != home:
            _check_unhidden(bench, file, declaration, name)
        edits += changes
    return edits


def _check_free(bench: Workbench, home: Path, declaration: Declaration, name: str) -> None:
    for other in names_in(bench.text(home)).declarations:
        is_beside = list(map(id, other.owners)) == list(map(id, declaration.owners))
        is_beside = is_beside and other.table is declaration.table
        if is_beside and other.name.text == name and other is not declaration:
            line = other.name.span.line
            raise RenameError(f"line {line} declares another element of the name '{name}'")


def _check_unhidden(bench: Workbench, file: Path, declaration: Declaration, name: str) -> None:
    """Refuses a name that means something else in another text, where that text comes first."""
    for other in names_in(bench.text(file)).declarations:
        is_kin = bool(set(other.table.subtypes) & set(declaration.table.subtypes))
        if is_kin and other.name.text == name:
            place = f"{file.name}:{other.name.span.line}"
            raise RenameError(f"{place} declares another element of the name '{name}'")


def _references(
    bench: Workbench, file: Path, home: Path, declaration: Declaration, name: str
) -> Iterator[Edit]:
    """Yields the changes of the references in a text."""
    for reference in names_in(bench.text(file)).references:
        found = meant(bench, file, reference)
        if found is None or found[0] != home:
            continue
        text = _replaced(reference, found[1], declaration, name)
        if text is not None:
            yield Edit(file, reference.name.span, written_path(text))


def _replaced(
    reference: Reference, target: Declaration, declaration: Declaration, name: str
) -> str | None:
    """Returns a reference with the new name; None when the old one is no step of it."""
    old = declaration.name.text
    text = reference.name.text
    if target is declaration:
        if reference.is_first_step:
            return name + text[len(old) :]
        return text[: len(text) - len(old)] + name
    if declaration.item not in target.owners:
        return None
    # The element is an owner of what is meant: its name is one of the steps before.
    inner = target.path[len(declaration.path) :]
    rest = "." + ".".join(inner)
    before = text[: len(text) - len(rest)]
    if not text.endswith(rest) or not (before == old or before.endswith(f".{old}")):
        return None
    return before[: len(before) - len(old)] + name + rest
