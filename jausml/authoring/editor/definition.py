"""Where the name at a place is declared, and the outline of what a text declares."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.authoring.editor.context import Part, context_at
from jausml.authoring.editor.names import Declaration, find
from jausml.authoring.editor.paths import sides_at
from jausml.authoring.editor.positions import Place, is_within
from jausml.authoring.editor.workbench import imported_file, names_in, pieces_parsed
from jausml.language.text.reading.shaping import span_of, word_text
from jausml.language.text.tree import Import, Span, snake_case

if TYPE_CHECKING:
    from pathlib import Path

    from lark import Token

    from jausml.authoring.editor.names import Reference
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.text.tree import Item


_WORDS = {"WORD", "INDEXED"}

_PUNCTUATION = {
    *("LBRACE", "RBRACE", "LPAR", "RPAR", "LSQB", "END_BRACKET", "NAMED_BRACKET", "COMMA"),
    *("COLON", "SEMICOLON", "ARROW", "PAIR", "GIVES", "AT_MOST", "EQUAL", "TILDE"),
}


@dataclass(frozen=True, slots=True)
class Definition:
    """The place where a name is given."""

    path: Path
    span: Span


def word_at(text: str, place: Place) -> Token | None:
    """Returns the word or text at a place; the place behind its last character counts."""
    found = [each for each in pieces_parsed(text).tokens if is_within(span_of(each), place)]
    return next((each for each in found if each.type not in _PUNCTUATION), None)


def define(bench: Workbench, path: Path, place: Place) -> Definition | None:
    """Returns where the name at a place is given."""
    text = bench.text(path)
    imported = _imported(bench, path, place)
    if imported is not None:
        return imported
    declared = declaration_at(bench, path, place)
    if declared is not None:
        return Definition(declared[0], declared[1].name.span)
    reference = names_in(text).reference_at(place)
    if reference is not None:
        return _in_models(bench, path, reference)
    token = word_at(text, place)
    context = context_at(text, pieces_parsed(text), place)
    if token is None or context.part not in (Part.SOURCE, Part.TARGET):
        return None
    sides = sides_at(bench, path, context)
    found = sides.follow(word_text(token), is_source=context.part is Part.SOURCE)
    return _element(bench, path, found.field) if found is not None else None


def declaration_at(bench: Workbench, path: Path, place: Place) -> tuple[Path, Declaration] | None:
    """Returns the declaration in a text that the name at a place means, or is; with its file."""
    names = names_in(bench.text(path))
    declared = names.declared_at(place)
    if declared is not None:
        return path, declared
    reference = names.reference_at(place)
    return meant(bench, path, reference) if reference is not None else None


def meant(bench: Workbench, path: Path, reference: Reference) -> tuple[Path, Declaration] | None:
    """Returns the declaration in texts that a reference means, with its file."""
    for file in (path, *bench.imports(path)):
        declaration = find(reference, names_in(bench.text(file)).declarations)
        if declaration is not None:
            return file, declaration
    return None


def _imported(bench: Workbench, path: Path, place: Place) -> Definition | None:
    for item in pieces_parsed(bench.text(path)).document.items:
        if isinstance(item, Import) and is_within(item.target.span, place):
            file = imported_file(item, path)
            return Definition(file, Span()) if file is not None and file.is_file() else None
    return None


def _in_models(bench: Workbench, path: Path, reference: Reference) -> Definition | None:
    element = bench.find(path, reference.wanted.python_class, reference.text)
    return _element(bench, path, element)


def _element(bench: Workbench, path: Path, element: EObject | None) -> Definition | None:
    place = bench.place_of(path, element) if element is not None else None
    if place is None:
        return None
    file, line, column = place
    return Definition(file, Span(line, column, line, column))


@dataclass(slots=True)
class Symbol:
    """Something that a text declares."""

    name: str
    kind: str
    span: Span
    name_span: Span
    children: list[Symbol] = field(default_factory=list)


def outline(text: str) -> list[Symbol]:
    """Returns what a text declares, as trees."""
    roots: list[Symbol] = []
    by_item: dict[int, Symbol] = {}
    for each in names_in(text).declarations:
        kind = snake_case(each.table.name)
        symbol = Symbol(each.name.text, kind, each.item.span, each.name.span)
        by_item[id(each.item)] = symbol
        owner = _nearest(each.owners, by_item)
        (owner.children if owner is not None else roots).append(symbol)
    return roots


def _nearest(owners: tuple[Item, ...], by_item: dict[int, Symbol]) -> Symbol | None:
    found = (by_item[id(each)] for each in reversed(owners) if id(each) in by_item)
    return next(found, None)
