"""What a component knows of its control over another one, and how it learns that (AS5710)."""

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
    """What a component knows of its control over another one."""

    SEEKING = "seeking"  # the target does not answer, or control was lost; it is requested
    CONTROLLED = "controlled"  # the target is controlled, and not (yet) Ready
    READY = "ready"  # the target is controlled and obeys every command
    REFUSED = "refused"
    """The target is not available or has a controller of the same or higher authority."""


class Session(Protocol):
    """One user's share, as the control sees it."""

    authority: int
    resume: bool

    def changed(self) -> None:
        """Learns that the state is another one."""


class Releases:
    """Gives control back, and knows to whom that was not acknowledged yet.

    The transport repeats a ReleaseControl until it is acknowledged. A repetition that comes after
    a new request ends the control which that request has brought, so requests wait for it.
    """

    def __init__(self, component: Host, on_done: Callable[[JausAddress], None]) -> None:
        """Has nothing under way; `on_done` is told each target to which nothing is any more."""
        self._component = component
        self._on_done = on_done
        self._under_way: dict[JausAddress, int] = {}

    def are_under_way(self, target: JausAddress) -> bool:
        """Returns whether a target may still take a release that was sent."""
        return target in self._under_way

    def send(self, target: JausAddress, *, acknowledge: bool) -> None:
        """Sends ReleaseControl, which may be repeated until it is acknowledged."""
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
        left = self._under_way.pop(target) - 1
        if left:
            self._under_way[target] = left
        else:
            self._on_done(target)


class Questions:
    """Questions to a target by their kind: which are open, and how often each was asked in vain."""

    def __init__(self, component: Host, target: JausAddress) -> None:
        self._component = component
        self._target = target
        self._presence = component.part(Presence)
        self._open: set[type[Message]] = set()
        self._tries: dict[type[Message], int] = {}

    @property
    def urgent(self) -> list[type[Message]]:
        """The open questions that were not asked in vain too often."""
        return [kind for kind in self._open if self.are_worth(kind)]

    def are_worth(self, kind: type[Message]) -> bool:
        """Returns whether a question was not asked in vain too often."""
        return self._tries.get(kind, 0) < QUICK_TRIES

    def ask(self, question: Message) -> None:
        """Sends a question; it is open until it is answered or closed."""
        kind = type(question)
        self._open.add(kind)
        self._tries[kind] = self._tries.get(kind, 0) + 1
        self.send(question)

    def answered(self, kind: type[Message]) -> bool:
        """Takes a question off the list; returns whether it was the last one that is worth asking.

        One that was asked in vain too often does not keep the others from their pace.
        """
        self._tries[kind] = 0
        if kind not in self._open:
            return False
        self._open.discard(kind)
        return not self.urgent

    def go_on(self, kind: type[Message]) -> None:
        """Keeps a question open that was answered, though not as wanted."""
        self._tries[kind] = 0

    def close(self) -> None:
        """Waits for no answer any more."""
        self._open.clear()

    def forget(self) -> None:
        """Begins anew: nothing is open, and nothing was asked in vain."""
        self._open.clear()
        self._tries.clear()

    def send(self, message: Message) -> None:
        """Sends a message.

        The transport repeats commands until they are acknowledged, as long as anyone may be there;
        of a question that is asked again and again, the first one. The others would wait for each
        other where the way is long.
        """
        is_first = self._tries.get(type(message), 0) <= 1
        is_command = not message.NAME.startswith("Query")
        acknowledge = is_command and is_first and self.are_hopeful
        self._component.send(message, self._target, acknowledge=acknowledge)

    @property
    def are_hopeful(self) -> bool:
        """Whether anybody may be there to acknowledge."""
        is_new = self._tries.get(RequestControl, 0) <= QUICK_TRIES
        return is_new or self._presence.heard_lately(self._target)


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
        self, component: Host, target: JausAddress, take: Callable[[Message], None]
    ) -> None:
        self._component = component
        self._events = component.part(EventClient)
        self._target = target
        self._take = take
        self._subscriptions: list[EventSubscription] = []
        self._timer = Alarm(component.loop)

    def start(self) -> None:
        """Subscribes, unless that was done."""
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
        """Has all events of the target renewed.

        One that has lost its controller, or does not obey it any more, may have been restarted.
        """
        self._events.suspect(self._target)

    def stop(self) -> None:
        """Cancels the events."""
        self._timer.cancel()
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            subscription.cancel()

    def _give_up(self) -> None:
        """Asks no longer for events that the target does not know; it may do so when restarted."""
        if not any(subscription.active for subscription in self._subscriptions):
            self.stop()
