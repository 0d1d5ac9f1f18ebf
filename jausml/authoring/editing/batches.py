"""Batches of commands, of which later ones speak of what earlier ones made."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from jausml.authoring.editing.commands import Add, Child, Move, Remove, Rename, Set

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.language.model.refs import Ref

AddedT = TypeVar("AddedT", Add, Child)


def with_created(
    command: Set | Add | Remove | Move | Rename, known: Callable[[Ref], Ref]
) -> Set | Add | Remove | Move | Rename:
    """Returns a command with refs to what is there in place of those to what was made.

    Args:
        known: Returns the ref for which one such as `new:0` stands, and any other text as it is.
    """
    if isinstance(command, Set):
        values = tuple(map(known, command.values))
        return replace(command, element=known(command.element), values=values)
    if isinstance(command, Rename | Remove):
        return replace(command, element=known(command.element))
    if isinstance(command, Move):
        return replace(command, element=known(command.element), owner=known(command.owner))
    return replace(_inside(command, known), owner=known(command.owner))


def _inside(made: AddedT, known: Callable[[Ref], Ref]) -> AddedT:
    values = {name: tuple(map(known, each)) for name, each in made.values.items()}
    children = tuple(_inside(each, known) for each in made.children)
    return replace(made, values=values, children=children)
