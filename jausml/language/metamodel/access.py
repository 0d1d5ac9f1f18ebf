"""Access to the features of elements, for a fraction of what pyecore's own access takes.

Rules and generators do little but ask elements for their features. pyecore makes a holder for each
feature that was never given a value, when it is first asked for; here that is answered without.
"""

# The state behind the setters is private to pyecore.
# ruff: noqa: SLF001

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.language.metamodel.tables import FeatureTable


class _Access:
    """Access to a feature, in place of pyecore's in the classes of elements."""

    __slots__ = ("_default", "_feature", "_name")

    def __init__(self, table: FeatureTable) -> None:
        self._feature = table.feature
        self._name = table.name
        self._default = table.default

    def __set__(self, obj: Any, value: Any) -> None:
        self._feature.__set__(obj, value)

    def __delete__(self, obj: Any) -> None:
        self._feature.__delete__(obj)


class _Single(_Access):
    """Access to a feature of one value."""

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
        return self._feature.__get__(obj, owner) if collection is None else collection


def hasten(table: FeatureTable) -> None:
    """Gives the class that declares a feature quick access to it.

    Of one with an opposite pyecore's setters expect the holder that its own access makes; what is
    derived is computed.
    """
    feature = table.feature
    if table.opposite is None and not feature.derived:
        access = _Many(table) if table.many else _Single(table)
        setattr(feature.eContainingClass.python_class, table.name, access)
