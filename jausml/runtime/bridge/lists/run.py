"""What the bridge has a JAUS peer execute for a goal: how it is followed, and how it ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from ..ends.ros_side import Outcome

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...base.address import JausAddress
    from ...base.loop import Timer
    from ...component.component import JausComponent
    from ...wire.message import Message
    from ..connections.controlled_peers import RepeatedStops

RETRIES = 3
"""Repetitions of a request without an answer; all of them fit into the timeout."""

ASKED_AGAIN = 7
"""Repetitions of the question how it goes. Of eight, one comes through where a fifth is lost."""

PATIENCE = 3
"""Timeouts in which a peer must begin."""


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
    """Elements that a peer executes. All of it happens on the loop, or with its lock.

    Attributes:
        noun: What the peer has of them, in words.
    """

    noun: str

    def __init__(
        self,
        component: JausComponent,
        peer: JausAddress,
        watcher: RunWatcher,
        timeout: float,
        stops: RepeatedStops,
    ) -> None:
        """Sends nothing before `start`.

        Args:
            timeout: Seconds in which the peer must answer.
        """
        self.peer = peer
        self._component = component
        self._watcher = watcher
        self._timeout = timeout
        self._stops = stops
        self._uids: list[int] = []
        self._last = -1  # index of the element that was active last
        self._has_ended = self._is_stopping = False
        self._begun = 0.0  # when the peer was told to begin
        self._poll: Timer | None = None

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
        """Has the peer stand, and not go on by itself.

        Args:
            on_settled: Told whether it is so, or how that was refused.
        """
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
        if self._poll is not None:
            self._poll.cancel()
        self._poll = None

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
            self._component.query(
                self.peer,
                query,
                report,
                lambda answer, _sender: self.heard(answer),
                on_failure=on_failure,
                timeout=self._timeout / (ASKED_AGAIN + 1),
                retries=ASKED_AGAIN,
            )
            on_failure = None
        self._poll = self._component.loop.call_later(self._timeout, self._ask)

    def _silent(self) -> None:
        if not (self._has_ended or self._is_stopping):
            self._give_up(f"{self.peer} is silent")

    def _reach(self, index: int) -> None:
        if index != self._last:
            self._last = index
            self._watcher.reached(self, index)
