"""Round trips: ways of values through maps and back."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from jausml.language.metamodel.classes import bridge
from jausml.language.model import Model
from jausml.language.semantics.connections.topics import Endpoint, endpoints
from jausml.language.semantics.paths.scopes import spelled_out
from jausml.language.semantics.subject import Subject
from jausml.proving.layout import (
    JAUS,
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
            tuple(connection for connection in connections if connection.map is attribute_map),
        )
        for attribute_map in dict.fromkeys((*own, *connected))
        if attribute_map is not None
    ]
    return [*of_maps, *_meeting(model)]


def _meeting(model: Model) -> Iterator[RoundTrip]:
    """Yields the round trips by topics that one connection publishes and another one takes."""
    for group in Subject(model, []).systems(("name", "namespace")):
        ends = [
            endpoint for endpoint in endpoints(group) if isinstance(endpoint.element, bridge.Topic)
        ]
        for one, other in product(ends, ends):
            if (one.publishes, other.publishes) == (True, False) and one.topic == other.topic:
                yield from _trip(one, other)


def _trip(published: Endpoint, taken: Endpoint) -> Iterator[RoundTrip]:
    """Yields the round trip of a topic, where two maps lead to the same messages and back."""
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
    """Returns the assignment that sets a number of a side on its way back; None for none.

    Args:
        side: `JAUS` or `ROS` of `layout`.
        path: Path of the number in the message of that side.
    """
    is_jaus = side == JAUS
    assignments = spelled_out(trip.to_jaus if is_jaus else trip.to_ros, to_ros=not is_jaus)
    for field_assignment in field_assignments(assignments):
        targets = (target.strip() for target in str(field_assignment.target).split(","))
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
    held = {
        target.strip()
        for constant in back
        if isinstance(constant, bridge.ConstantAssignment)
        for target in str(constant.target).split(",")
    }
    sources = {str(assignment.source).strip() for assignment in field_assignments(there)}
    return path in held & sources


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
