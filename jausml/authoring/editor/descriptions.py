"""Descriptions of messages, types, services and maps as Markdown: what one needs to write them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.model.names import qualified_name
from jausml.language.text.tree import Direction, Element, End
from jausml.live.messages.definitions import rows_of
from jausml.live.messages.errors import DefinitionError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.language.metamodel.classes.ecore import EObject

_MOST_ROWS = 60
_MOST_NAMES = 12


def described(element: EObject) -> str:
    """Returns what is known of an element of the library or a text; empty for other classes."""
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
        f"{'JAUS' if each.is_jaus else 'ROS'} `{each.type.text}`"
        for each in block.items
        if isinstance(each, End)
    ]
    ways = [
        "JAUS->ROS" if each.to_ros else "ROS->JAUS"
        for each in block.items
        if isinstance(each, Direction)
    ]
    return _joined(", ".join(ends), ", ".join(dict.fromkeys(ways)))


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
        (each.name or "", _ros_type(each), _first_line(each.documentation)) for each in type_.fields
    ]
    return _table(("field", "type", ""), cells)


def _ros_type(field: ros.Field) -> str:
    if isinstance(field, ros.MessageField):
        word = qualified_name(field.messageType).replace(".", "/") if field.messageType else ""
    else:
        word = str(getattr(getattr(field, "type", None), "name", ""))
    size = field.arraySize or ""
    brackets = {"fixedArray": f"[{size}]", "boundedSequence": f"[<={size}]"}
    kind = field.arrayKind.name
    return word + brackets.get(kind, "[]" if kind == "unboundedSequence" else "")


def _service(service: jaus.Service) -> str:
    facts = [f"`{service.urn}` {service.version}"]
    if service.inherits is not None:
        facts.append(f"inherits {service.inherits.name}")
    messages = [
        f"{word}: {', '.join(str(each.name) for each in messages)}"
        for word, messages in (("takes", service.inputs), ("sends", service.outputs))
        if messages
    ]
    return _joined(_head(service), ", ".join(facts), service.documentation, *messages)


def _table(head: Sequence[str], cells: Sequence[Sequence[str]]) -> str:
    """Returns a table in Markdown, empty without rows."""
    if not cells:
        return ""
    lines = [_line(head), _line(["---"] * len(head)), *map(_line, cells[:_MOST_ROWS])]
    more = f"\n\n{len(cells) - _MOST_ROWS} more" if len(cells) > _MOST_ROWS else ""
    return "\n".join(lines) + more


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(each.replace('|', chr(92) + '|') for each in cells)} |"


def _first_line(text: str | None) -> str:
    return (text or "").partition("\n")[0]


def _joined(*parts: Any, between: str = "\n\n") -> str:
    return between.join(str(each) for each in parts if each)
