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
    """Gives a place a value.

    Attributes:
        place: The place.
        value: The value.
        remark: What is said of it, such as its unit.
    """

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
    """Refuses the message unless a condition holds.

    Attributes:
        condition: The condition.
        error: Class of the error.
        text: What is wrong: for an absent field, its path.
    """

    condition: Condition
    error: str
    text: str


@dataclass(frozen=True)
class Choose:
    """Steps that are gone where conditions hold.

    Attributes:
        conditions: Alternatives, each of conditions that hold together.
        steps: The steps.
    """

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
        item: Python type of an element that is gone through.
        made: Python type of an element that is made.
        code: Format character of `struct` where numbers of ROS are made; empty for records.
        are_octets: Whether each is a number of eight bits, on both sides.
    """

    item: str
    made: str
    code: str
    are_octets: bool


@dataclass(frozen=True)
class Each:
    """Makes the elements of a list from those of another.

    Attributes:
        items: The elements that are gone through.
        item: Variable of each.
        index: Variable of its number.
        is_counted: Whether the steps ask for the number.
        element: Variable of the element that is made.
        new: An element without values; None where the steps make it.
        steps: What is done for each.
        place: The list that is filled.
        is_fresh: Whether the list is not there, or not empty, in a message as it is made.
        is_replaced: Whether the list must be complete before it is put in its place.
        alike: How the elements lie; None where they do not lie alike.
        owner: Attribute of the bridge that is the connection.
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
