"""Round trips: ways of values through maps and back, their inputs, and their assignments."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model import Model
from jausml.language.semantics.connections.topics import Endpoint, endpoints
from jausml.language.semantics.paths.scopes import spelled_out
from jausml.language.semantics.subject import Subject
from jausml.proving.layout import (
    JAUS,
    USUAL,
    Layout,
    LayoutError,
    Number,
    Usual,
    jaus_layout,
    ros_layout,
)


@dataclass(frozen=True)
class RoundTrip:
    """The way of values through a map and back, in the directions that there are.

    Attributes:
        to_jaus: The map that makes JAUS messages: the same one, or that of another connection.
        connections: Those whose policies and quantities count; of several, those of the first.
    """

    name: str
    to_ros: bridge.AttributeMap
    to_jaus: bridge.AttributeMap
    connections: tuple[bridge.Connection, ...] = ()


def round_trips(model: Model) -> list[RoundTrip]:
    """Returns the round trips of maps of a model and its bridges, and of connections that meet."""
    maps = model.instances(bridge.AttributeMap)
    own = [
        attribute_map
        for attribute_map in maps
        if (document := model.document_of(attribute_map)) and document.is_input
    ]
    connections = model.instances(bridge.Connection)
    connected = [connection.map for connection in model.instances(bridge.Connection, library=False)]
    of_maps = [
        RoundTrip(
            str(attribute_map.name),
            attribute_map,
            attribute_map,
            tuple(c for c in connections if c.map is attribute_map),
        )
        for attribute_map in dict.fromkeys((*own, *connected))
        if attribute_map is not None
    ]
    return [*of_maps, *_meeting(model)]


def _meeting(model: Model) -> Iterator[RoundTrip]:
    """Yields the round trips by topics that one connection publishes and another one takes.

    They have maps of their own, between the same messages.
    """
    for group in Subject(model, []).systems(("name", "namespace")):
        ends = [
            endpoint for endpoint in endpoints(group) if isinstance(endpoint.element, bridge.Topic)
        ]
        for one, other in product(ends, ends):
            if (one.publishes, other.publishes) == (True, False) and one.topic == other.topic:
                yield from _trip(one, other)


def _trip(published: Endpoint, taken: Endpoint) -> Iterator[RoundTrip]:
    first, second = published.element.eContainer(), taken.element.eContainer()
    if not isinstance(first, bridge.Connection) or not isinstance(second, bridge.Connection):
        return
    to_ros, to_jaus = first.map, second.map
    is_main = isinstance(taken.element, bridge.Topic) and taken.element.join is None
    is_same = to_ros.message is to_jaus.message and to_ros.type is to_jaus.type
    if not is_main or not is_same or to_ros is to_jaus or not to_ros.toRos or not to_jaus.toJaus:
        return
    values: dict[str, set[float]] = {}
    for owner in {first.eContainer(), second.eContainer()}:
        for quantity in owner.quantities if isinstance(owner, bridge.Bridge) else ():
            values.setdefault(str(quantity.name), set()).add(quantity.value)
    # A bridge of both maps has one value for each quantity.
    if all(len(value) == 1 for value in values.values()):
        name = f"{published.owner.name}.{first.name} + {taken.owner.name}.{second.name}"
        yield RoundTrip(name, to_ros, to_jaus, (first, second))


def assignment_of(trip: RoundTrip, side: str, path: str) -> bridge.FieldAssignment | None:
    """Returns the assignment that sets a number of a side on its way back."""
    is_jaus = side == JAUS
    assignments = spelled_out(trip.to_jaus if is_jaus else trip.to_ros, to_ros=not is_jaus)
    for field_assignment in field_assignments(assignments):
        targets = (one.strip() for one in str(field_assignment.target).split(","))
        if any(_is_at(path, target) for target in targets):
            return field_assignment
    return None


def is_alone(assignment: bridge.FieldAssignment | None, path: str) -> bool:
    """Tells whether an assignment sets one number from one source.

    What shares an assignment, as the parts of an orientation do, may rightly be lost in it.
    """
    if assignment is None or "," in assignment.source:
        return False
    return f".{path}".endswith(f".{str(assignment.target).strip()}")


def is_held(trip: RoundTrip, side: str, path: str) -> bool:
    """Whether a number of a side goes over by itself, and a constant comes back in its place."""
    there, back = spelled_out(trip.to_ros, to_ros=True), spelled_out(trip.to_jaus, to_ros=False)
    there, back = (there, back) if side == JAUS else (back, there)
    constants = (held for held in back if isinstance(held, bridge.ConstantAssignment))
    held = {one.strip() for constant in constants for one in str(constant.target).split(",")}
    return path in held and any(
        path == str(going.source).strip() for going in field_assignments(there)
    )


def field_assignments(assignments: Iterable[bridge.Assignment]) -> Iterator[bridge.FieldAssignment]:
    """Yields the assignments of fields, in lists too."""
    for assignment in assignments:
        if isinstance(assignment, bridge.FieldAssignment):
            yield assignment
        elif isinstance(assignment, bridge.ListAssignment):
            yield from field_assignments(assignment.assignments)


def _is_at(path: str, target: str) -> bool:
    """Tells whether the path of a number is that of a target, or within it."""
    if path == target or path.startswith(f"{target}."):
        return True
    plain = re.sub(r"\[\d+\]", "", path)
    return "[" in path and "[" not in target and plain.endswith(f".{target.lstrip('/')}")


Making: TypeAlias = "Callable[[bytes | None, Usual], Layout]"
"""Makes a message of usual values, or finds the numbers in one."""

_SIZE = 4


@dataclass(frozen=True)
class Input:
    """The inputs of a translation.

    Attributes:
        joins: The joined messages, by the names with which paths of their numbers begin.
    """

    message: Making
    joins: Mapping[str, Making]

    def layout(self, data: bytes | None, usual: Usual = USUAL) -> Layout:
        """Returns messages of usual values, or the numbers in some."""
        makings = {"": self.message, **self.joins}
        parts = [None] * len(makings) if data is None else self._split(data)
        octets, numbers, sizes = b"", list[Number](), b""
        for (name, making), part in zip(makings.items(), parts, strict=True):
            layout = making(part, usual)
            numbers += [_behind(octets, name, number) for number in layout.numbers]
            octets += layout.data
            sizes += len(layout.data).to_bytes(_SIZE, "little") if name else b""
        return Layout(octets + sizes, numbers)

    def main(self, data: bytes) -> bytes:
        """Returns the message without the joined ones."""
        return self._split(data)[0]

    @functools.cached_property
    def usual_joins(self) -> bytes:
        """Joined messages of usual values, which stand behind a message."""
        octets = self.layout(None).data
        return octets[len(self.main(octets)) :]

    def _split(self, data: bytes) -> list[bytes]:
        count, parts = len(self.joins), list[bytes]()
        end = len(data) - _SIZE * count
        sizes = data[max(0, end) :]
        for at in reversed(range(0, _SIZE * count, _SIZE)):
            begin = end - int.from_bytes(sizes[at : at + _SIZE], "little")
            if begin < 0:
                raise LayoutError("joined messages are cut off")
            parts.append(data[begin:end])
            end = begin
        return [data[:end], *reversed(parts)]


def _behind(octets: bytes, name: str, number: Number) -> Number:
    path = f"{name}.{number.path}" if name else number.path
    return replace(number, path=path, at=len(octets) + number.at)


def inputs(trip: RoundTrip) -> dict[bool, Input]:
    """Returns the inputs of the translations, by whether they make messages of ROS."""
    return {
        True: Input(
            _jaus(trip.to_ros.message),
            {
                str(report_join.name): _jaus(report_join.message)
                for report_join in trip.to_ros.reportJoins
            },
        ),
        False: Input(
            _ros(trip.to_jaus.type),
            {str(join.name): _ros(join.type) for join in trip.to_jaus.joins},
        ),
    }


def _jaus(message: jaus.MessageDef) -> Making:
    return functools.partial(jaus_layout, wire.resolve(message))


def _ros(type_: ros.MessageType) -> Making:
    return functools.partial(ros_layout, type_)
