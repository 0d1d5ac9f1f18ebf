"""Sizes of ROS messages as the middleware serializes them (CDR, OMG DDS-XTypes 7.4, XCDR1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.cdr import PRIMITIVES
from jausml.language.metamodel.classes import ros
from jausml.views.analysis.sizes import TEXT_LENGTH, Size

if TYPE_CHECKING:
    from collections.abc import Callable

HEADER = 4
"""Bytes of the encapsulation header."""

_COUNT = 4
_GREATEST_ALIGNMENT = 8


class _UnboundedError(Exception):
    """Nothing limits the size."""


def ros_size(kind: ros.MessageType, length: int) -> Size:
    """Returns the size of a message of a type."""
    least = _Writer(_nothing, _nothing).message(kind, 0)
    expected = _Writer(
        lambda bound: min(length, bound) if bound else length,
        lambda bound: min(TEXT_LENGTH, bound) if bound else TEXT_LENGTH,
    ).message(kind, 0)
    try:
        most = _Writer(_bound, _bound).message(kind, 0)
    except _UnboundedError:
        return Size(HEADER + least, HEADER + expected, None)
    # rmw_fastrtps gives types of a bounded size a multiple of four bytes.
    return Size(*(HEADER + _aligned(each, _COUNT) for each in (least, expected, most)))


def _nothing(_: int) -> int:
    return 0


def _bound(bound: int) -> int:
    if not bound:
        raise _UnboundedError
    return bound


class _Writer:
    """Tells how far the serialized form of a message reaches."""

    def __init__(self, elements: Callable[[int], int], characters: Callable[[int], int]) -> None:
        self._elements = elements
        self._characters = characters

    def message(self, kind: ros.MessageType, position: int) -> int:
        """Returns the position after a message that begins at a position."""
        if not kind.fields:
            return position + 1  # rosidl puts a byte into an empty type
        for field in kind.fields:
            position = self._field(field, position)
        return position

    def _field(self, field: ros.Field, position: int) -> int:
        match field.arrayKind.name:
            case "single":
                return self._value(field, position)
            case "fixedArray":
                return self._repeat(field, position, int(field.arraySize))
            case "boundedSequence":
                count = self._elements(int(field.arraySize))
            case _:
                count = self._elements(0)
        return self._repeat(field, _aligned(position, _COUNT) + _COUNT, count)

    def _repeat(self, field: ros.Field, position: int, count: int) -> int:
        """Returns the position after so many values; their sizes recur with the alignment."""
        steps: dict[int, tuple[int, int]] = {}
        done = 0
        while done < count:
            phase = position % _GREATEST_ALIGNMENT
            if phase in steps:
                then, where = steps[phase]
                turns = (count - done) // (done - then)
                position += turns * (position - where)
                done += turns * (done - then)
                steps.clear()
                if done == count:
                    break
            steps[phase] = done, position
            position = self._value(field, position)
            done += 1
        return position

    def _value(self, field: ros.Field, position: int) -> int:
        if isinstance(field, ros.MessageField):
            return self.message(field.messageType, position)
        assert isinstance(field, ros.PrimitiveField)  # noqa: S101 - the only other class
        name = field.type.name
        if name not in PRIMITIVES:
            count = self._characters(int(field.stringBound))
            # A string ends with a NUL that counts; a wide one is UTF-16 without.
            octets = count + 1 if name == "string" else 2 * count
            return _aligned(position, _COUNT) + _COUNT + octets
        width = PRIMITIVES[name].size
        return _aligned(position, width) + width


def _aligned(position: int, width: int) -> int:
    return position + -position % width
