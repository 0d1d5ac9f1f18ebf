"""Writer of elements as uniform blocks: a keyword, a name, and the features between braces."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.classes import bridge
from jausml.language.model.xmi.writer import is_written
from jausml.language.semantics.connections.exchanges import FEATURES, unstated
from jausml.language.text.keywords import owning_features, snake_case
from jausml.language.text.tree import BlockItem, Element, Feature, Name, Text, Value, is_map
from jausml.language.text.writing.layout import space
from jausml.language.text.writing.spelling import (
    IN_THE_HEAD,
    attribute_value,
    documented,
    head_name,
    needs_feature,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Any

    from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.text.writing.references import DocumentNames

    Special = Callable[[Any], Iterator[BlockItem]]

ROOT = Name("root")
"""The feature of a document that makes a root of an element which could not stand there alone."""

_VALUES = (FeatureKind.ATTRIBUTE, FeatureKind.CROSS_REFERENCE)
_STANDING = frozenset(
    {"system.System", "bridge.MapLibrary", "jaus.ServiceSet", "ros.InterfacePackage"}
)


class ElementWriter:
    """Makes the blocks of one document."""

    def __init__(self, metamodels: Metamodels, names: DocumentNames) -> None:
        self._metamodels = metamodels
        self._names = names
        self.special: dict[str, Special] = {}
        """What writes the blocks of a class in a notation of their own, by qualified class."""

    def root(self, obj: EObject) -> Element | Feature:
        """Returns a root element with all that it owns."""
        if self._metamodels.class_of(obj).qualified_name in _STANDING:
            return self.element(obj)
        return documented(Feature(ROOT, [self._value(obj, with_class=True)]), obj)

    def element(self, obj: EObject) -> Element:
        """Returns an element as a block by itself."""
        table = self._metamodels.class_of(obj)
        keyword, name, items = Name(snake_case(table.name)), head_name(obj), self._items(obj)
        if name is None:
            block = Element(None, keyword, items)
        else:
            block = Element(None if is_map(items) else keyword, name, items)
        return documented(block, obj)

    def values(self, obj: EObject, *, without: frozenset[str]) -> Iterator[Feature]:
        """Yields the attributes and references of an element as features."""
        following = unstated(obj) if isinstance(obj, bridge.Connection) else None
        for feature in self._metamodels.class_of(obj).features.values():
            said_here = feature.name not in without or needs_feature(obj, feature.name)
            if not said_here or feature.kind not in _VALUES:
                continue
            if following is not None and feature.name in FEATURES:
                is_needed = feature.name not in following
            else:
                is_needed = is_written(obj, feature)
            if is_needed:
                yield self.feature(obj, feature)

    def _items(self, obj: EObject) -> list[BlockItem]:
        """Returns what stands in the block of an element, values before owned elements."""
        table = self._metamodels.class_of(obj)
        if special := self.special.get(table.qualified_name):
            return list(special(obj))
        items: list[BlockItem] = [*self.values(obj, without=IN_THE_HEAD)]
        for feature in table.features.values():
            if feature.kind is FeatureKind.CONTAINMENT and is_written(obj, feature):
                items += self.owned(obj, feature)
        space(items)
        return items

    def children(self, obj: EObject, names: Sequence[str]) -> list[BlockItem]:
        """Returns the elements that an element owns by some features, as items."""
        features = self._metamodels.class_of(obj).features
        return [item for name in names for item in self.owned(obj, features[name])]

    def owned(self, obj: EObject, feature: FeatureTable) -> Iterator[BlockItem]:
        """Yields the elements of one feature."""
        value = getattr(obj, feature.name)
        for each in value if feature.many else [value]:
            if each is not None:
                yield self.item(obj, each, feature)

    def item(self, obj: EObject, each: EObject, feature: FeatureTable) -> Element | Feature:
        """Returns one of the elements of a feature of an element."""
        if self._names.is_apart(each):
            return Feature(Name(feature.name), [self._names.href(each)])
        table = self._metamodels.class_of(each)
        is_said_best = table is feature.target and _is_said_by(feature, table)
        is_unclear = table.qualified_name in self.special and head_name(each) is None
        if is_said_best or is_unclear or not self._is_obvious(obj, feature, table):
            return self.value_item(each, feature)
        return self.element(each)

    def value_item(self, obj: EObject, feature: FeatureTable) -> Feature:
        """Returns an owned element as the value of its feature, `inputs: new message_def A {}`."""
        with_class = (
            self._metamodels.class_of(obj) is not feature.target or head_name(obj) is not None
        )
        item = Feature(Name(feature.name), [self._value(obj, with_class=with_class)])
        return documented(item, obj)

    def _is_obvious(self, owner: EObject, feature: FeatureTable, table: ClassTable) -> bool:
        """Tells whether a block of a class goes to a feature of its owner by itself."""
        return owning_features(self._metamodels.class_of(owner), table) == [feature.name]

    def _value(self, obj: EObject, *, with_class: bool) -> Element:
        table = self._metamodels.class_of(obj)
        if not with_class:
            return Element(None, None, self._items(obj))
        return Element(Name(snake_case(table.name)), head_name(obj), self._items(obj))

    def feature(self, obj: EObject, feature: FeatureTable) -> Feature:
        """Returns an attribute or a reference of an element with its values."""
        value = getattr(obj, feature.name)
        values = list(value) if feature.many else [value]
        written: list[Value] = []
        for each in values:
            if feature.kind is FeatureKind.CROSS_REFERENCE:
                written.append(self._names.name(obj, each, feature))
            elif feature.name in IN_THE_HEAD and each is not None:
                written.append(Text(each))
            else:
                written.append(attribute_value(each, feature))
        return Feature(Name(feature.name), written)


def _is_said_by(feature: FeatureTable, table: ClassTable) -> bool:
    """Tells whether `qos: { ... }` says more than `qos_profile { ... }`, which has no name."""
    is_keyword = feature.many and feature.name.startswith(snake_case(table.name))
    return "name" not in table.features and not is_keyword
