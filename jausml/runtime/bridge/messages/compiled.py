"""Compiled translations: functions of a library beside the module of a bridge.

A function only translates messages in the usual case. It leaves all others to the method of the
bridge, which translates the same bytes, so that limits, counts, and errors do not depend on the
form. The library is made by `jausml build`, `jausml run` or the build of the workspace. If it is
missing, or was built of another source, the methods translate all messages.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

MethodT = TypeVar("MethodT", bound="Callable[..., Any]")

# Returns the target message of a source message and of messages of joins, or None to leave it.
Function: TypeAlias = "Callable[..., bytes | None]"

LIBRARIES = "_core*.so"  # names of the libraries beside the module of a bridge
_DIGEST = "jausml_digest"
_DIGEST_SIZE = 32


class NoCoreError(Exception):
    """A bridge has no compiled core; the text says why."""


@dataclass(frozen=True)
class Core:
    """The compiled core of a bridge package."""

    module: str  # path of the module, beside which the library is
    digest: str  # of the source, which the library must have too

    def function(self, name: str, **fields: Any) -> Callable[[MethodT], MethodT]:
        """Returns a decorator that adds a compiled form to a method; an override has none.

        Args:
            name: Name of the function in the library.
            **fields: Other fields of `Compiled`.
        """
        form = Compiled(self, name, **fields)

        def mark(method: MethodT) -> MethodT:
            vars(method)["compiled"] = form
            return method

        return mark

    def load(self) -> ctypes.CDLL:
        """Returns the library; raises NoCoreError if there is none of this source."""
        paths = sorted(Path(self.module).parent.glob(LIBRARIES))
        reason = "it is not built"
        for path in paths:
            try:
                # PyDLL keeps the lock of the interpreter: a function takes microseconds.
                library = ctypes.PyDLL(str(path))
                digest = (ctypes.c_char * _DIGEST_SIZE).in_dll(library, _DIGEST).value.decode()
            except (OSError, ValueError) as error:
                reason = str(error)
                continue
            if digest == self.digest:
                return library
            reason = "it was built of another model"
        raise NoCoreError(reason)


@dataclass(frozen=True)
class Compiled:
    """The compiled form of a translation."""

    core: Core
    name: str
    quantities: tuple[str, ...] = ()  # attributes of the bridge that are numbers
    texts: tuple[str, ...] = ()  # attributes of the bridge that are texts
    joins: tuple[str, ...] = ()  # parameters that are joined messages
    needs_clock: bool = False  # whether it uses the present time
    unknown: tuple[str, ...] = ()  # fields that it omits where their value is not a number

    def of(self, bridge: Any, library: ctypes.CDLL, note: Callable[[str], None]) -> Function:
        """Returns the function for a bridge; calls `note` with the path of each omitted field."""
        function = getattr(library, self.name)
        function.argtypes = (
            ctypes.c_char_p,
            ctypes.c_size_t,
            ctypes.POINTER(_Live),
            ctypes.POINTER(_Result),
        )
        function.restype = ctypes.c_int64
        result = _Result()
        result_reference, read = ctypes.byref(result), ctypes.string_at
        if not (self.quantities or self.texts or self.joins or self.needs_clock):

            def plain(data: bytes) -> bytes | None:
                size = function(data, len(data), None, result_reference)
                return None if size < 0 else read(result.data, size)

            return self._with_note(plain, result, note)
        live = _LiveValues(bridge, self)
        live_reference, update = ctypes.byref(live.shared), live.update

        def with_live(data: bytes, *joins: bytes | None) -> bytes | None:
            if not update(joins):
                return None
            size = function(data, len(data), live_reference, result_reference)
            return None if size < 0 else read(result.data, size)

        return self._with_note(with_live, result, note)

    def alone(self, bridge: Any, library: ctypes.CDLL) -> Translation | None:
        """Returns the function for the core to call without Python; None for one with joins.

        It uses the present values of attributes.
        """
        live = _LiveValues(bridge, self)
        if self.joins or not live.update(()):
            return None
        function = ctypes.cast(getattr(library, self.name), ctypes.c_void_p)
        translation = Translation(function.value, ctypes.pointer(live.shared), self.needs_clock)
        translation.values = live  # kept, as the core only has their address
        return translation

    def paths_of(self, left_out: int) -> list[str]:
        """Returns the paths of the omitted fields, for which `left_out` has a bit each."""
        return [path for bit, path in enumerate(self.unknown) if left_out >> bit & 1]

    def _with_note(
        self, function: Function, result: _Result, note: Callable[[str], None]
    ) -> Function:
        """Returns a function that also calls `note` for each omitted field."""
        if not self.unknown:
            return function
        paths_of = self.paths_of

        def with_note(data: bytes, *joins: bytes | None) -> bytes | None:
            target = function(data, *joins)
            if target is not None and result.unknown:
                for path in paths_of(result.unknown):
                    note(path)
            return target

        return with_note


def compiled_of(translate: Callable[..., Any]) -> Compiled | None:
    """Returns the compiled form of a translation; None for an override."""
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
    """A function, the values that it uses, and whether it uses the time."""

    _fields_ = (
        ("function", ctypes.c_void_p),
        ("live", ctypes.POINTER(_Live)),
        ("needs_clock", ctypes.c_uint8),
    )

    values: _LiveValues


class _Result(ctypes.Structure):
    _fields_ = (("data", ctypes.c_void_p), ("unknown", ctypes.c_uint64))


class _LiveValues:
    """Attributes of a bridge, joins and the time, in the structure that a function reads."""

    def __init__(self, bridge: Any, compiled: Compiled) -> None:
        self._bridge = bridge
        self._quantities, self._texts = compiled.quantities, compiled.texts
        self._needs_clock = compiled.needs_clock
        self._encoded_texts: list[Any] = [None] * len(self._texts)
        self._numbers = (ctypes.c_double * max(1, len(self._quantities)))()
        self._text_bytes = (_Bytes * max(1, len(self._texts)))()
        self._joins = (_Bytes * max(1, len(compiled.joins)))()
        self.shared = _Live(self._numbers, self._text_bytes, self._joins, 0, 0)

    def update(self, joins: Sequence[bytes | None]) -> bool:
        """Takes the present values; returns False if one is no float or ASCII text."""
        bridge = self._bridge
        for index, name in enumerate(self._quantities):
            value = getattr(bridge, name)
            if type(value) is not float:
                return False
            self._numbers[index] = value
        for index, name in enumerate(self._texts):
            value = getattr(bridge, name)
            if value is not self._encoded_texts[index] and not self._set_text(index, value):
                return False
        for index, data in enumerate(joins):
            self._joins[index] = _Bytes(data, 0 if data is None else len(data))
        if self._needs_clock:
            now = bridge.now()
            self.shared.sec, self.shared.nanosec = now.sec, now.nanosec
        return True

    def _set_text(self, index: int, value: Any) -> bool:
        if not isinstance(value, str) or not value.isascii():
            return False
        data = value.encode()
        self._text_bytes[index] = _Bytes(data, len(data))
        self._encoded_texts[index] = value
        return True
