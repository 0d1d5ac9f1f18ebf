"""Parts of a controlled target: its states, releases, open queries and events (AS5710)."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from functools import partial
from typing import Protocol

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..messages import (
    QueryControl,
    QueryStatus,
    ReleaseControl,
    ReportControl,
    ReportStatus,
    RequestControl,
)
from ..services.host import Host
from ..wire.message import Message
from .event_client import EventClient
from .event_subscription import EventSubscription
from .pace import QUICK_TRIES
from .presence import Presence


class ControlState(Enum):
    """The state of control over a target, as far as the controlling component knows."""

    SEEKING = "seeking"  # the target does not answer, or control was lost; it is requested
    CONTROLLED = "controlled"  # the target is controlled, and not (yet) Ready
    READY = "ready"  # the target is controlled and obeys every command
    # The target is not available, or its controller has the same or a higher authority.
    REFUSED = "refused"


class Session(Protocol):
    """One user of a controlled target."""

    authority: int
    resume: bool

    def changed(self) -> None:
        """Called when the state of control has changed."""


class Releases:
    """Sends ReleaseControl, and knows the targets that have not acknowledged it yet.

    The transport repeats a ReleaseControl until it is acknowledged. A repetition that arrives after
    a new request would end the control just granted, so requests wait for the acknowledgement.
    """

    def __init__(self, component: Host, on_done: Callable[[JausAddress], None]) -> None:
        """Calls `on_done` with a target once no release to it is under way any more."""
        self._component = component
        self._on_done = on_done
        self._under_way: dict[JausAddress, int] = {}

    def are_under_way(self, target: JausAddress) -> bool:
        """Returns whether a release to a target is neither acknowledged nor given up."""
        return target in self._under_way

    def send(self, target: JausAddress, *, acknowledge: bool) -> None:
        """Sends ReleaseControl; `acknowledge` has it repeated until it is acknowledged."""
        if not acknowledge:
            self._component.send(ReleaseControl(), target)
            return
        self._under_way[target] = self._under_way.get(target, 0) + 1
        self._component.transport.send(
            self._component.address,
            target,
            ReleaseControl().encode(),
            acknowledge=True,
            on_result=partial(self._ended, target),
        )

    def _ended(self, target: JausAddress, _acknowledged: bool) -> None:  # noqa: FBT001
        remaining = self._under_way.pop(target) - 1
        if remaining:
            self._under_way[target] = remaining
        else:
            self._on_done(target)


class Questions:
    """Queries and requests to a target by class: the unanswered ones, and their vain tries."""

    def __init__(self, component: Host, target: JausAddress) -> None:
        self._component = component
        self._target = target
        self._presence = component.part(Presence)
        self._open: set[type[Message]] = set()
        self._tries: dict[type[Message], int] = {}

    @property
    def urgent(self) -> list[type[Message]]:
        """The open questions with less than `QUICK_TRIES` vain tries."""
        return [kind for kind in self._open if self.are_worth(kind)]

    def are_worth(self, kind: type[Message]) -> bool:
        """Returns whether a question has less than `QUICK_TRIES` vain tries."""
        return self._tries.get(kind, 0) < QUICK_TRIES

    def ask(self, question: Message) -> None:
        """Sends a question; it is open until it is answered or closed."""
        kind = type(question)
        self._open.add(kind)
        self._tries[kind] = self._tries.get(kind, 0) + 1
        self.send(question)

    def answered(self, kind: type[Message]) -> bool:
        """Closes a question; returns whether it was open and no urgent one is left."""
        self._tries[kind] = 0
        if kind not in self._open:
            return False
        self._open.discard(kind)
        return not self.urgent

    def go_on(self, kind: type[Message]) -> None:
        """Keeps a question open after an unwanted answer, and forgets its vain tries."""
        self._tries[kind] = 0

    def close(self) -> None:
        """Closes all questions."""
        self._open.clear()

    def forget(self) -> None:
        """Closes all questions, and forgets their vain tries."""
        self._open.clear()
        self._tries.clear()

    def send(self, message: Message) -> None:
        """Sends a message.

        The first try of a command is repeated until it is acknowledged, if the target may be there.
        Later tries are not: over a slow network they would wait for each other.
        """
        is_first = self._tries.get(type(message), 0) <= 1
        is_command = not message.NAME.startswith("Query")
        acknowledge = is_command and is_first and self.are_hopeful
        self._component.send(message, self._target, acknowledge=acknowledge)

    @property
    def are_hopeful(self) -> bool:
        """Whether the target may be there to acknowledge."""
        is_new = self._tries.get(RequestControl, 0) <= QUICK_TRIES
        return is_new or self._presence.heard_lately(self._target)


# Seconds after which a component that confirms no event is taken for one without Events.
PATIENCE = 5.0

_WATCHED: tuple[tuple[type[Message], type[Message]], ...] = (
    (QueryStatus, ReportStatus),
    (QueryControl, ReportControl),
)


class TargetWatch:
    """Subscribes to every change of a component's state and of its controller.

    So its controller learns at once when it leaves Ready by itself. A component without the
    service Events is only queried now and then, by `ControlledTarget`.
    """

    def __init__(
        self, component: Host, target: JausAddress, take: Callable[[Message], None]
    ) -> None:
        self._component = component
        self._events = component.part(EventClient)
        self._target = target
        self._take = take
        self._subscriptions: list[EventSubscription] = []
        self._timer = Alarm(component.loop)

    def start(self) -> None:
        """Subscribes, unless subscribed already."""
        if self._subscriptions:
            return
        self._subscriptions = [
            self._events.subscribe(
                self._target, query(), report_class, lambda report, _: self._take(report)
            )
            for query, report_class in _WATCHED
        ]
        self._timer.set(PATIENCE, self._give_up)

    def verify(self) -> None:
        """Renews all events of the target, which may have been restarted."""
        self._events.suspect(self._target)

    def stop(self) -> None:
        """Cancels the events."""
        self._timer.cancel()
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            subscription.cancel()

    def _give_up(self) -> None:
        """Unsubscribes from a target that has confirmed no event."""
        if not any(subscription.active for subscription in self._subscriptions):
            self.stop()
