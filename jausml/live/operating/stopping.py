"""The stop of everything: its components, its sending, and commands that come too late."""

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

LONGEST_STOP = 30.0  # seconds to wait for the acknowledgement of a stop


def obeying(operator: Operator) -> list[JausAddress]:
    """Returns the components that we control, or that we lost control of without a refusal.

    A component that we lost may still regard us as its controller, and then obeys our stop.
    """
    return [
        hold.target
        for hold in operator.holds
        if hold.session is not None and hold.session.state is not ControlState.REFUSED
    ]


class Gate:
    """A gate for commands: one that was requested before a stop is not sent after it.

    Attributes:
        count: Number of stops of everything so far.
    """

    def __init__(self) -> None:
        """Begins without a stop."""
        self._sending = Lock()
        self.count = 0

    def stop(self) -> None:
        """Closes the gate for earlier requests; waits for a command that is being sent."""
        with self._sending:
            self.count += 1

    @contextmanager
    def unless_stopped(self, before: int) -> Iterator[None]:
        """Makes a stop wait while a command is sent; raises `Refused` after a stop.

        Args:
            before: Number of stops when the command was requested.
        """
        with self._sending:
            if self.count != before:
                raise Refused("it was not sent, as a stop came before")
            yield


class Stopping:
    """Sends the stop of everything, and notes its outcome in the journal."""

    def __init__(self, system: WatchedSystem, journal: Journal) -> None:
        """Begins without a stop."""
        self._system, self._journal = system, journal
        self._running: dict[JausAddress, Event] = {}

    def stop(self, name: str, kind: str, targets: Sequence[JausAddress]) -> list[dict[str, object]]:
        """Stops all components at the same time, and returns the outcome of each as JSON values.

        Args:
            name: The person who stops them.
            kind: The kind of stop, one of `stops.STOP_KINDS`.
        """
        operator = self._system.operator
        for target in targets:
            self._system.act(target)
        outcomes = {str(target): ("", False) for target in targets}
        threads = [
            Thread(target=self._stop_one, args=(operator, target, kind, outcomes))
            for target in targets
        ]
        for thread in threads:
            thread.start()
        shown = ", ".join(map(str, targets)) or "nothing that is controlled"
        self._journal.note(name, f"STOP ({kind}) of {shown}")
        for thread in threads:
            thread.join()
        for component, (outcome, _) in outcomes.items():
            self._journal.note("unit", f"after STOP, {self._system.name_of(component)}: {outcome}")
        return [
            {"component": target, "outcome": outcome_text, "confirmed": is_confirmed}
            for target, (outcome_text, is_confirmed) in outcomes.items()
        ]

    def _stop_one(
        self,
        operator: Operator,
        target: JausAddress,
        kind: str,
        outcomes: dict[str, tuple[str, bool]],
    ) -> None:
        try:
            state = self._send_stop(operator, target, kind)
        except (NoAnswer, Refused) as error:
            outcomes[str(target)] = str(error), False
            self._journal.alarm(self._system.name_of(target), f"the stop is not confirmed: {error}")
            return
        if state is not None:
            outcomes[str(target)] = state.name, True
        else:
            outcomes[str(target)] = "its state is not told", False
            self._journal.alarm(self._system.name_of(target), "the stop is not confirmed")

    def _send_stop(self, operator: Operator, target: JausAddress, kind: str) -> Status | None:
        """Sends the stop until it is acknowledged; returns the new state, None if not reported."""
        is_emergency = kind == "emergency"
        if not (is_emergency or target in obeying(operator)):
            raise Refused("it is not controlled by us, and obeys Standby of its controller alone")
        for hold in operator.holds:
            if hold.target == target:
                hold.expect_standby()
        message, is_over = stop_of(kind), Event()
        self._running[target] = is_over
        # It goes before all waiting messages; then the state is queried.
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
            # The caller may release the component next, after which it would not obey the stop.
            is_over.wait(LONGEST_STOP)
        return state
