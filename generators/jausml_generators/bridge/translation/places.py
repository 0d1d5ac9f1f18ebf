"""Places in messages, and conditions on them, for any language."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeAlias

from jausml.language.attributes import expressions as authored
from jausml.language.attributes.expressions import opposite


class PathError(ValueError):
    """A path that leads nowhere."""


# Compared by identity: two variables may have the same hint.
@dataclass(frozen=True, eq=False)
class Local:
    """A variable of a translation; printers name it at its assignment."""

    hint: str


@dataclass(frozen=True)
class Place:
    """A variable, or a part of it.

    Attributes:
        root: The variable: a parameter by its name, or a local one.
        steps: The way on by attributes, as texts, and by elements of lists, as numbers.
    """

    root: str | Local
    steps: tuple[str | int, ...] = ()

    def at(self, *steps: str | int) -> Place:
        """Returns the place some steps further."""
        return replace(self, steps=(*self.steps, *steps))

    @property
    def last(self) -> str:
        """The name that a variable for the value should have."""
        # Only the last name and the indexes behind it make the hint: whole paths are too long.
        words = [str(self.root.hint if isinstance(self.root, Local) else self.root)]
        for step in self.steps:
            words = [*words, f"{step}"] if isinstance(step, int) else [step]
        return "_".join(words)

    def is_within(self, other: Place) -> bool:
        """Whether it is another place, or a part of it."""
        count = len(other.steps)
        return self.root == other.root and self.steps[:count] == other.steps

    def named(self, other: Place, local: Local) -> Place:
        """Returns this place as a part of a variable, which holds a place that this one is in."""
        return Place(local, self.steps[len(other.steps) :])


@dataclass(frozen=True)
class There:
    """The condition that a place is not empty."""

    place: Place


@dataclass(frozen=True)
class Longer:
    """A list has more than some elements."""

    place: Place
    than: int


@dataclass(frozen=True)
class Chosen:
    """The variable field at a place has the alternative of an index."""

    place: Place
    index: int


@dataclass(frozen=True)
class IsOption:
    """The variant at a place is the option of a class."""

    place: Place
    class_name: str


@dataclass(frozen=True)
class Equal:
    """The number at a place is this one."""

    place: Place
    number: int


@dataclass(frozen=True)
class AsLongAs:
    """A list has an element for each of the names in a constant."""

    place: Place
    names: str


@dataclass(frozen=True)
class MarkerOperand:
    """A number that a marker asks for.

    Attributes:
        place: The number, or the list whose elements are counted.
        type: The primitive type of ROS; empty for the count of a list.
    """

    place: Place
    type: str


@dataclass(frozen=True)
class HasValue:
    """A marker does not say that the field at a place has no value.

    Attributes:
        marker: What it asks.
        operands: What the names in it stand for.
    """

    place: Place
    marker: authored.Expression
    operands: tuple[tuple[str, MarkerOperand], ...]

    @property
    def condition(self) -> authored.Expression:
        """The opposite of the marker."""
        return opposite(self.marker)


@dataclass(frozen=True)
class Named:
    """No condition, but a variable for the value that the conditions before it have found."""

    local: Local
    place: Place


Condition: TypeAlias = There | Longer | Chosen | IsOption | Equal | AsLongAs | HasValue
Requirement: TypeAlias = Condition | Named
"""What a value needs to be there: conditions, and variables for what they found."""


def without_implied(conditions: Iterable[Requirement]) -> tuple[Requirement, ...]:
    """Returns conditions without those that others imply."""
    unique = tuple(dict.fromkeys(conditions))
    longest: dict[Place, int] = {}
    for condition in unique:
        if isinstance(condition, Longer):
            # A list with more than 5 elements has more than 3 too: the strictest test is enough.
            longest[condition.place] = max(condition.than, longest.get(condition.place, 0))
    kept = (
        replace(condition, than=longest[condition.place])
        if isinstance(condition, Longer)
        else condition
        for condition in unique
    )
    return tuple(dict.fromkeys(kept))


def only_conditions(requirements: Iterable[Requirement]) -> tuple[Condition, ...]:
    """Returns requirements without the variables among them."""
    return tuple(condition for condition in requirements if not isinstance(condition, Named))
