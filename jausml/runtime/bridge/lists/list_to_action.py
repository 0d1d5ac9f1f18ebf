"""Connection of a JAUS list driver with a ROS action: the list is the goal.

The bridge is the driver. ExecuteList makes the elements from one on a goal; feedback tells which
element is active. A goal ends before the next one is sent, so the robot never follows two.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

from ...base.address import JausAddress
from ...base.clocks import Alarm
from ...clients.peer_binding import PeerBinding, Search
from ...services.list_elements import ListElement
from ...wire.message import Message
from ..connections.connection import NOT_READY
from ..connections.translations import ros_encoder
from ..ends import parameters
from ..ends.actions import LONGEST_GOAL, ActionClient, ListAction, Outcome, SentGoal
from ..ends.ends import Ends
from ..ends.list_driver import ListAnswers, ListDriver, ListMessages
from ..ends.topics import TopicFault
from ..reports.states import Standing, StopReason
from .list_connection import ListConnection, node_actions

SourceT = TypeVar("SourceT", bound="Message")
TargetT = TypeVar("TargetT")

TOO_LONG = "too_long"
NO_ANSWERS = ListAnswers()  # nothing is told but the active element

ANSWER_PERIOD = 0.1
"""Seconds between two looks at a goal that is not accepted: its server may just be starting."""

CHECK_PERIOD = 1.0
"""Seconds between two looks at a goal: whether its server is there, and whether it is cancelled."""

SHORTEST_ROUND = 1.0
"""Seconds that one round of a circular list takes at least: a server may succeed at once."""


class ListToAction(ListConnection[SourceT, TargetT]):
    """Has the list of the bridge's controller executed by a ROS action."""

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        message: type[SourceT],
        action: ListAction,
        driver: ListMessages,
        answers: ListAnswers = NO_ANSWERS,
        fill: Callable[[Any, float | None], object] | None = None,
        peers: Sequence[JausAddress] | Search = (),
        timeout: float = 1.0,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Makes an element of the goal of what an element of the list holds.
            fill: Sets what a goal has besides its elements; it is given the speed in m/s.
            peers: JAUS components whose lists are executed, or how they are found; none means that
                of whoever controls the bridge.
            timeout: Seconds in which a goal must be accepted.
        """
        super().__init__(name, translate, action=action)
        self.timeout = timeout
        self._message = message
        self._messages = driver
        self._answers = answers
        self._fill = fill
        self._peers = PeerBinding(peers)
        self._driver: ListDriver
        self._client: ActionClient
        self._encode: Callable[[Any], bytes]
        self._start: int | None = None  # the element from which a goal is to be sent
        self._speed: float | None = None
        self._goal: SentGoal | None = None
        self._elements: tuple[ListElement, ...] = ()  # those of the goal
        self._is_accepted = self._is_cancelled = False
        self._sent = 0.0
        self._check: Alarm
        self._result = "none yet"

    # ------------------------------------------------------------------ as a connection

    def open(self, ends: Ends) -> None:
        """Makes the client of the action, then listens to the controller."""
        self._encode = ros_encoder(ends.ros, self._action.element)
        super().open(ends)
        self._start = self._goal = None  # of an earlier life
        self._check = Alarm(ends.loop)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._peers.follow(ends.component, lambda _: None, lambda _: None)
        self._client = ends.ros.part(node_actions).action_client(self._action)
        self._driver = ends.component.part(self._messages.driver)
        self._driver.add(self, self._answers)

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns what decodes the message of an element."""
        return self._message.decode

    def encode(self, target: TargetT) -> bytes:
        """Serializes an element of the goal."""
        return self._encode(target)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Ends the list of a controller that counts no more, and what passes while inactive."""
        ended = lost is not None and self.stop(lost)
        return super().follow(standing, lost) or ended

    def stop(self, reason: StopReason) -> bool:
        """Ends the list that is executed; whether there was one."""
        if not self._driver.is_executed_by(self):
            return False
        self.note_stop(reason)
        self._finish(succeeded=False)
        return True

    @property
    def when_lost(self) -> str:
        """What happens when the controller is lost."""
        return "the goal is canceled"

    def topic_faults(self) -> Sequence[TopicFault]:
        """Why no goal can be sent."""
        return self._client.faults()

    def describe_peers(self) -> list[tuple[str, str]]:
        """The list, and how the last goal ended."""
        active = self._driver.active if self._driver.is_executed_by(self) else 0
        waits = self._goal is not None and not self._is_accepted
        state = "none" if self._goal is None else "sent" if waits else "executing"
        return [
            *self._peers.describe(),
            ("active element", str(active)),
            ("goal", "canceling" if self._is_cancelled else state),
            ("last goal", self._result),
        ]

    # ------------------------------------------------------------------ for the driver

    def obeys(self, sender: JausAddress) -> bool:
        """Whether a controller may have lists executed."""
        return self._peers.is_anybody or sender in self._peers.present

    def is_of(self, element: ListElement) -> bool:
        """Whether an element holds the message that is translated."""
        return element.message_code == self._message.CODE

    def can_carry(self, element: ListElement) -> bool:
        """Whether an element can be translated."""
        return self._translated([element]) is not None

    def begin(self, uid: int, speed: float | None) -> None:
        """Executes the list from an element on, in the place of what is executed."""
        self.statistics.arrivals += 1
        self.statistics.last_arrival = self._ends.loop.now()
        self.note_usable()
        self._driver.reached(self, uid)
        self._start, self._speed = uid, speed
        self._proceed()

    def change_speed(self, speed: float) -> None:
        """Stands still at 0, and goes on from the active element afterwards."""
        former, self._speed = self._speed, speed
        if (former == 0) is not (speed == 0):
            self._start = self._driver.active
            self._proceed()

    def list_changed(self) -> None:
        """Goes on with the new list from the active element, unless that is not there any more."""
        active = self._driver.active
        rest = [(element.uid, element.data) for element in self._driver.elements_from(active)]
        sent = [(element.uid, element.data) for element in self._elements]
        if not rest:
            self._finish(succeeded=False)
        elif self._goal is not None and rest != sent[len(sent) - len(rest) :]:
            self._start = active
            self._proceed()

    def leave(self) -> None:
        """Ends what is executed."""
        self._finish(succeeded=False)

    # ------------------------------------------------------------------ goals

    def _proceed(self) -> None:
        """Sends the next goal; if there is one, it ends first."""
        if self._goal is not None:
            self._cancel()
        elif self._start is not None and self._speed != 0:
            self._send(self._start)

    def _send(self, start: int) -> None:
        self._start = None
        elements = self._driver.elements_from(start)
        payloads = self._translated(elements)
        if not payloads:
            self._finish(succeeded=False)
            return
        fill = None if self._fill is None else partial(self._fill_in, self._fill, self._speed)
        self._elements = tuple(elements)
        self._is_accepted = self._is_cancelled = False
        self._sent = self._ends.loop.now()
        self._goal = self._client.send(payloads, fill, self)
        self._check.set(ANSWER_PERIOD, self._look)

    @staticmethod
    def _fill_in(
        fill: Callable[[Any, float | None], object], speed: float | None, goal: Any
    ) -> None:
        fill(goal, speed)

    def _translated(self, elements: Sequence[ListElement]) -> list[bytes] | None:
        """Returns the elements of a goal; None, counted, when one cannot be translated."""
        if len(elements) > LONGEST_GOAL:
            self.drop(TOO_LONG, f"{len(elements)} elements; a goal has {LONGEST_GOAL} at most")
            return None
        if self._halt is not None:
            self.drop(NOT_READY, self._halt.value)
            return None
        return self.all_transcoded(element.data for element in elements)

    def _cancel(self) -> None:
        if self._goal is not None:
            self._is_cancelled = True
            self._goal.cancel()

    def _look(self) -> None:
        """Looks after the goal: an answer may be due, its server gone, or a cancellation lost."""
        goal, loop = self._goal, self._ends.loop
        if goal is None:
            return
        if not self._is_accepted and loop.now() - self._sent >= self.timeout:
            faults = self._client.faults()
            goal.forget()
            why = faults[0].text if faults else "no answer"
            self.ended(goal, Outcome.LOST, f"{why} in {self.timeout:g} s")
            return
        if self._is_cancelled:
            goal.cancel()
        goal.check()
        self._check.set(CHECK_PERIOD if self._is_accepted else ANSWER_PERIOD, self._look)

    # ------------------------------------------------------------------ GoalWatcher

    def accepted(self, goal: SentGoal) -> None:
        """The action server executes the goal."""
        if goal is self._goal:
            self._is_accepted = True
            self.statistics.passed += 1

    def progressed(self, goal: SentGoal, number: int) -> None:
        """The feedback says which element is active."""
        if goal is self._goal and not self._is_cancelled:
            at = self._action.counting.index(number, len(self._elements))
            self._driver.reached(self, self._elements[at].uid)

    def ended(self, goal: SentGoal, outcome: Outcome, reason: str) -> None:
        """The goal has ended: the list too, or the next goal is sent."""
        if goal is not self._goal:
            return
        self._goal = None
        was_cancelled, self._is_cancelled = self._is_cancelled, False
        self._result = f"{outcome.value}: {reason}" if reason else outcome.value
        if was_cancelled:
            self._proceed()
        elif outcome is Outcome.SUCCEEDED:
            self._go_round()
        else:
            self.drop(outcome.value, reason)
            self._finish(succeeded=False)

    def _go_round(self) -> None:
        """Begins a circular list again; any other one is done with its last element."""
        again = self._driver.first_again
        if not again:
            self._driver.reached(self, self._elements[-1].uid)
            self._finish(succeeded=True)
            return
        self._start = again
        wait = max(0.0, self._sent + SHORTEST_ROUND - self._ends.loop.now())
        self._ends.loop.call_later(wait, self._next_round)

    def _next_round(self) -> None:
        if self._goal is None:
            self._proceed()

    def _finish(self, *, succeeded: bool) -> None:
        self._start = None
        self._cancel()
        self._driver.finished(self, succeeded=succeeded)
