"""Maps that say the same: their connections share what is made of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import ecore

if TYPE_CHECKING:
    from collections.abc import Hashable

    from jausml.language.metamodel.classes import bridge
    from jausml.language.metamodel.classes.ecore import EClass, EObject

_SAYS_NOTHING = frozenset({"name", "documentation"})
"""Features of a map that are in no translation."""


class AlikeMaps:
    """The maps of a bridge by what they say."""

    def __init__(self) -> None:
        self._features: dict[EClass, list[tuple[str, bool]]] = {}
        self._first: dict[bridge.AttributeMap, bridge.AttributeMap] = {}
        self._by_content: dict[Hashable, bridge.AttributeMap] = {}

    def first(self, attribute_map: bridge.AttributeMap) -> bridge.AttributeMap:
        """Returns the first map that was asked for of those that say the same under other names."""
        if attribute_map not in self._first:
            # The tests of vectors name the map.
            name = attribute_map.name if attribute_map.vectors else None
            own = self._values(attribute_map, _SAYS_NOTHING)
            self._first[attribute_map] = self._by_content.setdefault((name, own), attribute_map)
        return self._first[attribute_map]

    def _values(self, element: EObject, without: frozenset[str] = frozenset()) -> Hashable:
        kind = element.eClass
        if kind not in self._features:
            features = kind.eAllStructuralFeatures()
            self._features[kind] = [(e.name, e.many) for e in features if e.name not in without]
        found: list[Hashable] = [kind]
        for name, is_many in self._features[kind]:
            value = getattr(element, name)
            said = [self._said(element, each) for each in (value if is_many else [value])]
            found.append(tuple(said))
        return tuple(found)

    def _said(self, owner: EObject, value: Hashable) -> Hashable:
        """Returns what a value says; an element that is only referred to stands for itself."""
        if isinstance(value, ecore.EObject) and value.eContainer() is owner:
            return self._values(value)
        return value
