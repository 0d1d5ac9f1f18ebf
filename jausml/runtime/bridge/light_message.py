"""Light classes: ROS messages as plain objects, which need no installed classes of ROS."""

from __future__ import annotations

import importlib
import struct
from array import array
from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Any, ClassVar, TypeAlias, TypeGuard, TypeVar

from ..wire.message import DecodeError, EncodeError
from .messages import cdr as cdr  # noqa: PLC0414 - for generated code
from .messages.limits import RosTypeError

MessageT = TypeVar("MessageT", bound="LightMessage")

Layout: TypeAlias = Mapping[str, str]  # types of fields by name
BAD_VALUES = (struct.error, TypeError, ValueError, OverflowError, AttributeError)


class LightMessage:
    """Base of generated classes, each with the attributes of the ROS class of the same type."""

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]
    TYPE: ClassVar[str]  # the type, e.g. `nav_msgs/msg/Odometry`
    # Types of the fields by name, in order, as by `get_fields_and_field_types` of the ROS class.
    LAYOUT: ClassVar[Layout]
    NESTED: ClassVar[tuple[type[LightMessage], ...]]  # classes of its fields
    LEAST: ClassVar[int]  # bytes of its shortest serialized form

    @classmethod
    def from_cdr(cls: type[MessageT], data: bytes) -> MessageT:
        """Returns a deserialized message, from either byte order; raises DecodeError."""
        order = cdr.ORDERS.get(data[:2])
        if order is None or len(data) < len(cdr.HEADER):
            raise DecodeError(cls.TYPE, "no XCDR1 encapsulation")
        try:
            return cls._read(data, len(cdr.HEADER), order)[0]
        except struct.error as error:
            raise DecodeError(cls.TYPE, str(error)) from error

    def to_cdr(self) -> bytes:
        """Returns the serialized message, little-endian; raises EncodeError for an unfit value."""
        parts = [cdr.HEADER]
        try:
            self._write(parts.append, len(cdr.HEADER))
        except BAD_VALUES as error:
            raise EncodeError(self.TYPE, str(error)) from error
        return b"".join(parts)

    @classmethod
    def _read(cls: type[MessageT], data: bytes, offset: int, order: int) -> tuple[MessageT, int]:
        """Returns the message at an offset, and the offset behind it."""
        raise NotImplementedError

    def _write(self, append: cdr.Append, offset: int) -> int:
        """Appends the message for an offset; returns the offset behind it."""
        raise NotImplementedError

    @classmethod
    def _read_many(
        cls: type[MessageT], data: bytes, offset: int, count: int, order: int
    ) -> tuple[list[MessageT], int]:
        """Returns consecutive messages, and the offset behind them."""
        cdr.check_count(data, offset, count, cls.LEAST)
        messages = []
        for _ in range(count):
            message, offset = cls._read(data, offset, order)
            messages.append(message)
        return messages, offset

    @classmethod
    def _write_many(
        cls: type[MessageT], messages: Sequence[MessageT], append: cdr.Append, offset: int
    ) -> int:
        """Appends messages for an offset; returns the offset behind them."""
        for message in messages:
            # An override may have put an object of ROS into the list.
            offset = cls._write(message, append, offset)
        return offset

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(_equal(getattr(self, name), getattr(other, name)) for name in self.LAYOUT)

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.LAYOUT)
        return f"{self.TYPE.replace('/', '.')}({fields})"


def assign(message: Any, path: str, *, value: object) -> None:
    """Sets the field at a dotted path of a message, light or of ROS."""
    owner, _, name = path.rpartition(".")
    setattr(attrgetter(owner)(message) if owner else message, name, value)


# ------------------------------------------------------------------ installed types


def is_light(message_type: type[Any]) -> TypeGuard[type[LightMessage]]:
    """Returns whether a class is a light one."""
    return issubclass(message_type, LightMessage)


def differences(light: type[LightMessage], real: Any) -> list[str]:
    """Returns how a type of the model, or one nested in it, differs from the installed one.

    Each sentence names the type, the field and both types of the field.
    """
    return list(_differences(light, real, set()))


def installed_class(light: type[LightMessage]) -> Any:
    """Returns the ROS class of a light one; raises RosTypeError if there is none like it."""
    try:
        real = installed(light.TYPE)
    except ImportError as error:
        package = light.TYPE.partition("/")[0]
        cure = f"install {package}, or add it to the path of the bridge"
        raise RosTypeError(f"{light.TYPE} is not installed ({error}); {cure}") from error
    mismatches = differences(light, real)
    if mismatches:
        package = mismatches[0].partition("/")[0]
        cure = f"import the installed types (jausml import ros {package} --force) and generate anew"
        raise RosTypeError(
            f"the installed types are not those of the model: {'; '.join(mismatches)}; {cure}"
        )
    return real


def installed(name: str) -> Any:
    """Returns the ROS class of a type such as `nav_msgs/msg/Odometry`; raises ImportError."""
    package, kind, own = name.split("/")
    module = importlib.import_module(f"{package}.{kind}")
    # The parts of services are SetBool_Request in ROS, and SetBool.Request in rclpy.
    whole, _, part = own.rpartition("_") if kind == "srv" else (own, "", "")
    try:
        return getattr(getattr(module, whole), part) if part else getattr(module, own)
    except AttributeError:
        raise ImportError(f"{package} has no type {own}", name=module.__name__) from None


def _differences(
    light: type[LightMessage], real: Any, known: set[type[LightMessage]]
) -> Iterator[str]:
    known.add(light)
    there: Mapping[str, str] = real.get_fields_and_field_types()
    for name, kind in light.LAYOUT.items():
        if there.get(name) != kind:
            other = f"is {there[name]} there" if name in there else "is not there"
            yield f"{light.TYPE}: {name} is {kind} in the model and {other}"
    for name, kind in there.items():
        if name not in light.LAYOUT:
            yield f"{light.TYPE}: {name} is not in the model and {kind} there"
    if list(light.LAYOUT) != list(there) and set(light.LAYOUT) == set(there):
        yield f"{light.TYPE}: the fields are in another order there"
    for nested in light.NESTED:
        if nested not in known:
            try:
                inner = installed(nested.TYPE)
            except ImportError as error:
                yield f"{nested.TYPE}: {error}"
            else:
                yield from _differences(nested, inner, known)


def _equal(one: Any, other: Any) -> bool:
    """Returns whether two values of a field are equal, whatever the type of an array."""
    if isinstance(one, array | bytes | bytearray | list | tuple):
        return list(one) == list(other)
    return bool(one == other)
