"""Events by which a controlled component tells what becomes of it (AS5710, Events)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..messages import QueryControl, QueryStatus, ReportControl, ReportStatus

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Timer
    from ..services.host import Host
    from ..wire.message import Message
    from .event_client import EventClient
    from .event_subscription import EventSubscription

PATIENCE = 5.0
"""Seconds after which a component that confirms no event is taken for one without Events."""

_WATCHED: tuple[tuple[type[Message], type[Message]], ...] = (
    (QueryStatus, ReportStatus),
    (QueryControl, ReportControl),
)


class TargetWatch:
    """Subscribes to every change of a component's state and of its controller.

    What a component does by itself, such as leaving Ready, is known at once so. A component without
    Events is asked now and then all the same, by who controls it.
    """

    def __init__(
        self,
        component: Host,
        events: EventClient,
        target: JausAddress,
        take: Callable[[Message], None],
    ) -> None:
        """Prepare; nothing is asked before ``start``."""
        self._component = component
        self._events = events
        self._target = target
        self._take = take
        self._subscriptions: list[EventSubscription] = []
        self._timer: Timer | None = None

    def start(self) -> None:
        """Subscribe, unless that was done."""
        if self._subscriptions:
            return
        self._subscriptions = [
            self._events.subscribe(self._target, query(), report, self._report, None, 0.0, None)
            for query, report in _WATCHED
        ]
        self._timer = self._component.loop.call_later(PATIENCE, self._give_up)

    def verify(self) -> None:
        """Have all events of the target renewed.

        One that has lost its controller, or does not obey it any more, may have been restarted.
        """
        self._events.suspect(self._target)

    def stop(self) -> None:
        """Cancel the events."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            subscription.cancel()

    def _report(self, report: Any, _provider: JausAddress) -> None:
        self._take(report)

    def _give_up(self) -> None:
        """Ask no longer for events that the target does not know; it may do so when restarted."""
        self._timer = None
        if not any(each.active for each in self._subscriptions):
            self.stop()
