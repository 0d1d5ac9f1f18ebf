"""Checks values of messages of rclpy, as light classes check theirs.

The classes of ROS take any object for a field, and their serialization reads it as raw memory: -1
in a field of real numbers arrives as not a number, 200 in an int8 as -56, and a list that is longer
than its bound not at all. So messages of users are checked and converted before.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

import operator
import struct
from array import array
from collections.abc import Callable
from functools import cache, partial
from typing import Any, TypeAlias

from rclpy.publisher import Publisher
from rosidl_parser.definition import (
    AbstractGenericString,
    AbstractNestedType,
    AbstractWString,
    Array,
    BasicType,
    NamespacedType,
    UnboundedSequence,
)

from ...wire.message import EncodeError
from ..light_message import BAD_VALUES, installed
from ..messages import cdr

# Returns the value of a field in the type of the field; raises one of BAD_VALUES.
Check: TypeAlias = Callable[[Any], Any]


def checked(message: Any) -> Any:
    """Returns a message of rclpy, in which values have been converted to the types of their fields.

    A conversion is one that light classes allow, such as of an integer to a real number.

    Raises:
        EncodeError: A value does not fit its field, whose path is named.
    """
    kind: Any = type(message)
    for name, check in _checks(kind):
        value = getattr(message, name)
        checked_value = _checked_at(name, check, value)
        if checked_value is not value:
            setattr(message, name, checked_value)
    return message


class CheckedPublisher(Publisher):  # type: ignore[misc, type-arg, unused-ignore]
    """A publisher of rclpy that checks its messages."""

    def publish(self, msg: Any) -> None:
        """Publishes a message; a serialized one is not checked."""
        super().publish(msg if isinstance(msg, bytes) else checked(msg))


def checked_answers(answer: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """Returns a callback of a service whose responses are checked."""
    return lambda request, response: checked(answer(request, response))


def is_of_any_size(kind: Any) -> bool:
    """Returns whether messages of a class have a sequence without a bound."""
    for slot in kind.SLOT_TYPES:
        inner = slot.value_type if isinstance(slot, AbstractNestedType) else slot
        is_part = isinstance(inner, NamespacedType)
        if isinstance(slot, UnboundedSequence) or (is_part and is_of_any_size(_class_of(inner))):
            return True
    return False


class _MisfitError(EncodeError):
    """A value does not fit its field, which is named by its path."""


def _checked_at(path: str, check: Check, value: Any) -> Any:
    try:
        return check(value)
    except _MisfitError as error:
        raise _MisfitError(f"{path}.{error.field}", error.reason) from error
    except (EncodeError, *BAD_VALUES) as error:
        shown = " ".join(repr(value).split())
        raise _MisfitError(path, f"{shown:.80} does not fit: {error}") from error


@cache
def _checks(kind: Any) -> tuple[tuple[str, Check], ...]:
    """Returns the fields of a class, and the check of each."""
    names = kind.get_fields_and_field_types()
    return tuple((name, _check(slot)) for name, slot in zip(names, kind.SLOT_TYPES, strict=True))


def _check(slot: Any) -> Check:
    if isinstance(slot, AbstractNestedType):
        is_fixed = isinstance(slot, Array)
        count = slot.size if is_fixed else slot.maximum_size if slot.has_maximum_size() else None
        return partial(_elements, _check(slot.value_type), count, is_fixed)
    if isinstance(slot, AbstractGenericString):
        encoded = cdr.wide if isinstance(slot, AbstractWString) else cdr.encoded
        return partial(_text, encoded, slot.maximum_size if slot.has_maximum_size() else 0)
    if isinstance(slot, BasicType):
        return _PRIMITIVE_CHECKS.get(slot.typename, _unchanged)
    return partial(_message, _class_of(slot))


def _class_of(slot: Any) -> Any:
    return installed("/".join(slot.namespaced_name()))


def _elements(check: Check, count: int | None, is_fixed: bool, values: Any) -> Any:  # noqa: FBT001
    if is_fixed and count is not None:
        cdr.exactly(values, count)
    elif count is not None:
        cdr.at_most(values, count)
    if isinstance(values, array) or hasattr(values, "dtype"):
        return values  # rclpy has converted its elements
    checked_values = [_checked_at(str(index), check, value) for index, value in enumerate(values)]
    return values if all(map(operator.is_, checked_values, values)) else checked_values


def _text(encoded: Callable[[str, int], bytes], most: int, value: Any) -> Any:
    encoded(value, most)
    return value


def _message(kind: Any, value: Any) -> Any:
    if not isinstance(value, kind):
        raise TypeError(f"{kind.__name__} of {kind.__module__.partition('.')[0]} expected")
    return checked(value)


def _number(layout: struct.Struct, kind: type[float], value: Any) -> Any:
    (number,) = layout.unpack(layout.pack(value))
    return value if type(value) is kind else kind(number)


def _octet(value: Any) -> Any:
    return bytes([cdr.octet(value)])


def _unchanged(value: Any) -> Any:
    return value


_CODES = {
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
}
_PRIMITIVE_CHECKS: dict[str, Check] = {
    **{name: partial(_number, struct.Struct(f"<{code}"), int) for name, code in _CODES.items()},
    "float": partial(_number, struct.Struct("<f"), float),
    "double": partial(_number, struct.Struct("<d"), float),
    "boolean": bool,
    "octet": _octet,
}
