"""The project as the page of the studio gets it, and the edits that it asks for, as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jausml.authoring.editing import commands
from jausml.authoring.editing.commands import Command, EditError
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.records import Entry, Freshness
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.wording import for_people
from jausml.live.serving.rpc import REFUSED, RpcError, TypedError, typed
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.views import UnknownViewError

_COMMANDS: Mapping[str, type[Command]] = {
    kind.NAME: kind
    for kind in (
        commands.Set,
        commands.Add,
        commands.Remove,
        commands.Move,
        commands.Rename,
        commands.Create,
        commands.Place,
    )
}


def command(value: Mapping[str, object], where: str = "command") -> Command:
    """Returns the command that an object of JSON means.

    Its `kind` names the command, so the class of a new element is its `type`.
    """
    members = dict(value)
    name = members.pop("kind", None)
    kind: Any = _COMMANDS.get(name) if isinstance(name, str) else None
    if kind is None:
        raise TypedError(f"{where}.kind is one of {', '.join(_COMMANDS)}")
    if "type" in members:
        members["kind"] = members.pop("type")
    new_command: Command = typed(kind, members, where)()
    return new_command


def files_as_json(project: Project) -> list[dict[str, Any]]:
    """Returns the files of a project."""
    return [
        {
            "path": file.path,
            "notation": file.notation,
            "stale": file.is_stale,
            "dirty": file.is_dirty,
        }
        for file in project.files
    ]


def log_as_json(project: Project) -> dict[str, bool]:
    """Returns whether there is something that can be undone, or done again."""
    return {"undoable": bool(project.log), "redoable": bool(project.undone)}


def freshness_as_json(freshness: Freshness) -> dict[str, Any]:
    """Returns how current an answer is."""
    return {"state": freshness.state, "since": freshness.since, "why": freshness.why}


def entry_as_json(entry: Entry | None) -> dict[str, Any] | None:
    """Returns an entry of the log; None for none."""
    names = ("number", "label", "files", "created")
    return None if entry is None else {name: getattr(entry, name) for name in names}


def refusal_of(error: Exception) -> RpcError | None:
    """Returns the answer that a page gets for an error; None for a fault of ours."""
    if isinstance(error, EditError):
        return RpcError(REFUSED, for_people(str(error)), {"conflict": error.conflict})
    if isinstance(error, OSError) and error.filename is not None:
        return RpcError(REFUSED, f"{error.filename}: {error.strerror}")
    refusals = (AnswerError, LayoutError, UnknownViewError)
    return RpcError(REFUSED, for_people(str(error))) if isinstance(error, refusals) else None
