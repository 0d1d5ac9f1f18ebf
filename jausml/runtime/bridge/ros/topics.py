"""Topics of a bridge on rclpy: publishers, subscriptions, their events and faults.

They are handles below the classes `Publisher` and `Subscription` of rclpy, each of which the
executor would check whenever it wakes up.
"""

# rclpy has few types, and type checks of generated code include this module.
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
    warn_of_unknown,
)
from .taking import Subscription
from .values import is_of_any_size
from .waiting import Listener, NoListenerError, WaitSets

TakeState = Callable[[Any], None]  # called with the state of an event


def matched_event(subscription: Any) -> Any:
    """Returns the event of a subscription for publishers that come and go."""
    with subscription:
        return internals.EventHandle(
            subscription, QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED
        )


def publisher_events(
    handle: Any, health: EndpointHealth, matched: TakeState
) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields the events of a publisher, and the function that reads each."""
    kinds = QoSPublisherEventType
    yield from _event(handle, kinds.RCL_PUBLISHER_MATCHED, matched)
    yield from _event(handle, kinds.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS, _incompatible(health))
    # Only events that may come, as waiting for each one costs time.
    if health.qos.deadline > 0:
        missed = _if_more(health.note_missed_deadline)
        yield from _event(handle, kinds.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED, missed)
    if health.qos.lease_duration > 0:
        lost = _if_more(health.note_lost_liveliness)
        yield from _event(handle, kinds.RCL_PUBLISHER_LIVELINESS_LOST, lost)


def subscription_events(
    handle: Any, health: EndpointHealth
) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields the events of a subscription, and the function that reads each."""

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
        missed = _if_more(health.note_missed_deadline)
        yield from _event(handle, kinds.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED, missed)
    if health.qos.lease_duration > 0:
        yield from _event(handle, kinds.RCL_SUBSCRIPTION_LIVELINESS_CHANGED, liveliness)


def _event(handle: Any, kind: Any, take: TakeState) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yields one event; none if the middleware does not support it."""
    try:
        with handle:
            event = internals.EventHandle(handle, kind)
    except UnsupportedEventTypeError:
        return

    def read() -> None:
        state = event.take_event()
        if state is not None:
            take(state)

    yield event, read


def _if_more(note: Callable[[], None]) -> TakeState:
    """Returns a function that calls `note` if the event has happened since the last read."""

    def take(state: Any) -> None:
        if state.total_count_change > 0:
            note()

    return take


def _incompatible(health: EndpointHealth) -> TakeState:
    def take(state: Any) -> None:
        if state.total_count_change > 0:
            health.note_incompatible(str(qos_policy_name_from_kind(state.last_policy_kind)))

    return take


class NodePublisher:
    """A publisher for serialized messages; `publish` is the function of rclpy itself."""

    __slots__ = ("handle", "matched", "publish", "published", "unmatched")

    def __init__(self, handle: Any, published: Published) -> None:
        self.handle = handle
        self.published = published
        self.publish: Callable[[bytes], None] = handle.publish_raw
        self.matched = 0
        self.unmatched = 0

    @property
    def address(self) -> int:
        """Address of the publisher in rcl."""
        return int(self.handle.pointer)


WaitingName = Literal["automatic", "listener", "wait-set"]  # how the bridge waits for ROS


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
        """Makes no topics yet.

        Args:
            waiting: `automatic` uses a listener where the middleware supports it.
            age_limit: Nanoseconds after which a waiting message is too old; 0 means never.
        """
        self._node = node
        self._parameters = parameters
        self._age_limit = age_limit
        self._health: dict[tuple[Topic, bool], EndpointHealth] = {}
        self._numbers: Counter[tuple[str, bool]] = Counter()  # of publishers or subscriptions
        self._publishers: list[Any] = []
        self._subscriptions: list[Any] = []
        self._events: list[Any] = []
        self._waiting = self._choose_waiting(waiting, context, loop)

    def publisher(
        self, ros_type: type[Any], topic: Topic, on_match: Callable[[], None] | None = None
    ) -> NodePublisher:
        """Makes a publisher; `on_match` is called for each subscriber that is found."""
        rclpy_class = message_class(ros_type)
        health = self._new_health(topic, topic.qos, publishes=True)
        health.qos = never_waiting(health.qos)
        handle = self._new_handle(internals.Publisher, rclpy_class, topic, health)
        self._publishers.append(handle)
        self._watch_types(health, rclpy_class, handle.get_subscription_count)
        published = Published(health.topic, _type_name(rclpy_class), health.qos)
        publisher = NodePublisher(handle, published)

        def matched(state: Any) -> None:
            publisher.matched = state.current_count
            if state.current_count_change > 0 and on_match is not None:
                on_match()

        self._wait_for(publisher_events(handle, health, matched))
        return publisher

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription, whose messages are taken after `listen`; returns its counts."""
        rclpy_class, counts = message_class(ros_type), TopicCounts()
        health = self._new_health(topic, deep_enough(topic.qos), publishes=False)
        handle = self._new_handle(internals.Subscription, rclpy_class, topic, health)
        self._subscriptions.append(handle)
        self._watch_types(health, rclpy_class, handle.get_publisher_count)
        health.counts = counts if is_of_any_size(rclpy_class) else None
        qos = health.qos
        # A latched message may have any age.
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
        """Returns the faults of a topic; where `alone`, a second publisher is one."""
        return self._health[topic, publishes].faults(alone=alone)

    def _new_health(self, topic: Topic, qos: Qos, *, publishes: bool) -> EndpointHealth:
        """Returns the health of a new publisher or subscription, with its QoS after overrides."""
        with as_parameter_error(f"topic {topic.name!a}: "):
            name = self._node.resolve_topic_name(topic.name)
        find = self._finder(publishes=publishes)
        number = self._numbers[name, publishes] = self._numbers[name, publishes] + 1
        suffix = f"_{number}" if number > 1 else ""
        entity = ("publisher" if publishes else "subscription") + suffix

        def others() -> list[tuple[str, Qos]]:
            return [(_node_name(endpoint), qos_of(endpoint.qos_profile)) for endpoint in find(name)]

        health = EndpointHealth(publishes, name, qos, entity, others)
        health.qos = overridden(health, self._parameters.overrides, self._parameters.declare)
        self._health[topic, publishes] = health
        return health

    def _watch_types(
        self, health: EndpointHealth, rclpy_class: type[Any], count: Callable[[], int]
    ) -> None:
        """Sets how a health counts its opposite ends, and finds those with another type."""
        find, own = self._finder(publishes=health.publishes), _type_name(rclpy_class)

        def strangers() -> list[tuple[str, str]]:
            if count():
                return []
            ends = find(health.topic)
            return [(_node_name(end), end.topic_type) for end in ends if end.topic_type != own]

        health.strangers, health.count = strangers, count

    def _finder(self, *, publishes: bool) -> Callable[[str], list[Any]]:
        """Returns the function that finds the opposite ends of a topic by its full name."""
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
        """Begins to take messages; `fail` is called with the error that ends a thread."""
        possible = (
            endpoint_health.parameter(policy)
            for endpoint_health in self._health.values()
            for policy in OVERRIDABLE
        )
        warn_of_unknown(self._node, possible)
        self._waiting.start(fail)

    def wait(self, deadline: float) -> None:
        """Waits until subscribers have the published messages, or until a steady time."""
        for publisher in self._publishers:
            left = Duration(seconds=max(deadline - time.monotonic(), 0.0))
            publisher.wait_for_all_acked(left.get_c_duration())

    def destroy(self) -> None:
        """Destroys all topics; called on the thread of the executor, or after its end."""
        self._waiting.close()
        for handle in (*self._events, *self._subscriptions, *self._publishers):
            handle.destroy_when_not_in_use()

    # ------------------------------------------------------------------ waiting

    def _choose_waiting(
        self, waiting: WaitingName, context: Any, loop: Loop
    ) -> Listener | WaitSets:
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
        """Returns a listener after a trial; raises NoListenerError if it does not work."""
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
