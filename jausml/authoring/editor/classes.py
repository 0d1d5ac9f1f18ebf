"""Classes of blocks: which class of the metamodels a block of text stands for."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable, load_metamodels
from jausml.language.text.tree import (
    Assignment,
    Direction,
    Element,
    End,
    Feature,
    Member,
    classes_by_keyword,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.text.tree import Item

ASSIGNMENTS = ("bridge.FieldAssignment", "bridge.ListAssignment", "bridge.MessageAssignment")


@cache
def keywords() -> Mapping[str, ClassTable]:
    """Returns the classes by their keywords."""
    return classes_by_keyword(load_metamodels())


def table(qualified_class: str) -> ClassTable:
    """Returns the class of a qualified name."""
    return load_metamodels().classes[qualified_class]


def class_of(element: Element, owner: ClassTable | None) -> ClassTable | None:
    """Returns the class of a block, None when nothing tells it.

    Args:
        owner: The class of the block around it; None on top level.
    """
    if element.keyword is not None:
        return keywords().get(element.keyword.text)
    if any(isinstance(each, (End, Direction)) for each in element.items):
        return table("bridge.AttributeMap")
    name = element.name.text if element.name is not None else ""
    if name in keywords():
        return keywords()[name]
    attribute_map = table("bridge.AttributeMap")
    holds_maps = owner is None or _holds(owner, attribute_map)
    return attribute_map if holds_maps else None


def class_of_value(element: Element, feature: FeatureTable | None) -> ClassTable | None:
    """Returns the class of a block that is the value of a feature."""
    if element.keyword is not None:
        return keywords().get(element.keyword.text)
    return feature.target if feature is not None else None


def features_of(container: Item | None, owner: ClassTable | None) -> dict[str, FeatureTable]:
    """Returns the features that a block can state."""
    if isinstance(container, Assignment):
        tables = [table(each) for each in ASSIGNMENTS]
        return {name: feature for each in tables for name, feature in each.features.items()}
    if isinstance(container, Member):
        names = ("units", "frame", "minimum", "maximum", "optional")
        known = {**table("ros.PrimitiveField").features, **table("jaus.FixedField").features}
        return {name: known[name] for name in names if name in known}
    if isinstance(container, End):
        return dict(table("jaus.MessageDef").features)
    return dict(owner.features) if owner is not None else {}


def feature_named(
    feature: Feature, container: Item | None, owner: ClassTable | None
) -> FeatureTable | None:
    """Returns what the metamodels say of a feature; None when they do not know it."""
    return features_of(container, owner).get(feature.name.text)


def contained_classes(owner: ClassTable) -> list[ClassTable]:
    """Returns the classes of what an element of a class can own."""
    found: dict[ClassTable, None] = {}
    for feature in owner.features.values():
        if feature.kind is FeatureKind.CONTAINMENT and feature.target is not None:
            concrete = [each for each in feature.target.subtypes if not each.abstract]
            found.update(dict.fromkeys(sorted(concrete, key=lambda each: each.name)))
    return list(found)


def _holds(owner: ClassTable, wanted: ClassTable) -> bool:
    return wanted in contained_classes(owner)
