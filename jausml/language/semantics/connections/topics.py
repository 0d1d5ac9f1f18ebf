"""Names of the ROS graph, by the rules of ROS 2 (rcl and rmw name validation)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.jaus.commands import is_command

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.metamodel.classes.ecore import EObject

_TOKEN = re.compile("[A-Za-z_][A-Za-z0-9_]*")
_LONGEST = 255


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A publisher or a subscription, of a node or of a bridge.

    Attributes:
        reliability: Its reliability policy, decided where the model leaves that open.
    """

    element: ros.TopicEndpoint | bridge.Topic
    feature: str
    owner: ros.Node | bridge.Bridge
    topic: str
    type: ros.MessageType
    publishes: bool
    reliability: str


def topic_fault(name: str) -> str:
    """Says why a text is no topic or service name, or returns an empty string."""
    if not name:
        return "is empty"
    if len(name) > _LONGEST:
        return f"is longer than {_LONGEST} characters"
    body = name[1:] if name.startswith("/") else name
    tokens = body.split("/")
    if tokens[0] == "~" and not name.startswith("/"):
        tokens = tokens[1:]
        if not tokens:
            return "names the node's own namespace, not a topic in it"
    return _tokens_fault(tokens)


def namespace_fault(namespace: str) -> str:
    """Says why a text is no namespace, or returns an empty string; empty means the root."""
    if namespace in ("", "/"):
        return ""
    if len(namespace) > _LONGEST:
        return f"is longer than {_LONGEST} characters"
    return _tokens_fault(namespace.removeprefix("/").split("/"))


def resolve_topic(name: str, namespace: str, node: str) -> str:
    """Returns the full name of a topic."""
    if name.startswith("/"):
        return name
    base = "/" + namespace.strip("/") if namespace.strip("/") else ""
    if name.startswith("~/"):
        return f"{base}/{node}/{name[2:]}"
    return f"{base}/{name}"


def endpoints(group: Iterable[EObject]) -> Iterator[Endpoint]:
    """Yields the publishers and subscriptions of some nodes and bridges whose names are legal."""
    for owner in group:
        if isinstance(owner, ros.Node):
            yield from _node_endpoints(owner)
        elif isinstance(owner, bridge.Bridge):
            yield from _bridge_endpoints(owner)


def _node_endpoints(node: ros.Node) -> Iterator[Endpoint]:
    ends: list[ros.TopicEndpoint] = [*node.publishers, *node.subscriptions]
    for each in ends:
        if each.type is not None and each.topic and not topic_fault(each.topic):
            topic = resolve_topic(each.topic, node.namespace or "", node.name or "")
            publishes = isinstance(each, ros.Publisher)
            policy = _stated(each.qos) or "reliable"
            yield Endpoint(each, "topic", node, topic, each.type, publishes, policy)


def _bridge_endpoints(owner: bridge.Bridge) -> Iterator[Endpoint]:
    for connection in owner.bridgeConnections:
        if connection.map is None or connection.map.type is None:
            continue
        publishes = connection.direction.name == "jausToRos"
        for each in connection.topics:
            if each.name and not topic_fault(each.name):
                topic = resolve_topic(each.name, owner.namespace or "", owner.name or "")
                type_ = connection.map.type if each.join is None else each.join.type
                if type_ is not None:
                    policy = reliability(connection, each)
                    yield Endpoint(each, "name", owner, topic, type_, publishes, policy)


def reliability(connection: bridge.Connection, topic: bridge.Topic) -> str:
    """Returns the reliability policy of a topic of a bridge.

    Where the model leaves it open, it is what meets every other end. A subscription that is
    best_effort hears publishers of both kinds. Two are reliable all the same: one of commands,
    since a command may be sent only once, and one that is transient_local, since what was published
    before it began is repeated to reliable subscriptions alone.
    """
    if policy := _stated(topic.qos):
        return policy
    publishes = connection.direction.name == "jausToRos"
    message = connection.map.message
    commands = topic.join is None and message is not None and is_command(message)
    is_sure = publishes or commands or is_latched(topic.qos)
    return "reliable" if is_sure else "best_effort"


def is_latched(profile: ros.QoSProfile | None) -> bool:
    """Tells whether a profile is one of late subscriptions that get what was published before."""
    return profile is not None and profile.durability.name == "transient_local"


def _stated(profile: ros.QoSProfile | None) -> str:
    """Returns the reliability that the model states, or an empty string."""
    policy = "automatic" if profile is None else profile.reliability.name
    return "" if policy == "automatic" else policy


def _tokens_fault(tokens: list[str]) -> str:
    for token in tokens:
        if not token:
            return "has an empty part ('//' or '/' at the end)"
        if "{" in token or "}" in token:
            return "has a substitution in braces, which models do not support"
        if "~" in token:
            return "has '~' elsewhere than at the start, before '/'"
        if token[0].isdigit():
            return f"has a part that starts with a digit ('{token}')"
        if not _TOKEN.fullmatch(token):
            return "has characters other than letters, digits, '_' and '/'"
        if "__" in token:
            return "has two underscores in a row"
    return ""
