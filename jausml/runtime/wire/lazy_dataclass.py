"""Dataclasses whose methods are made when they are needed, as generated messages are.

The decorator of the standard library compiles methods while the module is imported, for a third of
a millisecond a class. A bridge with hundreds of messages translates most of them from bytes to
bytes, and never makes one.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar, get_origin

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_METHODS = ("__init__", "__repr__", "__eq__")
_MADE_LATER = (*_METHODS, "__dataclass_fields__", "__dataclass_params__")
_OF_NO_SLOTS = ("__dict__", "__weakref__")


class _Later:
    """Stands for a method of a dataclass until it is asked for."""

    def __init__(self, written: Mapping[str, Any]) -> None:
        """Remembers the attributes of the class as it is written."""
        self._written = written

    def __set_name__(self, owner: type, name: str) -> None:
        self._owner, self._name = owner, name

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        # Another thread may have completed it meanwhile, and another one may do the same just now.
        if vars(self._owner)[self._name] is self:
            _complete(self._owner, self._written)
        found = vars(self._owner)[self._name]
        return found.__get__(instance, owner) if self._name in _METHODS else found


def _complete(cls: type, written: Mapping[str, Any]) -> None:
    # The module of the class may have gone since: what it is asked for, ClassVar, is here too.
    attributes = {**written, "__module__": __name__}
    whole: type = dataclasses.dataclass(type(cls.__name__, cls.__bases__, attributes))
    for name, value in vars(whole).items():
        if name not in (*written, *_OF_NO_SLOTS):
            setattr(cls, name, value)


def _with_slots(cls: type) -> type:
    written = {name: value for name, value in vars(cls).items() if name not in _OF_NO_SLOTS}
    written["__qualname__"] = cls.__qualname__
    inherited = getattr(cls, "__match_args__", ())
    declared = [name for name, kind in cls.__annotations__.items() if not _is_of_class(kind)]
    own = tuple(name for name in declared if name not in inherited)
    attributes = {name: value for name, value in written.items() if name not in declared}
    attributes |= {"__slots__": own, "__match_args__": (*inherited, *own)}
    attributes |= {name: _Later(written) for name in _MADE_LATER}
    return type(cls)(cls.__name__, cls.__bases__, {**attributes, "__hash__": None})


def _is_of_class(kind: Any) -> bool:
    """Whether an annotation, which is a text in generated code, is that of a class attribute."""
    return kind.startswith("ClassVar") if isinstance(kind, str) else get_origin(kind) is ClassVar


if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass  # noqa: PLC0414 - what checkers know
else:

    def dataclass(*, slots: bool) -> Callable[[type], type]:
        """Returns a dataclass that differs from one of the standard library in its time alone.

        Args:
            slots: Without slots it is that of the standard library.
        """
        return _with_slots if slots else dataclasses.dataclass
