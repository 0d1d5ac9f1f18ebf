"""Order of array elements that a translation takes by position, by the names beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class NamedPlaces:
    """Array elements that a translation takes by position, and messages have in any order."""

    keys: str  # the field with the name of each element, such as `name` of sensor_msgs/JointState
    names: tuple[str, ...]  # the names, in the order of the positions
    arrays: tuple[str, ...]  # the fields whose elements the translation takes

    def reorder(self, message: Any, by_name: Callable[..., list[Any]]) -> Any:
        """Puts the elements of a message in order, in place, and returns it.

        A message without names is unchanged.

        Args:
            by_name: Returns values in the order of names, of the names, the keys of the values, the
                values and their field; raises AbsentFieldError.
        """
        keys = getattr(message, self.keys)
        if len(keys):
            for array in self.arrays:
                values = by_name(self.names, keys, getattr(message, array), array)
                setattr(message, array, values)
            setattr(message, self.keys, list(self.names))
        return message
