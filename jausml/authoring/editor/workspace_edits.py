"""Workspace edits: what commands, quick fixes and new names change in texts of an editor."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, cast

from jausml.authoring.editing.commands import Command, EditError, Rename
from jausml.authoring.editing.drafts import Draft
from jausml.authoring.editing.executing import execute
from jausml.authoring.editing.reading import Reader, stored
from jausml.authoring.editing.splices import common_ends
from jausml.authoring.editor.definition import declaration_at
from jausml.authoring.editor.names import Declaration
from jausml.authoring.editor.places import Place, is_within, start_of
from jausml.authoring.editor.workbench import Workbench, checked, names_in
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.quick_fixes.fixes import quick_fixes
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import refs
from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.library import library_root
from jausml.language.model.model import Model
from jausml.language.model.reading.reader import ReadResult
from jausml.language.model.refs import Ref
from jausml.language.text.reading.document import TextDocument
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.tree import Href, Item, Name, Number, Span, Text


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of a text."""

    path: Path
    span: Span
    text: str


class Unsaved:
    """Texts as an editor holds them, unsaved.

    `texts`: the texts by real path. What they refer to besides is read where it is stored.
    """

    def __init__(self, texts: Mapping[Path, str]) -> None:
        self.root = Path(os.path.commonpath([text.parent for text in texts]))
        self._names = {path: path.relative_to(self.root).as_posix() for path in texts}
        self._texts = texts
        self._files = {
            name: stored(name, texts[path].encode(), 0) for path, name in self._names.items()
        }
        self._reader = Reader(self.root)

    def read(self, path: Path) -> ReadResult:
        """Returns the model of a text and all that it refers to."""
        return self._reader.read(self._names[path], self._files)

    def ref(self, path: Path, find: Callable[[Model], EObject | None]) -> Ref:
        """Returns the ref of an element of a text, empty where there is none."""
        model = self.read(path).model
        return refs.ref_of(find(model), model, self.root)

    def edits(self, commands: Sequence[Command]) -> list[Edit]:
        """Returns the edits of texts that commands lead to (`EditError`: none can be made)."""
        draft = Draft(self.root, self._files, self._reader, 1)
        execute(commands, draft)
        changed = {change.file for change in draft.changes()}
        return [
            edit
            for file, of_file in self._names.items()
            if of_file in changed
            for edit in self._edits(file, draft.files[of_file].data.decode())
        ]

    def _edits(self, path: Path, new: str) -> Iterator[Edit]:
        """Yields the changes of a text: of words where nothing else differs, as in a rename."""
        text = self._texts[path]
        words = changed_words(text, new)
        if words is not None:
            yield from (Edit(path, span, word) for span, word in words)
            return
        front, back = common_ends(text, new)
        (line, column), (end_line, end_column) = (
            (before.count("\n") + 1, len(before) - before.rfind("\n"))
            for before in (text[:front], text[: len(text) - back])
        )
        span = Span(line, column, end_line, end_column)
        yield Edit(path, span, new[front : len(new) - back])


_Words: TypeAlias = "list[tuple[Span, str]]"


def changed_words(old: str, new: str) -> _Words | None:
    """Returns the words that differ between two texts of one layout, with their places.

    Returns:
        None where more differs than words and layout.
    """
    lines = new.split("\n")
    words: _Words = []
    pending: list[tuple[Any, Any]] = [(parsed_text(old).document, parsed_text(new).document)]
    while pending:
        one, other = pending.pop()
        if type(one) is not type(other):
            return None
        if isinstance(one, Name | Number | Text | Href):
            if one.text != other.text:
                line, column, _, end = other.span
                words.append((one.span, lines[line - 1][column - 1 : end - 1]))
        elif isinstance(one, list | tuple):
            if len(one) != len(other):
                return None
            pending += zip(one, other, strict=True)
        elif is_dataclass(one):
            names = [field.name for field in fields(one) if field.name not in _LAYOUT]
            pending += ((getattr(one, name), getattr(other, name)) for name in names)
        elif one != other:
            return None
    return sorted(words)


_LAYOUT = frozenset({"span", "comments", "trailing", "spaced", "closing"})
"""The attributes of a syntax tree that have no meaning for the model."""


def unsaved(bench: Workbench, path: Path) -> Unsaved:
    """Returns a text, its project, the open ones and their imports, as an editor holds them."""
    return Unsaved({file: bench.text(file) for file in bench.related(path) if not is_shipped(file)})


def is_shipped(path: Path) -> bool:
    """Tells whether a file is one of the library, which nobody changes."""
    return path.is_relative_to(library_root().resolve())


@dataclass(frozen=True, slots=True)
class Fix:
    """An edit by which a finding goes away."""

    label: str
    finding: Diagnostic
    edits: list[Edit]


def fixes(bench: Workbench, path: Path, lines: range) -> Iterator[Fix]:
    """Yields the quick fixes of what is found in some lines of a text, counted from 1."""
    held = unsaved(bench, path)
    result = held.read(path)
    scope, shown = Scope(result.model, held.root), result.model.documents[0].display
    for finding in checked(result):
        if finding.location.path != shown or finding.location.line not in lines:
            continue
        for fix in quick_fixes(scope, finding):
            try:
                edits = held.edits(fix.commands)
            except EditError:
                continue
            yield Fix(fix.label, finding, edits)


class RenameError(ValueError):
    """A name cannot be given."""


def renamed_span(bench: Workbench, path: Path, place: Place) -> Span | None:
    """Returns the name at a place that can be changed, None when there is none."""
    if declaration_at(bench, path, place) is None:
        return None
    names = names_in(bench.text(path))
    spans = [declaration.name.span for declaration in names.declarations]
    spans += [reference.name.span for reference in names.references]
    return next(span for span in spans if is_within(span, place))


def rename(bench: Workbench, path: Path, place: Place, name: str) -> list[Edit]:
    """Returns the changes that give an element another name, wherever a text names it.

    `name`: the new name, without back quotes. `RenameError`: no text of the user declares what is
    at the place, the name is taken or empty, or a text that would change cannot be read.
    """
    declared = declaration_at(bench, path, place)
    if declared is None:
        raise RenameError("only what a text declares can be renamed here")
    home, declaration = declared
    if home not in bench.texts and is_shipped(home):
        raise RenameError(f"'{declaration.name.text}' belongs to the shipped library")
    if not name.strip() or any(not character.isprintable() for character in name):
        raise RenameError("a name has printable characters")
    _check_free(bench, home, declaration, name)
    held = unsaved(bench, home)
    try:
        element = held.ref(home, partial(_declared, declaration=declaration))
        return held.edits([Rename(element, name)])
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


def _spans(items: Iterable[Item]) -> list[Span]:
    return [item.span for item in items]


def _check_free(bench: Workbench, home: Path, declaration: Declaration, name: str) -> None:
    for other in names_in(bench.text(home)).declarations:
        is_beside = _spans(other.owners) == _spans(declaration.owners)
        is_beside &= other.table is declaration.table and other.item.span != declaration.item.span
        if is_beside and other.name.text == name:
            line = other.name.span.line
            raise RenameError(f"line {line} declares another element of the name '{name}'")
