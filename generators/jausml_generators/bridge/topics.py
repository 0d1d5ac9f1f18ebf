"""Topics of connections, and joined ones, as Python text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml.language.semantics.connections.topics import reliability
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import bridge, ros

_QOS = {
    "reliability": "reliable",
    "durability": "volatile",
    "history": "keep_last",
    "depth": 10,
    "deadline": 0.0,
    "lifespan": 0.0,
    "liveliness": "automatic",
    "leaseDuration": 0.0,
}


@dataclass(frozen=True)
class JoinView:
    """A further topic that a translation takes values from."""

    connection: bridge.Connection
    join: bridge.Join
    name: str
    type_name: str

    @property
    def model_name(self) -> str:
        """Its name in the model."""
        return str(self.join.name)

    @property
    def type(self) -> ros.MessageType:
        """The ROS type in the model."""
        return self.join.type

    @property
    def topics(self) -> tuple[bridge.Topic, ...]:
        """The topics that feed it."""
        return tuple(each for each in self.connection.topics if each.join is self.join)

    @property
    def argument(self) -> str:
        """The join as an argument of the runtime class, as Python text."""
        topics = list_of(topic_call(self.connection, topic) for topic in self.topics)
        found = [python_string(self.model_name), self.type_name, topics]
        found.append(f"freshness={python_literal(float(self.join.freshness))}")
        if self.join.whenStale.name == "dropMessage":
            found.append("drop=True")
        return call("Join", *found)


def topic_call(connection: bridge.Connection, topic: bridge.Topic) -> str:
    """Returns a topic with the policies that differ from the usual ones."""
    policies = {"reliability": reliability(connection, topic), **_further_policies(topic.qos)}
    stated = [
        f"{snake_case(feature)}={python_literal(value)}"
        for feature, value in policies.items()
        if value != _QOS[feature]
    ]
    arguments = [python_string(topic.name)]
    if stated:
        arguments.append(call("Qos", *stated))
    return call("Topic", *arguments)


def list_of(items: Iterable[str]) -> str:
    """Returns a list of what is Python text already."""
    return f"[{', '.join(items)}]"


def _further_policies(profile: ros.QoSProfile | None) -> dict[str, object]:
    """Returns all but the reliability."""
    if profile is None:
        return {}
    values = {each: getattr(profile, each) for each in _QOS if each != "reliability"}
    return {feature: getattr(value, "name", value) for feature, value in values.items()}
