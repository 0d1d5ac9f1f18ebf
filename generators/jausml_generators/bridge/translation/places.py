"""Places in messages, and what must hold for something to stand there: typed, in no language."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True, eq=False)
class Local:
    """A variable of a translation; printers name it where it is given its value."""

    hint: str


@dataclass(frozen=True)
class Place:
    """A variable, or what stands in it.

    Attributes:
        root: The variable: a parameter by its name, or a local one.
        steps: The way on by attributes, as texts, and by elements of lists, as numbers.
    """

    root: str | Local
    steps: tuple[str | int, ...] = ()

    def at(self, *steps: str | int) -> Place:
        """Returns what stands some steps further."""
        return replace(self, steps=(*self.steps, *steps))

    @property
    def last(self) -> str:
        """What a variable for the value should be called."""
        words = [str(self.root.hint if isinstance(self.root, Local) else self.root)]
        for step in self.steps:
            words = [*words, f"{step}"] if isinstance(step, int) else [step]
        return "_".join(words)

    def is_within(self, other: Place) -> bool:
        """Whether it is another place, or stands in it."""
        count = len(other.steps)
        return self.root == other.root and self.steps[:count] == other.steps

    def named(self, other: Place, local: Local) -> Place:
        """Returns the same place by the variable that holds a place on the way to it."""
        return Place(local, self.steps[len(other.steps) :])


@dataclass(frozen=True)
class There:
    """Something stands at a place, which may be empty."""

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
class Named:
    """No condition, but a variable for what those before it have found."""

    local: Local
    place: Place


Condition: TypeAlias = There | Longer | Chosen | IsOption | Equal | AsLongAs
Way: TypeAlias = Condition | Named
"""What stands on the way to a value: conditions, and variables for what they found."""


def joined(conditions: Iterable[Way]) -> tuple[Way, ...]:
    """Returns conditions without those that others imply."""
    unique = tuple(dict.fromkeys(conditions))
    longest: dict[Place, int] = {}
    for each in unique:
        if isinstance(each, Longer):
            longest[each.place] = max(each.than, longest.get(each.place, 0))
    kept = (
        replace(each, than=longest[each.place]) if isinstance(each, Longer) else each
        for each in unique
    )
    return tuple(dict.fromkeys(kept))
