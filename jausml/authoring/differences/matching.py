"""Matching of two states: pairs of root elements, and pairs of elements that are the same."""

from __future__ import annotations

import os
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

from jausml.language.metamodel import FeatureKind, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.names import name_of, with_owners

_KEYS = ("target", "path", "jaus", "value", "index", "text")
"""Attributes that tell elements without a name apart, the first that a class has."""
SEQUENCES = frozenset({"arguments", "conversions", "dimensions", "names"})
"""Features of which each value means what it does by its place."""
_MOST = 60  # elements of one list that are compared with each other to find renamed ones
_ALIKE = 0.5
"""Share of the facts of two elements that must be equal for one to be the other, renamed."""


class Matching:
    """The pairs of elements of two states.

    Elements are the same by, in this order: the id in the file; class and name; class and the
    key of unnamed elements; equal contents; similar contents, which a renamed element has.
    """

    def __init__(self, old: Model, new: Model, roots: Sequence[tuple[EObject, EObject]]) -> None:
        self._old = old
        self._new = new
        self._class_of = old.metamodels.class_of
        self._facts: dict[EObject, Counter[Hashable]] = {}
        self.news: dict[EObject, EObject] = {}
        """The new element of each old one."""
        self.olds: dict[EObject, EObject] = {}
        """The old element of each new one."""
        pending = [pair for pair in roots if pair[0].eClass is pair[1].eClass]
        while pending:
            one, other = pending.pop()
            self.news[one], self.olds[other] = other, one
            for feature in self._class_of(one).contained:
                pending += self._pairs(values(one, feature), values(other, feature), feature)

    def _pairs(
        self, ours: list[EObject], theirs: list[EObject], feature: FeatureTable
    ) -> Iterator[tuple[EObject, EObject]]:
        if not feature.many:
            yield from (pair for pair in zip(ours, theirs, strict=False) if _same_class(*pair))
            return
        for key in (self._identifier, self._name, self._key, self._content):
            pairs = list(_by_key(ours, theirs, key))
            yield from pairs
            ours = [
                element for element in ours if not any(element is paired for paired, _ in pairs)
            ]
            theirs = [
                element for element in theirs if not any(element is paired for _, paired in pairs)
            ]
        if len(ours) <= _MOST and len(theirs) <= _MOST:
            yield from self._renamed(ours, theirs)

    def _identifier(self, obj: EObject) -> Hashable:
        return self._old.identifier(obj) or self._new.identifier(obj)

    def _name(self, obj: EObject) -> Hashable:
        name = getattr(obj, "name", None)
        return (obj.eClass.name, name) if name else None

    def _key(self, obj: EObject) -> Hashable:
        table = self._class_of(obj)
        for key in _KEYS:
            if key in table.features and "name" not in table.features:
                return key, str(getattr(obj, key))
        return None

    def _content(self, obj: EObject) -> Hashable:
        return frozenset(self.facts(obj).items())

    def _renamed(
        self, ours: list[EObject], theirs: list[EObject]
    ) -> Iterator[tuple[EObject, EObject]]:
        likeness = [
            (-self._likeness(one, other), i, j)
            for i, one in enumerate(ours)
            for j, other in enumerate(theirs)
            if _same_class(one, other)
        ]
        taken: tuple[set[int], set[int]] = set(), set()
        for share, i, j in sorted(likeness):
            if -share > _ALIKE and i not in taken[0] and j not in taken[1]:
                taken[0].add(i)
                taken[1].add(j)
                yield ours[i], theirs[j]

    def _likeness(self, one: EObject, other: EObject) -> float:
        ours, theirs = self.facts(one), self.facts(other)
        both = (ours | theirs).total()
        return (ours & theirs).total() / both if both else 0.0

    def facts(self, obj: EObject) -> Counter[Hashable]:
        """Returns the values of an element and its parts, but for its name and documentation."""
        known = self._facts.get(obj)
        if known is None:
            known = self._facts[obj] = Counter()
            for feature in self._class_of(obj).features.values():
                if feature.name in ("name", "documentation"):
                    continue
                for at, value in enumerate(values(obj, feature)):
                    place = feature.name, at if feature.name in SEQUENCES else 0
                    if feature.kind is FeatureKind.CONTAINMENT:
                        inner = getattr(value, "name", None)
                        known[place, value.eClass.name, inner] += 1
                        known += Counter(
                            {
                                (place, inner, fact): number
                                for fact, number in self.facts(value).items()
                            }
                        )
                    elif feature.kind is not FeatureKind.CONTAINER:
                        known[place, address(value) or str(value)] += 1
            self._facts[obj] = known
        return known


def values(obj: EObject, feature: FeatureTable) -> list[Any]:
    """Returns the values of a feature, none for one that is not set."""
    value = getattr(obj, feature.name)
    return list(value) if feature.many else [] if value is None else [value]


def address(value: Any) -> str:
    """Returns the names on the way to an element; empty for other values."""
    if not hasattr(value, "eContainer"):
        return ""
    steps: list[str] = []
    for element in with_owners(value):
        urn = getattr(element, "urn", None)
        if urn:
            steps.append(f"{urn} {getattr(element, 'version', '')}")
            break
        steps.append(name_of(element) or element.eClass.name)
    return "/".join(reversed(steps))


def _same_class(one: EObject, other: EObject) -> bool:
    return one.eClass is other.eClass


def _by_key(
    ours: list[EObject], theirs: list[EObject], key: Callable[[EObject], Hashable]
) -> Iterator[tuple[EObject, EObject]]:
    """Yields pairs of elements of one class with the same key, of several the first ones."""
    waiting: dict[Hashable, list[EObject]] = defaultdict(list)
    for element in theirs:
        waiting[key(element)].append(element)
    for own_element in ours:
        key_value = key(own_element)
        rest = waiting.get(key_value) if key_value is not None else None
        if rest and _same_class(own_element, rest[0]):
            yield own_element, rest.pop(0)


def paired_roots(
    old: Model, new: Model, old_folder: Path, new_folder: Path
) -> list[tuple[EObject | None, EObject | None]]:
    """Returns pairs of root elements, None for one that the other state lacks.

    A file that cannot be parsed in one of the states has none. Where each state has one given
    file, these are a pair whatever their names are.
    """
    before, after = _files(old, old_folder), _files(new, new_folder)
    unread = {*_unread(old, old_folder), *_unread(new, new_folder)}
    given_files = [[name for name, entry in files.items() if entry[1]] for files in (before, after)]
    if len(given_files[0]) == len(given_files[1]) == 1:
        if not unread.isdisjoint((given_files[0][0], given_files[1][0])):
            return []
        before[given_files[1][0]] = before.pop(given_files[0][0])
    pairs: list[tuple[EObject | None, EObject | None]] = []
    for name in [*after, *(old_name for old_name in before if old_name not in after)]:
        if name in unread:
            continue
        one, other = (files.get(name, ((), False)) for files in (before, after))
        # A file that one state alone refers to is shown at the reference.
        if one[1] or other[1] or (name in before and name in after):
            pairs += zip_longest(one[0], other[0])
    return pairs


def _files(model: Model, folder: Path) -> dict[str, tuple[Sequence[EObject], bool]]:
    """Returns the roots of files that were given or are users' own, and whether one was given."""
    own = (document for document in model.documents if document.is_input or not document.is_library)
    return {_name(document, folder): (document.roots, document.is_input) for document in own}


def _unread(model: Model, folder: Path) -> list[str]:
    return [_name(document, folder) for document in model.documents if not document.readable]


def _name(document: Document, folder: Path) -> str:
    """Returns the path of a file from a folder."""
    return Path(os.path.relpath(document.path, folder.resolve())).as_posix()
