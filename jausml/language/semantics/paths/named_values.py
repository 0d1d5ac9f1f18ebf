"""Named values: enumerations of both sides of an assignment, compared by their names."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import takewhile
from typing import TypeAlias

from jausml.language.model.words import words
from jausml.language.semantics.paths.attributes import NUMBER, Attribute, is_real

_LEAST_COMMON = 2
"""Names that both sides have from which on they are taken for one enumeration."""


@dataclass(frozen=True)
class NamedValue:
    """A value that has a name."""

    name: str
    number: int


_Named: TypeAlias = "tuple[list[str], NamedValue]"
"""A value with the words of its name."""


@dataclass(frozen=True)
class Comparison:
    """Two enumerations."""

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
    """Returns the enumerations of the ends of an assignment; None if not both have names."""
    found = Comparison(named_values(source), named_values(target))
    return found if found.source and found.target and found.common else None


def named_values(attribute: Attribute) -> dict[str, NamedValue]:
    """Returns the named values of a number, by their names without case, separators and prefix.

    Constants of a ROS type belong to all of its fields. Those that begin with the name of the field
    are its own, else those that begin with the first words of that name; where none does, all
    count. What all names have in common at their beginning is no part of them.
    """
    if attribute.kind != NUMBER or not attribute.integral:
        return {}
    found = [
        (_words(name), NamedValue(name, int(float(value))))
        for name, value in attribute.constants
        if is_real(value)
    ]
    if attribute.is_ros:
        found = _own(_words(attribute.label), found)
    found = [(each, value) for each, value in found if each]
    common = _common([each for each, _ in found])
    return {"".join(each[common:]): value for each, value in found}


def _own(label: list[str], found: list[_Named]) -> list[_Named]:
    """Returns the constants of a field: those with the longest beginning of its name."""
    for length in range(len(label), 0, -1):
        beginning = "".join(label[:length])
        own = [
            (rest, value)
            for each, value in found
            if (rest := _without(beginning, each)) is not None
        ]
        if own:
            return own
    return found


def _without(beginning: str, name: list[str]) -> list[str] | None:
    """Returns the words of a name behind a beginning; None where it begins otherwise."""
    for length in range(1, len(name) + 1):
        if "".join(name[:length]) == beginning:
            return name[length:]
    return None


def _common(names: list[list[str]]) -> int:
    """Returns how many words several names have in common at their beginning, none a whole name."""
    if len(names) < _LEAST_COMMON:
        return 0
    columns = zip(*(each[:-1] for each in names), strict=False)
    return sum(1 for _ in takewhile(lambda column: len({*column}) == 1, columns))


def table_text(found: Comparison, *, to_ros: bool) -> str:
    """Returns the entries of a table that maps common values by their names, as text."""
    entries = table_entries(found, to_ros=to_ros)
    return "  ".join(f"{_written(jaus.name)} <-> {_written(ros.name)}" for jaus, ros in entries)


def table_entries(found: Comparison, *, to_ros: bool) -> list[tuple[NamedValue, NamedValue]]:
    """Returns the entries of a table that maps common values by their names: of JAUS, and of ROS.

    They are in the order of the JAUS values, so that both directions have one table.
    """
    pairs = found.common if to_ros else [(other, one) for one, other in found.common]
    return sorted(pairs, key=lambda pair: pair[0].number)


def _written(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z_]\w*", name) else f'"{name}"'


def _words(name: str) -> list[str]:
    return [each.casefold() for each in words(name)]
