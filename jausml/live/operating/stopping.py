"""The stop of everything: its components, its sending, and commands that it holds back."""

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

LONGEST_STOP = 30.0  # seconds of waiting for the acknowledgement of a stop


def obeying(operator: Operator) -> list[JausAddress]:
    """Returns the components to stop: those that we controlled and that have not refused us since.

    A component that is lost to us may still take us for its controller.
    """
    return [
        hold.target
        for hold in operator.holds
        if hold.session is not None and hold.session.state is not ControlState.REFUSED
    ]


class Gate:
    """A gate for commands: what was asked for before a stop is not sent after it."""

    def __init__(self) -> None:
        """Begins without a stop."""
        self._sending = Lock()
        self._count = 0

    @property
    def count(self) -> int:
        """Number of stops of everything so far."""
        return self._count

    def stop(self) -> None:
        """Refuses commands of earlier requests from now on; waits for one that is being sent."""
        with self._sending:
            self._count += 1

    @contextmanager
    def unless_stopped(self, before: int) -> Iterator[None]:
        """Lets a stop wait while a command is sent; refuses the command after a stop.

        Args:
            before: Number of stops when the command was requested.
        """
        with self._sending:
            if self._count != before:
                raise Refused("it was not sent, as a stop came before")
            yield


class Stopping:
    """Sends the stop of everything, and reports its outcome."""

    def __init__(self, system: WatchedSystem, journal: Journal) -> None:
        """Begins without a stop."""
        self._system, self._journal = system, journal
        self._running: dict[JausAddress, Event] = {}

    def stop(self, name: str, word: str, targets: Sequence[JausAddress]) -> list[dict[str, str]]:
        """Stops components at once, and returns the outcome of each.

        Args:
            name: The person who stops them.
            word: The kind of stop, one of `stops.WORDS`.
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
        # Acknowledged, and before all waiting messages; then its state is queried.
        deliver(
            operator,
            target,
            message,
            lambda: self._running[target] is is_over,  # until a later stop is sent
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
            # A component that is released before would no longer obey the stop.
            is_over.wait(LONGEST_STOP)
        return state
