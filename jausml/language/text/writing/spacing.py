"""Empty lines between the items of a block, where a reader wants to take breath."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from jausml.language.text.tree import Direction, Element, Feature, Import, Item

if TYPE_CHECKING:
    from collections.abc import Sequence

_MUCH = 5
"""Values from which on a block stands apart."""


def space(items: Sequence[Item]) -> None:
    """Sets apart what says much, and the elements that follow values."""
    for before, item in pairwise(items):
        follows_values = isinstance(before, Feature) and _values(before) == 1
        if follows_values and (isinstance(item, Feature) or not _says_much(item)):
            item.spaced = bool(item.documentation)
        else:
            item.spaced = _says_much(before) or _says_much(item)


def space_document(items: Sequence[Item]) -> None:
    """Sets all that stands on top level apart, but not imports from each other."""
    for before, item in pairwise(items):
        item.spaced = not (isinstance(before, Import) and isinstance(item, Import))


def _says_much(item: Item) -> bool:
    return _values(item) >= _MUCH


def _values(item: Item) -> int:
    """Returns how many values an item holds, roughly the lines that it takes."""
    if isinstance(item, Element):
        return 1 + sum(map(_values, item.items))
    if isinstance(item, Feature):
        return sum(_values(each) if isinstance(each, Element) else 1 for each in item.values[:1])
    return _MUCH if isinstance(item, Direction) else 1
