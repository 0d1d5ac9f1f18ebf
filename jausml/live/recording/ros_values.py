"""Decoder of recorded messages of ROS into plain values, by their recorded definitions.

No code of the recording is run, and no package needs to be installed. The bytes are those of CDR
(OMG DDSI-RTPS, encapsulation CDR_BE and CDR_LE).
"""

from __future__ import annotations

import re
import struct
import sys
from array import array
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from jausml.language.cdr import PRIMITIVES
from jausml.language.interfaces import parse_definition
from jausml.language.interfaces.definitions import FIXED, SINGLE, FieldDefinition, FieldType
from jausml.live.recording.mcap_files import RecordingError

Read: TypeAlias = "Callable[['_Bytes'], Any]"

_PART = re.compile(r"^=+\nMSG: (\S+)\n", re.MULTILINE)
# A type that ROS makes of a service or action, such as `std_srvs/SetBool_Request`.
_PART_OF_CALL = re.compile(r"^(?:MSG: )?\w+/[A-Z][A-Za-z0-9]*(?:_[A-Z][A-Za-z0-9]*)+", re.MULTILINE)

# The member in the definition that ROS makes of a type without fields.
_NO_MEMBER = "structure_needs_at_least_one_member"

_HEAD = 4
_ORDERS = {0: ">", 1: "<"}
_DEEPEST = 32


class _Bytes:
    """The bytes of a message, and the position of the reader, by which values are aligned."""

    __slots__ = ("at", "data", "order")

    def __init__(self, data: bytes) -> None:
        if len(data) < _HEAD or data[0] or data[1] not in _ORDERS:
            raise RecordingError("its bytes are no plain CDR")
        self.data, self.at, self.order = data[_HEAD:], 0, _ORDERS[data[1]]

    def number(self, code: str, size: int) -> Any:
        """Returns the next number (`code`: of `struct`; `size`: its bytes)."""
        at = -(-self.at // size) * size
        self.at = at + size
        return struct.unpack_from(self.order + code, self.data, at)[0]

    def numbers(self, code: str, size: int, count: int) -> tuple[Any, ...]:
        """Returns the next `count` numbers."""
        if not count:
            return ()
        at = -(-self.at // size) * size
        if at + size * count > len(self.data):
            raise RecordingError("it ends in the midst of an array")
        self.at = at + size * count
        return struct.unpack_from(f"{self.order}{count}{code}", self.data, at)

    def text(self) -> str:
        """Returns the next text, which ends with a zero byte."""
        size = self.number("I", 4)
        end = self.at + size
        if end > len(self.data):
            raise RecordingError("it ends in the midst of a text")
        octets = self.data[self.at : max(self.at, end - 1)]
        self.at = end
        return octets.decode("utf-8", "replace")

    def wide_text(self) -> str:
        """Returns the next text of wide characters: UTF-16 units of four bytes each."""
        units = self.numbers("I", 4, self.number("I", 4))
        try:
            return array("H", units).tobytes().decode(_UTF_16, "replace")
        except OverflowError as error:
            raise RecordingError("a text of wide characters has others") from error


_UTF_16 = f"utf-16-{sys.byteorder[0]}e"


class RosReader:
    """Reader of messages of one type.

    Values are dictionaries, lists, tuples of numbers, texts and numbers.
    """

    def __init__(self, name: str, definition: str) -> None:
        """Reads the definition of a type and of all types in it, in the form of `ros2msg`.

        Raises:
            RecordingError: The definition is wrong, or lacks a type.
        """
        parts = defined_parts(name, definition)
        self._name = name
        self._read = _record(next(iter(parts)), parts, {}, 0)

    def read(self, data: bytes) -> dict[str, Any]:
        """Returns the fields of a message.

        Raises:
            RecordingError: The bytes are no message of this type.
        """
        try:
            fields: dict[str, Any] = self._read(_Bytes(data))
        except (RecordingError, struct.error) as error:
            raise RecordingError(f"a message of {self._name} cannot be read: {error}") from error
        return fields


def defined_parts(name: str, definition: str) -> dict[str, str]:
    """Returns the definitions in a `ros2msg` text by short name, that of type `name` first."""
    first, *rest = _PART.split(
        _PART_OF_CALL.sub(lambda match: _in_camel_case(match[0]), definition)
    )
    own = _in_camel_case(_short(name))
    return {own: first, **dict(zip(map(_short, rest[::2]), rest[1::2], strict=True))}


def defined_fields(name: str, parts: Mapping[str, str]) -> list[FieldDefinition]:
    """Returns the fields of a type.

    Raises:
        RecordingError: It is not defined, or its definition is wrong.
    """
    if name not in parts:
        raise RecordingError(f"the recording does not define {name}")
    definition = parse_definition(parts[name], "msg")
    if definition.faults:  # a missing field would shift all following ones
        raise RecordingError(f"its definition of {name} is wrong: {definition.faults[0].message}")
    return definition.sections[0].fields


def _in_camel_case(name: str) -> str:
    """Returns a type of a service or action without `_`, which definitions may not have."""
    package, slash, own = name.rpartition("/")
    return package + slash + own.replace("_", "")


def _short(name: str) -> str:
    """Returns the short name of a type, such as `nav_msgs/Odometry`."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}"


def _record(name: str, parts: Mapping[str, str], known: dict[str, Read], depth: int) -> Read:
    """Returns the reader of a type; `known` has the readers made so far."""
    if name in known:
        return known[name]
    if depth > _DEEPEST:
        raise RecordingError(f"its definition of {name} holds itself")
    fields = defined_fields(name, parts)
    package = name.partition("/")[0]
    members = [(field.name, _field(field.type, package, parts, known, depth)) for field in fields]
    if [name for name, _ in members] in ([], [_NO_MEMBER]):
        return _nothing

    def read(source: _Bytes) -> dict[str, Any]:
        return {name: member(source) for name, member in members}

    known[name] = read
    return read


def _nothing(source: _Bytes) -> dict[str, Any]:
    """Reads the one byte that a type without fields has on the wire."""
    source.number("B", 1)
    return {}


def _field(
    kind: FieldType, package: str, parts: Mapping[str, str], known: dict[str, Read], depth: int
) -> Read:
    primitive = None if kind.package else PRIMITIVES.get(kind.name)
    if primitive is not None:
        return _numeric(kind, primitive.code)
    if kind.is_primitive:
        one: Read = _Bytes.text if kind.name == "string" else _Bytes.wide_text
    else:
        one = _record(f"{kind.package or package}/{kind.name}", parts, known, depth + 1)
    if kind.array == SINGLE:
        return one
    size = kind.array_size if kind.array == FIXED else None

    def read(source: _Bytes) -> list[Any]:
        count = source.number("I", 4) if size is None else size
        if count > len(source.data) - source.at:
            raise RecordingError("it ends in the midst of a sequence")
        return [one(source) for _ in range(count)]

    return read


def _numeric(kind: FieldType, code: str) -> Read:
    size = struct.calcsize("=" + code)
    if kind.array == SINGLE:
        return lambda source: source.number(code, size)
    if kind.array == FIXED:
        return lambda source: source.numbers(code, size, kind.array_size)
    return lambda source: source.numbers(code, size, source.number("I", 4))
