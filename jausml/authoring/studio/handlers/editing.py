"""Requests that change the project, and the answers that say what was done."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - parameters are typed at run time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import Add, EditError, Place, Set
from jausml.authoring.proposals.new_elements import free_address
from jausml.authoring.studio.handlers import showing
from jausml.authoring.studio.json_values import command, entry_as_json
from jausml.authoring.studio.rpc import Method, Nothing
from jausml.language.metamodel.classes import jaus

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.editing.records import Entry
    from jausml.authoring.studio.context import KeptEdit, StudioContext
    from jausml.language.model import Model

_ADDRESS = "address"


@dataclass(frozen=True)
class Edit:
    """Commands to be carried out, all or none."""

    commands: tuple[Mapping[str, object], ...]
    label: str
    base: int | None = None
    dry: bool = False


@dataclass(frozen=True)
class Write:
    """What somebody typed."""

    file: str
    text: str
    base: int


@dataclass(frozen=True)
class Copy:
    """Elements to be described."""

    elements: tuple[str, ...]


@dataclass(frozen=True)
class Paste:
    """Descriptions of elements that are to be added.

    Attributes:
        commands: What `copy` gave.
    """

    owner: str
    commands: tuple[Mapping[str, object], ...]


@dataclass(frozen=True)
class Kept:
    """An edit that is kept, by its number."""

    number: int


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "edit": Method(Edit, lambda request: _edit(context, request), in_turn=True),
        "kept": Method(Nothing, lambda _: _kept(context)),
        "kept.again": Method(Kept, lambda request: _again(context, request), in_turn=True),
        "kept.discard": Method(Kept, lambda request: _discard(context, request), in_turn=True),
        "copy": Method(
            Copy, lambda request: {"commands": context.project.describe(request.elements)}
        ),
        "paste": Method(Paste, lambda request: _paste(context, request), in_turn=True),
        "undo": Method(Nothing, lambda _: _undo(context), in_turn=True),
        "redo": Method(Nothing, lambda _: _redo(context), in_turn=True),
        "log": Method(Nothing, lambda _: _log(context)),
        "write": Method(Write, lambda request: _write(context, request), in_turn=True),
        "arrange": Method(showing.OfView, lambda request: _arrange(context, request), in_turn=True),
    }


def _edit(context: StudioContext, request: Edit) -> dict[str, Any]:
    commands = [command(each, f"commands[{i}]") for i, each in enumerate(request.commands)]
    return edit(context, commands, request.label, request.base, dry=request.dry)


def edit(
    context: StudioContext, commands: list[Command], label: str, base: int | None, *, dry: bool
) -> dict[str, Any]:
    """Carries out commands, or tells what they would do; see `Edit`."""
    project = context.project
    if dry:
        seen = project.preview(commands, base)
        return {
            "revision": project.revision,
            "created": seen.created,
            "diff": seen.diff,
            "referrers": seen.referrers,
        }
    base = project.revision if base is None else base
    return _carried_out(context, commands, label, base)


def _carried_out(
    context: StudioContext,
    commands: Sequence[Command],
    label: str,
    base: int,
    kept: KeptEdit | None = None,
) -> dict[str, Any]:
    project = context.project
    try:
        # Who does it again has seen what others did, and means it.
        made = project.do(commands, label, base, is_first=kept is None)
    except EditError as error:
        if error.conflict and (kept or context.keep(commands, label, base, str(error))):
            message = f"{error}. It is kept: do it again or discard it"
            raise EditError(message, conflict=True) from error
        raise
    finally:
        # What it met on its way is told, whether it was done or not.
        context.notify_outside(context.project.unreported())
    if kept is not None:
        # Only now, whatever kept it from being done.
        context.kept.discard(kept.number)
        context.notify_kept()
    context.changed(made)
    return {"revision": project.revision, "entry": entry_as_json(made), "created": made.created}


def _kept(context: StudioContext) -> dict[str, Any]:
    return {"edits": [each.as_json() for each in context.kept.all]}


def _again(context: StudioContext, request: Kept) -> dict[str, Any]:
    edit = context.kept.find(request.number)
    if edit is None:
        raise EditError("this edit is kept no more")
    return _carried_out(context, edit.commands, edit.label, edit.base, edit)


def _discard(context: StudioContext, request: Kept) -> dict[str, Any]:
    context.kept.discard(request.number)
    context.notify_kept()
    return {}


def _paste(context: StudioContext, request: Paste) -> dict[str, Any]:
    given = [command(each, f"commands[{i}]") for i, each in enumerate(request.commands)]
    added = [each for each in given if isinstance(each, Add | Set)]
    model = context.project.find(request.owner)[1]
    made = context.project.paste(with_free_addresses(model, added), request.owner, "Paste")
    context.changed(made)
    return {
        "revision": context.project.revision,
        "entry": entry_as_json(made),
        "created": made.created,
    }


def _undo(context: StudioContext) -> dict[str, Any]:
    return _done(context, context.project.undo())


def _redo(context: StudioContext) -> dict[str, Any]:
    return _done(context, context.project.redo())


def _done(context: StudioContext, made: Entry | None) -> dict[str, Any]:
    if made is not None:
        context.changed(made)
    return {"revision": context.project.revision, "entry": entry_as_json(made)}


def _log(context: StudioContext) -> dict[str, Any]:
    done, undone = context.project.log, context.project.undone
    return {"entries": [entry_as_json(each) for each in (*done, *undone)], "at": len(done)}


def _write(context: StudioContext, request: Write) -> dict[str, Any]:
    made = context.project.write_text(request.file, request.text, request.base)
    context.changed(made)
    return {"revision": context.project.revision}


def _arrange(context: StudioContext, request: showing.OfView) -> dict[str, Any]:
    placed = context.project.positions(request.file, request.view)
    if placed:
        forget = Place(request.file, request.view, dict.fromkeys(placed))
        context.changed(context.project.do([forget], f"Arrange {request.view}"))
    context.drawings.forget(request.file, request.view)
    return showing.view(context, request)


def with_free_addresses(model: Model, commands: Sequence[Add | Set]) -> list[Add | Set]:
    """Returns what was copied with JAUS ids of its own, where those that it has are in use."""
    components = model.instances(jaus.Component, library=False)
    used = {str(each.address) for each in components if each.address}
    found: list[Add | Set] = []
    for each in commands:
        own = each.values.get(_ADDRESS, ()) if isinstance(each, Add) else ()
        if isinstance(each, Add) and own and own[0] in used:
            own = (free_address(model, used),)
            found.append(replace(each, values={**each.values, _ADDRESS: own}))
        else:
            found.append(each)
        used.update(own)
    return found
