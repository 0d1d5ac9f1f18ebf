"""Comparison of two model elements with all that they own."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from jausml.language.metamodel import FeatureKind, FeatureTable, Metamodels
from jausml.language.metamodel.classes.ecore import EObject

NOTHING = "nothing"
"""How a difference shows that there is no value or no element."""


@dataclass(frozen=True, slots=True)
class Policy:
    """Policy of a comparison: what counts as a difference.

    Attributes:
        ignored: Features that may differ, by name (`documentation`) or by the class that declares
            or inherits them and name (`jaus.Service.machines`).
        matched_by: Features whose elements belong together by the value of an attribute and not by
            position, for example `{"services": "name"}`. Their order may differ.
        optional: Features that differ only where both elements have a value.
        closeness: Relative difference up to which two real numbers are the same.
    """

    ignored: frozenset[str] = frozenset()
    matched_by: Mapping[str, str] = field(default_factory=dict)
    optional: frozenset[str] = frozenset()
    closeness: float = 0.0


EXACT = Policy()
"""Everything counts."""

ON_THE_WIRE = Policy(
    ignored=frozenset(
        {"documentation", "frame", "moves", "jaus.Service.events", "jaus.Service.machines"}
    ),
    matched_by={"services": "name", "inputs": "name", "outputs": "name"},
    optional=frozenset({"units"}),
    closeness=1e-12,
)
"""What two descriptions of the same services must agree on to understand each other.

Documentation, axes, whether a command moves anything, internal events and protocol behaviour do not
count, nor the order of messages, nor units where one side states none; limits count up to the
digits with which they are written.
"""


@dataclass(frozen=True, slots=True)
class Difference:
    """One difference between two models.

    Attributes:
        path: The names of the elements from the compared one to that which differs.
        first: The values of the feature in the first model as text, or `NOTHING`.
        first_element: The element that differs; the one that owns what the first model lacks.
    """

    path: str
    feature: str
    first: str
    second: str
    first_element: EObject | None = None
    second_element: EObject | None = None

    def __str__(self) -> str:
        return f"{self.path}: {self.feature}: {self.first} / {self.second}"


def compare(
    first: EObject, second: EObject, metamodels: Metamodels, policy: Policy = EXACT
) -> list[Difference]:
    """Compares two elements and all that they own.

    References are the same when they lead to the same place: within the compared elements by
    position, elsewhere by the names along the way (services by URN and version).

    Returns:
        The differences in the order of the first model; none for models that are the same.
    """
    return list(_Comparison(first, second, metamodels, policy).run())


class _Comparison:
    def __init__(
        self, first: EObject, second: EObject, metamodels: Metamodels, policy: Policy
    ) -> None:
        self._roots = (first, second)
        self._metamodels = metamodels
        self._policy = policy

    def run(self) -> Iterator[Difference]:
        """Yields the differences, those of two elements before those of what they own."""
        first, second = self._roots
        pending = [(first, second, _label(first))]
        while pending:
            one, other, path = pending.pop()
            if one.eClass is not other.eClass:
                yield Difference(path, "class", one.eClass.name, other.eClass.name, one, other)
                continue
            children: list[tuple[EObject, EObject, str]] = []
            for feature in self._compared_features(one):
                if feature.kind is not FeatureKind.CONTAINMENT:
                    yield from self._values(one, other, path, feature)
                    continue
                ours, theirs = self._keyed(one, feature), self._keyed(other, feature)
                children += [
                    (child, theirs[key], f"{path}/{_label(child, feature, key)}")
                    for key, child in ours.items()
                    if key in theirs
                ]
                for key, child in ours.items():
                    if key not in theirs:
                        yield Difference(path, feature.name, _label(child), NOTHING, child, other)
                for key, child in theirs.items():
                    if key not in ours:
                        yield Difference(path, feature.name, NOTHING, _label(child), one, child)
            pending += reversed(children)

    def _compared_features(self, obj: EObject) -> Iterator[FeatureTable]:
        """Yields the features that may not differ, in order."""
        table, ignored = self._metamodels.class_of(obj), self._policy.ignored
        for name, feature in table.features.items():
            names = {name, *(f"{owner.qualified_name}.{name}" for owner in table.supertypes)}
            if feature.kind is not FeatureKind.CONTAINER and ignored.isdisjoint(names):
                yield feature

    def _keyed(self, obj: EObject, feature: FeatureTable) -> dict[Hashable, EObject]:
        """Returns the elements of a feature by what makes them belong together in both models."""
        value = getattr(obj, feature.name)
        values = list(value) if feature.many else [] if value is None else [value]
        attribute = self._policy.matched_by.get(feature.name)
        keyed: dict[Hashable, EObject] = {}
        for position, element in enumerate(values):
            key: Hashable = getattr(element, attribute) if attribute else position
            # A second element of the key is told apart by its position.
            keyed[(key, position) if key in keyed else key] = element
        return keyed

    def _values(
        self, one: EObject, other: EObject, path: str, feature: FeatureTable
    ) -> Iterator[Difference]:
        ours, theirs = (self._compared(obj, feature) for obj in (one, other))
        if feature.name in self._policy.optional and not (ours and theirs):
            return
        same = len(ours) == len(theirs) and all(map(self._same, ours, theirs))
        if not same:
            yield Difference(path, feature.name, _shown(ours), _shown(theirs), one, other)

    def _compared(self, obj: EObject, feature: FeatureTable) -> list[Any]:
        value = getattr(obj, feature.name)
        values = list(value) if feature.many else [] if value is None else [value]
        if feature.is_reference:
            return [self._address(target) for target in values]
        return [getattr(item, "name", item) for item in values]

    def _same(self, one: Any, other: Any) -> bool:
        if isinstance(one, float) and isinstance(other, float):
            if math.isnan(one) or math.isnan(other):
                return math.isnan(one) and math.isnan(other)
            return math.isclose(one, other, rel_tol=self._policy.closeness)
        return bool(one == other)

    def _address(self, obj: EObject | None) -> str:
        """Returns where an element stands, the same for the same place of both models."""
        steps: list[str] = []
        while obj is not None:
            if obj in self._roots:
                steps.append("")
                break
            # A service is the same wherever it stands.
            urn = getattr(obj, "urn", None)
            if urn:
                steps.append(f"{urn} {getattr(obj, 'version', '')}")
                break
            steps.append(_step(obj))
            obj = obj.eContainer()
        return "/".join(reversed(steps))


def _step(obj: EObject) -> str:
    feature = obj.eContainmentFeature()
    if feature is None:
        return _label(obj)
    value = getattr(obj.eContainer(), feature.name)
    position = f".{value.index(obj)}" if feature.many else ""
    return f"{feature.name}{position}"


def _label(obj: EObject, feature: FeatureTable | None = None, key: Hashable = "") -> str:
    name = getattr(obj, "name", None)
    if name or feature is None:
        return str(name or obj.eClass.name)
    return f"{feature.name}[{key}]" if feature.many else feature.name


def _shown(values: list[Any]) -> str:
    return " ".join(map(str, values)) or NOTHING
