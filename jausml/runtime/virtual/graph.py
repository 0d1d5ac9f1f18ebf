"""Topics and actions of a virtual ROS: publishers and subscriptions in one process."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from random import Random
from typing import Any, TypeAlias

from ..base.loop import Loop
from ..bridge.ends.actions import GoalTaker
from ..bridge.ends.topics import EndpointHealth, Published, Qos, Topic, TopicCounts, conflicts
from ..bridge.messages.limits import RosTypeError
from .actions import VirtualAction, VirtualActionClient
from .network import Link, Path

# A message class of ROS, a light class, or the name of a type, e.g. `nav_msgs/msg/Odometry`.
RosType: TypeAlias = "type[Any] | str"

MAX_KEPT = 5000  # messages that a latched publisher with `keep_all` keeps
UNDEMANDING = Qos(reliability="best_effort")  # requested by a subscription to any publisher
_OUTSIDE = "the world"  # node of publishers and subscriptions of tests


def type_name(ros_type: RosType) -> str:
    """Returns the name of a type, e.g. `nav_msgs/msg/Odometry`."""
    if isinstance(ros_type, str):
        return ros_type
    light_name: str | None = getattr(ros_type, "TYPE", None)
    if light_name is not None:
        return light_name
    package, kind, *_ = f"{ros_type.__module__}..".split(".")
    return f"{package}/{kind}/{ros_type.__name__}"


class GraphPublisher:
    """A publisher of a topic; made by `RosGraph`."""

    def __init__(
        self,
        node: str,
        qos: Qos,
        topic: GraphTopic,
        on_matched: Callable[[], None] | None,
        health: EndpointHealth,
    ) -> None:
        self.node = node
        self.qos = qos
        self.topic = topic
        self.on_matched = on_matched
        self.health = health
        self.publish: Callable[[bytes], None] = self._publish
        self.unmatched = 0  # messages without a subscription, counted by the caller of `publish`
        self.subscriptions: list[GraphSubscription] = []  # connected subscriptions
        size = MAX_KEPT if qos.history == "keep_all" else qos.depth
        # Data and publication time in nanoseconds since 1970, for late subscriptions.
        self.kept: deque[tuple[bytes, int]] = deque(maxlen=size)

    @property
    def matched(self) -> int:
        """The number of connected subscriptions."""
        return len(self.subscriptions)

    @property
    def published(self) -> Published:
        """Topic, type and quality of service."""
        return Published(self.topic.name, self.topic.kind, self.qos)

    def _publish(self, data: bytes) -> None:
        # A copy: the caller may use the buffer again.
        message = bytes(data), self.topic.wall_time()
        if self.qos.durability == "transient_local":
            self.kept.append(message)
        for subscription in tuple(self.subscriptions):
            subscription.send(*message, self.qos.lifespan)

    def send_kept(self, subscription: GraphSubscription) -> None:
        """Sends a late subscription the kept messages within its depth and their lifespan."""
        lifespan, now = self.qos.lifespan, self.topic.wall_time()
        valid = [kept for kept in self.kept if not _has_expired(now - kept[1], lifespan)]
        if subscription.qos.history != "keep_all":
            valid = valid[-subscription.qos.depth :]
        for data, stamp in valid:
            subscription.send(data, stamp, lifespan)

    @property
    def address(self) -> int:
        """0, as there is no client library."""
        return 0

    def close(self) -> None:
        """Removes the publisher."""
        self.topic.remove_publisher(self)


@dataclass(eq=False)
class GraphSubscription:
    """A subscription, and the path to it."""

    node: str
    qos: Qos
    topic: GraphTopic
    take: Callable[[bytes, int], None]
    path: Path
    health: EndpointHealth
    counts: TopicCounts = field(default_factory=TopicCounts)
    is_open: bool = True

    @property
    def link(self) -> Link:
        """The properties of the path; may be set at any time."""
        return self.path.link

    @link.setter
    def link(self, link: Link) -> None:
        self.path.link = link

    def close(self) -> None:
        """Unsubscribes."""
        self.topic.remove_subscription(self)

    def send(self, data: bytes, stamp: int, lifespan: float) -> None:
        """Sends a message that was published at `stamp`, in nanoseconds since 1970."""
        if not self.path.carry(partial(self._arrive, data, stamp, lifespan)):
            self.counts.missed += 1

    def _arrive(self, data: bytes, stamp: int, lifespan: float) -> None:
        if not self.is_open:
            return  # closed before the message arrived
        age = self.topic.wall_time() - stamp
        # In DDS the lifespan is the publisher's; the queue of a subscription has one as well.
        if _has_expired(age, lifespan) or _has_expired(age, self.qos.lifespan):
            self.counts.lost += 1
            self.counts.missed += 1
            return
        self.counts.taken += 1
        self.topic.on_message(self.topic.name, data)
        self.take(data, stamp)


def _has_expired(age: int, lifespan: float) -> bool:
    """Returns whether an age in ns exceeds a lifespan in seconds; 0 means an endless one."""
    return 0 < lifespan * 1e9 < age


class GraphTopic:
    """A topic with its publishers and subscriptions."""

    def __init__(self, graph: RosGraph, name: str, kind: str) -> None:
        self.name = name
        self.kind = kind
        self.wall_time = graph.loop.wall
        self.on_message = graph.on_message
        self.publishers: list[GraphPublisher] = []
        self.subscriptions: list[GraphSubscription] = []
        self._loop = graph.loop

    def add_publisher(self, publisher: GraphPublisher) -> None:
        """Connects a publisher with the present subscriptions."""
        self.publishers.append(publisher)
        for subscription in self.subscriptions:
            self._connect(publisher, subscription)

    def add_subscription(self, subscription: GraphSubscription) -> None:
        """Connects a subscription with the present publishers."""
        self.subscriptions.append(subscription)
        for publisher in self.publishers:
            self._connect(publisher, subscription)

    def remove_publisher(self, publisher: GraphPublisher) -> None:
        """Disconnects a publisher; no effect if disconnected."""
        publisher.subscriptions.clear()
        if publisher in self.publishers:
            self.publishers.remove(publisher)

    def remove_subscription(self, subscription: GraphSubscription) -> None:
        """Disconnects a subscription; no effect if disconnected."""
        subscription.is_open = False
        if subscription in self.subscriptions:
            self.subscriptions.remove(subscription)
        for publisher in self.publishers:
            if subscription in publisher.subscriptions:
                publisher.subscriptions.remove(subscription)

    def publishers_of(self, subscription: GraphSubscription) -> int:
        """Returns the number of publishers that are connected to a subscription."""
        return sum(subscription in publisher.subscriptions for publisher in self.publishers)

    def endpoints(self, *, publishers: bool) -> list[tuple[str, Qos]]:
        """Returns node and quality of service of all publishers, or of all subscriptions."""
        endpoints = self.publishers if publishers else self.subscriptions
        return [(endpoint.node, endpoint.qos) for endpoint in endpoints]

    def _connect(self, publisher: GraphPublisher, subscription: GraphSubscription) -> None:
        mismatches = conflicts(publisher.qos, subscription.qos)
        if mismatches:
            publisher.health.note_incompatible(mismatches[0].policy)
            subscription.health.note_incompatible(mismatches[0].policy)
            return
        publisher.subscriptions.append(subscription)
        if publisher.on_matched is not None:
            # Later, as in ROS.
            self._loop.call_soon(publisher.on_matched)
        if subscription.qos.durability == "transient_local":
            publisher.send_kept(subscription)


class RosGraph:
    """Topics and actions by name, for nodes of a virtual world and for tests.

    Messages are serialized, as in `RosSide`. Each subscription has a path of its own, which loses
    messages whatever their quality of service: it stands for `best_effort`.
    """

    def __init__(
        self, loop: Loop, random: Random, on_message: Callable[[str, bytes], None]
    ) -> None:
        self.loop = loop
        self.on_message = on_message
        self._random = random
        self._topics: dict[str, GraphTopic] = {}
        self._actions: dict[str, VirtualAction] = {}
        self._own: dict[tuple[str, Qos], GraphPublisher] = {}

    def publish(self, topic: str, ros_type: RosType, data: bytes, qos: Qos | None = None) -> None:
        """Publishes a serialized message; the first one of a topic creates the publisher."""
        offered = Qos() if qos is None else qos
        publisher = self._own.get((topic, offered))
        if publisher is None or publisher.topic.kind != type_name(ros_type):
            # Another type than before raises RosTypeError, as for any node.
            publisher = self.advertise(_OUTSIDE, ros_type, Topic(topic, offered))
            self._own[topic, offered] = publisher
        publisher.publish(data)

    def subscribe(
        self,
        topic: str,
        ros_type: RosType,
        take: Callable[[bytes], object],
        qos: Qos | None = None,
        link: Link | None = None,
    ) -> GraphSubscription:
        """Subscribes to a topic.

        Args:
            qos: Quality of service; by default one that is compatible with all publishers.

        Returns:
            The subscription, whose link may be set, and which may be closed.
        """
        requested = Topic(topic, UNDEMANDING if qos is None else qos)

        def take_data(data: bytes, _stamp: int) -> None:
            take(data)

        link = Link() if link is None else link
        return self.attach(_OUTSIDE, ros_type, requested, take_data, link)

    def serve_action(self, name: str, taker: GoalTaker) -> VirtualAction:
        """Sets the server of an action, in place of the former one."""
        action = self._action(name)
        action.server = taker
        return action

    def action_client(self, name: str, link: Link | None = None) -> VirtualActionClient:
        """Returns a client of an action; a link carries goals, feedback and results."""
        path = Path(self.loop, self._random, Link() if link is None else link)
        return VirtualActionClient(self._action(name), path)

    # ------------------------------------------------------------------ for nodes

    def advertise(
        self,
        node: str,
        ros_type: RosType,
        topic: Topic,
        on_matched: Callable[[], None] | None = None,
    ) -> GraphPublisher:
        """Creates a publisher of a node; `on_matched` is called at each connected subscription."""
        graph_topic = self._topic(topic.name, ros_type)
        health = self._health(graph_topic, topic.qos, publishes=True)
        publisher = GraphPublisher(node, topic.qos, graph_topic, on_matched, health)
        health.count = lambda: publisher.matched
        graph_topic.add_publisher(publisher)
        return publisher

    def attach(
        self,
        node: str,
        ros_type: RosType,
        topic: Topic,
        take: Callable[[bytes, int], None],
        link: Link,
    ) -> GraphSubscription:
        """Creates a subscription of a node; `take` gets data and time in ns since 1970."""
        graph_topic = self._topic(topic.name, ros_type)
        path = Path(self.loop, self._random, link)
        health = self._health(graph_topic, topic.qos, publishes=False)
        subscription = GraphSubscription(node, topic.qos, graph_topic, take, path, health)
        health.count = lambda: graph_topic.publishers_of(subscription)
        graph_topic.add_subscription(subscription)
        return subscription

    def _action(self, name: str) -> VirtualAction:
        action = self._actions.get(_full(name))
        if action is None:
            action = self._actions[name] = VirtualAction(name)
        return action

    def _topic(self, name: str, ros_type: RosType) -> GraphTopic:
        kind = type_name(ros_type)
        graph_topic = self._topics.get(_full(name))
        if graph_topic is None:
            graph_topic = self._topics[name] = GraphTopic(self, name, kind)
        if graph_topic.kind != kind:
            raise RosTypeError(f"{name} has the type {graph_topic.kind}, not {kind}")
        return graph_topic

    def _health(self, topic: GraphTopic, qos: Qos, *, publishes: bool) -> EndpointHealth:
        entity = "publisher" if publishes else "subscription"
        others = partial(topic.endpoints, publishers=not publishes)
        return EndpointHealth(publishes, topic.name, qos, entity, others, self.loop.now)


def _full(name: str) -> str:
    if not name.startswith("/"):
        raise ValueError(f"{name!r} is no full name of a topic or an action, such as /odometry")
    return name
