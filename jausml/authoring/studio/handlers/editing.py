"""Requests that change the project, and those for what was done."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jausml.authoring.editing.commands import Add, Command, EditError, Place, Set
from jausml.authoring.editing.records import Entry
from jausml.authoring.projects.creating import model_text
from jausml.authoring.projects.eclipse_xmi import metamodels_for
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.starting import STARTING_POINTS
from jausml.authoring.proposals.new_elements import free_address
from jausml.authoring.studio.context import KeptEdit, StudioContext
from jausml.authoring.studio.handlers import showing
from jausml.authoring.studio.rpc import command, entry_as_json
from jausml.authoring.studio.views.wording import for_people
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model
from jausml.language.semantics.names import system_name
from jausml.language.text.notation import SUFFIX

_ADDRESS = "address"


@dataclass(frozen=True)
class Dropped:
    """The place of a drop: a view of a file, and the corner of the new box in pixels."""

    file: str
    view: str
    x: int
    y: int


def _edit(
    context: StudioContext,
    commands: tuple[Mapping[str, object], ...],
    label: str,
    base: int | None = None,
    dry: bool = False,  # noqa: FBT001, FBT002 - a parameter by name
    at: Dropped | None = None,
) -> dict[str, Any]:
    """Carries out commands, all or none; dry, tells what they would do."""
    read = [command(words, f"commands[{index}]") for index, words in enumerate(commands)]
    project = context.project
    if dry:
        preview = project.preview(read, base)
        return {
            "revision": project.revision,
            "created": preview.created,
            "diff": preview.diff,
            "referrers": preview.referrers,
        }
    return _carried_out(context, read, label, project.revision if base is None else base, at=at)


def _carried_out(
    context: StudioContext,
    commands: Sequence[Command],
    label: str,
    base: int,
    kept: KeptEdit | None = None,
    at: Dropped | None = None,
) -> dict[str, Any]:
    """Carries out commands that were made for a revision, and reports what came of it.

    Args:
        kept: The kept edit that has the commands, if there is one.
        at: Where the first new element is to be drawn.
    """
    project = context.project
    try:
        # Who does it again has seen what others did, and means it.
        entry = project.do(commands, label, base, is_first=kept is None)
    except EditError as error:
        why = for_people(str(error))
        if error.conflict and (kept or context.keep(commands, label, base, why)):
            message = f"{why}. It is kept: do it again or discard it"
            raise EditError(message, conflict=True) from error
        raise
    finally:
        # What it met on its way is told, whether it was done or not.
        context.notify_outside(context.project.unreported())
    if kept is not None:
        # Only now, whatever kept it from being done.
        context.discard(kept.number)
    if at is not None and entry.created:
        context.drawings.expect(at.file, at.view, entry.created[0], (at.x, at.y))
    return _reported(context, entry)


def _reported(context: StudioContext, entry: Entry) -> dict[str, Any]:
    """Reports an entry to pages, and returns its new elements."""
    if entry.changes:
        context.changed()
    return {"revision": context.project.revision, "created": entry.created}


def _kept(context: StudioContext) -> dict[str, Any]:
    return {"edits": context.kept}


def _again(context: StudioContext, number: int) -> dict[str, Any]:
    """Carries out a kept edit, after what others have done since."""
    edit = next((edit for edit in context.kept if edit.number == number), None)
    if edit is None:
        raise EditError("this edit is kept no more")
    return _carried_out(context, edit.commands, edit.label, edit.base, edit)


def _copy(context: StudioContext, elements: tuple[str, ...]) -> dict[str, Any]:
    return {"text": context.project.copy(elements)}


def _paste(context: StudioContext, owner: str, text: str) -> dict[str, Any]:
    """Adds the elements of a text that was copied here or elsewhere, or typed by somebody."""
    clip = context.project.clip(text, owner)
    model = context.project.find(owner)[1]
    entry = context.project.paste(with_free_addresses(model, clip.commands), owner, "Paste")
    return {**_reported(context, entry), "left_out": clip.left_out}


def _create(context: StudioContext, file: str, origin: str) -> dict[str, Any]:
    """Makes a model file that begins with a starting point."""
    is_text = file.endswith(SUFFIX)
    beside = metamodels_for(context.project.root / file, context.project.root)
    try:
        data = model_text(origin, system_name(Path(file)), beside, is_text=is_text)
    except ProjectError as error:
        raise EditError(str(error)) from error
    return _reported(context, context.project.add_file(file, data, f"Create {file}"))


def _stepped(context: StudioContext, entry: Entry | None) -> dict[str, Any]:
    """Reports the entry that was undone or redone, None for none."""
    if entry is not None:
        context.changed()
    return {"revision": context.project.revision, "entry": entry_as_json(entry)}


def _log(context: StudioContext) -> dict[str, Any]:
    done, undone = context.project.log, context.project.undone
    return {"entries": [entry_as_json(entry) for entry in (*done, *undone)], "at": len(done)}


def _write(context: StudioContext, file: str, text: str, base: int) -> dict[str, Any]:
    return _reported(context, context.project.write_text(file, text, base))


def _arrange(
    context: StudioContext, file: str, view: str, opened: tuple[str, ...] = ()
) -> dict[str, Any]:
    placed = context.project.positions(file, view)
    if placed:
        forget = Place(file, view, dict.fromkeys(placed))
        _reported(context, context.project.do([forget], f"Arrange {view}"))
    context.drawings.forget(file, view)
    return showing.view(context, file, view, opened)


def with_free_addresses(model: Model, commands: Sequence[Add | Set]) -> list[Add | Set]:
    """Returns the copied elements with free JAUS ids, where their own are in use."""
    components = model.instances(jaus.Component, library=False)
    used = {str(component.address) for component in components if component.address}
    changes: list[Add | Set] = []
    for change in commands:
        own = change.values.get(_ADDRESS, ()) if isinstance(change, Add) else ()
        if isinstance(change, Add) and own and own[0] in used:
            own = (free_address(model, used),)
            changes.append(replace(change, values={**change.values, _ADDRESS: own}))
        else:
            changes.append(change)
        used.update(own)
    return changes


METHODS: Mapping[str, Callable[..., object]] = {
    "kept": _kept,
    "starting_points": lambda _: {"points": STARTING_POINTS},
    "copy": _copy,
    "log": _log,
}
"""The functions that answer questions, by name."""

CHANGES: Mapping[str, Callable[..., object]] = {
    "edit": _edit,
    "kept.again": _again,
    "kept.discard": StudioContext.discard,
    "create": _create,
    "paste": _paste,
    "undo": lambda context: _stepped(context, context.project.undo()),
    "redo": lambda context: _stepped(context, context.project.redo()),
    "write": _write,
    "arrange": _arrange,
}
"""The functions that answer requests which change something, in turn."""
