"""The roots of two states that belong together: by the names of their files."""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model


def paired_roots(
    old: Model, new: Model, old_folder: Path, new_folder: Path
) -> list[tuple[EObject | None, EObject | None]]:
    """Returns pairs of root elements, None for one that the other state lacks.

    Nothing can be said of a file that cannot be parsed in one of the states, so it has none.

    Where each state has one given file, these are a pair whatever their names are.
    """
    before, after = _files(old, old_folder), _files(new, new_folder)
    unread = {*_unread(old, old_folder), *_unread(new, new_folder)}
    given = [[name for name, each in files.items() if each[1]] for files in (before, after)]
    if len(given[0]) == len(given[1]) == 1:
        if not unread.isdisjoint((given[0][0], given[1][0])):
            return []
        before[given[1][0]] = before.pop(given[0][0])
    pairs: list[tuple[EObject | None, EObject | None]] = []
    for name in [*after, *(each for each in before if each not in after)]:
        if name in unread:
            continue
        one, other = (files.get(name, ((), False)) for files in (before, after))
        # What one state alone refers to shows where it refers to it.
        if one[1] or other[1] or (name in before and name in after):
            pairs += zip_longest(one[0], other[0])
    return pairs


def _files(model: Model, folder: Path) -> dict[str, tuple[Sequence[EObject], bool]]:
    """Returns the roots of files that were given or are users' own, and whether one was given."""
    own = (each for each in model.documents if each.given or not each.is_library)
    return {_name(each, folder): (each.roots, each.given) for each in own}


def _unread(model: Model, folder: Path) -> list[str]:
    return [_name(each, folder) for each in model.documents if not each.readable]


def _name(document: Document, folder: Path) -> str:
    path, root = document.path, folder.resolve()
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
