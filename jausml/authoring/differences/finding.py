"""Finder of what changed from one state of a model to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from jausml.authoring.differences.changes import (
    Change,
    Kind,
    breaks,
    element_words,
    is_sign_change,
    statement,
    value_text,
    with_unit,
    words,
)
from jausml.authoring.differences.matching import SEQUENCES, Matching, address, values
from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.model import Model
from jausml.language.model.reading.reader import LostReference

_ORDERED = {
    *("jaus.Record.fields", "jaus.Sequence.fields", "jaus.Variant.options"),
    *("ros.MessageType.fields", "jaus.State.transitions", "jaus.State.defaults"),
    *("jaus.State.entry", "jaus.State.exit", "jaus.Transition.actions"),
}
"""Owned parts whose order is that on the wire, or in which a machine tries or does them."""
_DOCUMENTATION = "documentation"
_PHRASES = {
    feature: (f"no longer {feature}", f"now {feature}")
    for feature in ("provides", "uses", "controls", "inherits")
}


def is_ordered(table: ClassTable, feature: FeatureTable) -> bool:
    """Tells whether the order of the parts of an element has a meaning."""
    return any(
        f"{supertype.qualified_name}.{feature.name}" in _ORDERED for supertype in table.supertypes
    )


@dataclass(frozen=True)
class _Missing:
    """The missing target of a reference."""

    fragment: str

    @property
    def name(self) -> str:
        return f"{self.fragment} (not found)"


def changes(
    old: Model,
    new: Model,
    roots: Sequence[tuple[EObject | None, EObject | None]],
    lost: Iterable[LostReference] = (),
) -> list[Change]:
    """Returns all changes, in the order of the new state; a removal comes at the former owner.

    Documentation, layout, ids and the order of parts that means nothing do not count. `roots`: root
    elements that belong together; None for one that the other state lacks. `lost`: the references
    of both states that lead to no element. They are compared by what they name.
    """
    return list(_Finding(old, new, roots, lost).run())


class _Finding:
    def __init__(
        self,
        old: Model,
        new: Model,
        roots: Sequence[tuple[EObject | None, EObject | None]],
        lost: Iterable[LostReference],
    ) -> None:
        self._old, self._new = old, new
        self._lost: dict[tuple[EObject, str], list[_Missing]] = defaultdict(list)
        for reference in lost:
            self._lost[reference.owner, reference.feature.name].append(_Missing(reference.fragment))
        self._roots = roots
        both = [(one, other) for one, other in roots if one is not None and other is not None]
        self._matching = Matching(old, new, both)
        self._class_of = old.metamodels.class_of

    def run(self) -> Iterator[Change]:
        for one, other in self._roots:
            if one is not None and other is not None and one in self._matching.news:
                yield from self._pair(one, other)
            else:
                if one is not None:
                    yield self._whole(Kind.REMOVED, one)
                if other is not None:
                    yield self._whole(Kind.ADDED, other)

    def _pair(self, one: EObject, other: EObject) -> Iterator[Change]:
        if isinstance(one, bridge.Assignment):
            yield from self._assignment(one, other)
            return
        table = self._class_of(other)
        for feature in table.features.values():
            if feature.kind is FeatureKind.CONTAINMENT:
                yield from self._parts(one, other, feature)
            elif feature.kind is not FeatureKind.CONTAINER and feature.name != _DOCUMENTATION:
                yield from self._values(one, other, feature)

    def _parts(self, one: EObject, other: EObject, feature: FeatureTable) -> Iterator[Change]:
        ours, theirs = values(one, feature), values(other, feature)
        for part in ours:
            if part not in self._matching.news:
                yield self._whole(Kind.REMOVED, part)
        for part in theirs:
            before = self._matching.olds.get(part)
            if before is None:
                yield self._whole(Kind.ADDED, part)
            else:
                yield from self._pair(before, part)
        if is_ordered(self._class_of(other), feature):
            yield from self._order(one, other, ours, feature)

    def _order(
        self, one: EObject, other: EObject, ours: list[EObject], feature: FeatureTable
    ) -> Iterator[Change]:
        kept = [self._matching.news[element] for element in ours if element in self._matching.news]
        now = [value for value in values(other, feature) if value in self._matching.olds]
        if any(element is not another for element, another in zip(kept, now, strict=True)):
            before, after = (", ".join(map(value_text, order)) for order in (kept, now))
            text = f"{words(feature.name)} in another order: {after}"
            yield self._change(
                Kind.ORDERED, one, other, feature.name, (before, after), text, is_lost=False
            )

    def _values(self, one: EObject, other: EObject, feature: FeatureTable) -> Iterator[Change]:
        ours, theirs = values(one, feature), values(other, feature)
        missing = [self._lost.get((element, feature.name), []) for element in (one, other)]
        ours = [
            *ours,
            *(_counterpart(lost_reference, theirs, self._new) for lost_reference in missing[0]),
        ]
        theirs = [
            *theirs,
            *(_counterpart(lost_reference, ours, self._old) for lost_reference in missing[1]),
        ]
        known = [
            self._matching.news.get(value, value) if address(value) else value for value in ours
        ]
        lost = [own for own, b in zip(ours, known, strict=True) if not _holds(theirs, b)]
        added = [value for value in theirs if not _holds(known, value)]
        is_same = known == theirs if feature.name in SEQUENCES else len(ours) == len(theirs)
        if not lost and not added and is_same:
            return
        old, new = (" ".join(map(value_text, side)) for side in (ours, theirs))
        kind = Kind.RENAMED if feature.name == "name" else Kind.CHANGED
        text = with_unit(feature.name, old, new)
        if kind is Kind.RENAMED:
            text = f"renamed from {old or 'nothing'}"
        elif feature.many and feature.is_reference:
            text = self._listed(one, feature.name, lost, added)
        else:
            text = f"{words(feature.name)} {text}"
        yield self._change(kind, one, other, feature.name, (old, new), text, is_lost=bool(lost))

    def _listed(self, one: EObject, feature: str, lost: list[Any], added: list[Any]) -> str:
        parts = []
        before, now = _PHRASES.get(feature, (f"{words(feature)} without", f"{words(feature)} with"))
        if lost:
            names = ", ".join(map(value_text, lost))
            users = self._users(one, lost) if feature == "provides" else []
            used = f", which {' and '.join(users)} use{'s' if len(users) == 1 else ''}"
            parts.append(f"{before} {names}{used if users else ''}")
        if added:
            parts.append(f"{now} {', '.join(map(value_text, added))}")
        return "; ".join(parts)

    def _users(self, provider: EObject, services: list[Any]) -> list[str]:
        """Returns the components of the old state that use services of a provider."""
        lost = {address(service) for service in services}
        users = []
        for component in self._old.instances(jaus.Component, library=False):
            connected = any(
                line.provider is provider and address(line.message.eContainer()) in lost
                for line in component.connections
                if line.message is not None
            )
            if component is not provider and (
                connected or any(address(service) in lost for service in component.uses)
            ):
                users.append(str(component.name))
        return users

    def _assignment(self, one: EObject, other: EObject) -> Iterator[Change]:
        if self._matching.facts(one) == self._matching.facts(other):
            return
        old, new = statement(one), statement(other)
        if isinstance(one, bridge.ListAssignment) and old == new:
            inner = list(self._parts(one, other, self._class_of(one).features["assignments"]))
            if inner:
                yield from inner
                return
        if is_sign_change(one, other):
            text = f"sign of {getattr(other, 'target', '')} changed: {old} => {new}"
        elif old == new:
            text = f"{new}: other options"
        else:
            text = f"{old} => {new}"
        is_lost = _methods(one) - _methods(other) != set()
        feature = "method" if is_lost else "conversions"
        yield self._change(Kind.CHANGED, one, other, feature, (old, new), text, is_lost=is_lost)

    def _whole(self, kind: Kind, obj: EObject) -> Change:
        is_new = kind is Kind.ADDED
        shown = statement(obj) if isinstance(obj, bridge.Assignment | bridge.OpenDecision) else ""
        text = f"{kind.value}: {shown}" if shown else kind.value
        old, new = (None, obj) if is_new else (obj, None)
        texts = ("", shown) if is_new else (shown, "")
        return self._change(kind, old, new, "", texts, text, is_lost=not is_new)

    def _change(
        self,
        kind: Kind,
        one: EObject | None,
        other: EObject | None,
        feature: str,
        texts: tuple[str, str],
        text: str,
        *,
        is_lost: bool,
    ) -> Change:
        shown, model = (other, self._new) if other is not None else (one, self._old)
        assert shown is not None  # noqa: S101 - one of both is given
        table = self._class_of(shown)
        place = feature if feature in table.features else None
        return Change(
            kind,
            element_words(table),
            model.element_path(shown),
            feature,
            *texts,
            text,
            breaks(kind, shown, table, feature, is_lost=is_lost),
            self._old.location(one, place) if one is not None else None,
            self._new.location(other, place) if other is not None else None,
            one,
            other,
        )


def _holds(candidates: list[Any], value: Any) -> bool:
    """Tells whether a value, or an element at the same names, is among others."""
    where = address(value)
    return any(
        value is candidate or (address(candidate) == where if where else candidate == value)
        for candidate in candidates
    )


def _counterpart(missing: _Missing, others: list[Any], model: Model) -> Any:
    """Returns the element that the other state has at the same fragment, else the missing one."""
    for other in others:
        if address(other) and missing.fragment in (model.identifier(other), model.path_of(other)):
            return other
    return missing


def _methods(obj: EObject) -> set[str]:
    steps = getattr(obj, "conversions", None) or ()
    return {str(step.method) for step in steps if step.method}
