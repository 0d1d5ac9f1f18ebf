"""Steps of translations: a closed set of types, which printers print."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

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
    """Refuses the message unless a condition holds.

    Attributes:
        texts: What the error is given.
    """

    condition: Condition
    error: str
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Choose:
    """Steps that are executed only where conditions hold.

    Attributes:
        conditions: Alternatives, one of which suffices; all conditions within it must hold.
    """

    conditions: tuple[tuple[Condition, ...], ...]
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class WhereKept:
    """Steps that are executed only if an attribute of the bridge has a kept value."""

    name: str
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Octets:
    """Elements of a list that are single octets on both sides.

    Attributes:
        record: Class of the records of JAUS that are made; empty where numbers of ROS are.
    """

    record: str


@dataclass(frozen=True)
class Each:
    """The elements of a list, made from those of another.

    Attributes:
        items: The list that is read; `item` is its present element, `index` the number of it.
        needs_index: Whether a step uses `index`.
        element: The variable for the element that is made.
        new: An element without values; None where the steps make it.
        steps: What is executed for each element.
        place: The list that is made.
        starts_empty: Whether the list must be made empty before elements are added: a new message
            has none, or one with elements.
        is_assigned_at_end: Whether the list must be complete before it is put in its place.
        octets: How octets are copied where the elements of both lists are octets; None for others.
    """

    items: Expression
    item: Local
    index: Local
    needs_index: bool
    element: Local
    new: Expression | None
    steps: tuple[Step, ...]
    place: Place
    starts_empty: bool = False
    is_assigned_at_end: bool = False
    octets: Octets | None = None


Step: TypeAlias = Let | Write | Keep | Append | Require | Choose | WhereKept | Each


def sets(steps: tuple[Step, ...], place: Place) -> bool:
    """Tells whether steps set a place under all conditions."""
    return any(isinstance(step, Write) and step.place == place for step in steps)
