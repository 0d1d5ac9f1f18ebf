"""Targets of translations: a JAUS message, a ROS message, or an element of a list in one."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

from jausml.generators.bridge.translation.ros_fields import RosStart, ros_field
from jausml.generators.bridge.translation.values import (
    BOOLEAN,
    PYTHON_TYPES,
    QUATERNION,
    TIME,
    AssignmentError,
    Fitted,
    Limit,
    Value,
    constant,
    fitted_to_jaus,
    fitted_to_ros,
    limited,
    ros_constant,
    ros_kind,
)
from jausml.generators.python.codec.compounds import PartValue, VariantValue
from jausml.generators.python.codec.jaus_fields import (
    BITS,
    FORMAT,
    INTEGER,
    LIST,
    OCTETS,
    REAL,
    TEXT,
    JausStart,
    jaus_field,
)
from jausml.generators.python.statements import call

if TYPE_CHECKING:
    from jausml.generators.bridge.translation.body import Body
    from jausml.generators.bridge.translation.ros_fields import RosField
    from jausml.generators.python.codec.jaus_fields import JausField
    from jausml.generators.python.codec.messages import MessageView
    from jausml.metamodel.classes import ros

_TIMESTAMP = ("milliseconds", "seconds", "minutes", "hour", "day")
_ZEROS = {REAL: "0.0", INTEGER: "0", BOOLEAN: "False", TEXT: '""', OCTETS: 'b""'}
_ELEMENT = re.compile(r"(?P<list>.*)\[(?P<index>[0-9]+)\]")


@dataclass(frozen=True)
class ManyTarget:
    """A list as the target of assignments.

    Attributes:
        place: The list, as Python text.
        path: Its path, for counters.
        counts: Fewest and most elements; None when nothing limits them.
        fresh: Whether the list is not there, or not empty, in a message as it is made.
        new_element: Python text of an element without values; None where an assignment makes it.
        start: Where paths of its elements start, without their name: JausStart or RosStart.
    """

    place: str
    path: str
    counts: tuple[int, int] | None
    fresh: bool
    new_element: str | None
    start: Any


class Target(Protocol):
    """Where the target paths of some assignments start."""

    def kind(self, path: str) -> str:
        """Returns the kind of value that a path takes."""

    def value_type(self, path: str) -> str:
        """Returns the Python type of the value that a path takes."""

    def listed(self, path: str) -> tuple[tuple[str, str], ...]:
        """Returns the names and values that the end of a path names."""

    def prepare(self, body: Body, path: str) -> None:
        """Adds the statements that make what a message lacks on the way to the end of a path."""

    def fitted(self, path: str, value: Value) -> Fitted:
        """Returns a value as the end of a path takes it."""

    def put(self, body: Body, path: str, value: Fitted, remark: str = "") -> None:
        """Adds the statement that stores a value that fits."""

    def constant(self, path: str, text: str) -> Value:
        """Returns a text of the model as a value for the end of a path."""


@dataclass(frozen=True)
class RosTarget:
    """A ROS message, or an element of an array in it.

    Attributes:
        type: The `ros.MessageType` of the message.
        start: Where paths start.
    """

    type: ros.MessageType
    start: RosStart

    def field(self, path: str) -> RosField:
        """Returns the end of a path.

        Raises:
            PathError: The path leads nowhere.
        """
        return ros_field(self.type, path, self.start)

    def kind(self, path: str) -> str:
        """Returns the kind of value that a path takes."""
        return ros_kind(self.field(path))

    def value_type(self, path: str) -> str:
        """Returns the Python type of the value that a path takes."""
        return PYTHON_TYPES.get(self.kind(path), "Any")

    def listed(self, path: str) -> tuple[tuple[str, str], ...]:
        """Returns the constants of the type that has the end of a path."""
        return self.field(path).constants

    def prepare(self, body: Body, path: str) -> None:
        """Adds nothing: ROS messages are complete as they are made."""

    def fitted(self, path: str, value: Value) -> Fitted:
        """Returns a value as the end of a path takes it."""
        found = self.field(path)
        if ros_kind(found) in {QUATERNION, TIME} and value.kind == ros_kind(found):
            return Fitted(value.code)
        return fitted_to_ros(value, found)

    def put(self, body: Body, path: str, value: Fitted, remark: str = "") -> None:
        """Adds the statement that stores a value that fits."""
        found = self.field(path)
        kind = ros_kind(found)
        if kind in {QUATERNION, TIME}:
            body.do(call(f"set_{kind}", found.place, value.code))
        else:
            body.store(value.code, found.place, remark)

    def constant(self, path: str, text: str) -> Value:
        """Returns a text of the model as a value for the end of a path."""
        return ros_constant(self.field(path), text)

    def many(self, path: str, type_name: str | None) -> ManyTarget:
        """Returns the array at the end of a path.

        Args:
            path: The path.
            type_name: Name of the class of its elements; None when they are no messages.
        """
        found = self.field(path)
        if not found.is_array:
            raise AssignmentError(f"{found.path} is no array")
        single = replace(found, is_array=False)
        new = f"{type_name}()" if type_name else _ZEROS[ros_kind(single)]
        counts = found.counts
        return ManyTarget(
            found.place,
            found.path,
            counts,
            fresh=counts is not None and counts[0] > 0,
            new_element=new,
            start=RosStart("", found.message_type, found.field, found.path),
        )

    def element(self, many: ManyTarget, root: str) -> RosTarget:
        """Returns an element of an array as a target."""
        return RosTarget(self.type, replace(many.start, root=root))


@dataclass(frozen=True)
class JausTarget:
    """A JAUS message, or an element of a list in it.

    Attributes:
        message: The message.
        start: Where paths start.
        made: Places of the containers that are there, with the names of those that have one.
    """

    message: MessageView
    start: JausStart = field(default_factory=lambda: JausStart("target"))
    made: dict[str, str] = field(default_factory=dict)

    def field(self, path: str) -> JausField:
        """Returns the end of a path.

        Raises:
            PathError: The path leads nowhere.
        """
        found = jaus_field(self.message, path, self.start)
        return replace(found, place=self._named(found.place))

    def _named(self, place: str) -> str:
        """A place by the name of the innermost element of a list on the way to it."""
        for known in reversed(self.made):
            name = self.made[known]
            if name and (place == known or place.startswith(f"{known}.")):
                return f"{name}{place[len(known) :]}"
        return place

    def kind(self, path: str) -> str:
        """Returns the kind of value that a path takes."""
        return self.field(path).kind

    def value_type(self, path: str) -> str:
        """Returns the Python type of the value that a path takes."""
        return PYTHON_TYPES.get(self.kind(path), "Any")

    def listed(self, path: str) -> tuple[tuple[str, str], ...]:
        """Returns the names and values of the value set at the end of a path."""
        return tuple((name, str(value)) for name, value in self.field(path).listed)

    def prepare(self, body: Body, path: str) -> None:
        """Adds the statements that make the containers on the way to the end of a path."""
        for place, code in self.field(path).containers:
            if place in self.made:
                continue
            found = _ELEMENT.fullmatch(place)
            if found is None:
                body.store(code, self._named(place))
                self.made[place] = ""
                continue
            for index in range(int(found["index"]) + 1):
                self._append(body, found["list"], index, code)

    def _append(self, body: Body, place: str, index: int, code: str) -> None:
        """Adds an element to a list, unless it is there."""
        element, appended = f"{place}[{index}]", self._named(place)
        if element in self.made:
            return
        self.made[element] = ""
        if code.endswith("()"):
            self.made[element] = body.name_of(element)
            body.store(code, self.made[element])
            code = self.made[element]
        body.do(call(f"{appended}.append", code))

    def fitted(self, path: str, value: Value) -> Fitted:
        """Returns a value as the end of a path takes it."""
        found = self.field(path)
        if found.kind == BITS and found.sub_fields != _TIMESTAMP:
            raise AssignmentError(f"{found.path} is no TimeStamp")
        return fitted_to_jaus(value, found)

    def put(self, body: Body, path: str, value: Fitted, remark: str = "") -> None:
        """Adds the statement that stores a value that fits."""
        found = self.field(path)
        if found.index is None:
            body.store(value.code, found.place, remark or found.units)
            return
        code = value.code
        if value.can_be_none:
            code = body.local("value", code)
        made = call(found.class_name, str(found.index), code)
        if value.can_be_none:
            made = f"None if {code} is None else {made}"
        body.store(made, found.place, remark or found.units)

    def constant(self, path: str, text: str) -> Value:
        """Returns a text of the model as a value for the end of a path."""
        found = self.field(path)
        code = constant(found.kind, text, found.limits, found.path, self.listed(path))
        return Value(code, found.kind, limits=found.limits)

    def many(self, path: str) -> ManyTarget:
        """Returns the list at the end of a path."""
        found = self.field(path)
        if found.kind != LIST:
            raise AssignmentError(f"{found.path} is no list")
        fewest, most = int(found.limits[0]), int(found.limits[1])
        element = found.element
        if isinstance(element, VariantValue) and len(element.options) > 1:
            new = None
        elif isinstance(element, PartValue | VariantValue):
            new = f"{element.python_type}()"
        else:
            new = getattr(element, "default", "None")
        return ManyTarget(
            found.place,
            found.path,
            (fewest, most),
            fresh=found.is_optional or fewest > 0,
            new_element=new,
            start=JausStart("", found.element, found.path),
        )

    def element(self, many: ManyTarget, root: str) -> JausTarget:
        """Returns an element of a list as a target."""
        return JausTarget(self.message, replace(many.start, root=root))

    def carrier(self, path: str, payload: str, limit: Limit) -> Fitted:
        """Returns an encoded message as the field that carries it takes it.

        Args:
            path: Path of the field.
            payload: The bytes.
            limit: What keeps their number within the field.

        Raises:
            AssignmentError: The field carries no message.
        """
        found = self.field(path)
        if found.kind == FORMAT:
            return Fitted(call(found.class_name, "0", payload))
        if found.kind == OCTETS:
            return limited(limit, "octets", payload, found.path, found.limits)
        raise AssignmentError(f"{found.path} carries no message")
