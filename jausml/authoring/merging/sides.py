"""The three states of a merge, and the identity of elements across them."""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from jausml.authoring.differences.changes import element_words
from jausml.authoring.differences.finding import changes
from jausml.authoring.differences.matching import Matching
from jausml.authoring.editing.working_copy import attribute_values
from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model import refs
from jausml.language.model.model import Model
from jausml.language.model.refs import Ref

_MOST_NAMED = 3  # changes of one element that the text of a conflict has at most

Value: TypeAlias = "EObject | str | None"
"""A value that is equal on all sides: text as XMI has it; the element of the base, else of the side
that added it; or the ref of an element of another file."""


@dataclass(frozen=True)
class Side:
    """A state that was made of the base."""

    model: Model
    matching: Matching


class Sides:
    """The states of one file: the base of both sides, our side, and theirs.

    `twins`: elements that our side added too, by the same ones of theirs. `around`: other files
    that differ between the states; their elements are known by those of our side.
    """

    def __init__(
        self, base: Model, ours: Model, theirs: Model, root: Path, around: Container[Path] = ()
    ) -> None:
        self._root = root
        self.base = base
        self.ours = Side(ours, Matching(base, ours, _roots(base, ours)))
        self.theirs = Side(theirs, Matching(base, theirs, _roots(base, theirs)))
        self.twins: dict[EObject, EObject] = {}
        self._around = {
            obj: now
            for model in (base, theirs)
            for obj, now in Matching(model, ours, _roots_of(model, ours, around)).news.items()
        }

    def table(self, obj: EObject) -> ClassTable:
        """Returns the class of an element."""
        return self.base.metamodels.class_of(obj)

    def features(self, obj: EObject) -> Iterator[FeatureTable]:
        """Yields the features of an element that a file has."""
        for feature in self.table(obj).features.values():
            if feature.settable and feature.kind is not FeatureKind.CONTAINER:
                yield feature

    def token(self, obj: EObject, side: Side | None) -> EObject | Ref:
        """Returns the identity of an element, which is the same on all sides.

        `side`: the side that has it, None for the base.
        """
        model = self.base if side is None else side.model
        # Elements of other files are compared by their refs, those of changed files by ours.
        if model.document_of(obj) is not model.documents[0]:
            if obj in self._around:
                obj, model = self._around[obj], self.ours.model
            return refs.ref_of(obj, model, self._root)
        known = None if side is None else side.matching.olds.get(obj)
        return known or self.twins.get(obj) or obj

    def values(self, obj: EObject, feature: FeatureTable, side: Side | None) -> tuple[Value, ...]:
        """Returns the values of an attribute as XMI writes them, or the tokens of a reference."""
        if feature.kind is FeatureKind.ATTRIBUTE:
            return attribute_values(obj, feature) if feature.name in obj.__dict__ else ()
        return tuple(self.token(content, side) for content in contents(obj, feature))

    def all_of(self, obj: EObject) -> Iterator[EObject]:
        """Yields an element and all its parts."""
        yield obj
        for feature in self.table(obj).contained:
            for content in contents(obj, feature):
                yield from self.all_of(content)

    def counterparts(self) -> Iterator[tuple[EObject, EObject]]:
        """Yields each element of theirs with its counterpart in the merge, itself if it is new."""
        for root in self.theirs.model.documents[0].roots:
            for obj in self.all_of(root):
                known = self.theirs.matching.olds.get(obj)
                ours = self.ours.matching.news.get(known) if known is not None else None
                yield obj, ours if ours is not None else self.twins.get(obj, obj)

    def is_same(self, base: EObject, obj: EObject, side: Side) -> bool:
        """Tells whether an element with all its parts is unchanged since the base."""
        for feature in self.features(base):
            if feature.kind is not FeatureKind.CONTAINMENT:
                if self.values(base, feature, None) != self.values(obj, feature, side):
                    return False
                continue
            before, now = contents(base, feature), contents(obj, feature)
            if [side.matching.news.get(element) for element in before] != list(now):
                return False
            if not all(self.is_same(old, new, side) for old, new in zip(before, now, strict=True)):
                return False
        return True

    def is_alike(self, ours: EObject, theirs: EObject) -> bool:
        """Tells whether elements of both sides have equal contents, whatever their history."""
        if ours.eClass is not theirs.eClass:
            return False
        for feature in self.features(ours):
            if feature.kind is not FeatureKind.CONTAINMENT:
                if self.values(ours, feature, self.ours) != self.values(
                    theirs, feature, self.theirs
                ):
                    return False
                continue
            here, there = contents(ours, feature), contents(theirs, feature)
            if len(here) != len(there):
                return False
            if not all(
                self.is_alike(here_element, there_element)
                for here_element, there_element in zip(here, there, strict=True)
            ):
                return False
        return True

    def label(self, obj: Any) -> str:
        """Returns the kind and the name of an element in words."""
        name = getattr(obj, "name", None) or getattr(obj, "target", None)
        what = element_words(self.table(obj))
        return f"{what} '{name}'" if name else what

    def difference(self, one: EObject, old: Side | None, other: EObject, new: Side) -> str:
        """Returns the changes from one element to another in words."""
        before = self.base if old is None else old.model
        differences = changes(before, new.model, [(one, other)])
        texts = [
            change.text
            if change.new_element is other
            else f"{change.element} {change.path}: {change.text}"
            for change in differences
        ]
        if not texts:
            return "documentation, ids or the order of parts"
        more = [f"and {len(texts) - _MOST_NAMED} more"] if len(texts) > _MOST_NAMED else []
        return ", ".join([*texts[:_MOST_NAMED], *more])


def _roots_of(old: Model, new: Model, paths: Container[Path]) -> list[tuple[EObject, EObject]]:
    """Returns pairs of the roots of other files."""
    there = {document.path: document.roots for document in new.documents[1:]}
    documents = [
        document
        for document in old.documents[1:]
        if document.path in paths and document.path in there
    ]
    return [
        pair
        for document in documents
        for pair in zip(document.roots, there[document.path], strict=False)
    ]


def _roots(base: Model, side: Model) -> list[tuple[EObject, EObject]]:
    return list(zip(base.documents[0].roots, side.documents[0].roots, strict=False))
