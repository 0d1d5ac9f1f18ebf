"""One mission that the bridge has a JAUS peer execute, from spooling it to its end (AS6062).

A mission is stopped by PauseMission, which has the spooler stand, and by AbortMission, which leaves
nothing that could be resumed: the state machine of the standard takes no AbortMission while it
executes a mission. What became of a mission is said by ReportMissionStatus alone, unasked or asked
for; nothing confirms that one was stored.
"""

from __future__ import annotations

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
from .list_run import RETRIES, Run, RunWatcher, Settled

_TASK = 1  # the one task of a mission: elements of a list have no tree
_BLOCKING = 1  # each message waits for the end of the one before, as elements of a list do
_UNDER_WAY = (State.RUNNING, State.BLOCKED)
_OVER = (State.ABORTED, State.FINISHED)


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

        The former mission of the peer is aborted first if it is there still. One that pauses is
        left paused by a stop, and not aborted.
        """
        super().__init__(component, peer, watcher, timeout, stops)
        self._messages = messages
        self._pauses = pauses
        self._number = 0
        # Numbers of missions of the bridge that the peer may have.
        self.stored: set[int] = set(former.stored) if isinstance(former, MissionRun) else set()
        self._was_run = self._is_sent = self._rests = False

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may execute it, or the one before."""
        return bool(self._going)

    @property
    def remains(self) -> bool:
        """Whether it may be there, and be it paused."""
        return bool(self.stored)

    @property
    def _going(self) -> set[int]:
        return self.stored - ({self._number} if self._rests else set())

    # ------------------------------------------------------------------ from its beginning

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:  # noqa: ARG002
        """Has what is left of the former one aborted; then spools the mission, and runs it."""
        self._number = first
        self._uids = list(range(first, first + len(payloads)))
        self._dismiss(partial(self._spool, payloads))

    def _spool(self, payloads: Sequence[bytes]) -> None:
        if self._has_ended or self._is_stopping:
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
        self._send(spool(spool.MissionInfo(self._number, source), [task]), self._spooled)

    def _spooled(self) -> None:
        # Acknowledgements may be lost: what the peer says of the mission counts.
        if not (self._has_ended or self._is_stopping):
            self._ask()

    def _run(self) -> None:
        self.stored = {self._number}
        self._was_run = True
        self._begun = self._component.loop.now()
        execute: Any = self._messages.execute
        self._send(execute(mission_id=self._number), self._ran)

    def _ran(self) -> None:
        self._is_sent = True

    # ------------------------------------------------------------------ what the peer tells

    def _queries(self) -> Sequence[tuple[Message, type[Message]]]:
        """Returns the queries of the mission and of the message that is under way."""
        query, report = self._status_query, self._messages.report
        queries = [(query(mission_id=self._number), report)]
        if self._was_run:
            uid = self._uids[max(self._last, 0)]
            queries.append((query(mission_id=self._number, task_id=_TASK, uid=uid), report))
        return queries

    @property
    def _status_query(self) -> Any:
        return self._messages.query

    def heard(self, report: Any) -> None:
        """Takes the state of a mission or of a message; that of a task says no more."""
        is_followed = not (self._has_ended or self._is_stopping)
        if report.type_ == Kind.MISSION and report.id_ in self.stored:
            if report.status in _OVER:
                self.stored.discard(report.id_)
            if report.id_ == self._number:
                self._rests = report.status == State.PAUSED and self._remains_paused(self._number)
                if is_followed:
                    self._state_reported(report.status)
        elif report.type_ == Kind.MESSAGE and report.id_ in self._uids and is_followed:
            index = self._uids.index(report.id_) + (report.status == State.FINISHED)
            if self._was_run and report.status in (*_UNDER_WAY, State.FINISHED):
                self._reach(min(max(index, self._last), len(self._uids) - 1))

    def _state_reported(self, state: int) -> None:
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
        if self._was_run or self._has_ended or self._is_stopping:
            super()._silent()
        else:
            self._give_up(f"{self.peer} does not take the mission")

    # ------------------------------------------------------------------ how it is stopped

    def send_stop(self, on_settled: Settled | None = None) -> None:
        """Has the mission paused, and aborted unless it is to stay."""

        def settled() -> None:
            confirmed = not self.may_go_on
            self._stops.sent(self.peer, confirmed)
            if on_settled is not None:
                on_settled(None, confirmed=confirmed)

        self._dismiss(settled)

    def _remains_paused(self, number: int) -> bool:
        """Whether a stop leaves a mission paused: RunMission must not be on its way still."""
        return self._pauses and number == self._number and self._is_sent and self._last >= 0

    def _dismiss(self, then: Callable[[], None]) -> None:
        """Ends what is there of the bridge; goes on when the peer has said so, or says nothing."""
        pause: Any = self._messages.pause
        abort: Any = self._messages.abort
        stops: list[Message] = []
        for number in sorted(self.stored):
            stops.append(pause(mission_id=number))
            if not self._remains_paused(number):
                stops.append(abort(mission_id=number))
        if not stops:
            then()
            return
        for stop in stops[:-1]:
            self._send(stop)
        self._send(stops[-1], partial(self._see, then, RETRIES))

    def _see(self, then: Callable[[], None], left: int) -> None:
        """Asks until nothing goes on, as often as is left."""
        going = self._going
        if not going or left < 0:
            then()
            return

        def seen(report: Any, _sender: JausAddress) -> None:
            self.heard(report)
            pause = self._pause if self._going else 0.0
            self._component.loop.call_later(pause, partial(self._see, then, left - 1))

        self._component.part(QueryClient).ask(
            self.peer,
            self._status_query(mission_id=min(going)),
            self._messages.report,
            seen,
            on_failure=then,
            timeout=self._pause,
            retries=RETRIES,
        )

    def _send(self, message: Message, then: Callable[[], None] | None = None) -> None:
        """Sends a message; goes on when it was acknowledged, or is repeated no longer."""

        def on_result(_acknowledged: bool) -> None:  # noqa: FBT001 - as transports tell
            if then is not None:
                then()

        component = self._component
        component.transport.send(
            component.address, self.peer, message.encode(), acknowledge=True, on_result=on_result
        )
