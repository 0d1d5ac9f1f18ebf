"""Topics of a bridge on rclpy: publishers, subscriptions, what waits for both, and who is there.

They are made below the classes `Publisher` and `Subscription` of rclpy: the executor would look at
each of those whenever it wakes up.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any, Literal

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.duration import Duration
from rclpy.event_handler import (
    QoSPublisherEventType,
    QoSSubscriptionEventType,
    UnsupportedEventTypeError,
)
from rclpy.qos import qos_policy_name_from_kind
from rclpy.type_support import check_is_valid_msg_type

from ...base.counters import LOGGER
from ...base.loop import Loop
from ..ends.topics import (
    EndpointHealth,
    ParameterError,
    Published,
    Qos,
    Topic,
    TopicCounts,
    TopicFault,
)
from .internals import internals, message_class
from .parameters import (
    OVERRIDABLE,
    NodeParameters,
    as_parameter_error,
    deep_enough,
    never_waiting,
    overridden,
    profile_of,
    qos_of,
    tell_unknown,
)
from .taking import Subscription
from .values import is_of_any_size
from .waiting import Listener, NoListenerError, WaitSets

Told = Callable[[Any], None]


def matched_event(subscription: Any) -> Any:
    """Returns the event of a subscription that tells of publishers that come and go."""
    with subscription:
        return internals.EventHandle(
            subscription, QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED
        )


def publisher_events(
    handle: Any, health: EndpointHealth, matched: Told
) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields the events of a publisher, and what takes each."""
    kinds = QoSPublisherEventType
    yield from _event(handle, kinds.RCL_PUBLISHER_MATCHED, matched)
    yield from _event(handle, kinds.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS, _incompatible(health))
    # ROS waits for each event apart, so only for those that may come.
    if health.qos.deadline > 0:
        missed = _more(health.note_missed_deadline)
        yield from _event(handle, kinds.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED, missed)
    if health.qos.lease_duration > 0:
        lost = _more(health.note_lost_liveliness)
        yield from _event(handle, kinds.RCL_PUBLISHER_LIVELINESS_LOST, lost)


def subscription_events(
    handle: Any, health: EndpointHealth
) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields the events of a subscription, and what takes each."""

    def liveliness(state: Any) -> None:
        if not (state.alive_count_change or state.not_alive_count_change):
            return
        if state.alive_count > 0:
            health.note_liveliness()
        elif state.not_alive_count > 0:
            health.note_lost_liveliness()

    kinds = QoSSubscriptionEventType
    callback = _incompatible(health)
    yield from _event(handle, kinds.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS, callback)
    if health.qos.deadline > 0:
        missed = _more(health.note_missed_deadline)
        yield from _event(handle, kinds.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED, missed)
    if health.qos.lease_duration > 0:
        yield from _event(handle, kinds.RCL_SUBSCRIPTION_LIVELINESS_CHANGED, liveliness)


def _event(handle: Any, kind: Any, tell: Told) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields one event; nothing where the middleware does not know it."""
    try:
        with handle:
            event = internals.EventHandle(handle, kind)
    except UnsupportedEventTypeError:
        return

    def read() -> None:
        state = event.take_event()
        if state is not None:
            tell(state)

    yield event, read


def _more(note: Callable[[], None]) -> Told:
    """Notes what happened since the last time; an event may be read when nothing did."""

    def tell(state: Any) -> None:
        if state.total_count_change > 0:
            note()

    return tell


def _incompatible(health: EndpointHealth) -> Told:
    def tell(state: Any) -> None:
        if state.total_count_change > 0:
            health.note_incompatible(str(qos_policy_name_from_kind(state.last_policy_kind)))

    return tell


class NodePublisher:
    """A publisher for serialized messages, which the function of rclpy itself publishes."""

    __slots__ = ("handle", "matched", "publish", "published", "unmatched")

    def __init__(self, handle: Any, published: Published) -> None:
        self.handle = handle
        self.published = published
        self.publish: Callable[[bytes], None] = handle.publish_raw
        self.matched = 0
        self.unmatched = 0

    @property
    def address(self) -> int:
        """Where the client library has it."""
        return int(self.handle.pointer)


WaitingName = Literal["automatic", "listener", "wait-set"]
"""How the bridge waits for ROS; `automatic` takes the listener where there is one."""


class NodeTopics:
    """The topics of one node."""

    def __init__(
        self,
        node: Any,
        context: Any,
        loop: Loop,
        waiting: WaitingName,
        parameters: NodeParameters,
        age_limit: int,
    ) -> None:
        """Has none yet; its queues keep messages for an age in nanoseconds, or 0 for ever."""
        self._node = node
        self._parameters = parameters
        self._age_limit = age_limit
        self._health: dict[tuple[Topic, bool], EndpointHealth] = {}
        self._kin: Counter[tuple[str, bool]] = Counter()  # endpoints that share a topic
        self._publishers: list[Any] = []
        self._subscriptions: list[Any] = []
        self._events: list[Any] = []
        self._waiting = self._chosen(waiting, context, loop)

    def publisher(
        self, ros_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> NodePublisher:
        """Makes a publisher of a class of rclpy, or of a light one, whose `TYPE` names the type."""
        rclpy_class = message_class(ros_type)
        health = self._watched(topic, topic.qos, publishes=True)
        health.qos = never_waiting(health.qos)
        handle = self._new_handle(internals.Publisher, rclpy_class, topic, health)
        self._publishers.append(handle)
        self._watch_types(health, rclpy_class, handle.get_subscription_count)
        published = Published(health.topic, _type_name(rclpy_class), health.qos)
        publisher = NodePublisher(handle, published)

        def matched(state: Any) -> None:
            publisher.matched = state.current_count
            if state.current_count_change > 0 and greet is not None:
                greet()

        self._wait_for(publisher_events(handle, health, matched))
        return publisher

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription; messages are taken after `start`."""
        rclpy_class, counts = message_class(ros_type), TopicCounts()
        health = self._watched(topic, deep_enough(topic.qos), publishes=False)
        handle = self._new_handle(internals.Subscription, rclpy_class, topic, health)
        self._subscriptions.append(handle)
        self._watch_types(health, rclpy_class, handle.get_publisher_count)
        health.counts = counts if is_of_any_size(rclpy_class) else None
        qos = health.qos
        # What is latched is as old as it is.
        age_limit = self._age_limit if qos.durability == "volatile" else 0
        depth = qos.depth if qos.history == "keep_last" else 0
        self._wait_for(subscription_events(handle, health))
        matched = matched_event(handle)
        self._events.append(matched)
        self._waiting.subscription(
            Subscription(handle, matched, rclpy_class, depth, take, age_limit, counts)
        )
        return counts

    def faults(self, topic: Topic, *, publishes: bool, alone: bool = False) -> list[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does."""
        return self._health[topic, publishes].faults(alone=alone)

    def _watched(self, topic: Topic, qos: Qos, *, publishes: bool) -> EndpointHealth:
        """Returns what will know how a publisher or subscription fares, with its final quality."""
        with as_parameter_error(f"topic {topic.name!a}: "):
            name = self._node.resolve_topic_name(topic.name)
        find = self._finder(publishes=publishes)
        kin = self._kin[name, publishes]
        self._kin[name, publishes] += 1
        entity = ("publisher" if publishes else "subscription") + (f"_{kin + 1}" if kin else "")

        def others() -> list[tuple[str, Qos]]:
            return [(_node_name(endpoint), qos_of(endpoint.qos_profile)) for endpoint in find(name)]

        health = EndpointHealth(publishes, name, qos, entity, others)
        health.qos = overridden(health, self._parameters.given, self._parameters.declare)
        self._health[topic, publishes] = health
        return health

    def _watch_types(
        self, health: EndpointHealth, rclpy_class: type[Any], count: Callable[[], int]
    ) -> None:
        """Lets what fares badly know who is at the other end with another type, if nobody else."""
        find, own = self._finder(publishes=health.publishes), _type_name(rclpy_class)

        def strangers() -> list[tuple[str, str]]:
            if count():
                return []
            ends = find(health.topic)
            return [(_node_name(end), end.topic_type) for end in ends if end.topic_type != own]

        health.strangers, health.count = strangers, count

    def _finder(self, *, publishes: bool) -> Callable[[str], list[Any]]:
        """Returns what finds the other ends of a topic, by its full name."""
        node: Any = self._node
        finder: Callable[[str], list[Any]] = (
            node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
        )
        return finder

    def _new_handle(
        self, kind: Any, rclpy_class: type[Any], topic: Topic, health: EndpointHealth
    ) -> Any:
        check_is_valid_msg_type(rclpy_class)
        with as_parameter_error(f"topic {topic.name!a}: "), self._node.handle:
            profile = profile_of(health.qos).get_c_qos_profile()
            return kind(self._node.handle, rclpy_class, topic.name, profile)

    def _wait_for(self, events: Iterator[tuple[Any, Callable[[], None]]]) -> None:
        for event, read in events:
            self._events.append(event)
            self._waiting.event(event, read)

    # ------------------------------------------------------------------ life

    def listen(self, fail: Callable[[BaseException], None]) -> None:
        """Begins to take the messages of what was subscribed to."""
        possible = (
            endpoint_health.parameter(policy)
            for endpoint_health in self._health.values()
            for policy in OVERRIDABLE
        )
        tell_unknown(self._node, possible)
        self._waiting.start(fail)

    def wait(self, deadline: float) -> None:
        """Waits until subscribers have what was published, at most to a steady time."""
        for publisher in self._publishers:
            left = Duration(seconds=max(deadline - time.monotonic(), 0.0))
            publisher.wait_for_all_acked(left.get_c_duration())

    def destroy(self) -> None:
        """Gives all topics back; on the thread of the executor, or when it is over."""
        self._waiting.close()
        for handle in (*self._events, *self._subscriptions, *self._publishers):
            handle.destroy_when_not_in_use()

    # ------------------------------------------------------------------ waiting

    def _chosen(self, waiting: WaitingName, context: Any, loop: Loop) -> Listener | WaitSets:
        if waiting == "wait-set":
            return WaitSets(loop, context)
        try:
            return self._listener(loop)
        except NoListenerError as error:
            if waiting == "listener":
                raise ParameterError(f"--ros-waiting listener: {error}") from error
            LOGGER.warning("waiting for ROS with a wait set, which is slower: %s", error)
            return WaitSets(loop, context)

    def _listener(self, loop: Loop) -> Listener:
        """Returns the listener, tried with a subscription and an event that go at once."""
        listener = Listener(loop)
        node = self._node.handle
        with node:
            profile = profile_of(Qos()).get_c_qos_profile()
            trial = internals.Subscription(node, DiagnosticArray, "_trial", profile)
        matched = matched_event(trial)
        try:
            listener.try_out(trial, matched)
        finally:
            matched.destroy_when_not_in_use()
            trial.destroy_when_not_in_use()
        return listener


def _type_name(rclpy_class: type[Any]) -> str:
    package, kind, *_ = rclpy_class.__module__.split(".")
    return f"{package}/{kind}/{rclpy_class.__name__}"


def _node_name(end: Any) -> str:
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"
