"""Connection from a ROS action to the list driver or mission spooler of a JAUS peer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

from ...base.address import JausAddress
from ...clients.peer_binding import Search
from ...services.definitions import Guard
from ...wire.message import Message
from ..connections.connection import NO_PEER, NOT_READY
from ..connections.controlled_peers import ControlledPeers, RepeatedStops
from ..connections.translations import ros_decoder
from ..ends import parameters
from ..ends.actions import LONGEST_GOAL, ListAction, Outcome, ServedGoal
from ..ends.ends import Ends
from ..ends.list_driver import ListMessages
from ..ends.mission_driver import MissionMessages
from ..reports.states import Standing, StopReason
from .list_connection import ListConnection, node_actions
from .list_run import ListRun, Run, Runs, list_runs
from .mission_run import MissionRun, mission_runs

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")

EMPTY = "empty_goal"
NO_SPEED = "no_speed"
TOO_LONG = "too_long"


class ActionToList(ListConnection[SourceT, TargetT]):
    """Serves a ROS action, whose goals the list driver or spooler of a JAUS peer executes.

    A new goal aborts the one that is executed, as at the servers of Nav2.
    """

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        action: ListAction,
        driver: ListMessages,
        peers: Sequence[JausAddress] | Search,
        speed: float = 0.0,
        speed_of: Callable[[Any], float] | None = None,
        control: Guard = Guard.READY,
        pauses: bool = False,
        timeout: float = 1.0,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Returns the JAUS message in an element of the list, for an element of a goal.
            speed: Speed for ExecuteList in m/s.
            speed_of: Returns the speed for a goal of rclpy instead.
            pauses: Whether a mission is paused, not aborted, when its goal ends early.
            timeout: Seconds within which the peer must answer.
        """
        super().__init__(name, translate, action=action)
        self.speed = speed
        self.timeout = timeout
        self._messages = driver
        self._peers = ControlledPeers(peers, control)
        self._pauses = pauses
        self._speed_of = speed_of
        self._stops = RepeatedStops(self._peers, self._may_go_on, self._stop_again)
        self._runs: Runs  # of all connections of the bridge
        self._run: Run | None = None
        self._goal: ServedGoal | None = None
        self._accepted: tuple[JausAddress, list[bytes], float] | None = None
        self._count = 0
        self._result = "none yet"

    # ------------------------------------------------------------------ as a connection

    def open(self, ends: Ends) -> None:
        """Begins to acquire control, then serves the action."""
        super().open(ends)
        self._run = self._goal = self._accepted = None
        self._runs = ends.component.part(mission_runs if self._has_missions else list_runs)
        self._stops.open(ends)
        self.speed = ends.ros.parameter(
            parameters.SPEED.of(self.speed, self.name), partial(setattr, self, "speed")
        )
        self._peers.open(
            ends, self.name, join=lambda _: None, leave=self._leave, changed=self._control_changed
        )
        if self._has_missions:
            ends.component.on_message(self._messages.report, self._take_report)
        ends.ros.part(node_actions).serve_action(self._action, self)

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns the function that decodes serialized elements."""
        return ros_decoder(self._ends.ros, self._action.element, self._translate)

    def encode(self, target: TargetT) -> bytes:
        """Encodes the message of an element."""
        return target.encode()

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:  # noqa: ARG002
        """Ends the goal while the bridge may not command."""
        return self.halt(standing.halt)

    def stop(self, reason: StopReason) -> bool:
        """Ends the goal that is executed or accepted; returns whether one was executed."""
        self._accepted = None
        if self._run is None:
            return False
        self.note_stop(reason)
        run = self._run
        run.stop(Outcome.ABORTED, reason.value)
        # The result must not wait for the answer of a peer that may be gone.
        run.leave(Outcome.ABORTED, reason.value)
        return True

    def end(self) -> bool:
        """Ends the goal that is executed for good; returns whether there was one."""
        self._stops.end()
        return super().end()

    @property
    def when_lost(self) -> str:
        """The effect of lost control, in words for the log."""
        if not self._has_missions:
            return "the list is stopped and the goal aborted"
        return f"the mission is {'paused' if self._pauses else 'aborted'}, as its goal is"

    def lacks_peers(self) -> str:
        """Returns which peer is searched for and not found."""
        return self._peers.lacking()

    def refusal(self) -> str:
        """Returns why no peer obeys; empty while one does."""
        present = self._peers.present
        if any(map(self._peers.obeys, present)):
            return ""
        reasons = "; ".join(map(self._peers.reason, present))
        return f"no peer obeys: {reasons}" if reasons else "no peer obeys"

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the JAUS components, the state of their control, and how the last goal ended."""
        under_way = "none" if self._run is None else f"executed by {self._run.peer}"
        return [*self._peers.describe(), ("goal", under_way), ("last goal", self._result)]

    # ------------------------------------------------------------------ peers

    @property
    def _has_missions(self) -> bool:
        return isinstance(self._messages, MissionMessages)

    def _leave(self, peer: JausAddress) -> None:
        if self._run is not None and self._run.peer == peer:
            self._run.leave(Outcome.ABORTED, f"{peer} is gone")

    def _control_changed(self, peer: JausAddress) -> None:
        run = self._run
        if run is not None and run.peer == peer and not self._peers.obeys(peer):
            run.leave(Outcome.ABORTED, f"{peer} does not obey: {self._peers.reason(peer)}")
        self._stops.changed(peer)

    def _take_report(self, report: Any, sender: JausAddress) -> None:
        """Takes a report that a spooler sends unasked."""
        run = self._last_run(sender)
        if run is not None:
            run.take_report(report)

    def _last_run(self, peer: JausAddress) -> Run | None:
        """Returns the last run of a peer; None if it is not of this connection."""
        run = self._runs.of(peer)
        return run if run is not None and run.is_of(self) else None

    def _may_go_on(self, peer: JausAddress) -> bool:
        run = self._last_run(peer)
        return run is not None and run is not self._run and run.may_go_on

    def _stop_again(self, peer: JausAddress) -> None:
        run = self._last_run(peer)
        if run is not None:
            run.send_stop()

    # ------------------------------------------------------------------ GoalTaker

    def accepts(self, elements: Sequence[bytes], request: Any) -> bool:
        """Returns whether a goal can be executed now; counts the reason if not."""
        counts = self.statistics
        counts.arrivals += 1
        counts.last_arrival = self._ends.loop.now()
        self._accepted = None
        peer = next(filter(self._peers.obeys, self._peers.present), None)
        if self._halt is not None:
            self.refuse_halted(self._halt)
        elif not elements:
            self.drop(EMPTY)
        elif len(elements) > LONGEST_GOAL:
            self.drop(TOO_LONG, f"a goal has {LONGEST_GOAL} elements at most")
        elif not self._peers.present:
            self.drop(NO_PEER)
        elif peer is None:
            self.drop(NOT_READY, ", ".join(map(str, self._peers.present)))
        else:
            self._accepted = self._prepare(peer, elements, request)
        return self._accepted is not None

    def begin(self, goal: ServedGoal) -> None:
        """Executes the goal that was accepted last, instead of another one."""
        accepted, self._accepted = self._accepted, None
        # Anything may have changed since then, as the lock was free.
        if accepted is None or not self._peers.obeys(accepted[0]):
            reason = "the bridge was stopped meanwhile, or its peer obeys no more"
            self.drop(NOT_READY, reason)
            goal.end(Outcome.ABORTED, reason)
            return
        peer, payloads, speed = accepted
        self._end_run(peer)
        self.note_usable()
        self._goal, self._count = goal, len(payloads)
        self._run = run = self._new_run(peer)
        self._runs.add(run)
        run.start(payloads, self._runs.next_uids(len(payloads)), speed)

    def _new_run(self, peer: JausAddress) -> Run:
        component, messages, former = self._ends.component, self._messages, self._runs.of(peer)
        timeout, stops = self.timeout, self._stops
        if not isinstance(messages, MissionMessages):
            return ListRun(component, peer, messages, self, timeout, stops, former)
        return MissionRun(
            component, peer, messages, self, timeout, stops, former, pauses=self._pauses
        )

    def _end_run(self, peer: JausAddress) -> None:
        """Aborts the goals of this connection and of `peer`, which replaces the list of its own."""
        reason = "another goal took its place"
        if self._run is not None and self._run.peer != peer:
            self._run.stop(Outcome.ABORTED, reason)
        for run in (self._run, self._runs.of(peer)):
            if run is not None:
                run.leave(Outcome.ABORTED, reason)

    def cancel(self, goal: ServedGoal) -> None:
        """Stops the list, as the client of the goal asks."""
        if goal is self._goal and self._run is not None:
            self._run.stop(Outcome.CANCELED, "canceled")

    def _prepare(
        self, peer: JausAddress, elements: Sequence[bytes], request: Any
    ) -> tuple[JausAddress, list[bytes], float] | None:
        """Returns the peer, encoded elements and speed; None, counted, if a translation fails."""
        try:
            speed = self.speed if self._speed_of is None else self._speed_of(request)
        except Exception as error:  # of code of the user
            self.fail(error)
            return None
        payloads = self.all_transcoded(elements)
        if payloads is None:
            return None
        if "speed" in getattr(self._messages.execute, "__dataclass_fields__", ()) and not (
            0 < speed <= parameters.GREATEST_SPEED
        ):
            self.drop(NO_SPEED, f"{speed} m/s")
            return None
        return peer, payloads, speed

    # ------------------------------------------------------------------ RunWatcher

    def reached(self, run: Run, index: int) -> None:
        """Sends the client the active element as feedback."""
        if run is self._run and self._goal is not None:
            self._goal.progress(self._action.counting.number(index, self._count))

    def ended(self, run: Run, outcome: Outcome, reason: str) -> None:
        """Sends the client the result."""
        if run is not self._run or self._goal is None:
            return
        goal, self._goal, self._run = self._goal, None, None
        self._result = f"{outcome.value}: {reason}" if reason else outcome.value
        if outcome is Outcome.SUCCEEDED:
            self.statistics.passed += 1
        elif outcome is Outcome.ABORTED:
            self.drop(outcome.value, reason)
        goal.end(outcome, reason)
