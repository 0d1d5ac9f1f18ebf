"""Sources of translations: a JAUS message, a ROS message, or an element of a list."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

from jausml.language.interfaces.definitions import INTEGER_RANGES
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.paths.attributes import COUNT
from jausml.language.semantics.paths.markers import marks_of
from jausml_generators.bridge.translation.expressions import (
    FORMAT,
    INTEGER,
    LIST,
    OCTETS,
    REAL,
    Expression,
    Length,
    Read,
)
from jausml_generators.bridge.translation.places import Local, PathError, Place, Requirement, There
from jausml_generators.bridge.translation.policies import Policy
from jausml_generators.bridge.translation.ros_fields import RosField, RosStart, markers, ros_field
from jausml_generators.bridge.translation.values import Value, real, ros_kind
from jausml_generators.python.codec.jaus_fields import JausField, JausStart, jaus_field
from jausml_generators.python.codec.messages import MessageView

INDEX = "index"
MANY = 2**32 - 1


@dataclass(frozen=True)
class Many:
    """A list as the source of assignments.

    Attributes:
        path: The path as counters and errors name it.
        conditions: What must hold for it to be there.
        start: Where the paths of its elements start, once they are in a variable.
        counts: Fewest and most elements.
    """

    place: Place
    path: str
    conditions: tuple[Requirement, ...]
    start: Any
    counts: tuple[float, float]


@dataclass
class Counters:
    """The variables of a loop that are at hand besides the element.

    Attributes:
        values: The values of `index` and `count`.
        used: The names of those that were asked for.
    """

    values: Mapping[str, Expression]
    used: set[str] = field(default_factory=set)

    def value(self, path: str, policy: Policy) -> Value | None:
        """Returns the value of a counter; None for other paths."""
        if path not in self.values:
            return None
        self.used.add(path)
        return Value(self.values[path], limits=(0, MANY), policy=policy)


@dataclass(frozen=True)
class JausSource:
    """A JAUS message, or an element of a list in it.

    Attributes:
        top: The source that is the message; None for itself.
        conditions: What must hold for the element to be there.
        joins: Python name and class of each joined report, by name of the join.
    """

    message: MessageView
    start: JausStart = field(default_factory=lambda: JausStart("source"))
    top: JausSource | None = None
    counters: Counters = field(default_factory=lambda: Counters({}))
    conditions: tuple[Requirement, ...] = ()
    joins: Mapping[str, tuple[str, MessageView]] = field(default_factory=dict)

    def inlined(self) -> JausSource:
        """Returns the same source, whose values give no names to elements of lists."""
        start = replace(self.start, names=None)
        return replace(self, start=start, top=self.top.inlined() if self.top else None)

    def field(self, path: str) -> JausField:
        """Returns the end of a path; one that begins with `/` starts at the message."""
        if path.startswith("/"):
            return (self.top or self).field(path[1:])
        name, _, rest = path.partition(".")
        if self.top is None and name in self.joins:
            root, joined = self.joins[name]
            start = JausStart(root, names=self.start.names)
            end = jaus_field(joined, rest or ".", start)
            conditions = (There(Place(root)), *end.conditions)
            return replace(end, path=f"{name}.{end.path}", conditions=conditions)
        end = jaus_field(self.message, path, self.start)
        return replace(end, conditions=(*self.conditions, *end.conditions))

    def value(self, path: str, policy: Policy) -> Value:
        """Returns the value at the end of a path, or that of a counter, with its policy."""
        try:
            # A path may name a counter of the loop, but a field of that name comes first.
            end = self.field(path)
        except PathError:
            counter = self.counters.value(path, policy) or _count(self, path, policy)
            if counter is None:
                raise
            return counter
        limits = end.brought if end.kind == INTEGER else end.limits
        value: Expression = Read(end.value, REAL if end.is_float else end.kind)
        if end.is_float and not end.is_scaled:
            # The codec hands on what a peer sends; only here is it known what becomes of the rest.
            value = real(policy, value, end.path, end.limits)
        listed = tuple((name, str(number)) for name, number in end.listed)
        return Value(value, end.conditions, end.units, limits, policy, listed)

    def many(self, path: str) -> Many:
        """Returns the list at the end of a path."""
        end = self.field(path)
        if end.kind != LIST:
            raise PathError(f"'{end.path}' is no list")
        start = JausStart("", end.element, end.path, self.start.names)
        return Many(end.place, end.path, end.conditions, start, end.limits)

    def element(
        self, many: Many, root: Local, counters: Counters, conditions: tuple[Requirement, ...]
    ) -> JausSource:
        """Returns an element of a list as a source."""
        start = replace(many.start, root=root)
        return JausSource(self.message, start, self.top or self, counters, conditions)

    def carried(self, path: str) -> JausField:
        """Returns the field that carries a message."""
        end = self.field(path)
        if end.kind not in {FORMAT, OCTETS}:
            raise PathError(f"'{end.path}' carries no message")
        return end


@dataclass(frozen=True)
class RosSource:
    """A ROS message, or an element of an array in it.

    Attributes:
        type: The `ros.MessageType` of the message.
        joins: Python name and `ros.MessageType` of each joined message, by name of the join.
        top: The source that is the message; None for itself.
        conditions: What must hold for the element to be there.
    """

    type: ros.MessageType
    start: RosStart
    joins: Mapping[str, tuple[str, ros.MessageType]]
    top: RosSource | None = None
    counters: Counters = field(default_factory=lambda: Counters({}))
    conditions: tuple[Requirement, ...] = ()

    def inlined(self) -> RosSource:
        """Returns itself, as values of ROS give no names."""
        return self

    def field(self, path: str) -> RosField:
        """Returns the end of a path; one that begins with `/` starts at the message."""
        if path.startswith("/"):
            return (self.top or self).field(path[1:])
        name, _, rest = path.partition(".")
        if self.top is None and name in self.joins:
            root, joined = self.joins[name]
            end = ros_field(joined, rest or ".", RosStart(root, joined, label=name))
            return replace(end, conditions=(There(Place(root)), *end.conditions))
        end = ros_field(self.type, path, self.start)
        return replace(end, conditions=(*self.conditions, *end.conditions))

    def value(self, path: str, policy: Policy) -> Value:
        """Returns the value at the end of a path, or that of a counter, with its policy."""
        try:
            end = self.field(path)
        except PathError:
            counter = self.counters.value(path, policy) or _count(self, path, policy)
            if counter is None:
                raise
            return counter
        limits = None if end.is_array else INTEGER_RANGES.get(end.type)
        value = Read(end.place, ros_kind(end))
        return Value(value, end.conditions, limits=limits, policy=policy, listed=end.constants)

    def many(self, path: str) -> Many:
        """Returns the array at the end of a path."""
        end = self.field(path)
        if not end.is_array:
            raise PathError(f"'{end.path}' is no array")
        start = RosStart("", end.message_type, end.field, end.path, end.owner)
        return Many(end.place, end.path, end.conditions, start, end.counts or (0, MANY))

    def element(
        self, many: Many, root: Local, counters: Counters, conditions: tuple[Requirement, ...]
    ) -> RosSource:
        """Returns an element of an array as a source."""
        start: RosStart = replace(many.start, root=root)
        if start.field is not None:
            # The marks of the array itself were asked on the way; these ask each element.
            marks = [mark for mark in marks_of(start.field) if mark.is_of_elements]
            own = markers(marks, start.field, Place(root), start.owner)
            conditions = (*conditions, *own)
        return RosSource(self.type, start, self.joins, self.top or self, counters, conditions)


def _count(source: Source, path: str, policy: Policy) -> Value | None:
    """Returns the number of elements of a list; None where a path does not lead to it."""
    owner, _, last = path.rpartition(".")
    if not owner or last != COUNT:
        return None
    try:
        many = source.many(owner)
    except PathError:
        return None
    return Value(Length(many.place), many.conditions, limits=many.counts, policy=policy)


Source: TypeAlias = JausSource | RosSource
"""Where the source paths of some assignments start."""
