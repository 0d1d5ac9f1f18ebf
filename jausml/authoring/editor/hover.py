"""Hover texts: what is known of the word at a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.editor.classes import features_of, keywords, table
from jausml.authoring.editor.context import Part, context_at
from jausml.authoring.editor.definition import declaration_at, word_at
from jausml.authoring.editor.descriptions import described, described_map
from jausml.authoring.editor.paths import facts, sides_at
from jausml.authoring.editor.positions import Place
from jausml.authoring.editor.workbench import names_in, sketched_text
from jausml.language.metamodel import documentation
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.text.keywords import snake_case
from jausml.language.text.reading.shaping import word_text
from jausml.language.text.tree import Element

if TYPE_CHECKING:
    from pathlib import Path

    from lark import Token

    from jausml.authoring.editor.context import Context
    from jausml.authoring.editor.workbench import Workbench


@dataclass(frozen=True, slots=True)
class Hover:
    """Everything known of a word."""

    text: str
    token: Token


def hover(bench: Workbench, path: Path, place: Place) -> Hover | None:
    """Returns what is known of the word at a place, None when it is nothing."""
    text = bench.text(path)
    token = word_at(text, place)
    if token is None:
        return None
    context = context_at(text, sketched_text(text), place)
    for explain in (_path, _conversion, _message, _feature, _literal, _named, _keyword):
        said = explain(bench, path, context, token)
        if said:
            return Hover(said, token)
    return None


def _path(bench: Workbench, path: Path, context: Context, token: Token) -> str:
    if context.part not in (Part.SOURCE, Part.TARGET):
        return ""
    is_source = context.part is Part.SOURCE
    found = sides_at(bench, path, context).follow(_name(token), is_source=is_source)
    if found is None:
        return ""
    attribute = found.attribute()
    said: list[Any] = [f"**{_name(token)}**: {', '.join(facts(attribute))}"]
    field = attribute.field
    said += [getattr(field, "interpretation", None), getattr(field, "documentation", None)]
    if attribute.constants:
        said.append(", ".join(f"{name} = {value}" for name, value in attribute.constants[:12]))
    return _joined(said)


def _conversion(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    if context.part is not Part.CONVERSION:
        return ""
    known = CONVERSIONS.get(_name(token))
    return "" if known is None else _joined([f"`{known.signature}`", known.documentation])


def _message(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    reference = names_in(bench.text(path)).reference_at(_place(token))
    if reference is None:
        return ""
    element = bench.find(path, reference.wanted.python_class, reference.text)
    return "" if element is None else described(element)


def _feature(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    feature = features_of(context.item, context.table).get(_name(token))
    if feature is None or context.part not in (Part.ITEM, Part.SOURCE):
        return ""
    kind = feature.type_name.rpartition(".")[2]
    return _joined([f"**{feature.name}**: {kind}", documentation(feature.feature)])


def _literal(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    feature = features_of(context.item, context.table).get(context.about)
    if context.part is not Part.VALUE or feature is None or feature.data_type is None:
        return ""
    literal = feature.data_type.literals.get(_name(token))
    return "" if literal is None else _joined([f"**{_name(token)}**", documentation(literal)])


def _named(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    found = declaration_at(bench, path, _place(token))
    if found is None:
        return ""
    _, declaration = found
    kind = snake_case(declaration.table.name)
    said: list[Any] = [f"{kind} **{declaration.name.text}**", declaration.item.documentation]
    if isinstance(declaration.item, Element) and declaration.table is table("bridge.AttributeMap"):
        said.append(described_map(declaration.item))
    return _joined(said)


def _keyword(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    known = keywords().get(_name(token))
    return "" if known is None else _joined([f"**{token}**", documentation(known.eclass)])


def _joined(parts: list[Any]) -> str:
    return "\n\n".join(str(each) for each in parts if each)


def _name(token: Token) -> str:
    return word_text(token)


def _place(token: Token) -> Place:
    return Place(token.line or 1, token.column or 1)
