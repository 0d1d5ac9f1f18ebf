"""Elements that note who reads their features.

They are of classes of their own, which specialise those of the metamodels: reading any other
element costs what it costs without. What they hold is what those hold (see `filling`).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.metamodel.reactive import Watch
    from jausml.language.metamodel.tables import ClassTable, FeatureTable

WATCH = "_watch"
"""Under which name an element has who reads it."""


@cache
def watched_class(table: ClassTable) -> type[EObject]:
    """Returns the class of the watched elements of a class."""
    plain: Any = table.python_class
    members = {each.name: _access(each) for each in table.features.values()}
    made: type[EObject] = type(plain)(plain.__name__, (plain,), members)
    return made


def watch_of(obj: EObject) -> Watch | None:
    """Returns who reads an element; None of one that is not watched."""
    found: Watch | None = obj.__dict__.get(WATCH)
    return found


def note(obj: EObject | None, name: str) -> None:
    """Notes that something of an element is read, which is no feature."""
    watch = None if obj is None else obj.__dict__.get(WATCH)
    if watch is not None:
        watch.note(name)


class _Watched:
    """Access to a feature of a watched element."""

    __slots__ = ("_default", "_feature", "_name")

    def __init__(self, table: FeatureTable) -> None:
        self._feature = table.feature
        self._name = table.name
        self._default = table.default

    def __set__(self, obj: Any, value: Any) -> None:
        raise TypeError(f"{self._name} of an element that is watched cannot be set")


class _WatchedValue(_Watched):
    __slots__ = ()

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        if obj is None:
            return self._feature
        state = obj.__dict__
        state[WATCH].note(self._name)
        return state.get(self._name, self._default)


class _WatchedReference(_Watched):
    __slots__ = ()

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        if obj is None:
            return self._feature
        state = obj.__dict__
        state[WATCH].note(self._name)
        holder = state.get(self._name)
        return self._default if holder is None else holder._value  # noqa: SLF001 -- pyecore's


class _WatchedValues(_Watched):
    __slots__ = ()

    def __get__(self, obj: Any, owner: Any = None) -> Any:
        if obj is None:
            return self._feature
        state = obj.__dict__
        state[WATCH].note(self._name)
        held = state.get(self._name)
        return self._feature.__get__(obj, owner) if held is None else held


def _access(table: FeatureTable) -> _Watched:
    if table.many:
        return _WatchedValues(table)
    return _WatchedReference(table) if table.is_reference else _WatchedValue(table)
