"""Access to the features of pyecore objects, quicker than pyecore's own.

Rules and generators do little but ask elements for their features: pyecore would make a holder for
each that was never given a value. The value of an attribute stands in the element itself, where
Python finds it first.
"""

from __future__ import annotations

from typing import Any

from pyecore.valuecontainer import EValue

from jausml.language.metamodel.filling import new_collection
from jausml.language.metamodel.tables import FeatureTable

# The state behind the setters is private to pyecore.
# ruff: noqa: SLF001


class _Default:
    """The default of an attribute of one value, while the element holds none by its name."""

    __slots__ = ("default", "feature")

    def __init__(self, table: FeatureTable) -> None:
        self.default = table.default
        self.feature = table.feature

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        return self.feature if obj is None else self.default


def _set_attribute(obj: Any, name: str, value: Any) -> None:
    """Sets an attribute as pyecore does: checked first, and stored before listeners are told."""
    known = _known(obj, name)
    if isinstance(known, _Default):
        holder = EValue(obj, known.feature)
        holder.check(value)
        holder._value = getattr(obj, name)
        obj.__dict__[name] = value
        holder._set(value)
    else:
        object.__setattr__(obj, name, value)


def _take_attribute(obj: Any, name: str) -> None:
    """Sets an attribute to its default, as pyecore does for `del`."""
    known = _known(obj, name)
    if isinstance(known, _Default):
        setattr(obj, name, known.default)
    else:
        object.__delattr__(obj, name)


def _known(obj: Any, name: str) -> Any:
    """Returns the attribute of the class of an element by its name, None when there is none."""
    return next((vars(base)[name] for base in type(obj).__mro__ if name in vars(base)), None)


class _Access:
    """Access to a feature, in place of pyecore's in the classes of elements."""

    __slots__ = ("_default", "_feature", "_name", "_table")

    def __init__(self, table: FeatureTable) -> None:
        self._table = table
        self._feature = table.feature
        self._name = table.name
        self._default = table.default

    def __set__(self, obj: Any, value: Any) -> None:
        self._feature.__set__(obj, value)

    def __delete__(self, obj: Any) -> None:
        self._feature.__delete__(obj)


class _Single(_Access):
    """Access to a reference of one value."""

    __slots__ = ()

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        if obj is None:
            return self._feature
        holder = obj.__dict__.get(self._name)
        return self._default if holder is None else holder._value


class _Many(_Access):
    """Access to a feature of many values, whose collection stays the same."""

    __slots__ = ()

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        if obj is None:
            return self._feature
        collection = obj.__dict__.get(self._name)
        return new_collection(obj, self._table) if collection is None else collection


def hasten(table: FeatureTable) -> None:
    """Puts quick access to a feature into its Python class, for all its elements.

    Features with opposites keep pyecore's access, whose holder its setters need, and derived ones
    are computed.
    """
    feature = table.feature
    if table.opposite is not None or feature.derived:
        return
    python_class = feature.eContainingClass.python_class
    if table.many:
        setattr(python_class, table.name, _Many(table))
    elif table.is_reference:
        setattr(python_class, table.name, _Single(table))
    else:
        setattr(python_class, table.name, _Default(table))
        python_class.__setattr__ = _set_attribute
        python_class.__delattr__ = _take_attribute
