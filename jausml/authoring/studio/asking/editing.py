"""Requests that change the project, and what they are told to have done."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - parameters are typed at run time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import Add, EditError, Place, Set
from jausml.authoring.studio import shown
from jausml.authoring.studio.answers.pasting import with_free_addresses
from jausml.authoring.studio.asking import showing
from jausml.authoring.studio.encoding import command
from jausml.authoring.studio.methods import Method, Nothing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.editing.records import Entry
    from jausml.authoring.studio.desk import Desk
    from jausml.authoring.studio.keeping import KeptEdit


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


def methods(desk: Desk) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "edit": Method(Edit, lambda asked: _edit(desk, asked), in_turn=True),
        "kept": Method(Nothing, lambda _: _kept(desk)),
        "kept.again": Method(Kept, lambda asked: _again(desk, asked), in_turn=True),
        "kept.discard": Method(Kept, lambda asked: _discard(desk, asked), in_turn=True),
        "copy": Method(Copy, lambda asked: {"commands": desk.project.describe(asked.elements)}),
        "paste": Method(Paste, lambda asked: _paste(desk, asked), in_turn=True),
        "undo": Method(Nothing, lambda _: _undo(desk), in_turn=True),
        "redo": Method(Nothing, lambda _: _redo(desk), in_turn=True),
        "log": Method(Nothing, lambda _: _log(desk)),
        "write": Method(Write, lambda asked: _write(desk, asked), in_turn=True),
        "arrange": Method(showing.OfView, lambda asked: _arrange(desk, asked), in_turn=True),
    }


def _edit(desk: Desk, asked: Edit) -> dict[str, Any]:
    commands = [command(each, f"commands[{i}]") for i, each in enumerate(asked.commands)]
    return edit(desk, commands, asked.label, asked.base, dry=asked.dry)


def edit(
    desk: Desk, commands: list[Command], label: str, base: int | None, *, dry: bool
) -> dict[str, Any]:
    """Carries out commands, or tells what they would do; see `Edit`."""
    project = desk.project
    if dry:
        seen = project.preview(commands, base)
        return {
            "revision": project.revision,
            "created": seen.created,
            "diff": seen.diff,
            "referrers": seen.referrers,
        }
    base = project.revision if base is None else base
    return _carried_out(desk, commands, label, base)


def _carried_out(
    desk: Desk,
    commands: Sequence[Command],
    label: str,
    base: int,
    kept: KeptEdit | None = None,
) -> dict[str, Any]:
    project = desk.project
    try:
        # Who does it again has seen what others did, and means it.
        made = project.do(commands, label, base, is_first=kept is None)
    except EditError as error:
        if error.conflict and (kept or desk.keep(commands, label, base, str(error))):
            message = f"{error}. It is kept: do it again or discard it"
            raise EditError(message, conflict=True) from error
        raise
    finally:
        # What it met on its way is told, whether it was done or not.
        desk.tell_outside(desk.project.met())
    if kept is not None:
        # Only now, whatever kept it from being done.
        desk.kept.discard(kept.number)
        desk.tell_kept()
    desk.changed(made)
    return {"revision": project.revision, "entry": shown.entry(made), "created": made.created}


def _kept(desk: Desk) -> dict[str, Any]:
    return {"edits": [each.told for each in desk.kept.all]}


def _again(desk: Desk, asked: Kept) -> dict[str, Any]:
    edit = desk.kept.find(asked.number)
    if edit is None:
        raise EditError("this edit is kept no more")
    return _carried_out(desk, edit.commands, edit.label, edit.base, edit)


def _discard(desk: Desk, asked: Kept) -> dict[str, Any]:
    desk.kept.discard(asked.number)
    desk.tell_kept()
    return {}


def _paste(desk: Desk, asked: Paste) -> dict[str, Any]:
    given = [command(each, f"commands[{i}]") for i, each in enumerate(asked.commands)]
    added = [each for each in given if isinstance(each, Add | Set)]
    model = desk.project.find(asked.owner)[1]
    made = desk.project.paste(with_free_addresses(model, added), asked.owner, "Paste")
    desk.changed(made)
    return {"revision": desk.project.revision, "entry": shown.entry(made), "created": made.created}


def _undo(desk: Desk) -> dict[str, Any]:
    return _done(desk, desk.project.undo())


def _redo(desk: Desk) -> dict[str, Any]:
    return _done(desk, desk.project.redo())


def _done(desk: Desk, made: Entry | None) -> dict[str, Any]:
    if made is not None:
        desk.changed(made)
    return {"revision": desk.project.revision, "entry": shown.entry(made)}


def _log(desk: Desk) -> dict[str, Any]:
    done, undone = desk.project.log, desk.project.undone
    return {"entries": [shown.entry(each) for each in (*done, *undone)], "at": len(done)}


def _write(desk: Desk, asked: Write) -> dict[str, Any]:
    made = desk.project.write_text(asked.file, asked.text, asked.base)
    desk.changed(made)
    return {"revision": desk.project.revision}


def _arrange(desk: Desk, asked: showing.OfView) -> dict[str, Any]:
    placed = desk.project.positions(asked.file, asked.view)
    if placed:
        forget = Place(asked.file, asked.view, dict.fromkeys(placed))
        desk.changed(desk.project.do([forget], f"Arrange {asked.view}"))
    desk.drawings.forget(asked.file, asked.view)
    return showing.view(desk, asked)
