"""Safety cases as a document to sign goal by goal, with a seal that tells whether it was."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import PurePath
from urllib.parse import quote

from markupsafe import Markup

from jausml.safety_case.argument import Goal, SafetyCase
from jausml.safety_case.pictures import STYLE, names_of
from jausml.views.pages import page

_SEAL = "<!-- sha256 of what stands above: "


def render(case: SafetyCase, pictures: Mapping[str, str]) -> str:
    """Returns a safety case as a document in HTML, sealed.

    Args:
        pictures: Its pictures in SVG by their names, all that it has.
    """
    drawings = {name: Markup(svg) for name, svg in pictures.items()}  # noqa: S704 - as we have drawn it
    known = {
        "case": case,
        "evidence": {evidence.id: evidence for evidence in case.evidence},
        "overview": drawings["case"],
        "pictures": {
            hazard.id: [drawings[name] for name in names_of(hazard)] for hazard in case.hazards
        },
        "places": {goal.id: _place(goal) for goal in case.goals},
        "links": {
            evidence.path: quote(evidence.path, errors="surrogateescape")
            for evidence in case.evidence
        },
    }
    text = page("jausml.safety_case", "case", f"Safety case of {case.system}", known, [STYLE])
    return _sealed(text)


def is_untouched(document: str) -> bool:
    """Tells whether a document is unchanged since it was made, to its last line end."""
    return document == _sealed(document.rpartition(_SEAL)[0])


def _sealed(text: str) -> str:
    """Returns a text with the digest of how it is written, paths that are no text included."""
    digest = hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()
    return f"{text}{_SEAL}{digest} -->\n"


def _place(goal: Goal) -> str:
    return f"{goal.element}, {PurePath(goal.location.path).name}:{goal.location.line}"
