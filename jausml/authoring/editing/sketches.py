"""Sketches of elements: as they will be once a command has been carried out.

A sketch refers to elements of the model and has an owner there, so that it can be written and named
like any element; the model knows nothing of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.commands import EditError
from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.filling import (
    contents,
    count,
    hang,
    is_set,
    link,
    new_object,
    point,
    set_value,
    set_values,
)
from jausml.language.model.values import convert, show, suggest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.authoring.editing.commands import Add, Child, Values
    from jausml.language.metamodel import ClassTable, DataTypeTable, FeatureTable, Metamodels
    from jausml.language.metamodel.classes.ecore import EObject


def feature_of(table: ClassTable, name: str) -> FeatureTable:
    """Returns a feature of a class that can be set."""
    feature = table.features.get(name)
    if feature is None or not feature.settable or feature.kind is FeatureKind.CONTAINER:
        hint = suggest(name, table.features)
        message = f"{table.name} has no feature {show(name)} that could be set"
        raise EditError(f"{message}; {hint}" if hint else message)
    return feature


def converted(texts: Values, feature: FeatureTable) -> list[Any]:
    """Returns the values of an attribute that texts stand for."""
    if len(texts) > 1 and not feature.many:
        raise EditError(f"{feature.name} takes one value")
    found = []
    for text in texts:
        value, fault = convert(text, cast("DataTypeTable", feature.data_type))
        if fault is not None:
            hint = f"; {fault.hint}" if fault.hint else ""
            raise EditError(f"{feature.name}: {fault.reason}{hint}")
        found.append(value)
    return found


def copied(
    obj: EObject, metamodels: Metamodels, without: tuple[EObject, str] | None = None
) -> tuple[EObject, dict[EObject, EObject]]:
    """Returns a sketch of an element as it is, and the sketch of all that it owns.

    Returns:
        The sketch, whose owner is that of the element, and the sketches by element.
    """
    sketches: dict[EObject, EObject] = {}
    sketch = _copied(obj, metamodels, without or (obj, ""), sketches)
    owner, feature = obj.eContainer(), obj.eContainmentFeature()
    if owner is not None and feature is not None:
        hang(sketch, owner, metamodels.class_of(owner).features[feature.name])
    return sketch, sketches


def _copied(
    obj: EObject,
    metamodels: Metamodels,
    without: tuple[EObject, str],
    sketches: dict[EObject, EObject],
) -> EObject:
    table = metamodels.class_of(obj)
    sketch: EObject = new_object(table)
    sketches[obj] = sketch
    for feature in table.features.values():
        if not feature.settable or feature.kind is FeatureKind.CONTAINER:
            continue
        if (obj, feature.name) == without:
            continue
        if feature.kind is FeatureKind.CONTAINMENT:
            for each in contents(obj, feature):
                link(sketch, feature, _copied(each, metamodels, without, sketches))
        elif feature.is_reference:
            for each in contents(obj, feature):
                point(sketch, feature, each)
        elif feature.many and count(obj, feature):
            set_values(sketch, feature, contents(obj, feature))
        elif not feature.many and is_set(obj, feature):
            set_value(sketch, feature, getattr(obj, feature.name))
    return sketch


def assign(obj: EObject, feature: FeatureTable, values: Sequence[Any]) -> None:
    """Gives a sketch without a value of a feature its values."""
    if feature.is_reference:
        for each in values:
            point(obj, feature, each)
    elif feature.many:
        if values:
            set_values(obj, feature, values)
    elif values:
        set_value(obj, feature, values[0])


def drawn(
    command: Add | Child,
    metamodels: Metamodels,
    find: Callable[[str, FeatureTable], EObject],
) -> EObject:
    """Returns a sketch of a new element with what it owns."""
    table = metamodels.classes.get(command.kind)
    if table is None or table.abstract:
        raise EditError(f"there are no elements of class {show(command.kind)}")
    sketch: EObject = new_object(table)
    _give(sketch, table, command.values, find)
    for child in command.children:
        feature = owning(table, child.feature, child.kind, metamodels)
        if not feature.many and count(sketch, feature):
            raise EditError(f"{feature.name} of {table.name} owns one element")
        link(sketch, feature, drawn(child, metamodels, find))
    return sketch


def owning(table: ClassTable, name: str, kind: str, metamodels: Metamodels) -> FeatureTable:
    """Returns the feature of a class that owns elements of another class."""
    feature = feature_of(table, name)
    owned = metamodels.classes.get(kind)
    if owned is None or owned.abstract:
        raise EditError(f"there are no elements of class {show(kind)}")
    if feature.kind is not FeatureKind.CONTAINMENT or feature.target not in owned.supertypes:
        raise EditError(f"{name} of {table.name} owns no {owned.name}")
    return feature


def _give(
    sketch: EObject,
    table: ClassTable,
    values: Mapping[str, Values],
    find: Callable[[str, FeatureTable], EObject],
) -> None:
    for name, texts in values.items():
        feature = feature_of(table, name)
        if feature.kind is FeatureKind.CONTAINMENT:
            raise EditError(f"{name} of {table.name} owns elements, it has no values")
        if feature.is_reference:
            assign(sketch, feature, [find(each, feature) for each in texts])
        else:
            assign(sketch, feature, converted(texts, feature))
