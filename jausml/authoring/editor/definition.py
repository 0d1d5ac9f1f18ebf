"""Where names are declared, paths followed to fields, and the outline of what a text declares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from lark import Token

from jausml.authoring.editor.context import Context, Part, context_at
from jausml.authoring.editor.names import Declaration, Reference, find
from jausml.authoring.editor.places import Place, is_within
from jausml.authoring.editor.workbench import Workbench, imported_file, imports_of, names_in
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.attributes import UNSTATED, Attribute
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.wholes import PathPlace
from jausml.language.text import tree
from jausml.language.text.keywords import keyword_of
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.reading.shaping import span_of, word_text
from jausml.language.text.tree import Item

MessageT = TypeVar("MessageT", "jaus.MessageDef", "ros.MessageType")


@dataclass(frozen=True, slots=True)
class Sides:
    """Starts of the paths of assignments; None where a message is not known."""

    source: PathPlace | None
    target: PathPlace | None
    joins: dict[str, PathPlace]

    def follow(self, path: str, *, is_source: bool) -> PathPlace | None:
        """Returns where a path leads to; None when it leads nowhere."""
        first, _, rest = path.partition(".")
        if is_source and first in self.joins:
            return _follow(self.joins[first], rest or ".")
        return _follow(self.source if is_source else self.target, path)


def sides_at(bench: Workbench, path: Path, context: Context) -> Sides:
    """Returns where the paths at a place start."""
    message = _at_end(bench, path, context, jaus.MessageDef)
    kind = _at_end(bench, path, context, ros.MessageType)
    from_jaus = message_place(message) if message is not None else None
    from_ros = RosPlace(type=kind) if kind is not None else None
    way = context.around(tree.Direction) or context.around(tree.Vector)
    if isinstance(way, (tree.Direction, tree.Vector)) and way.to_ros:
        joins = _joins(bench, path, context, "report_join")
        return _nested(Sides(from_jaus, from_ros, joins), context)
    return _nested(Sides(from_ros, from_jaus, _joins(bench, path, context, "join")), context)


def _at_end(
    bench: Workbench, path: Path, context: Context, kind: type[MessageT]
) -> MessageT | None:
    end = context.end_of_map(is_jaus=kind is jaus.MessageDef)
    return None if end is None else bench.find(path, kind, end.type.text)


def fields_of(place: PathPlace | None) -> list[attributes.Part]:
    """Returns the fields that the next step of a path can name."""
    if isinstance(place, JausPlace):
        return [member for member in place.members() or [] if member.name]
    if place is not None and place.type is not None and not place.is_array:
        return list(place.type.fields)
    return []


def facts(attribute: Attribute) -> list[str]:
    """Returns the facts of an attribute: kind, unit, range, resolution, axes, presence."""
    details = [attribute.name]
    if attribute.units:
        details.append(f"unit {attribute.units}")
    if attribute.lower is not None and attribute.upper is not None:
        details.append(f"{attribute.lower:.12g} to {attribute.upper:.12g}")
    if attribute.step is not None and not attribute.integral:
        details.append(f"steps of {attribute.step:.3g}")
    if attribute.frame != UNSTATED:
        details.append(f"frame {attribute.frame}")
    if attribute.optional:
        details.append("may be left out")
    return details


def _nested(sides: Sides, context: Context) -> Sides:
    """Returns where paths start in the blocks of list assignments around a place."""
    for level in context.levels:
        if isinstance(level.item, tree.Assignment):
            first = level.item.sources[0]
            source = _follow(sides.source, first.text) if isinstance(first, tree.Name) else None
            target = _follow(sides.target, level.item.targets[0].text)
            sides = Sides(_declared_element(source), _declared_element(target), {})
    return sides


def _declared_element(place: PathPlace | None) -> PathPlace | None:
    is_list = isinstance(place, RosPlace) and place.is_array
    is_list = is_list or (
        isinstance(place, JausPlace) and isinstance(place.field, (jaus.List, jaus.Array))
    )
    return place.element() if place is not None and is_list else None


def _follow(place: PathPlace | None, path: str) -> PathPlace | None:
    path_place = place.follow(path) if place is not None else None
    return path_place if isinstance(path_place, (JausPlace, RosPlace)) else None


def _joins(bench: Workbench, path: Path, context: Context, keyword: str) -> dict[str, PathPlace]:
    joins: dict[str, PathPlace] = {}
    for item in context.map.items if context.map is not None else []:
        if isinstance(item, tree.Element) and item.name is not None and _keyword(item) == keyword:
            for feature in item.items:
                place = _joined(bench, path, feature) if isinstance(feature, tree.Feature) else None
                if place is not None:
                    joins[item.name.text] = place
    return joins


def _joined(bench: Workbench, path: Path, feature: tree.Feature) -> PathPlace | None:
    """Returns where the paths of a join start, if a feature says it."""
    value = feature.values[0]
    name = value.text if isinstance(value, tree.Name) else ""
    if name and feature.name.text == "type":
        type_ = bench.find(path, ros.MessageType, name)
        return RosPlace(type=type_) if type_ is not None else None
    if name and feature.name.text == "message":
        message = bench.find(path, jaus.MessageDef, name)
        return message_place(message) if message is not None else None
    return None


def _keyword(element: tree.Element) -> str:
    return element.keyword.text if element.keyword is not None else ""


_PUNCTUATION = {
    *("LBRACE", "RBRACE", "LPAR", "RPAR", "LSQB", "END_BRACKET", "NAMED_BRACKET", "COMMA"),
    *("COLON", "SEMICOLON", "ARROW", "PAIR", "GIVES", "AT_MOST", "EQUAL", "TILDE"),
}


@dataclass(frozen=True, slots=True)
class Definition:
    """The place where a name is given."""

    path: Path
    span: tree.Span


def word_at(text: str, place: Place) -> Token | None:
    """Returns the word or text at a place; the place behind its last character counts."""
    tokens = parsed_text(text).tokens
    candidates = (
        token
        for token in tokens
        if token.end_line == place.line and is_within(span_of(token), place)
    )
    return next((token for token in candidates if token.type not in _PUNCTUATION), None)


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
        element = bench.find(path, reference.wanted.python_class, reference.text)
        return _element(bench, path, element)
    token = word_at(text, place)
    context = context_at(text, parsed_text(text), place)
    if token is None or context.part not in (Part.SOURCE, Part.TARGET):
        return None
    sides = sides_at(bench, path, context)
    path_place = sides.follow(word_text(token), is_source=context.part is Part.SOURCE)
    return _element(bench, path, path_place.field) if path_place is not None else None


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
        declaration = find(reference, names_in(bench.text(file)))
        if declaration is not None:
            return file, declaration
    return None


def _imported(bench: Workbench, path: Path, place: Place) -> Definition | None:
    for item in imports_of(bench.tree(path)):
        if is_within(item.target.span, place):
            file = imported_file(item, path)
            return Definition(file, tree.Span()) if file is not None and file.is_file() else None
    return None


def _element(bench: Workbench, path: Path, element: EObject | None) -> Definition | None:
    place = bench.place_of(path, element) if element is not None else None
    if place is None:
        return None
    file, line, column = place
    return Definition(file, tree.Span(line, column, line, column))


@dataclass(slots=True)
class Symbol:
    """A declaration of a text."""

    name: str
    kind: str
    span: tree.Span
    name_span: tree.Span
    children: list[Symbol] = field(default_factory=list)


def outline(text: str) -> list[Symbol]:
    """Returns the declarations of a text, as trees."""
    roots: list[Symbol] = []
    by_item: dict[int, Symbol] = {}
    for declaration in names_in(text).declarations:
        symbol = Symbol(
            declaration.name.text,
            keyword_of(declaration.table.name),
            declaration.item.span,
            declaration.name.span,
        )
        by_item[id(declaration.item)] = symbol
        owner = _nearest(declaration.owners, by_item)
        (owner.children if owner is not None else roots).append(symbol)
    return roots


def _nearest(owners: Sequence[Item], by_item: dict[int, Symbol]) -> Symbol | None:
    keys = map(id, reversed(owners))
    return next((by_item[key] for key in keys if key in by_item), None)
