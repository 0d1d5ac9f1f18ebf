"""Commands: what a user wants changed, in the terms of the metamodels."""

from __future__ import annotations

# The types of commands are asked for at run time, where commands come as JSON.
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, TypeAlias, TypeVar

from jausml.language.model.refs import Ref

LayoutKey: TypeAlias = str
"""Name of a box of a view that survives shifts of positions, such as `bridge:main/velocity`."""

Values: TypeAlias = "tuple[str, ...]"
"""Values of a feature: attributes as XMI writes them, references as refs; none unset it."""

NEW = "new:"
"""`new:0` is a ref to what the first `Add` or `Create` of a batch of commands made, and so on.

`new:0/@maps.1` is a ref to what that owns.
"""

IDENTIFIER = "xmi:id"
"""Among the values of a new element: the id that it shall have. Without one it gets none."""

ElementCommand: TypeAlias = "Set | Add | Remove | Move | Rename"

Command: TypeAlias = "ElementCommand | Create | Place"


class EditError(Exception):
    """Why a command is not carried out, for people. Nothing was changed.

    `conflict`: whether the reason is that a file has changed since the command was thought of.
    """

    def __init__(self, message: str, *, conflict: bool = False) -> None:
        super().__init__(message)
        self.conflict = conflict


@dataclass(frozen=True, slots=True)
class Set:
    """Gives a feature of an element its values; without any, the feature is no longer set."""

    NAME: ClassVar = "set"

    element: Ref
    feature: str
    values: Values = ()


@dataclass(frozen=True, slots=True)
class Child:
    """An element that a new element owns.

    `kind`: its class with the package, such as `bridge.PeriodicConnection`.
    """

    feature: str
    kind: str
    values: Mapping[str, Values] = field(default_factory=dict)
    children: tuple[Child, ...] = ()


@dataclass(frozen=True, slots=True)
class Add:
    """Adds an element with what it owns.

    `position`: its position among the values of the feature, None for the end.
    """

    NAME: ClassVar = "add"

    owner: Ref
    feature: str
    kind: str
    values: Mapping[str, Values] = field(default_factory=dict)
    children: tuple[Child, ...] = ()
    position: int | None = None


@dataclass(frozen=True, slots=True)
class Remove:
    """Removes an element, what it owns, and what refers to either.

    References to it lose this value; what cannot be without a reference goes too.
    """

    NAME: ClassVar = "remove"

    element: Ref


@dataclass(frozen=True, slots=True)
class Movement:
    """An element that goes elsewhere with another one, as `Move` says it."""

    element: Ref
    owner: Ref
    feature: str
    position: int | None = None


@dataclass(frozen=True, slots=True)
class Move:
    """Gives an element another owner, or another position; what refers to it follows.

    `also`: what moves with it. All refs are those before, each position is that after the moves
    before it.
    """

    NAME: ClassVar = "move"

    element: Ref
    owner: Ref
    feature: str
    position: int | None = None
    also: tuple[Movement, ...] = ()

    @property
    def single_moves(self) -> tuple[Move, ...]:
        """The moves that it is, one for each element."""
        others = (
            Move(movement.element, movement.owner, movement.feature, movement.position)
            for movement in self.also
        )
        return replace(self, also=()), *others


@dataclass(frozen=True, slots=True)
class Rename:
    """Gives an element another name; what refers to it by name follows."""

    NAME: ClassVar = "rename"

    element: Ref
    name: str


@dataclass(frozen=True, slots=True)
class Create:
    """Makes a model file with one root element."""

    NAME: ClassVar = "create"

    file: str
    kind: str
    values: Mapping[str, Values] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Place:
    """Places boxes of a view by hand.

    `positions`: upper left corners in pixels by the key of the box; None leaves a box to the layout
    engine again.
    """

    NAME: ClassVar = "place"

    file: str
    view: str
    positions: Mapping[LayoutKey, tuple[int, int] | None]


AddedT = TypeVar("AddedT", Add, Child)


def with_created(command: ElementCommand, known: Callable[[Ref], Ref]) -> ElementCommand:
    """Returns a command with refs to what is there in place of those to what was made.

    `known`: returns the ref for which one such as `new:0` stands, and any other text as it is.
    """
    if isinstance(command, Set):
        values = tuple(map(known, command.values))
        return replace(command, element=known(command.element), values=values)
    if isinstance(command, Rename | Remove):
        return replace(command, element=known(command.element))
    if isinstance(command, Move):
        also = tuple(
            replace(movement, element=known(movement.element), owner=known(movement.owner))
            for movement in command.also
        )
        element, owner = known(command.element), known(command.owner)
        return replace(command, element=element, owner=owner, also=also)
    return replace(_inside(command, known), owner=known(command.owner))


def _inside(addition: AddedT, known: Callable[[Ref], Ref]) -> AddedT:
    values = {name: tuple(map(known, value)) for name, value in addition.values.items()}
    children = tuple(_inside(child, known) for child in addition.children)
    return replace(addition, values=values, children=children)
