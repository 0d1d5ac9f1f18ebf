"""What ROS tells of publishers and subscriptions: who is there, who does not fit."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.event_handler import (
    QoSPublisherEventType,
    QoSSubscriptionEventType,
    UnsupportedEventTypeError,
)
from rclpy.qos import qos_policy_name_from_kind

from .internals import internals

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ..ends.quality import EndpointHealth

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
    found = _incompatible(health)
    yield from _event(handle, kinds.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS, found)
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
