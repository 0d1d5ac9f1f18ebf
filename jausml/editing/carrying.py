"""Carrying out of commands in a draft, one after the other, each checked by reading again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.editing.commands import EditError, Set
from jausml.editing.planning import Context
from jausml.editing.xmi.planner import XmiPlanner
from jausml.text.notation import SUFFIX

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.editing.commands import Command
    from jausml.editing.drafts import Draft
    from jausml.editing.planning import Planner
    from jausml.editing.records import Referrer
    from jausml.model.refs import Ref


@dataclass(frozen=True, slots=True)
class Outcome:
    """What commands did: the elements that they made, and what lost its reference or went too."""

    created: tuple[Ref, ...] = ()
    referrers: tuple[Referrer, ...] = ()


def planner_of(file: str) -> Planner:
    """Returns the planner of the notation of a file."""
    if file.endswith(SUFFIX):
        raise EditError(f"{file} is text, which cannot be edited by commands yet")
    return XmiPlanner()


def carry_out(commands: Sequence[Command], draft: Draft) -> Outcome:
    """Carries out commands in a draft.

    Args:
        commands: The commands, each of which finds what those before it did.
        draft: The draft.

    Raises:
        EditError: They cannot be carried out; the draft is worth nothing any more.
    """
    for each in commands:
        if not isinstance(each, Set):
            raise EditError(f"{type(each).__name__} is not known yet")
        draft.element(each.element)
        file = draft.editable(each.element)
        context = Context(file, draft.root, draft.read(file).model)
        draft.apply(file, planner_of(file).plan([each], context))
    return Outcome()
