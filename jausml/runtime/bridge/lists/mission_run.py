"""Execution of the elements of one goal by a JAUS peer, as a mission (AS6062).

A mission is stopped by PauseMission, then by AbortMission, after which it cannot be resumed: the
state machine of the standard takes no AbortMission while a mission is executed. Only
ReportMissionStatus, solicited or not, tells of its progress; no message confirms that a mission was
stored.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from ...base.address import JausAddress
from ...clients.query import QueryClient
from ...services.host import Host
from ...wire.message import Message
from ..connections.controlled_peers import RepeatedStops
from ..ends.actions import Outcome
from ..ends.mission_driver import Kind, MissionMessages, State
from .list_run import GREATEST_UID, RETRIES, Run, Runs, RunWatcher, StopResult

_TASK = 1  # the one task of a mission: elements of a list have no tree
_BLOCKING = 1  # each message waits for the end of the one before
_UNDER_WAY = (State.RUNNING, State.BLOCKED)
_ENDED = (State.ABORTED, State.FINISHED)


def mission_runs(_component: Host) -> Runs:
    """Returns the runs of missions of a component, as a part of it."""
    # A spooler may still have a mission of an earlier process of the bridge.
    return Runs(random.randint(1, GREATEST_UID))


class MissionRun(Run):
    """A mission that a peer executes; its number is the UID of its first message."""

    noun = "mission"

    def __init__(
        self,
        component: Host,
        peer: JausAddress,
        messages: MissionMessages,
        watcher: RunWatcher,
        timeout: float,
        stops: RepeatedStops,
        former: Run | None = None,
        *,
        pauses: bool = False,
    ) -> None:
        """Sends nothing before `start`.

        Args:
            former: The former run of the peer, whose missions are aborted first.
            pauses: Whether a stop leaves the mission paused instead of aborting it.
        """
        super().__init__(component, peer, watcher, timeout, stops)
        self._messages = messages
        self._pauses = pauses
        self._number = 0
        # Numbers of missions of the bridge that the peer may still have.
        self.stored: set[int] = set(former.stored) if isinstance(former, MissionRun) else set()
        self._was_run = self._run_sent = self._is_paused = False

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may still execute this mission, or one before."""
        return bool(self._running_missions)

    @property
    def remains(self) -> bool:
        """Whether the peer may still have a mission, even paused."""
        return bool(self.stored)

    @property
    def _running_missions(self) -> set[int]:
        return self.stored - ({self._number} if self._is_paused else set())

    # ------------------------------------------------------------------ begin

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:  # noqa: ARG002
        """Aborts former missions; then spools the mission, and runs it."""
        self._number = first
        self._uids = list(range(first, first + len(payloads)))
        self._stop_missions(partial(self._spool, payloads))

    def _spool(self, payloads: Sequence[bytes]) -> None:
        if self.has_ended or self._is_stopping:
            return
        spool: Any = self._messages.spool
        own, peer = self._component.address, self.peer
        receiver = spool.DestinationID(peer.component, peer.node, peer.subsystem)
        data = [
            spool.MessageData(uid, receiver, payload, _BLOCKING)
            for uid, payload in zip(self._uids, payloads, strict=True)
        ]
        source = spool.SourceID(own.component, own.node, own.subsystem)
        task = spool.Task(spool.TaskData(spool.TaskInfo(_TASK), data), [])
        self.stored.add(self._number)
        self._send(spool(spool.MissionInfo(self._number, source), [task]), self._follow_spooled)

    def _follow_spooled(self) -> None:
        # Whether acknowledged or not: only the status tells that the mission is stored.
        if not (self.has_ended or self._is_stopping):
            self._ask()

    def _run(self) -> None:
        self.stored = {self._number}
        self._was_run = True
        self._begun = self._component.loop.now()
        execute: Any = self._messages.execute
        self._send(execute(mission_id=self._number), self._note_run_sent)

    def _note_run_sent(self) -> None:
        self._run_sent = True

    # ------------------------------------------------------------------ progress

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns the queries of the mission and of its present message."""
        query, report = self._status_query, self._messages.report
        queries = [(query(mission_id=self._number), report)]
        if self._was_run:
            uid = self._uids[max(self._last, 0)]
            queries.append((query(mission_id=self._number, task_id=_TASK, uid=uid), report))
        return queries

    @property
    def _status_query(self) -> Any:
        return self._messages.query

    def take_report(self, report: Any) -> None:
        """Takes the state of a mission or of a message."""
        is_followed = not (self.has_ended or self._is_stopping)
        if report.type_ == Kind.MISSION and report.id_ in self.stored:
            if report.status in _ENDED:
                self.stored.discard(report.id_)
            if report.id_ == self._number:
                self._is_paused = report.status == State.PAUSED and self._stays_paused(self._number)
                if is_followed:
                    self._take_state(report.status)
        elif report.type_ == Kind.MESSAGE and report.id_ in self._uids and is_followed:
            index = self._uids.index(report.id_) + (report.status == State.FINISHED)
            if self._was_run and report.status in (*_UNDER_WAY, State.FINISHED):
                self._reach(min(max(index, self._last), len(self._uids) - 1))

    def _take_state(self, state: int) -> None:
        if state == State.INIT and not self._was_run:
            self._run()
        elif state == State.INIT:
            if self._is_late:
                self._give_up(f"{self.peer} does not execute the mission")
        elif not self._was_run:
            self.stored.discard(self._number)
            self._end(Outcome.ABORTED, f"{self.peer} has another mission {self._number}")
        elif state in _UNDER_WAY:
            self._reach(max(self._last, 0))
        elif state == State.FINISHED:
            self._end(Outcome.SUCCEEDED, "")
        elif state == State.ABORTED:
            done, count = self._last + 1, len(self._uids)
            self._end(Outcome.ABORTED, f"{self.peer} ended the mission at {done} of {count}")
        elif state == State.PAUSED:
            self._give_up(f"{self.peer} paused the mission")

    def _silent(self) -> None:
        if self._was_run or self.has_ended or self._is_stopping:
            super()._silent()
        else:
            self._give_up(f"{self.peer} does not take the mission")

    # ------------------------------------------------------------------ stop

    def send_stop(self, on_result: StopResult | None = None) -> None:
        """Pauses the mission, and aborts it unless it is to stay paused."""

        def stopped() -> None:
            confirmed = not self.may_go_on
            self._stops.sent(self.peer, confirmed)
            if on_result is not None:
                on_result(None, confirmed=confirmed)

        self._stop_missions(stopped)

    def _stays_paused(self, number: int) -> bool:
        """Returns whether a stop leaves a mission paused: if no RunMission can come after it."""
        return self._pauses and number == self._number and self._run_sent and self._last >= 0

    def _stop_missions(self, then: Callable[[], None]) -> None:
        """Stops all missions of the bridge; calls `then` on a report of that, or without any."""
        pause: Any = self._messages.pause
        abort: Any = self._messages.abort
        stops: list[Message] = []
        for number in sorted(self.stored):
            stops.append(pause(mission_id=number))
            if not self._stays_paused(number):
                stops.append(abort(mission_id=number))
        if not stops:
            then()
            return
        for stop in stops[:-1]:
            self._send(stop)
        self._send(stops[-1], partial(self._await_stop, then, RETRIES))

    def _await_stop(self, then: Callable[[], None], retries: int) -> None:
        """Queries the status until no mission runs or no retry is left, then calls `then`."""
        running = self._running_missions
        if not running or retries < 0:
            then()
            return

        def query_again(report: Any, _sender: JausAddress) -> None:
            self.take_report(report)
            pause = self._pause if self._running_missions else 0.0
            self._component.loop.call_later(pause, partial(self._await_stop, then, retries - 1))

        self._component.part(QueryClient).ask(
            self.peer,
            self._status_query(mission_id=min(running)),
            self._messages.report,
            query_again,
            on_failure=then,
            timeout=self._pause,
            retries=RETRIES,
        )

    def _send(self, message: Message, then: Callable[[], None] | None = None) -> None:
        """Sends a message; calls `then` when it was acknowledged or is not repeated any more."""

        def on_result(_acknowledged: bool) -> None:  # noqa: FBT001 - as transports call it
            if then is not None:
                then()

        component = self._component
        component.transport.send(
            component.address, self.peer, message.encode(), acknowledge=True, on_result=on_result
        )
