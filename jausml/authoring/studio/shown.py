"""Records of the project as pages know them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.authoring.editing.project import Project
    from jausml.authoring.editing.records import Entry, Freshness


def files(project: Project) -> list[dict[str, Any]]:
    """Returns the files of a project."""
    return [
        {
            "path": each.path,
            "notation": each.notation,
            "revision": each.revision,
            "stale": each.is_stale,
            "dirty": each.is_dirty,
        }
        for each in project.files
    ]


def freshness(found: Freshness) -> dict[str, Any]:
    """Returns what an answer is worth."""
    return {"state": found.state, "since": found.since, "why": found.why}


def entry(made: Entry | None) -> dict[str, Any] | None:
    """Returns an entry of the log; None for none."""
    if made is None:
        return None
    return {
        "number": made.number,
        "label": made.label,
        "files": made.files,
        "created": made.created,
        "layout": made.layout,
        "outside": made.is_outside,
    }
