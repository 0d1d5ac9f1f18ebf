"""Reports for programs: JSON with a versioned schema."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.language.model.diagnostics import Diagnostic, Location
    from jausml.language.validation.rule import Report, SetAside

SCHEMA = 1
"""Version of the layout; it changes when a reader of the present one would be misled."""


def render(report: Report) -> str:
    """Returns a JSON object with `schema`, `files`, `diagnostics` and `setAside`."""
    content = {
        "schema": SCHEMA,
        "files": list(report.files),
        "diagnostics": [as_json(each) for each in report.diagnostics],
        "setAside": [_set_aside(each) for each in report.set_aside],
    }
    return json.dumps(content, indent=2) + "\n"


def as_json(each: Diagnostic) -> dict[str, Any]:
    """Returns every attribute of a finding."""
    return {
        "rule": each.rule,
        "severity": each.severity.value,
        **_place(each.location),
        "element": each.element,
        "fragment": each.fragment,
        "message": each.message,
        "hint": each.hint,
        "related": [{**_place(note.location), "message": note.message} for note in each.related],
    }


def _set_aside(each: SetAside) -> dict[str, Any]:
    said_at = _place(each.location) if each.location is not None else None
    why = {"ground": each.ground.value, "reason": each.reason, "saidAt": said_at}
    return {**as_json(each.diagnostic), **why}


def _place(location: Location) -> dict[str, Any]:
    return {"file": location.path, "line": location.line, "column": location.column}
