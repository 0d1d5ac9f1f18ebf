"""The values of a source message, as expressions of flat translations ask for them."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.translation.ros_fields import PathError, RosStart, ros_field

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import ros
    from jausml_generators.bridge.flat.jaus_reading import PartReading
    from jausml_generators.bridge.flat.protocols import Reading, SequenceReading

_OBJECTS = {
    "geometry_msgs/Quaternion": ("Quaternion", ("x", "y", "z", "w")),
    "builtin_interfaces/Time": ("Time", ("sec", "nanosec")),
}


def _name(name: str) -> ast.expr:
    return ast.parse(name, mode="eval").body


@dataclass(frozen=True)
class RosValues:
    """The values of a ROS message or element.

    Attributes:
        type: Type of the whole message.
        start: Where paths start.
        reading: What reads them.
    """

    type: ros.MessageType
    start: RosStart
    reading: Reading

    def expression(self, path: str) -> ast.expr:
        """Returns the expression of a value; orientations and instants are made of theirs."""
        try:
            found = ros_field(self.type, path or ".", self.start)
        except PathError as error:
            raise NotFlatError(str(error)) from error
        if found.is_array:
            return _name(self._sequence(path).values())
        if found.message_type is None:
            return _name(self.reading.value(path))
        known = _OBJECTS.get(found.type)
        if known is None:
            raise NotFlatError(f"{path} is a message")
        kind, parts = known
        callee = ast.Attribute(_name("conversions"), kind, ast.Load())
        return ast.Call(callee, self.parts(path, parts), [])

    def presence(self, path: str) -> ast.expr:
        """Returns the value itself, which is never None."""
        return self.expression(path)

    def stamp_bits(self, path: str) -> ast.expr:
        """Refuses: ROS has no TimeStamp."""
        raise NotFlatError(f"{path} is no TimeStamp")

    def chosen(self, path: str, class_name: str) -> ast.expr:
        """Refuses: ROS has no variants."""
        raise NotFlatError(f"{path} is no {class_name}")

    def count(self, path: str) -> ast.expr:
        """Returns the expression of the number of elements of an array."""
        return _name(self._sequence(path).count)

    def elements(self, path: str) -> tuple[SequenceReading, RosValues]:
        """Returns what reads an array, and the values of an element."""
        sequence = self._sequence(path)
        found = ros_field(self.type, path, self.start)
        start = RosStart("", found.message_type, found.field, found.path)
        return sequence, RosValues(self.type, start, sequence.element)

    def inside(self, path: str) -> RosValues:
        """Refuses what no readable translation of ROS has."""
        raise NotFlatError(f"{path} has no name")

    def _sequence(self, path: str) -> SequenceReading:
        return self.reading.sequence(path)

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Returns the expressions of the fields of an object."""
        prefix = f"{path}." if path else ""
        return [_name(self.reading.value(f"{prefix}{name}")) for name in names]


@dataclass(frozen=True)
class JausValues:
    """The values of a JAUS message or element.

    Attributes:
        reading: What reads them.
        prefix: Path of what paths start at, with a dot at its end; empty for the whole.
    """

    reading: PartReading
    prefix: str = ""

    def _path(self, path: str) -> str:
        return f"{self.prefix}{path}" if path else self.prefix[:-1] or "."

    def expression(self, path: str) -> ast.expr:
        """Returns the expression of a value."""
        if self.reading.is_bit_field(self._path(path)):
            raise NotFlatError(f"{path} is an object")
        return _name(self.reading.value(self._path(path)))

    def presence(self, path: str) -> ast.expr:
        """Returns an expression that is None where a value is absent."""
        return _name(self.reading.value(self._path(path)))

    def stamp_bits(self, path: str) -> ast.expr:
        """Returns the expression of the bits of a TimeStamp."""
        return _name(self.reading.value(self._path(path)))

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Returns the expressions of the fields of an object."""
        return [self.expression(f"{path}.{name}") for name in names]

    def chosen(self, path: str, class_name: str) -> ast.expr:
        """Returns the condition that an option of a variant was sent."""
        return _name(self.reading.chosen(self._path(path), class_name))

    def count(self, path: str) -> ast.expr:
        """Returns the expression of the number of elements of a list."""
        return _name(self.reading.sequence(self._path(path)).count)

    def elements(self, path: str) -> tuple[SequenceReading, JausValues]:
        """Returns what reads a list, and the values of an element."""
        sequence = self.reading.sequence(self._path(path))
        return sequence, JausValues(sequence.element)

    def inside(self, path: str) -> JausValues:
        """Returns the values of a part or of an element of a list."""
        return JausValues(self.reading, f"{self._path(path)}.")
