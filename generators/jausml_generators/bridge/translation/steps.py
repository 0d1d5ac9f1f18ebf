"""Typed steps of translations: a closed set, in order, which printers print in a language."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from jausml_generators.bridge.translation.expressions import Expression
    from jausml_generators.bridge.translation.places import Condition, Local, Place


@dataclass(frozen=True)
class Let:
    """Gives a variable a value, or several variables the results of a conversion."""

    locals: tuple[Local, ...]
    value: Expression


@dataclass(frozen=True)
class Write:
    """Gives a place a value."""

    place: Place
    value: Expression
    remark: str = ""


@dataclass(frozen=True)
class Keep:
    """Keeps a value for later messages in an attribute of the bridge."""

    name: str
    value: Expression


@dataclass(frozen=True)
class Append:
    """Adds an element to a list."""

    place: Place
    value: Expression


@dataclass(frozen=True)
class Require:
    """Refuses the message unless a condition holds."""

    condition: Condition
    error: str
    text: str


@dataclass(frozen=True)
class Choose:
    """Steps that are gone where conditions hold."""

    conditions: tuple[tuple[Condition, ...], ...]
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class WhereKept:
    """Steps that are gone once a value has been kept in an attribute of the bridge."""

    name: str
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Alike:
    """How the elements of two lists lie, where all lie alike in each.

    Attributes:
        code: Format character of `struct` where numbers of ROS are made; empty for records.
    """

    item: str
    made: str
    code: str
    are_octets: bool


@dataclass(frozen=True)
class Each:
    """Makes the elements of a list from those of another.

    Attributes:
        new: An element without values; None where the steps make it.
        is_fresh: Whether the list is not there, or not empty, in a message as it is made.
        is_replaced: Whether the list must be complete before it is put in its place.
        alike: How the elements lie; None where they do not lie alike.
    """

    items: Expression
    item: Local
    index: Local
    is_counted: bool
    element: Local
    new: Expression | None
    steps: tuple[Step, ...]
    place: Place
    is_fresh: bool = False
    is_replaced: bool = False
    alike: Alike | None = None
    owner: str = ""


Step: TypeAlias = Let | Write | Keep | Append | Require | Choose | WhereKept | Each


def gives(steps: tuple[Step, ...], place: Place) -> bool:
    """Tells whether steps give a place a value whatever holds."""
    return any(isinstance(each, Write) and each.place == place for each in steps)
