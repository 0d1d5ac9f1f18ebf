"""Compiled translations: functions of a library that stands beside the module of a bridge.

A function does the usual case alone. In every other one it gives way, and the method of the bridge
treats the same bytes: what is dropped, limited, counted and said does not depend on the form. The
library is made by `jausml build`, `jausml run` or the build of the workspace; where it is missing,
or was made of another text, the methods do all.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

MethodT = TypeVar("MethodT", bound="Callable[..., Any]")

Function: TypeAlias = "Callable[..., bytes | None]"
"""Makes bytes of bytes and of those of joins, or gives way with None."""

LIBRARIES = "_core*.so"  # names of the libraries beside the module of a bridge
_DIGEST = "jausml_digest"
_DIGEST_SIZE = 32


class NoCoreError(Exception):
    """A bridge has no compiled core; the text says why."""


@dataclass(frozen=True)
class Core:
    """The compiled core of a bridge package.

    Its library stands beside the file of the module, and must say the digest of the text that it
    was made of.
    """

    module: str
    digest: str

    def function(self, name: str, **fields: Any) -> Callable[[MethodT], MethodT]:
        """Returns a decorator: a method with a compiled form, which an override does not have.

        What it is given besides the message are fields of `Compiled`.
        """
        form = Compiled(self, name, **fields)

        def mark(method: MethodT) -> MethodT:
            vars(method)["compiled"] = form
            return method

        return mark

    def load(self) -> ctypes.CDLL:
        """Returns the library; raises NoCoreError where none of this text can be loaded."""
        paths = sorted(Path(self.module).parent.glob(LIBRARIES))
        reason = "it is not built"
        for path in paths:
            try:
                # With the lock of the interpreter held: a function takes microseconds.
                library = ctypes.PyDLL(str(path))
                made_of = (ctypes.c_char * _DIGEST_SIZE).in_dll(library, _DIGEST).value.decode()
            except (OSError, ValueError) as error:
                reason = str(error)
                continue
            if made_of == self.digest:
                return library
            reason = "it was built of another model"
        raise NoCoreError(reason)


@dataclass(frozen=True)
class Compiled:
    """What a method has besides itself."""

    core: Core
    name: str
    quantities: tuple[str, ...] = ()  # attributes of the bridge that are numbers
    texts: tuple[str, ...] = ()  # attributes of the bridge that are texts
    joins: tuple[str, ...] = ()  # parameters that are joined messages
    needs_clock: bool = False  # whether it is told the present time
    unknown: tuple[str, ...] = ()  # fields that it leaves out where their value is no number

    def of(self, bridge: Any, library: ctypes.CDLL, note: Callable[[str], None]) -> Function:
        """Returns the function of a bridge; fields left out, as they are no number, are noted."""
        function = getattr(library, self.name)
        function.argtypes = (
            ctypes.c_char_p,
            ctypes.c_size_t,
            ctypes.POINTER(_Live),
            ctypes.POINTER(_Made),
        )
        function.restype = ctypes.c_int64
        result = _Made()
        where, text = ctypes.byref(result), ctypes.string_at
        if not (self.quantities or self.texts or self.joins or self.needs_clock):

            def plain(data: bytes) -> bytes | None:
                size = function(data, len(data), None, where)
                return None if size < 0 else text(result.data, size)

            return self._noting(plain, result, note)
        live = _LiveValues(bridge, self)
        live_reference, update = ctypes.byref(live.given), live.update

        def with_live(data: bytes, *joins: bytes | None) -> bytes | None:
            if not update(joins):
                return None
            size = function(data, len(data), live_reference, where)
            return None if size < 0 else text(result.data, size)

        return self._noting(with_live, result, note)

    def alone(self, bridge: Any, library: ctypes.CDLL) -> Translation | None:
        """Returns what a core is given to run the function without Python; None for one with joins.

        What may change between two messages is what it is now.
        """
        live = _LiveValues(bridge, self)
        if self.joins or not live.update(()):
            return None
        function = ctypes.cast(getattr(library, self.name), ctypes.c_void_p)
        translation = Translation(function.value, ctypes.pointer(live.given), self.needs_clock)
        translation.keep(live)
        return translation

    def paths_of(self, left_out: int) -> list[str]:
        """Returns the paths of the fields that a function has left out, each a bit."""
        return [path for at, path in enumerate(self.unknown) if left_out >> at & 1]

    def _noting(self, function: Function, result: _Made, note: Callable[[str], None]) -> Function:
        """Returns a function that counts the fields that are left out."""
        if not self.unknown:
            return function
        bits = [(1 << at, path) for at, path in enumerate(self.unknown)]

        def noting(data: bytes, *joins: bytes | None) -> bytes | None:
            target = function(data, *joins)
            if target is not None and result.unknown:
                for bit, path in bits:
                    if result.unknown & bit:
                        note(path)
            return target

        return noting


def compiled_of(translate: Callable[..., Any]) -> Compiled | None:
    """Returns the compiled form of a translation; none of an override."""
    form: Compiled | None = getattr(translate, "compiled", None)
    return form


class _Bytes(ctypes.Structure):
    _fields_ = (("data", ctypes.c_char_p), ("size", ctypes.c_size_t))


class _Live(ctypes.Structure):
    _fields_ = (
        ("quantities", ctypes.POINTER(ctypes.c_double)),
        ("texts", ctypes.POINTER(_Bytes)),
        ("joins", ctypes.POINTER(_Bytes)),
        ("sec", ctypes.c_int64),
        ("nanosec", ctypes.c_int64),
    )


class Translation(ctypes.Structure):
    """A function, the values that it is given, and whether it is told the time."""

    _fields_ = (
        ("function", ctypes.c_void_p),
        ("live", ctypes.POINTER(_Live)),
        ("needs_clock", ctypes.c_uint8),
    )

    def keep(self, values: _LiveValues) -> None:
        """Lends values for as long as this is there."""
        self._values = values


class _Made(ctypes.Structure):
    _fields_ = (("data", ctypes.c_void_p), ("unknown", ctypes.c_uint64))


class _LiveValues:
    """What may change while the bridge runs, as a function is given it."""

    def __init__(self, bridge: Any, compiled: Compiled) -> None:
        self._bridge = bridge
        self._quantities, self._texts = compiled.quantities, compiled.texts
        self._needs_clock = compiled.needs_clock
        self._known: list[Any] = [None] * len(self._texts)
        self._numbers = (ctypes.c_double * max(1, len(self._quantities)))()
        self._lent = (_Bytes * max(1, len(self._texts)))()
        self._joins = (_Bytes * max(1, len(compiled.joins)))()
        self.given = _Live(self._numbers, self._lent, self._joins, 0, 0)

    def update(self, joins: Sequence[bytes | None]) -> bool:
        """Takes the present values; False where one of them is not what it should be."""
        bridge = self._bridge
        for at, name in enumerate(self._quantities):
            value = getattr(bridge, name)
            if type(value) is not float:
                return False
            self._numbers[at] = value
        for at, name in enumerate(self._texts):
            value = getattr(bridge, name)
            if value is not self._known[at] and not self._take(at, value):
                return False
        for at, data in enumerate(joins):
            self._joins[at] = _Bytes(data, 0 if data is None else len(data))
        if self._needs_clock:
            now = bridge.now()
            self.given.sec, self.given.nanosec = now.sec, now.nanosec
        return True

    def _take(self, at: int, value: Any) -> bool:
        if not isinstance(value, str) or not value.isascii():
            return False
        data = value.encode()
        self._lent[at] = _Bytes(data, len(data))
        self._known[at] = value
        return True
