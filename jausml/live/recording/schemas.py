"""JSON schemas of JAUS messages in MCAP files."""

from __future__ import annotations

from typing import Any

from jausml.language import wire
from jausml.live.messages import MessageEntry

Schema = dict[str, Any]

_ADDRESS: Schema = {"type": "string", "description": "JAUS id, subsystem.node.component"}
_ANY: Schema = {"type": "object"}


def schema_of(entry: MessageEntry) -> Schema:
    """Returns the JSON schema of a recorded JAUS message: its header and its fields."""
    body = entry.layout.body
    fields: Schema = _ANY
    if body is not None:
        inner = _typed(body.kind)
        # Recordings have the fields without the one record of a body.
        fields = inner if inner["type"] == "object" else _object({body.name: inner})
    return {
        "title": entry.name,
        "description": entry.documentation,
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
            return _object({group.name: {"type": "integer"} for group in kind.groups})
        case wire.FixedText() | wire.Text():
            return {"type": "string"}
        case wire.Record():
            return _object({member.name: _described(member) for member in kind.members})
        case wire.List() | wire.Array():
            # The elements of an array of several dimensions stand in one list.
            return {"type": "array", "items": _typed(kind.element.kind)}
        case _:
            return _ANY


def _number(name: str, units: str) -> Schema:
    schema: Schema = {"type": name}
    return {**schema, "description": f"in {units}"} if units not in ("", "one") else schema


def _described(field: wire.Field) -> Schema:
    schema = _typed(field.kind)
    text = ", ".join(filter(None, (field.documentation.strip(), schema.get("description", ""))))
    return {**schema, "description": text} if text else schema
