"""The roots of two states that belong together: by the names of their files."""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.metamodel.classes.ecore import EObject
    from jausml.model.model import Model


def paired_roots(
    old: Model, new: Model, old_folder: Path, new_folder: Path
) -> list[tuple[EObject | None, EObject | None]]:
    """Returns pairs of root elements, None for one that the other state lacks.

    Where each state has one given file, these are a pair whatever their names are.

    Args:
        old: The old state.
        new: The new state.
        old_folder: What names of files of the old state are relative to.
        new_folder: The same of the new state.
    """
    before, after = _files(old, old_folder), _files(new, new_folder)
    given = [[name for name, each in files.items() if each[1]] for files in (before, after)]
    if len(given[0]) == len(given[1]) == 1:
        before[given[1][0]] = before.pop(given[0][0])
    pairs: list[tuple[EObject | None, EObject | None]] = []
    for name in [*after, *(each for each in before if each not in after)]:
        one, other = (files.get(name, ((), False)) for files in (before, after))
        # What one state alone refers to shows where it refers to it.
        if one[1] or other[1] or (name in before and name in after):
            pairs += zip_longest(one[0], other[0])
    return pairs


def _files(model: Model, folder: Path) -> dict[str, tuple[Sequence[EObject], bool]]:
    """Returns the roots of files that were given or are users' own, and whether one was given."""
    root = folder.resolve()
    found: dict[str, tuple[Sequence[EObject], bool]] = {}
    for document in model.documents:
        if document.given or not document.is_library:
            path = document.path
            inside = path.is_relative_to(root)
            name = path.relative_to(root).as_posix() if inside else path.name
            found[name] = (document.roots, document.given)
    return found
