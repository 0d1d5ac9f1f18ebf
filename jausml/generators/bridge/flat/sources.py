"""The values of a source message, as expressions of flat translations ask for them."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.translation.ros_fields import PathError, RosStart, ros_field
from jausml.generators.python.codec.classes import ContainerClass
from jausml.generators.python.codec.compounds import PartValue
from jausml.generators.python.codec.scalars import Bits

if TYPE_CHECKING:
    from jausml.generators.bridge.flat.protocols import Reading
    from jausml.generators.python.codec.messages import MessageView
    from jausml.metamodel.classes import ros

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
            raise NotFlatError(f"{path} is a list")
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

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Returns the expressions of the fields of an object."""
        prefix = f"{path}." if path else ""
        return [_name(self.reading.value(f"{prefix}{name}")) for name in names]


@dataclass(frozen=True)
class JausValues:
    """The values of a JAUS message or element.

    Attributes:
        message: The message.
        root: What paths start at; None for the whole message.
        reading: What reads them.
    """

    message: MessageView
    root: ContainerClass | None
    reading: Reading

    def expression(self, path: str) -> ast.expr:
        """Returns the expression of a value."""
        if self._is_bit_field(path):
            raise NotFlatError(f"{path} is an object")
        return _name(self.reading.value(path))

    def presence(self, path: str) -> ast.expr:
        """Returns an expression that is None where a value is absent."""
        return _name(self.reading.value(path))

    def stamp_bits(self, path: str) -> ast.expr:
        """Returns the expression of the bits of a TimeStamp."""
        return _name(self.reading.value(path))

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Returns the expressions of the fields of an object."""
        return [_name(self.reading.value(f"{path}.{name}")) for name in names]

    def _is_bit_field(self, path: str) -> bool:
        container = self.root or self.message.body
        value: object = None
        for step in path.split("."):
            found = next((each for each in container.members if each.attribute == step), None)
            if found is None:
                return False
            value = found.value
            if isinstance(value, PartValue) and isinstance(value.part, ContainerClass):
                container = value.part
        return isinstance(value, Bits) and bool(path)
