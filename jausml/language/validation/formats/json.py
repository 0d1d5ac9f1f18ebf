"""Reports for programs: JSON with a versioned schema."""

from __future__ import annotations

import json
from typing import Any

from jausml.language.model.diagnostics import Diagnostic, Location
from jausml.language.validation.rule import Report, SetAside

SCHEMA = 1
"""Version of the layout; it changes when a reader of the present one would be misled."""


def render(report: Report) -> str:
    """Returns a JSON object with `schema`, `files`, `diagnostics` and `setAside`."""
    content = {
        "schema": SCHEMA,
        "files": list(report.files),
        "diagnostics": [as_json(diagnostic) for diagnostic in report.diagnostics],
        "setAside": [_set_aside(suppression) for suppression in report.set_aside],
    }
    return json.dumps(content, indent=2) + "\n"


def as_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """Returns every attribute of a finding."""
    return {
        "rule": diagnostic.rule,
        "severity": diagnostic.severity.value,
        **_place(diagnostic.location),
        "element": diagnostic.element,
        "fragment": diagnostic.fragment,
        "message": diagnostic.message,
        "hint": diagnostic.hint,
        "related": [
            {**_place(note.location), "message": note.message} for note in diagnostic.related
        ],
    }


def _set_aside(aside: SetAside) -> dict[str, Any]:
    said_at = _place(aside.location) if aside.location is not None else None
    why = {"ground": aside.ground.value, "reason": aside.reason, "saidAt": said_at}
    return {**as_json(aside.diagnostic), **why}


def _place(location: Location) -> dict[str, Any]:
    return {"file": location.path, "line": location.line, "column": location.column}
