"""What is proved: the ways of values through maps and back."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.semantics.subject import Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.model import Model
    from jausml.language.semantics.connections.topics import Endpoint


@dataclass(frozen=True)
class RoundTrip:
    """The way of values through a map and back, in the directions that there are.

    Attributes:
        to_ros: The map that makes messages of ROS.
        to_jaus: The map that makes JAUS messages: the same one, or that of another connection.
        connections: Those whose policies and quantities count; of several, those of the first.
    """

    name: str
    to_ros: bridge.AttributeMap
    to_jaus: bridge.AttributeMap
    connections: tuple[bridge.Connection, ...] = ()


def round_trips(model: Model) -> list[RoundTrip]:
    """Returns those of the maps of a model and of its bridges, and of connections that meet."""
    maps = model.instances(bridge.AttributeMap)
    own = [each for each in maps if (found := model.document_of(each)) and found.given]
    connections = model.instances(bridge.Connection)
    used = [each.map for each in model.instances(bridge.Connection, library=False)]
    of_maps = [
        RoundTrip(str(each.name), each, each, tuple(c for c in connections if c.map is each))
        for each in dict.fromkeys((*own, *used))
        if each is not None
    ]
    return [*of_maps, *_meeting(model)]


def _meeting(model: Model) -> Iterator[RoundTrip]:
    """Yields those by the topics that one connection publishes and another one takes.

    They have maps of their own, between the same messages.
    """
    for group in Subject(model, []).systems(("name", "namespace")):
        ends = [each for each in endpoints(group) if isinstance(each.element, bridge.Topic)]
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
        for each in owner.quantities if isinstance(owner, bridge.Bridge) else ():
            values.setdefault(str(each.name), set()).add(each.value)
    # A bridge of both maps has one value for each quantity.
    if all(len(each) == 1 for each in values.values()):
        name = f"{published.owner.name}.{first.name} + {taken.owner.name}.{second.name}"
        yield RoundTrip(name, to_ros, to_jaus, (first, second))
