"""JSON schemas of JAUS messages, by which tools know what they can plot.

They say types alone, in the part of the language that Foxglove reads: an object has properties, a
list has items. What has several shapes is an object of which nothing is said.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.language import wire

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry

Schema = dict[str, Any]

_ADDRESS: Schema = {"type": "string", "description": "JAUS id, subsystem.node.component"}
_ANY: Schema = {"type": "object"}


def schema_of(entry: MessageEntry) -> Schema:
    """Returns the schema of a message of a recording: its header and its fields."""
    body = wire.resolve(entry.definition).body
    fields: Schema = _ANY
    if body is not None:
        inner = _typed(body.kind)
        # Recordings have the fields without the one record of a body.
        fields = inner if inner["type"] == "object" else _object({body.name: inner})
    return {
        "title": entry.name,
        "description": str(entry.definition.documentation or ""),
        **_object(
            {
                "source": _ADDRESS,
                "destination": _ADDRESS,
                "sequence": {"type": "integer"},
                "payload": {"type": "string", "description": "code and body in hexadecimal"},
                "fields": fields,
            }
        ),
    }


def _object(properties: dict[str, Schema]) -> Schema:
    return {"type": "object", "properties": properties}


def _typed(kind: wire.Kind) -> Schema:
    match kind:
        case wire.Integer():
            return _number("integer", kind.units)
        case wire.Real() | wire.Scaled():
            return _number("number", kind.units)
        case wire.BitField():
            return _object({each.name: {"type": "integer"} for each in kind.groups})
        case wire.FixedText() | wire.Text():
            return {"type": "string"}
        case wire.Record():
            return _object({each.name: _described(each) for each in kind.members})
        case wire.List() | wire.Array():
            return _listed(kind)
        case _:
            return _ANY


def _listed(kind: wire.List | wire.Array) -> Schema:
    found: Schema = _typed(kind.element.kind)
    depth = len(kind.dimensions) if isinstance(kind, wire.Array) else 1
    for _ in range(depth):
        found = {"type": "array", "items": found}
    return found


def _number(name: str, units: str) -> Schema:
    found: Schema = {"type": name}
    return {**found, "description": f"in {units}"} if units not in ("", "one") else found


def _described(field: wire.Field) -> Schema:
    found = _typed(field.kind)
    text = ", ".join(filter(None, (field.documentation.strip(), found.get("description", ""))))
    return {**found, "description": text} if text else found
