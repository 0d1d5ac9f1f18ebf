"""Filling of pyecore objects, and questions about their features, without notification.

pyecore's setters check types, notify and search containers for each value, which a reader that has
checked everything itself need not pay for. What is written here is exactly the state that the
setters would leave behind (pyecore 0.15), so objects can be changed by the setters afterwards;
tests/metamodel compares the two. The value of an attribute stands in the element itself, without a
holder, as `access` reads it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

from ordered_set import OrderedSet
from pyecore.innerutils import InternalSet
from pyecore.valuecontainer import ECollection, EList, EOrderedSet, EValue

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.tables import (
    ClassTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
    ValueKind,
)

ElementT = TypeVar("ElementT", bound="EObject")

# The state behind the setters is private to pyecore. Its `_isset` is a dict, used as a set.
# ruff: noqa: SLF001


def new_object(table: ClassTable) -> Any:
    """Makes an element of a class that is not abstract, with all features at their defaults.

    It is not among pyecore's `allInstances`, whose weak references would take most of the time.
    """
    element = object.__new__(table.eclass.python_class)
    state = {
        "_internal_id": None,
        "_isset": InternalSet(),
        "_container": None,
        "_containment_feature": None,
        "_eresource": None,
        "listeners": [],
        "_eternal_listener": [],
        "_inverse_rels": set(),
        "_staticEClass": False,
        "dyn_inst": element,
    }
    object.__setattr__(element, "__dict__", state)
    return element


def set_value(obj: Any, table: FeatureTable, value: Any) -> None:
    """Sets a single-valued attribute."""
    obj.__dict__[table.name] = value
    obj._isset[table.feature] = None


def add_values(obj: Any, table: FeatureTable, values: Iterable[Any]) -> None:
    """Adds values to a multi-valued attribute."""
    _extend(_collection(obj, table), values)
    obj._isset[table.feature] = None


def fill(obj: Any, table: FeatureTable, values: Sequence[Any]) -> None:
    """Sets an attribute to its value, or adds values to one with many; none changes nothing."""
    if table.many:
        add_values(obj, table, values)
    elif values:
        set_value(obj, table, values[0])


def assign(obj: Any, table: FeatureTable, value: Any) -> None:
    """Sets a feature, or adds to one with many values; an enumeration by the name of a literal."""
    if table.kind is not FeatureKind.ATTRIBUTE:
        for target in value if table.many and isinstance(value, list | tuple) else [value]:
            link(obj, table, target)
    elif table.many:
        add_values(obj, table, value)
    else:
        data_type = table.data_type
        if data_type is not None and data_type.kind is ValueKind.ENUMERATION:
            value = data_type.literals[value]
        set_value(obj, table, value)


def make(metamodels: Metamodels, kind: type[ElementT], /, **features: Any) -> ElementT:
    """Makes an element of a class.

    Args:
        features: Values, names of literals, elements, or lists of these. None leaves a feature
            alone.
    """
    table = metamodels.class_of(kind)
    element: ElementT = new_object(table)
    for name, value in features.items():
        if value is not None:
            assign(element, table.features[name], value)
    return element


def link(owner: Any, table: FeatureTable, target: Any) -> None:
    """Sets a single-valued reference or adds to a multi-valued one; opposites are kept."""
    point(owner, table, target)
    if table.kind is FeatureKind.CONTAINMENT:
        hang(owner, table, target)
    opposite = table.opposite
    if opposite is None:
        target._inverse_rels.add((owner, table.feature))
    else:
        point(target, opposite, owner)


def hang(owner: Any, table: FeatureTable, target: Any) -> None:
    """Sets what an element has as its owner; the feature of the owner is not changed."""
    state = target.__dict__
    state["_container"] = owner
    state["_containment_feature"] = table.feature


def point(owner: Any, table: FeatureTable, target: Any) -> None:
    """Sets a single-valued reference or adds to a multi-valued one, without the opposite."""
    if table.many:
        collection = _collection(owner, table)
        if not isinstance(collection, EList):
            OrderedSet.add(collection, target)
        elif target not in collection:
            list.append(collection, target)
    else:
        holder = EValue.__new__(EValue)
        holder.owner = owner
        holder.feature = table.feature
        holder.is_ref = True
        holder.is_cont = table.kind is FeatureKind.CONTAINMENT
        holder.generic_type = None
        holder._value = target
        owner.__dict__[table.name] = holder
    owner._isset[table.feature] = None


def _collection(obj: Any, table: FeatureTable) -> Any:
    collection = obj.__dict__.get(table.name)
    return new_collection(obj, table) if collection is None else collection


def new_collection(obj: Any, table: FeatureTable) -> Any:
    """Returns the empty collection that a feature has from now on."""
    if not table.unique:
        collection = ECollection.create(obj, table.feature)
    else:
        # What pyecore's constructors set, without their calls: each list that is read has one.
        collection = EOrderedSet.__new__(EOrderedSet)
        collection.__dict__ = {
            "owner": obj,
            "feature": table.feature,
            "is_ref": table.is_reference,
            "is_cont": table.kind is FeatureKind.CONTAINMENT,
            "generic_type": None,
            "_orderedset_update": False,
            "items": [],
            "map": {},
        }
    obj.__dict__[table.name] = collection
    return collection


def _extend(collection: Any, values: Iterable[Any]) -> None:
    # The base classes' methods: those of pyecore's collections notify.
    if isinstance(collection, EList):
        list.extend(collection, values)
    else:
        for value in values:
            OrderedSet.add(collection, value)


def count(obj: Any, table: FeatureTable) -> int:
    """Returns how many values a feature has; unset and None count as none."""
    held = obj.__dict__.get(table.name)
    if table.many:
        return 0 if held is None else len(held)
    return int(_value(held) is not None)


def contents(obj: Any, table: FeatureTable) -> Sequence[Any]:
    """Returns the values of a feature; unlike asking for it, that leaves no empty value behind."""
    held = obj.__dict__.get(table.name)
    if held is None:
        return ()
    if table.many:
        return list(held)
    value = _value(held)
    return () if value is None else (value,)


def is_set(obj: Any, table: FeatureTable) -> bool:
    """Tells whether a feature was set, also to its default."""
    return table.name in obj.__dict__ and table.feature in obj._isset


def unset(obj: Any, table: FeatureTable) -> None:
    """Makes a feature unset.

    Its value must be its default, as no opposite, owner or listener is told.
    """
    obj.__dict__.pop(table.name, None)
    obj._isset.pop(table.feature, None)


def holds(obj: Any, table: FeatureTable, value: Any) -> bool:
    """Tells whether a reference refers to an element already."""
    held = obj.__dict__.get(table.name)
    if held is None:
        return False
    return value in held if table.many else _value(held) is value


def _value(held: Any) -> Any:
    """Returns the value of a single-valued feature, as the element holds it."""
    return held._value if isinstance(held, EValue) else held
