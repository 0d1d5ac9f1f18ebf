"""Topics: their names, by the rules of ROS 2 (rcl and rmw name validation), ends and loops."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.subject import remembered

_TOKEN = re.compile("[A-Za-z_][A-Za-z0-9_]*")
_LONGEST = 255


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A publisher or a subscription, of a node or of a bridge."""

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
        if isinstance(owner, ros.Node | bridge.Bridge):
            yield from _own_endpoints(owner)


@remembered
def _own_endpoints(owner: ros.Node | bridge.Bridge) -> tuple[Endpoint, ...]:
    if isinstance(owner, ros.Node):
        return tuple(_node_endpoints(owner))
    return tuple(_bridge_endpoints(owner))


def _node_endpoints(node: ros.Node) -> Iterator[Endpoint]:
    ends: list[ros.TopicEndpoint] = [*node.publishers, *node.subscriptions]
    for end in ends:
        if end.type is not None and end.topic and not topic_fault(end.topic):
            topic = resolve_topic(end.topic, node.namespace or "", node.name or "")
            publishes = isinstance(end, ros.Publisher)
            policy = _stated(end.qos) or "reliable"
            yield Endpoint(end, "topic", node, topic, end.type, publishes, policy)


def _bridge_endpoints(owner: bridge.Bridge) -> Iterator[Endpoint]:
    for connection in owner.bridgeConnections:
        if connection.map is None or connection.map.type is None:
            continue
        publishes = is_to_ros(connection)
        for bridge_topic in connection.topics:
            if bridge_topic.name and not topic_fault(bridge_topic.name):
                topic = resolve_topic(bridge_topic.name, owner.namespace or "", owner.name or "")
                type_ = connection.map.type if bridge_topic.join is None else bridge_topic.join.type
                if type_ is not None:
                    policy = reliability(connection, bridge_topic)
                    yield Endpoint(bridge_topic, "name", owner, topic, type_, publishes, policy)


def reliability(connection: bridge.Connection, topic: bridge.Topic) -> str:
    """Returns the reliability policy of a topic of a bridge.

    Where the model leaves it open, it is what meets every other end. A subscription that is
    best_effort hears publishers of both kinds. Two are reliable all the same: one of commands,
    since a command may be sent only once, and one that is transient_local, since what was published
    before it began is repeated to reliable subscriptions alone.
    """
    if policy := _stated(topic.qos):
        return policy
    publishes = is_to_ros(connection)
    message = connection.map.message
    commands = topic.join is None and message is not None and is_command(message)
    is_sure = publishes or commands or is_latched(topic.qos)
    return "reliable" if is_sure else "best_effort"


def is_latched(profile: ros.QoSProfile | None) -> bool:
    """Tells whether a profile lets late subscriptions get earlier messages."""
    return profile is not None and profile.durability.name == "transient_local"


_POLICIES = (
    "durability",
    "history",
    "depth",
    "deadline",
    "lifespan",
    "liveliness",
    "leaseDuration",
)


def policies(profile: ros.QoSProfile | None) -> Mapping[str, Any]:
    """Returns the policies of a profile besides reliability, by feature; the usual ones of none."""
    if profile is None:
        return _usual_policies()
    values = {policy: getattr(profile, policy) for policy in _POLICIES}
    return {feature: getattr(value, "name", value) for feature, value in values.items()}


@cache
def _usual_policies() -> Mapping[str, Any]:
    return policies(ros.QoSProfile())


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


@dataclass(frozen=True, slots=True)
class Flow:
    """A connection with its bridge."""

    connection: bridge.Connection
    owner: bridge.Bridge = field(hash=False)
    to_ros: bool = field(hash=False)
    code: int = field(hash=False)
    topics: frozenset[str] = field(hash=False)
    peers: frozenset[jaus.Component] = field(hash=False)
    is_open: bool = field(hash=False)

    @property
    def is_message(self) -> bool:
        """Whether messages cross by themselves, neither asked for nor subscribed to."""
        return self.connection.exchange.name == "message"

    def has_peer(self, component: jaus.Component) -> bool:
        """Tells whether messages are exchanged with a component."""
        return component in self.peers or self.is_open


def flow_of(connection: bridge.Connection, owner: bridge.Bridge) -> Flow:
    """Returns a connection as a flow."""
    namespace, node = owner.namespace or "", owner.name or ""
    # What arrives on a joined topic waits for a message on the main one.
    names = [topic.name for topic in connection.topics if topic.name and topic.join is None]
    return Flow(
        connection,
        owner,
        to_ros=is_to_ros(connection),
        code=code(connection.map.message),
        topics=frozenset(
            resolve_topic(name, namespace, node) for name in names if not topic_fault(name)
        ),
        peers=frozenset(connection.peers),
        # Who is found at run time is not known here.
        is_open=not connection.peers and connection.search is None,
    )


def find_loops(flows: list[Flow]) -> list[list[Flow]]:
    """Returns one loop for each set of connections that reach each other.

    Returns:
        Loops in the order of the connections, each from its first connection on.
    """
    subscribers: dict[str, list[Flow]] = defaultdict(list)
    takers: dict[int, list[Flow]] = defaultdict(list)
    for flow in flows:
        if flow.to_ros:
            takers[flow.code].append(flow)
        for topic in () if flow.to_ros else flow.topics:
            subscribers[topic].append(flow)
    after = {
        flow: [other for topic in sorted(flow.topics) for other in subscribers[topic]]
        if flow.to_ros
        else [other for other in takers[flow.code] if _crosses_jaus(flow, other)]
        for flow in flows
    }
    loops: list[list[Flow]] = []
    reported: set[Flow] = set()
    for flow in flows:
        if flow not in reported:
            loop = _way_back(flow, after)
            if loop:
                loops.append(loop)
                reported.update(loop)
    return loops


def _way_back(start: Flow, after: dict[Flow, list[Flow]]) -> list[Flow]:
    """Returns the shortest way from a connection back to it, empty when there is none."""
    paths: list[list[Flow]] = [[start]]
    seen: set[Flow] = set()
    # The list grows while it is gone through, so that shorter ways come first.
    for way in paths:
        for following in after[way[-1]]:
            if following is start:
                return way
            if following not in seen:
                seen.add(following)
                paths.append([*way, following])
    return []


def _crosses_jaus(sender: Flow, receiver: Flow) -> bool:
    """Tells whether a message of one bridge enters ROS again at another."""
    if sender.is_message:
        to_bridge = receiver.owner in sender.peers and receiver.has_peer(sender.owner)
        # Or the message goes to the very peer that sends the same message.
        return to_bridge or not sender.peers.isdisjoint(receiver.peers)
    return sender.owner in receiver.peers and sender.has_peer(receiver.owner)
