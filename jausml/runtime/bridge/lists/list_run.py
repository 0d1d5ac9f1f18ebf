"""Execution of the elements of one goal by a JAUS peer (`Run`), here as a list (`ListRun`).

AS6009 has no message that ends the execution of a list. Two together do: ExecuteList without an
element and with speed 0, by which the vehicle stops ("modifies the travel speed"), and
DeleteElement of all elements (AS5710, ListManager). No message says how a list has ended either:
the active element is 0 after any end. So a list has succeeded if its last element was active
before; peers with command events (AS5710 v1.1) also report a failure.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, Protocol

from ...base.address import JausAddress
from ...base.clocks import Alarm
from ...clients.command_client import CommandClient, PendingCommand
from ...clients.event_client import EventClient
from ...clients.event_subscription import EventSubscription
from ...clients.list_client import ListClient, ListRequest, deletion, replacement
from ...clients.query import QueryClient
from ...services.host import Host
from ...services.list_manager import ALL_UIDS, NO_UID, chain
from ...wire.message import Message
from ..connections.controlled_peers import RepeatedStops
from ..ends.actions import Outcome
from ..ends.list_driver import ListMessages

RETRIES = 3  # repetitions of a request without an answer; all of them fit into the timeout

QUERY_RETRIES = 7  # repetitions of a query of the state, which may be lost more often
GREATEST_UID = 60000  # after which UIDs begin anew
PATIENCE = 3  # timeouts within which a peer must begin the execution


class StopResult(Protocol):
    """Callback for the result of a stop."""

    def __call__(self, code: int | None, *, confirmed: bool) -> None:
        """Takes whether the peer has confirmed the stop, or the code with which it refused."""


class RunWatcher(Protocol):
    """Callbacks for the progress of a run: on the loop, with its lock."""

    def reached(self, run: Run, index: int) -> None:
        """The element of an index is active."""

    def ended(self, run: Run, outcome: Outcome, reason: str) -> None:
        """The run has ended; this is the last call."""


class Run:
    """Execution of elements by a peer. Everything runs on the loop, or with its lock."""

    noun: str  # `list` or `mission`, for logs

    def __init__(
        self,
        component: Host,
        peer: JausAddress,
        watcher: RunWatcher,
        timeout: float,
        stops: RepeatedStops,
    ) -> None:
        """Sends nothing before `start`; the peer must answer within the timeout in seconds."""
        self.peer = peer
        self._component = component
        self._watcher = watcher
        self._timeout = timeout
        self._stops = stops
        self._uids: list[int] = []
        self._last = -1  # index of the element that was active last
        self.has_ended = self._is_stopping = False
        self._begun = 0.0  # time of the command to begin
        self._poll = Alarm(component.loop)

    # ------------------------------------------------------------------ for the kinds

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:
        """Sends the elements to the peer, then the command to execute them.

        Args:
            payloads: The encoded elements.
            first: UID of the first element; the others follow it. UIDs other than those of the
                former run tell its late reports apart.
            speed: Metres per second, for a peer with a speed.
        """
        raise NotImplementedError

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may still execute these elements, or those before, after their end."""
        raise NotImplementedError

    @property
    def remains(self) -> bool:
        """Whether the next run of the peer has to replace this one."""
        return self.may_go_on

    def send_stop(self, on_result: StopResult | None = None) -> None:
        """Commands the peer to stop for good; `on_result` is called with its answer."""
        raise NotImplementedError

    def take_report(self, report: Any) -> None:
        """Takes a report of the peer, solicited or not."""
        raise NotImplementedError

    def is_of(self, watcher: RunWatcher) -> bool:
        """Returns whether it is a run of this connection."""
        return self._watcher is watcher

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns the periodic queries and their reports; the peer must answer the first one."""
        raise NotImplementedError

    # ------------------------------------------------------------------ end

    def leave(self, outcome: Outcome, reason: str) -> None:
        """Ends the run without a stop: another run replaces it, or the peer has gone."""
        self._end(outcome, reason)

    def stop(self, outcome: Outcome, reason: str) -> None:
        """Stops the peer; the run ends when the peer has answered."""
        if self._is_stopping or self.has_ended:
            return
        self._is_stopping = True
        self._drop_requests()

        def settled(code: int | None, *, confirmed: bool) -> None:
            answer = "did not confirm it" if code is None else f"refused it with code {code}"
            if confirmed:
                self._end(outcome, reason)
            else:
                why = f"{reason}; {self.peer} should have stopped and {answer}"
                self._end(Outcome.ABORTED, why)

        self.send_stop(settled)

    def _give_up(self, reason: str) -> None:
        """Ends the run, and sends a stop whose answer is not awaited."""
        self.send_stop()
        self._end(Outcome.ABORTED, reason)

    def _refused(self, code: int | None) -> None:
        answer = "does not answer" if code is None else f"refuses the {self.noun} with code {code}"
        if self.may_go_on:
            self._give_up(f"{self.peer} {answer}")
        else:
            self._end(Outcome.ABORTED, f"{self.peer} {answer}")

    def _end(self, outcome: Outcome, reason: str) -> None:
        if self.has_ended:
            return
        self.has_ended = True
        self._drop_requests()
        self._watcher.ended(self, outcome, reason)

    def _drop_requests(self) -> None:
        self._poll.cancel()

    # ------------------------------------------------------------------ progress

    @property
    def _pause(self) -> float:
        """Seconds before a request is repeated."""
        return self._timeout / (RETRIES + 1)

    @property
    def _is_late(self) -> bool:
        return self._component.loop.now() - self._begun > PATIENCE * self._timeout

    def _ask(self) -> None:
        """Queries the state periodically: events may be lost, and the peer may fail."""
        on_failure: Any = self._silent
        for query, report in self._queries():
            self._component.part(QueryClient).ask(
                self.peer,
                query,
                report,
                lambda answer, _sender: self.take_report(answer),
                on_failure=on_failure,
                timeout=self._timeout / (QUERY_RETRIES + 1),
                retries=QUERY_RETRIES,
            )
            on_failure = None
        self._poll.set(self._timeout, self._ask)

    def _silent(self) -> None:
        if not (self.has_ended or self._is_stopping):
            self._give_up(f"{self.peer} is silent")

    def _reach(self, index: int) -> None:
        if index != self._last:
            self._last = index
            self._watcher.reached(self, index)


class Runs:
    """The last run of each peer, whichever connection of a bridge it is of.

    A peer has one list, so that the goal of one connection takes the place of that of another.
    """

    def __init__(self, first: int) -> None:
        """Has no run yet; `first` is the UID of the first element."""
        self._next = first
        self._latest: dict[JausAddress, Run] = {}

    def of(self, peer: JausAddress) -> Run | None:
        """Returns the last run of a peer."""
        return self._latest.get(peer)

    def add(self, run: Run) -> None:
        """Takes a run for the last one of its peer; forgets those of which nothing is left."""
        latest = self._latest.items()
        kept = {peer: former for peer, former in latest if former.remains or not former.has_ended}
        self._latest = {**kept, run.peer: run}

    def next_uids(self, count: int) -> int:
        """Returns the first of so many UIDs; those of runs before it are others."""
        first = self._next if self._next + count <= GREATEST_UID else 1
        self._next = first + count
        return first


def list_runs(_component: Host) -> Runs:
    """Returns the runs of lists of a component, as a part of it."""
    return Runs(1)


LONGEST_LIST = 30 * 24 * 3600  # seconds for a list in a command event: a month, as no limit


class ListRun(Run):
    """A list that a peer executes."""

    noun = "list"

    def __init__(
        self,
        component: Host,
        peer: JausAddress,
        messages: ListMessages,
        watcher: RunWatcher,
        timeout: float,
        stops: RepeatedStops,
        former: Run | None = None,
    ) -> None:
        """Sends nothing before `start`, which replaces the former list of the peer."""
        super().__init__(component, peer, watcher, timeout, stops)
        self._messages = messages
        self._is_followed = former is not None and former.may_go_on
        self._has_stopped = self._is_empty = False
        self._speed = 0.0
        self._request: ListRequest | None = None
        self._events: EventSubscription | None = None
        self._command: PendingCommand | None = None

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:
        """Sets the list of the peer, then commands its execution."""
        self._uids = list(range(first, first + len(payloads)))
        self._speed = speed
        contents = ((uid, data, 0) for uid, data in zip(self._uids, payloads, strict=True))
        self._request = self._component.part(ListClient).change(
            self.peer,
            replacement(list(chain(contents))),
            on_done=self._execute,
            on_refused=self._refused,
            timeout=self._pause,
            retries=RETRIES,
        )

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may still execute these elements, or those before, after their end."""
        return self._is_followed and not (self._has_stopped and self._is_empty)

    def send_stop(self, on_result: StopResult | None = None) -> None:
        """Stops the vehicle, if the driver has a speed, and empties the list."""
        component, execute = self._component, self._messages.execute
        if "speed" in _fields_of(execute):
            stop: Any = execute
            component.transport.send(
                component.address,
                self.peer,
                stop(speed=0.0).encode(),
                acknowledge=True,
                on_result=self._stop_sent,
                supersedes=True,
            )
        else:
            self._has_stopped = True

        def emptied(code: int | None = None, *, confirmed: bool = False) -> None:
            self._is_empty = self._is_empty or confirmed or code is not None
            self._stops.sent(self.peer, not self.may_go_on)
            if on_result is not None:
                on_result(code, confirmed=confirmed)

        component.part(ListClient).change(
            self.peer,
            [deletion([ALL_UIDS])],
            on_done=partial(emptied, confirmed=True),
            on_refused=emptied,
            timeout=self._pause,
            retries=RETRIES,
        )

    def _stop_sent(self, acknowledged: bool) -> None:  # noqa: FBT001 - as transports call it
        self._has_stopped = self._has_stopped or self._stops.has_arrived(self.peer, acknowledged)

    # ------------------------------------------------------------------ answers of the peer

    def _execute(self) -> None:
        component, messages = self._component, self._messages
        self._is_followed = True
        self._events = component.part(EventClient).subscribe(
            self.peer,
            messages.query(),
            messages.report,
            lambda report, _sender: self.take_report(report),
        )
        self._begun = component.loop.now()
        # A peer of core v1.0 has no command events, and executes the plain command.
        self._command = component.part(CommandClient).command(
            self.peer,
            self._execute_message(),
            on_done=self._command_done,
            on_refused=lambda _code, _text: component.send(
                self._execute_message(), self.peer, acknowledge=True
            ),
            max_duration=LONGEST_LIST,
            timeout=self._timeout,
        )
        self._ask()

    def _execute_message(self) -> Message:
        execute: Any = self._messages.execute
        speed = {"speed": self._speed} if "speed" in _fields_of(execute) else {}
        message: Message = execute(element_uid=self._uids[0], **speed)
        return message

    def _command_done(self, succeeded: bool) -> None:  # noqa: FBT001 - as the client calls it
        if not succeeded and not self._is_stopping:
            self._is_followed = False
            self._end(Outcome.ABORTED, f"{self.peer} could not do it")

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns the query of the active element."""
        return [(self._messages.query(), self._messages.report)]

    def take_report(self, report: Any) -> None:
        """Takes the report of the active element."""
        if self.has_ended or self._is_stopping:
            return
        uid = report.element_uid
        if uid in self._uids:
            self._reach(self._uids.index(uid))
        elif self._last >= 0:
            self._end_at(uid)
        elif self._is_late:
            self._give_up(f"{self.peer} does not execute the list")

    def _end_at(self, uid: int) -> None:
        last, count = self._last + 1, len(self._uids)
        self._is_followed = False
        if uid != NO_UID:
            self._end(Outcome.ABORTED, f"{self.peer} executes another list")
        elif last == count:
            self._end(Outcome.SUCCEEDED, "")
        else:
            self._end(Outcome.ABORTED, f"{self.peer} stopped at element {last} of {count}")

    def _drop_requests(self) -> None:
        super()._drop_requests()
        for exchange in (self._request, self._events, self._command):
            if exchange is not None:
                exchange.cancel()
        self._request = self._events = self._command = None


def _fields_of(message: type[Message]) -> frozenset[str]:
    return frozenset(getattr(message, "__dataclass_fields__", ()))
