"""Translations that connections of one map share: made once without a name, and given each name."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import ecore
from jausml_generators.bridge.translation.surroundings import Surroundings

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from jausml.language.metamodel.classes import bridge
    from jausml.language.metamodel.classes.ecore import EClass, EObject


_NAME = "\1"
"""Stands for the name of a connection."""


@dataclass
class _Unnamed(Surroundings):
    """Surroundings of a connection without a name: what takes its name is claimed later.

    Attributes:
        claims: How each of it is claimed, from the surroundings and the name of a connection.
    """

    claims: list[Callable[[Surroundings, str], str]] = field(default_factory=list)

    def frame(self, connection: str, path: str, value: str) -> str:  # noqa: ARG002 - none yet
        """Returns what stands for the attribute of the name of a frame."""
        return self._later(lambda uses, name: uses.frame(name, path, value))

    def memory(self, name: str, annotation: str) -> str:
        """Returns what stands for the attribute that keeps a value."""
        return self._later(
            lambda uses, connection: uses.memory(name.replace(_NAME, connection), annotation)
        )

    def _later(self, claim: Callable[[Surroundings, str], str]) -> str:
        self.claims.append(claim)
        return _mark(len(self.claims) - 1)


class SharedTranslations:
    """The translations of one bridge by what makes them the same but for the name."""

    def __init__(self, uses: Surroundings) -> None:
        self._uses = uses
        self._once: set[object] = set()
        self._shared: dict[object, tuple[str, _Unnamed]] = {}

    def lines(
        self, key: object, name: str, make: Callable[[str, Surroundings], tuple[str, ...]]
    ) -> tuple[str, ...]:
        """Returns the lines of a translation."""
        if key not in self._once:
            # Most maps have one connection; all that is not named after it is claimed here.
            self._once.add(key)
            return make(name, self._uses)
        if key not in self._shared:
            known = {each.name: getattr(self._uses, each.name) for each in fields(self._uses)}
            around = _Unnamed(**known)
            self._shared[key] = "\n".join(make(_NAME, around)), around
        text, around = self._shared[key]
        for number, claim in enumerate(around.claims):
            text = text.replace(_mark(number), claim(self._uses, name))
        return tuple(text.replace(_NAME, name).split("\n"))


def _mark(number: int) -> str:
    return f"\2{number}\3"


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
