"""Targets of translations: a JAUS message, a ROS message, or an element of a list in one."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

from jausml.language.metamodel.classes import ros
from jausml.language.semantics.paths.markers import marks_of, unknown
from jausml.language.semantics.paths.ros_paths import fields_by_name
from jausml.language.semantics.paths.scopes import parse_path
from jausml_generators.bridge.translation.body import Body
from jausml_generators.bridge.translation.expressions import (
    BITS,
    BOOLEAN,
    FORMAT,
    INTEGER,
    LIST,
    OCTETS,
    QUATERNION,
    REAL,
    TEXT,
    TIME,
    Constant,
    Expression,
    IfKept,
    Limit,
    New,
    Read,
    Scalar,
    number,
)
from jausml_generators.bridge.translation.places import HasValue, Local, Place
from jausml_generators.bridge.translation.policies import Policy
from jausml_generators.bridge.translation.ros_fields import RosField, RosStart, markers, ros_field
from jausml_generators.bridge.translation.steps import Append, Let, Write
from jausml_generators.bridge.translation.values import (
    PYTHON_TYPES,
    AssignmentError,
    Value,
    constant,
    fitted_to_jaus,
    fitted_to_ros,
    ros_constant,
    ros_kind,
)
from jausml_generators.python.codec.jaus_fields import JausField, JausStart, default_of, jaus_field
from jausml_generators.python.codec.members import PartValue, VariantValue
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

_TIMESTAMP = ("milliseconds", "seconds", "minutes", "hour", "day")
_ZEROS: dict[str, Scalar] = {REAL: 0.0, INTEGER: 0, BOOLEAN: False, TEXT: "", OCTETS: b""}


@dataclass(frozen=True)
class ManyTarget:
    """A list as the target of assignments.

    Attributes:
        counts: Fewest and most elements; None when nothing limits them.
        fresh: Whether the list is not there, or not empty, in a message as it is made.
        new_element: An element without values; None where an assignment makes it.
    """

    place: Place
    path: str
    counts: tuple[int, int] | None
    fresh: bool
    new_element: Expression | None
    start: Any


@dataclass(frozen=True)
class RosTarget:
    """A ROS message, or an element of an array in it.

    Attributes:
        type: The `ros.MessageType` of the message.
        class_of: Gives the name of the class of a type.
        created: The elements of sequences that were made.
    """

    type: ros.MessageType
    start: RosStart
    class_of: Callable[[ros.MessageType], str]
    created: set[Place] = field(default_factory=set)

    def field(self, path: str) -> RosField:
        """Returns the end of a path."""
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
        """Adds the elements of sequences on the way; all else is there in a new message."""
        end = self.field(path)
        for length, sequence in end.elements:
            for index in range(length.than + 1):
                element = length.place.at(index)
                if element in self.created:
                    continue
                self.created.add(element)
                new: Expression
                if isinstance(sequence, ros.MessageField):
                    message = New(self.class_of(sequence.messageType))
                    new = Read(Place(body.local(element.last, message)))
                else:
                    # An element that is no message has no class: it is the zero of its kind.
                    kind = ros_kind(end)
                    new = Constant(_ZEROS[kind], kind)
                body.add(Append(length.place, new))

    def fitted(self, path: str, value: Value) -> Expression:
        """Returns a value as the end of a path takes it."""
        end = self.field(path)
        if ros_kind(end) in {QUATERNION, TIME} and value.kind == ros_kind(end):
            return value.expression
        return fitted_to_ros(value, end)

    def put(self, body: Body, path: str, value: Expression, remark: str = "") -> None:
        """Adds the statement that stores a value that fits."""
        body.add(Write(self.field(path).place, value, remark))

    def constant(self, path: str, text: str) -> Value:
        """Returns a text of the model as a value for the end of a path."""
        return ros_constant(self.field(path), text)

    def unknown(self, path: str) -> str:
        """Returns the value of a field that has none; empty where a new message has it."""
        end = self.field(path)
        return "" if end.is_array or end.field is None else unknown(end.field) or ""

    def unset(self, taken: Iterable[str]) -> Iterator[str]:
        """Yields the paths with a marker for no value that no assignment sets."""
        if self.start.type is not None:
            yield from marked_paths(self.start.type, {parse_path(path) for path in taken})

    def unlimited(self, path: str) -> Iterator[HasValue]:
        """Yields the conditions under which a field does not say that nothing limits it."""
        end = self.field(path)
        if end.field is not None and not end.is_array:
            marks = [mark for mark in marks_of(end.field) if mark.is_unlimited]
            yield from markers(marks, end.field, end.place, end.owner)

    def many(self, path: str, type_name: str | None) -> ManyTarget:
        """Returns the array at the end of a path.

        Args:
            type_name: Name of the class of its elements; None when they are no messages.
        """
        end = self.field(path)
        if not end.is_array:
            raise AssignmentError(f"{end.path} is no array")
        single = replace(end, is_array=False)
        kind = ros_kind(single)
        new = New(type_name) if type_name else Constant(_ZEROS[kind], kind)
        counts = end.counts
        return ManyTarget(
            end.place,
            end.path,
            counts,
            # ROS fills an array of fixed size with zeros; appending would make it too long.
            fresh=counts is not None and counts[0] > 0,
            new_element=new,
            start=RosStart("", end.message_type, end.field, end.path, end.owner),
        )

    def element(self, many: ManyTarget, root: Local) -> RosTarget:
        """Returns an element of an array as a target."""
        return RosTarget(self.type, replace(many.start, root=root), self.class_of)


def marked_paths(
    message: ros.MessageType, taken: Container[tuple[str, ...]] = (), around: tuple[str, ...] = ()
) -> Iterator[str]:
    """Yields the paths of the fields that take a value to say that they have none.

    Args:
        taken: Paths that are left out with all that is in them.
        around: The path to the message.
    """
    for name, member in fields_by_name(message).items():
        path = (*around, name)
        if member.arrayKind.name != "single" or path in taken:
            continue
        if isinstance(member, ros.MessageField):
            yield from marked_paths(member.messageType, taken, path)
        elif unknown(member):
            yield ".".join(path)


@dataclass(frozen=True)
class JausTarget:
    """A JAUS message, or an element of a list in it."""

    message: MessageView
    start: JausStart = field(default_factory=lambda: JausStart("target"))
    created: dict[Place, Local | None] = field(default_factory=dict)

    def field(self, path: str) -> JausField:
        """Returns the end of a path."""
        end = jaus_field(self.message, path, self.start)
        return replace(end, place=self._named(end.place))

    def _named(self, place: Place) -> Place:
        """A place by the variable of the innermost element of a list on the way to it."""
        # The innermost was made last, and shortens the place the most.
        for known in reversed(self.created):
            local = self.created[known]
            if local is not None and place.is_within(known):
                return place.named(known, local)
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
        for place, value in self.field(path).containers:
            if place in self.created:
                continue
            last = place.steps[-1] if place.steps else ""
            if isinstance(last, str):
                body.add(Write(self._named(place), value))
                self.created[place] = None
                continue
            # Elements before the wanted one are needed too; they stay as they are made.
            for index in range(last + 1):
                self._append(body, replace(place, steps=place.steps[:-1]), index, value)

    def _append(self, body: Body, place: Place, index: int, value: Expression) -> None:
        """Adds an element to a list, unless it is there."""
        element, appended = place.at(index), self._named(place)
        if element in self.created:
            return
        self.created[element] = None
        if isinstance(value, New):
            local = self.created[element] = body.local_of(element)
            body.add(Let((local,), value))
            value = Read(Place(local))
        body.add(Append(appended, value))

    def fitted(self, path: str, value: Value) -> Expression:
        """Returns a value as the end of a path takes it."""
        end = self.field(path)
        if end.kind == BITS and end.sub_fields != _TIMESTAMP:
            raise AssignmentError(f"{end.path} is no TimeStamp")
        return fitted_to_jaus(value, end)

    def put(self, body: Body, path: str, value: Expression, remark: str = "") -> None:
        """Adds the statement that stores a value that fits."""
        end = self.field(path)
        if end.index is not None:
            value = self._alternative(body, end, value)
        body.add(Write(end.place, value, remark or end.units))

    @staticmethod
    def _alternative(body: Body, end: JausField, value: Expression) -> Expression:
        """Returns a value as an alternative of a variable field; none where it was dropped."""
        index = number(int(end.index or 0))
        if not (isinstance(value, Limit) and value.drops_field):
            return New(end.class_name, (index, value))
        # A variable field that holds None would be encoded: the field itself must be None.
        kept = Read(Place(body.local("value", value)), value.kind)
        return IfKept(kept, New(end.class_name, (index, kept)))

    def constant(self, path: str, text: str) -> Value:
        """Returns a text of the model as a value for the end of a path."""
        end = self.field(path)
        expression = constant(end.kind, text, end.limits, end.path, self.listed(path))
        return Value(expression, limits=end.limits)

    def unknown(self, path: str) -> str:
        """Returns an empty text: a field without a value is left out."""
        del path
        return ""

    def unset(self, taken: Iterable[str]) -> Iterable[str]:
        """Returns no paths: a field that is not set is left out."""
        del taken
        return ()

    def unlimited(self, path: str) -> Iterable[HasValue]:
        """Returns no conditions: JAUS has no number for no limit."""
        del path
        return ()

    def many(self, path: str) -> ManyTarget:
        """Returns the list at the end of a path."""
        end = self.field(path)
        if end.kind != LIST:
            raise AssignmentError(f"{end.path} is no list")
        fewest, most = int(end.limits[0]), int(end.limits[1])
        element = end.element
        new: Expression | None = None
        if isinstance(element, PartValue | Bits):
            new = New(element.python_type)
        elif isinstance(element, VariantValue):
            # With several options only an assignment can tell which one is meant.
            new = New(element.python_type) if len(element.options) == 1 else None
        elif isinstance(element, Fixed | Blob):
            new = default_of(element)
        return ManyTarget(
            end.place,
            end.path,
            (fewest, most),
            # A list that may be absent is None as it is made, and a minimum fills it with elements.
            fresh=end.is_optional or fewest > 0,
            new_element=new,
            start=JausStart("", end.element, end.path),
        )

    def element(self, many: ManyTarget, root: Local) -> JausTarget:
        """Returns an element of a list as a target."""
        return JausTarget(self.message, replace(many.start, root=root))

    def carrier(self, path: str, payload: Expression, policy: Policy) -> Expression:
        """Returns an encoded message as a value of the field that carries it."""
        end = self.field(path)
        if end.kind == FORMAT:
            return New(end.class_name, (number(end.message_format), payload))
        if end.kind == OCTETS:
            return policy.limit("octets", payload, end.path, end.limits)
        raise AssignmentError(f"{end.path} carries no message")


Target: TypeAlias = JausTarget | RosTarget
"""Where the target paths of some assignments start."""
