"""Hover texts: what is known of the word at a place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lark import Token

from jausml.authoring.editor.context import Context, Part, context_at, features_of, keywords, table
from jausml.authoring.editor.definition import declaration_at, facts, sides_at, word_at
from jausml.authoring.editor.places import Place
from jausml.authoring.editor.workbench import Workbench, names_in
from jausml.language.metamodel import documentation
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import qualified_name
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.paths.markers import in_words
from jausml.language.text.keywords import keyword_of
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.reading.shaping import word_text
from jausml.language.text.tree import Direction, Element, End
from jausml.live.messages.errors import DefinitionError
from jausml.live.messages.ros_rows import ros_rows
from jausml.live.messages.text import rows_of
from jausml.views.pages import markdown_table

_MOST_ROWS = 60

_MOST_NAMES = 12


@dataclass(frozen=True, slots=True)
class Hover:
    """Everything known of a word."""

    text: str
    token: Token


def hover(bench: Workbench, path: Path, place: Place) -> Hover | None:
    """Returns the facts of the element that the word at a place names, None without one."""
    text = bench.text(path)
    token = word_at(text, place)
    if token is None:
        return None
    context = context_at(text, parsed_text(text), place)
    for explain in (_path, _conversion, _message, _feature, _literal, _named, _keyword):
        said = explain(bench, path, context, token)
        if said:
            return Hover(said, token)
    return None


def _path(bench: Workbench, path: Path, context: Context, token: Token) -> str:
    if context.part not in (Part.SOURCE, Part.TARGET):
        return ""
    is_source = context.part is Part.SOURCE
    path_place = sides_at(bench, path, context).follow(_name(token), is_source=is_source)
    if path_place is None:
        return ""
    attribute = path_place.attribute()
    said: list[Any] = [f"**{_name(token)}**: {', '.join(facts(attribute))}"]
    field = attribute.field
    said += map(in_words, getattr(field, "markers", ()))
    said += [getattr(field, "interpretation", None), getattr(field, "documentation", None)]
    if attribute.constants:
        said.append(", ".join(f"{name} = {value}" for name, value in attribute.constants[:12]))
    return _joined(*said)


def _conversion(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    if context.part is not Part.CONVERSION:
        return ""
    known = CONVERSIONS.get(_name(token))
    return "" if known is None else _joined(f"`{known.signature}`", known.documentation)


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
    return _joined(f"**{feature.name}**: {kind}", documentation(feature.feature))


def _literal(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    feature = features_of(context.item, context.table).get(context.about)
    if context.part is not Part.VALUE or feature is None or feature.data_type is None:
        return ""
    literal = feature.data_type.literals.get(_name(token))
    return "" if literal is None else _joined(f"**{_name(token)}**", documentation(literal))


def _named(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    declared = declaration_at(bench, path, _place(token))
    if declared is None:
        return ""
    _, declaration = declared
    kind = keyword_of(declaration.table.name)
    said: list[Any] = [f"{kind} **{declaration.name.text}**", declaration.item.documentation]
    if isinstance(declaration.item, Element) and declaration.table is table("bridge.AttributeMap"):
        said.append(described_map(declaration.item))
    return _joined(*said)


def _keyword(bench: Workbench, path: Path, context: Context, token: Token) -> str:  # noqa: ARG001
    known = keywords().get(_name(token))
    return "" if known is None else _joined(f"**{token}**", documentation(known.eclass))


def _name(token: Token) -> str:
    return word_text(token)


def _place(token: Token) -> Place:
    return Place(token.line or 1, token.column or 1)


def described(element: EObject) -> str:
    """Returns the facts of an element of the library or a text; empty for other classes."""
    if isinstance(element, jaus.MessageDef):
        return _joined(_head(element, element.code), element.documentation, _fields(element))
    if isinstance(element, ros.MessageType):
        return _joined(_head(element), element.documentation, _ros_fields(element))
    if isinstance(element, jaus.Service):
        return _service(element)
    return ""


def described_map(block: Element) -> str:
    """Returns which ends a map has, and in which directions it goes."""
    ends = [
        f"{'JAUS' if item.is_jaus else 'ROS'} `{item.type.text}`"
        for item in block.items
        if isinstance(item, End)
    ]
    directions = [
        "JAUS->ROS" if item.to_ros else "ROS->JAUS"
        for item in block.items
        if isinstance(item, Direction)
    ]
    return _joined(", ".join(ends), ", ".join(dict.fromkeys(directions)))


def _head(element: EObject, *facts: str | None) -> str:
    return " ".join(filter(None, (f"**{qualified_name(element)}**", *facts)))


def _fields(message: jaus.MessageDef) -> str:
    try:
        rows = rows_of(message)
    except DefinitionError:
        return ""
    # Paths start at the members of the outermost record.
    outermost = int(bool(rows) and rows[0].type.startswith("record"))
    cells = [
        (
            f"{'&nbsp;&nbsp;' * (row.depth - outermost)}{row.name}",
            row.type,
            row.units,
            _joined(row.legal, _names(row.names), between=" "),
            row.presence or "always",
        )
        for row in rows[outermost:]
    ]
    return _table(("field", "type", "unit", "values", "present"), cells)


def _names(names: Mapping[int, str] | None) -> str:
    shown = [f"{value} {name}" for value, name in sorted((names or {}).items())]
    more = [f"{len(shown) - _MOST_NAMES} more"] if len(shown) > _MOST_NAMES else []
    return ", ".join(shown[:_MOST_NAMES] + more)


def _ros_fields(type_: ros.MessageType) -> str:
    cells = [
        (row.name, row.type, row.units, _joined(_first_line(row.documentation), *row.markers))
        for row in ros_rows(type_)
        if row.depth == 0
    ]
    return _table(("field", "type", "unit", ""), cells)


def _service(service: jaus.Service) -> str:
    facts = [f"`{service.urn}` {service.version}"]
    if service.inherits is not None:
        facts.append(f"inherits {service.inherits.name}")
    messages = [
        f"{word}: {', '.join(str(message.name) for message in messages)}"
        for word, messages in (("takes", service.inputs), ("sends", service.outputs))
        if messages
    ]
    return _joined(_head(service), ", ".join(facts), service.documentation, *messages)


def _table(head: Sequence[str], cells: Sequence[Sequence[str]]) -> str:
    """Returns a table in Markdown, empty without rows."""
    if not cells:
        return ""
    more = f"\n\n{len(cells) - _MOST_ROWS} more" if len(cells) > _MOST_ROWS else ""
    return "\n".join(markdown_table(head, cells[:_MOST_ROWS])) + more


def _first_line(text: str | None) -> str:
    return (text or "").partition("\n")[0]


def _joined(*parts: Any, between: str = "\n\n") -> str:
    return between.join(str(part) for part in parts if part)
