"""Base of the generated messages, and the two errors of their codecs.

A message on the wire is its code (u16, little endian) and a packed body without padding; all
numbers are little endian (SAE AS5684, encoding of JSIDL messages; codes: AS5710, AS6009).
"""

from __future__ import annotations

import struct
from dataclasses import fields, is_dataclass, replace
from functools import cache
from reprlib import recursive_repr
from typing import Any, ClassVar, TypeVar

from ..base.api import JausError

_CODE = struct.Struct("<H")
# Errors of values of another type than their field.
_MISFITS = (struct.error, TypeError, AttributeError, OverflowError)

MessageT = TypeVar("MessageT", bound="Message")


class DecodeError(JausError):
    """Bytes are no valid message of their class."""

    def __init__(self, where: str, reason: str) -> None:
        super().__init__(f"{where}: {reason}")
        self.where = where
        self.reason = reason


class EncodeError(JausError):
    """A value cannot be encoded, for example outside the range of its field."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.reason = reason


def read_code(payload: bytes) -> int:
    """Returns the message code of a payload; DecodeError if it is too short."""
    try:
        code: int = _CODE.unpack_from(payload)[0]
    except struct.error:
        raise DecodeError("message code", f"{len(payload)} bytes cannot hold it") from None
    return code


class Message:
    """One JAUS message; the generated subclasses are dataclasses of its fields.

    The presence vector leaves out an optional field that is None. Two messages are equal when their
    fields are. Comparison and representation are defined here once: functions for them in each of
    some hundred classes would take a tenth of the start of a large bridge.
    """

    __slots__ = ()

    CODE: ClassVar[int]
    NAME: ClassVar[str]

    __hash__ = None  # type: ignore[assignment]  # its fields can be changed

    def __eq__(self, other: object) -> bool:
        if other.__class__ is not self.__class__:
            return NotImplemented
        return _values(self) == _values(other)

    @recursive_repr()
    def __repr__(self) -> str:
        shown = zip(_names(self), _values(self), strict=True)
        values = ", ".join(f"{name}={value!r}" for name, value in shown)
        return f"{self.__class__.__qualname__}({values})"

    def encode(self) -> bytes:
        """Returns message code and body as bytes; EncodeError if a field does not fit."""
        out = bytearray(_CODE.pack(self.CODE))
        try:
            self.write_to(out)
        except _MISFITS as error:
            raise EncodeError(self.NAME, str(error)) from error
        return bytes(out)

    @classmethod
    def decode(cls: type[MessageT], payload: bytes) -> MessageT:
        """Returns the message of a payload; DecodeError if it is not one of this class.

        Bytes after the body are refused: a longer body follows another definition, so that the
        values read of it cannot be trusted.
        """
        if payload[:2] != _CODE.pack(cls.CODE):
            cls.check_code(payload)
        try:
            message, end = cls.read_from(payload, 2)
        except struct.error as error:
            raise DecodeError(cls.NAME, f"the body ends too early: {error}") from None
        if end != len(payload):
            raise DecodeError(cls.NAME, f"{len(payload) - end} bytes follow the body")
        return message

    @classmethod
    def check_code(cls, payload: bytes) -> None:
        """Raises DecodeError for a payload of another message."""
        code = read_code(payload)
        if code != cls.CODE:
            raise DecodeError(cls.NAME, f"message code 0x{code:04X} is another message's")

    def write_to(self, out: bytearray) -> None:
        """Appends the body, empty by default."""

    @classmethod
    def read_from(cls: type[MessageT], buffer: bytes, offset: int) -> tuple[MessageT, int]:  # noqa: ARG003
        """Reads the body, empty by default; returns the message and the offset after it."""
        return cls(), offset


def _names(message: Message) -> tuple[str, ...]:
    """Returns the names of the fields, as dataclasses know them."""
    names: tuple[str, ...] = getattr(message, "__match_args__", ())
    return names


def _values(message: Message) -> tuple[Any, ...]:
    return tuple(getattr(message, name) for name in _names(message))


def asked_for(query: Message, report: MessageT) -> MessageT:
    """Returns a copy of a report without the optional fields that its query does not select.

    The field PresenceVector of a query names the optional fields of the report, by the bits of the
    report's own presence vector (AS5710, AS6009, queries). A query without that field selects all.
    Where nothing is left out, the report itself is returned.
    """
    wanted = _wanted(query)
    if wanted is None:
        return report
    message_class: type = type(report)
    names = optional_fields(message_class)
    if not ~wanted & (1 << len(names)) - 1:
        return report
    left_out = {
        name: None
        for bit, name in enumerate(names)
        if not wanted >> bit & 1 and getattr(report, name) is not None
    }
    return replace(report, **left_out) if left_out else report  # type: ignore[type-var]


def asked_for_in(query: Message, report_class: type[Message], report: bytes) -> bytes:
    """Returns an encoded report without the optional fields that its query does not select."""
    report_class.check_code(report)
    if asks_for_all(query, report_class):
        return report
    whole = report_class.decode(report)
    part = asked_for(query, whole)
    return report if part is whole else part.encode()


def asks_for_all(query: Message, report_class: type[Message]) -> bool:
    """Returns whether a query selects all optional fields of its report."""
    wanted = _wanted(query)
    message_class: type = report_class
    every = (1 << len(optional_fields(message_class))) - 1
    return wanted is None or wanted & every == every


def _wanted(query: Message) -> int | None:
    """Returns the presence vector by which a query selects fields; None for all."""
    wanted = getattr(query, "presence_vector", None)
    return wanted if isinstance(wanted, int) else None


@cache
def optional_fields(message_class: type) -> tuple[str, ...]:
    """Returns the attributes of a message's optional fields in the order of their presence bits.

    Args:
        message_class: Generated class; only its optional fields default to None.
    """
    if not is_dataclass(message_class):
        return ()
    return tuple(field.name for field in fields(message_class) if field.default is None)
