"""The stop of everything: whom it is for, how it is sent, and what it keeps from being sent."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from threading import Event, Lock, Thread

from jausml.live.operating.journal import Journal
from jausml.live.operating.stops import deliver, stop_of
from jausml.live.operating.watching import WatchedSystem
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.runtime import ControlState
from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.definitions import Status

LONGEST_STOP = 30.0
"""Seconds for which a stop is waited for."""


def obeying(operator: Operator) -> list[JausAddress]:
    """Returns whom a stop is for: who was ours, and has not said that it is another one's.

    Who is lost to us may still take us for its controller.
    """
    return [
        hold.target
        for hold in operator.holds
        if hold.session is not None and hold.session.state is not ControlState.REFUSED
    ]


class Gate:
    """A gate for commands: what was asked for before a stop is not sent after it."""

    def __init__(self) -> None:
        """Nothing was stopped yet."""
        self._sending = Lock()
        self._count = 0

    @property
    def count(self) -> int:
        """How many stops of everything there were."""
        return self._count

    def stop(self) -> None:
        """Refuses from now on what was asked for before; waits for what is being sent."""
        with self._sending:
            self._count += 1

    @contextmanager
    def unless_stopped(self, before: int) -> Iterator[None]:
        """Has a stop wait while something is sent, which is refused after one.

        Args:
            before: How many stops there were when that was asked for.
        """
        with self._sending:
            if self._count != before:
                raise Refused("it was not sent, as a stop came before")
            yield


class Stopping:
    """Sends the stop of everything, and tells what became of it."""

    def __init__(self, system: WatchedSystem, journal: Journal) -> None:
        """Stops nothing."""
        self._system, self._journal = system, journal
        self._running: dict[JausAddress, Event] = {}

    def stop(self, name: str, word: str, targets: Sequence[JausAddress]) -> list[dict[str, str]]:
        """Stops components at once, and returns what each says.

        Args:
            name: Who stops them.
            word: What the stop is, one of `stops.WORDS`.
        """
        operator = self._system.operator
        for target in targets:
            self._system.act(target)
        outcomes = {str(target): "" for target in targets}
        threads = [
            Thread(target=self._stop_one, args=(operator, target, word, outcomes))
            for target in targets
        ]
        for thread in threads:
            thread.start()
        shown = ", ".join(map(str, targets)) or "nothing that is controlled"
        self._journal.note(name, f"STOP ({word}) of {shown}")
        for thread in threads:
            thread.join()
        for component, outcome in outcomes.items():
            self._journal.note("unit", f"after STOP, {self._system.name_of(component)}: {outcome}")
        return [
            {"component": target, "outcome": outcome_text}
            for target, outcome_text in outcomes.items()
        ]

    def _stop_one(
        self, operator: Operator, target: JausAddress, word: str, outcomes: dict[str, str]
    ) -> None:
        try:
            state = self._stopped(operator, target, word)
        except (NoAnswer, Refused) as error:
            outcomes[str(target)] = str(error)
            self._journal.alarm(self._system.name_of(target), f"the stop is not confirmed: {error}")
            return
        outcomes[str(target)] = state.name if state is not None else "its state is not told"
        if state is None:
            self._journal.alarm(self._system.name_of(target), "the stop is not confirmed")

    def _stopped(self, operator: Operator, target: JausAddress, word: str) -> Status | None:
        """Sends the stop until it is acknowledged, and returns the state that follows."""
        is_emergency = word == "emergency"
        if not (is_emergency or target in obeying(operator)):
            raise Refused("it is not controlled by us, and obeys Standby of its controller alone")
        for hold in operator.holds:
            if hold.target == target:
                hold.expect_standby()
        message, is_over = stop_of(word), Event()
        self._running[target] = is_over
        # With acknowledgement, and before all that waits; then it is asked for its state.
        deliver(
            operator,
            target,
            message,
            lambda: self._running[target] is is_over,  # and no later stop is sent
            lambda _: is_over.set(),
        )
        state = None
        try:
            state = operator.change(
                target, message, Status.EMERGENCY if is_emergency else Status.STANDBY
            )
        finally:
            if state is not None:
                operator.answered(target, message)
            # Who released it before that would have it heed the stop no more.
            is_over.wait(LONGEST_STOP)
        return state
