"""Commands: changes that a user wants, in the terms of the metamodels."""

from __future__ import annotations

# The types of commands are read at run time, where commands come as JSON.
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, TypeAlias, TypeVar

from jausml.language.model.refs import Ref

LayoutKey: TypeAlias = str
"""Name of a box of a view that survives shifts of positions, such as `bridge:main/velocity`."""

Values: TypeAlias = "tuple[str, ...]"
"""Values of a feature: attributes as XMI writes them, references as refs; none unset it."""

NEW = "new:"
"""`new:0` is a ref to the element of the first `Add` or `Create` in a batch of commands, and so on;
`new:0/@maps.1` to a part of it.
"""

IDENTIFIER = "xmi:id"
"""The key of the id of a new element among its values; without one it gets no id."""

ElementCommand: TypeAlias = "Set | Add | Remove | Move | Rename"

Command: TypeAlias = "ElementCommand | Create | Place"


class EditError(Exception):
    """A refused command, with the reason for people. Nothing was changed.

    `conflict`: whether a file has changed since the state that the command is for.
    """

    def __init__(self, message: str, *, conflict: bool = False) -> None:
        super().__init__(message)
        self.conflict = conflict


@dataclass(frozen=True, slots=True)
class Set:
    """Sets the values of a feature; without any, the feature is no longer set."""

    NAME: ClassVar = "set"

    element: Ref
    feature: str
    values: Values = ()


@dataclass(frozen=True, slots=True)
class Child:
    """A part of a new element.

    `kind`: its class with the package, such as `bridge.PeriodicConnection`.
    """

    feature: str
    kind: str
    values: Mapping[str, Values] = field(default_factory=dict)
    children: tuple[Child, ...] = ()


@dataclass(frozen=True, slots=True)
class Add:
    """Adds an element with its parts.

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
    """Removes an element with its parts.

    References to them lose this value; elements that need such a reference are removed too.
    """

    NAME: ClassVar = "remove"

    element: Ref


@dataclass(frozen=True, slots=True)
class Movement:
    """A further element that a `Move` moves."""

    element: Ref
    owner: Ref
    feature: str
    position: int | None = None


@dataclass(frozen=True, slots=True)
class Move:
    """Moves an element to another owner or position; references to it follow.

    `also`: further elements that move. All refs are of the state before, each position is that
    after the moves before it.
    """

    NAME: ClassVar = "move"

    element: Ref
    owner: Ref
    feature: str
    position: int | None = None
    also: tuple[Movement, ...] = ()

    @property
    def single_moves(self) -> tuple[Move, ...]:
        """A move for each element."""
        others = (
            Move(movement.element, movement.owner, movement.feature, movement.position)
            for movement in self.also
        )
        return replace(self, also=()), *others


@dataclass(frozen=True, slots=True)
class Rename:
    """Renames an element; references by name follow."""

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

    `positions`: upper left corners in pixels by the key of the box; None has the layout engine
    place the box again.
    """

    NAME: ClassVar = "place"

    file: str
    view: str
    positions: Mapping[LayoutKey, tuple[int, int] | None]


AddedT = TypeVar("AddedT", Add, Child)


def with_created(command: ElementCommand, known: Callable[[Ref], Ref]) -> ElementCommand:
    """Returns a command with refs to existing elements instead of refs such as `new:0`.

    `known`: returns the ref of an element that was made, and any other text as it is.
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
