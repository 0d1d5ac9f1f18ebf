"""The outline of a file: all its elements as a tree, of which so much is told as is open."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from jausml.authoring.proposals.elements import Scope, label_of
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.names import in_words

_MOST_INNER, _MOST_FOUND = 200, 100
"""Rows that are told of one owner, and that a search tells: nobody reads so many."""


@dataclass(frozen=True)
class OutlineRow:
    """An element in the outline; one without an element tells how many more there are.

    `inner`: how many elements it owns. `note`: of what it is, where that is not above it.
    """

    element: str
    label: str
    kind: str
    depth: int
    inner: int = 0
    is_open: bool = False
    note: str = ""


def outline(scope: Scope, opened: Collection[str]) -> list[OutlineRow]:
    """Returns the elements of a file whose owners are open, in the order of the file.

    `opened`: refs of elements.
    """
    roots = scope.model.documents[0].roots if scope.model.documents else []
    return [row for root in roots for row in _rows(scope, root, 0, frozenset(opened))]


def _rows(
    scope: Scope, element: EObject, depth: int, opened: Collection[str]
) -> Iterator[OutlineRow]:
    ref, inner = scope.ref(element), scope.model.owned(element)
    is_open = bool(inner) and (depth == 0 or ref in opened)
    label, kind = label_of(element), _kind(element)
    yield OutlineRow(ref, label, kind, depth, len(inner), is_open)
    if not is_open:
        return
    for child in inner[:_MOST_INNER]:
        yield from _rows(scope, child, depth + 1, opened)
    if len(inner) > _MOST_INNER:
        label = f"{len(inner) - _MOST_INNER} more: search for them"
        yield OutlineRow("", label, "", depth + 1)


def search(scope: Scope, query: str) -> list[OutlineRow]:
    """Returns the elements of a file whose name or kind has all words, names first."""
    words = query.lower().split()
    named, others = [], []
    for element in scope.model.elements_of(scope.model.documents[0]):
        name = label_of(element).lower()
        if all(word in name for word in words):
            named.append(element)
        elif all(word in f"{name} {_kind(element)}" for word in words):
            others.append(element)
    hits = [*named, *others]
    rows = []
    for hit in hits[:_MOST_FOUND]:
        inner, owner = len(scope.model.owned(hit)), hit.eContainer()
        note = label_of(owner) if owner is not None else ""
        rows.append(OutlineRow(scope.ref(hit), label_of(hit), _kind(hit), 0, inner, note=note))
    if len(hits) > _MOST_FOUND:
        rows.append(OutlineRow("", f"{len(hits) - _MOST_FOUND} more: type more of it", "", 0))
    return rows


def _kind(element: EObject) -> str:
    return in_words(element.eClass.name)
