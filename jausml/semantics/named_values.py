"""Named values: enumerations of both sides of an assignment, compared by their names."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.semantics.attributes import NUMBER, Attribute
from jausml.semantics.values import is_real

if TYPE_CHECKING:
    from collections.abc import Iterator

_LEAST_COMMON = 2
"""Names that both sides have from which on they are taken for one enumeration."""


@dataclass(frozen=True)
class NamedValue:
    """A value that has a name.

    Attributes:
        name: Its name, as the model writes it.
        number: Its number.
    """

    name: str
    number: int


@dataclass(frozen=True)
class Comparison:
    """Two enumerations.

    Attributes:
        source: That of the source, by the name without case, separators and prefix.
        target: That of the target, likewise.
    """

    source: dict[str, NamedValue]
    target: dict[str, NamedValue]

    @property
    def common(self) -> list[tuple[NamedValue, NamedValue]]:
        """What both have by name, in the order of the source."""
        return [(each, self.target[key]) for key, each in self.source.items() if key in self.target]

    @property
    def renumbered(self) -> list[tuple[NamedValue, NamedValue]]:
        """What both have by name, with other numbers."""
        return [(one, other) for one, other in self.common if one.number != other.number]

    @property
    def unmatched(self) -> list[NamedValue]:
        """The values of the source of which the target has neither the name nor the number."""
        numbers = {each.number for each in self.target.values()}
        return [
            each
            for key, each in self.source.items()
            if key not in self.target and each.number not in numbers
        ]

    @property
    def is_of_one_enumeration(self) -> bool:
        """Whether so many names are common that both sides mean the same values."""
        return len(self.common) >= min(_LEAST_COMMON, len(self.source), len(self.target))


def compared(source: Attribute, target: Attribute) -> Comparison | None:
    """Returns the enumerations of the ends of an assignment; None if not both have names.

    Args:
        source: What is read.
        target: What is filled.
    """
    found = Comparison(named_values(source), named_values(target))
    return found if found.source and found.target and found.common else None


def named_values(attribute: Attribute) -> dict[str, NamedValue]:
    """Returns the named values of a number, by their names without case, separators and prefix.

    Constants of a ROS type belong to all of its fields. Those that begin with the name of the field
    are its own; where none does, all count that have no such prefix of another one in common.
    """
    if attribute.kind != NUMBER or not attribute.integral:
        return {}
    label = _plain(attribute.label)
    pairs = [(name, int(float(value))) for name, value in attribute.constants if is_real(value)]
    own = [pair for pair in pairs if label and _plain(pair[0]).startswith(label)]
    if not attribute.is_ros:
        own = []
    return {
        key: NamedValue(name, number)
        for name, number in own or pairs
        if (key := _plain(name).removeprefix(label if own else ""))
    }


def table_text(found: Comparison, *, to_ros: bool) -> str:
    """Returns the entries of a table that maps common values by their names, as text.

    Args:
        found: The enumerations.
        to_ros: The direction of the assignment.
    """
    return "  ".join(_entries(found, to_ros=to_ros))


def _entries(found: Comparison, *, to_ros: bool) -> Iterator[str]:
    for one, other in found.common:
        jaus, ros = (one, other) if to_ros else (other, one)
        yield f"{_written(jaus.name)} <-> {_written(ros.name)}"


def _written(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z_]\w*", name) else f'"{name}"'


def _plain(name: str) -> str:
    return re.sub(r"[\W_]+", "", name).casefold()
