"""Names of the ROS message classes in the modules of one bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml_generators.common.ros import RosType, ros_type

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import ros


class RosClasses:
    """Gives each ROS type a name, in the order in which they are asked for.

    A class that shares its name with another, as messages that mirror JAUS do, is imported under a
    name with its package.
    """

    def __init__(self, taken: Iterable[str]) -> None:
        """Starts without names."""
        self.names: dict[RosType, str] = {}
        self._taken = set(taken)

    def name_of(self, element: ros.MessageType) -> str:
        """Returns the name of the class of a type."""
        kind = ros_type(element)
        if kind not in self.names:
            package = "".join(word.capitalize() for word in kind.package.split("_"))
            name = kind.class_name
            if name in self._taken:
                name = f"{package}{name}"
            self.names[kind] = name
            self._taken.add(name)
        return self.names[kind]

    def copy(self) -> RosClasses:
        """Returns the same names, to which others may be added without a trace here."""
        other = RosClasses(self._taken)
        other.names = dict(self.names)
        return other
