"""What the bridge has a JAUS peer execute for a goal, and one list, from setting it to its end.

AS6009 has no message that ends the execution of a list. Two together do, and leave nothing that
could go on: ExecuteList without an element and with speed 0, by which the vehicle stands ("modifies
the travel speed"), and DeleteElement of all elements (AS5710, ListManager). How a list has ended is
not said either: the active element is 0 after an end of any kind. So a list is done when its last
element was active before that; peers with command events (AS5710 v1.1) tell of a failure besides.
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

ASKED_AGAIN = 7
"""Repetitions of the question how it goes. Of eight, one comes through where a fifth is lost."""

PATIENCE = 3  # timeouts in which a peer must begin


class Settled(Protocol):
    """Whoever is told whether a peer has stopped for good; the code is that of a refusal."""

    def __call__(self, code: int | None, *, confirmed: bool) -> None:
        """Takes it."""


class RunWatcher(Protocol):
    """Whoever is told how a run goes on: on the loop, with its lock."""

    def reached(self, run: Run, index: int) -> None:
        """An element is active, from 0."""

    def ended(self, run: Run, outcome: Outcome, reason: str) -> None:
        """The elements are not executed any more."""


class Run:
    """Elements that a peer executes. All of it happens on the loop, or with its lock."""

    noun: str  # what the peer has of them, in words

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
        self._has_ended = self._is_stopping = False
        self._begun = 0.0  # when the peer was told to begin
        self._poll = Alarm(component.loop)

    # ------------------------------------------------------------------ what the kinds say

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:
        """Gives the elements to the peer, and then has them executed.

        Args:
            first: UID of the first one; the others follow it. UIDs that the former run had not
                keep late words about that one apart.
            speed: Metres per second, for peers that are told one.
        """
        raise NotImplementedError

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may follow it, or the one before, whatever was told of its end."""
        raise NotImplementedError

    @property
    def remains(self) -> bool:
        """Whether the next one of the peer has to do with it."""
        return self.may_go_on

    def send_stop(self, on_settled: Settled | None = None) -> None:
        """Has the peer stand, and not go on by itself; tells whether it is so, or why not."""
        raise NotImplementedError

    def heard(self, report: Any) -> None:
        """Takes a report of the peer, asked for or not."""
        raise NotImplementedError

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns what the peer is asked again and again; the first one it must answer."""
        raise NotImplementedError

    # ------------------------------------------------------------------ how it ends

    def leave(self, outcome: Outcome, reason: str) -> None:
        """Ends it without a word to the peer: another one takes its place, or it is gone."""
        self._end(outcome, reason)

    def stop(self, outcome: Outcome, reason: str) -> None:
        """Has the peer stop, and ends when that is confirmed."""
        if self._is_stopping or self._has_ended:
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
        """Ends it at a peer that may go on with it, and that may not hear of that."""
        self.send_stop()
        self._end(Outcome.ABORTED, reason)

    def _refused(self, code: int | None) -> None:
        answer = "does not answer" if code is None else f"refuses the {self.noun} with code {code}"
        if self.may_go_on:
            self._give_up(f"{self.peer} {answer}")
        else:
            self._end(Outcome.ABORTED, f"{self.peer} {answer}")

    def _end(self, outcome: Outcome, reason: str) -> None:
        if self._has_ended:
            return
        self._has_ended = True
        self._drop_requests()
        self._watcher.ended(self, outcome, reason)

    def _drop_requests(self) -> None:
        self._poll.cancel()

    # ------------------------------------------------------------------ how it is followed

    @property
    def _pause(self) -> float:
        """Seconds before a question is repeated."""
        return self._timeout / (RETRIES + 1)

    @property
    def _is_late(self) -> bool:
        return self._component.loop.now() - self._begun > PATIENCE * self._timeout

    def _ask(self) -> None:
        """Asks how it goes: what a peer tells by itself may be lost, and the peer may die."""
        on_failure: Any = self._silent
        for query, report in self._queries():
            self._component.part(QueryClient).ask(
                self.peer,
                query,
                report,
                lambda answer, _sender: self.heard(answer),
                on_failure=on_failure,
                timeout=self._timeout / (ASKED_AGAIN + 1),
                retries=ASKED_AGAIN,
            )
            on_failure = None
        self._poll.set(self._timeout, self._ask)

    def _silent(self) -> None:
        if not (self._has_ended or self._is_stopping):
            self._give_up(f"{self.peer} is silent")

    def _reach(self, index: int) -> None:
        if index != self._last:
            self._last = index
            self._watcher.reached(self, index)


LONGEST_LIST = 30 * 24 * 3600
"""Seconds that a peer is given for a list: a month, which is to say as long as it takes."""


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
        """Sends nothing before `start`, which replaces what the peer executed last."""
        super().__init__(component, peer, watcher, timeout, stops)
        self._messages = messages
        self._is_followed = former is not None and former.may_go_on
        self._stands = self._is_empty = False
        self._speed = 0.0
        self._request: ListRequest | None = None
        self._events: EventSubscription | None = None
        self._command: PendingCommand | None = None

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:
        """Sets the list of the peer, and then has it executed."""
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
        """Whether the peer may follow it, or the one before, whatever was told of its end."""
        return self._is_followed and not (self._stands and self._is_empty)

    def send_stop(self, on_settled: Settled | None = None) -> None:
        """Makes the vehicle stand, and the list empty; some drivers know no speed."""
        component, execute = self._component, self._messages.execute
        if "speed" in _fields_of(execute):
            stop: Any = execute
            component.transport.send(
                component.address,
                self.peer,
                stop(speed=0.0).encode(),
                acknowledge=True,
                on_result=self._stood,
                supersedes=True,
            )
        else:
            self._stands = True

        def settled(code: int | None = None, *, confirmed: bool = False) -> None:
            self._is_empty = self._is_empty or confirmed or code is not None
            self._stops.sent(self.peer, not self.may_go_on)
            if on_settled is not None:
                on_settled(code, confirmed=confirmed)

        component.part(ListClient).change(
            self.peer,
            [deletion([ALL_UIDS])],
            on_done=partial(settled, confirmed=True),
            on_refused=settled,
            timeout=self._pause,
            retries=RETRIES,
        )

    def _stood(self, acknowledged: bool) -> None:  # noqa: FBT001 - as transports tell
        self._stands = self._stands or self._stops.has_arrived(self.peer, acknowledged)

    # ------------------------------------------------------------------ answers of the peer

    def _execute(self) -> None:
        component, messages = self._component, self._messages
        self._is_followed = True
        self._events = component.part(EventClient).subscribe(
            self.peer, messages.query(), messages.report, lambda report, _sender: self.heard(report)
        )
        self._begun = component.loop.now()
        # A peer of core v1.0 knows no command events, and executes the plain command.
        self._command = component.part(CommandClient).command(
            self.peer,
            self._execution(),
            on_done=self._command_done,
            on_refused=lambda _code, _text: component.send(
                self._execution(), self.peer, acknowledge=True
            ),
            max_duration=LONGEST_LIST,
            timeout=self._timeout,
        )
        self._ask()

    def _execution(self) -> Message:
        execute: Any = self._messages.execute
        own = {"speed": self._speed} if "speed" in _fields_of(execute) else {}
        message: Message = execute(element_uid=self._uids[0], **own)
        return message

    def _command_done(self, succeeded: bool) -> None:  # noqa: FBT001 - as the client calls it
        if not succeeded and not self._is_stopping:
            self._is_followed = False
            self._end(Outcome.ABORTED, f"{self.peer} could not do it")

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns the query of the active element: events may be refused or lost."""
        return [(self._messages.query(), self._messages.report)]

    def heard(self, report: Any) -> None:
        """Takes which element is active."""
        if self._has_ended or self._is_stopping:
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
