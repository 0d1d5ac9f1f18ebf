"""Connection from a JAUS list driver, which the bridge provides, to a ROS action.

ExecuteList sends the elements from one on as a goal; feedback tells which element is active. A goal
ends before the next one is sent, so that the robot never follows two.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
NO_ANSWERS = ListAnswers()  # for QueryActiveElement alone
ANSWER_PERIOD = 0.1  # seconds between two checks of a goal that is not accepted
CHECK_PERIOD = 1.0  # seconds between two checks of an accepted goal
SHORTEST_ROUND = 1.0  # seconds for a round of a circular list, as a server may succeed at once


class ListToAction(ListConnection[SourceT, TargetT]):
    """Executes the list of the controller of the bridge by a ROS action."""

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
            translate: Returns the element of a goal for the message in an element of the list.
            message: The message in elements of the list.
            fill: Sets the other fields of a goal; its second argument is the speed in m/s.
            peers: JAUS components whose lists are executed, or how they are found; none means any
                controller.
            timeout: Seconds within which a goal must be accepted.
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
        self._start: int | None = None  # UID of the first element of the next goal
        self._speed: float | None = None
        self._goal: SentGoal | None = None
        self._elements: tuple[ListElement, ...] = ()  # of the goal
        self._is_accepted = self._is_cancelled = False
        self._sent = 0.0
        self._check: Alarm
        self._result = "none yet"

    # ------------------------------------------------------------------ as a connection

    def open(self, ends: Ends) -> None:
        """Makes the client of the action, then registers with the list driver."""
        self._encode = ros_encoder(ends.ros, self._action.element)
        super().open(ends)
        self._start = self._goal = None
        self._check = Alarm(ends.loop)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._peers.follow(ends.component, lambda _: None, lambda _: None)
        self._client = ends.ros.part(node_actions).action_client(self._action)
        self._driver = ends.component.part(self._messages.driver)
        self._driver.add(self, self._answers)

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns the function that decodes the message of an element."""
        return self._message.decode

    def encode(self, target: TargetT) -> bytes:
        """Serializes an element of the goal."""
        return self._encode(target)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Ends the list of a lost controller, and any list while the bridge is inactive."""
        ended = lost is not None and self.stop(lost)
        return super().follow(standing, lost) or ended

    def stop(self, reason: StopReason) -> bool:
        """Ends the list that is executed; returns whether there was one."""
        if not self._driver.is_executed_by(self):
            return False
        self.note_stop(reason)
        self._finish(succeeded=False)
        return True

    @property
    def when_lost(self) -> str:
        """The effect of a lost controller, in words for the log."""
        return "the goal is canceled"

    def topic_faults(self) -> Sequence[TopicFault]:
        """Returns why no goal can be sent."""
        return self._client.faults()

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns peers, the active element, and the states of the present and last goal."""
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
        """Returns whether a sender may have lists executed."""
        return self._peers.is_anybody or sender in self._peers.present

    def is_of(self, element: ListElement) -> bool:
        """Returns whether an element holds the message of this connection."""
        return element.message_code == self._message.CODE

    def can_carry(self, element: ListElement) -> bool:
        """Returns whether an element can be translated."""
        return self._translated([element]) is not None

    def begin(self, uid: int, speed: float | None) -> None:
        """Executes the list from an element on, instead of the present goal."""
        self.statistics.arrivals += 1
        self.statistics.last_arrival = self._ends.loop.now()
        self.note_usable()
        self._driver.reached(self, uid)
        self._start, self._speed = uid, speed
        self._proceed()

    def change_speed(self, speed: float) -> None:
        """Cancels the goal at speed 0; goes on from the active element at another speed."""
        former, self._speed = self._speed, speed
        if (former == 0) is not (speed == 0):
            self._start = self._driver.active
            self._proceed()

    def list_changed(self) -> None:
        """Goes on with the new list from the active element; ends if it was deleted."""
        active = self._driver.active
        remaining = [(element.uid, element.data) for element in self._driver.elements_from(active)]
        former = [(element.uid, element.data) for element in self._elements]
        if not remaining:
            self._finish(succeeded=False)
        elif self._goal is not None and remaining != former[len(former) - len(remaining) :]:
            self._start = active
            self._proceed()

    def leave(self) -> None:
        """Ends the list that is executed."""
        self._finish(succeeded=False)

    # ------------------------------------------------------------------ goals

    def _proceed(self) -> None:
        """Sends the next goal, or first cancels the present one."""
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
        fill, speed = self._fill, self._speed
        self._elements = tuple(elements)
        self._is_accepted = self._is_cancelled = False
        self._sent = self._ends.loop.now()
        fill_goal = None if fill is None else lambda goal: fill(goal, speed)
        self._goal = self._client.send(payloads, fill_goal, self)
        self._check.set(ANSWER_PERIOD, self._check_goal)

    def _translated(self, elements: Sequence[ListElement]) -> list[bytes] | None:
        """Returns the translated elements of a goal; None, counted, if there can be no goal."""
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

    def _check_goal(self) -> None:
        """Ends a goal that was not accepted in time or lost its server; repeats a cancellation."""
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
        self._check.set(CHECK_PERIOD if self._is_accepted else ANSWER_PERIOD, self._check_goal)

    # ------------------------------------------------------------------ GoalWatcher

    def accepted(self, goal: SentGoal) -> None:
        """The action server executes the goal."""
        if goal is self._goal:
            self._is_accepted = True
            self.statistics.passed += 1

    def progressed(self, goal: SentGoal, number: int) -> None:
        """Feedback has come: sets the active element."""
        if goal is self._goal and not self._is_cancelled:
            index = self._action.counting.index(number, len(self._elements))
            self._driver.reached(self, self._elements[index].uid)

    def ended(self, goal: SentGoal, outcome: Outcome, reason: str) -> None:
        """The goal has ended: sends the next one, or ends the list."""
        if goal is not self._goal:
            return
        self._goal = None
        was_cancelled, self._is_cancelled = self._is_cancelled, False
        self._result = f"{outcome.value}: {reason}" if reason else outcome.value
        if was_cancelled:
            self._proceed()
        elif outcome is Outcome.SUCCEEDED:
            self._repeat_list()
        else:
            self.drop(outcome.value, reason)
            self._finish(succeeded=False)

    def _repeat_list(self) -> None:
        """Begins a circular list again; ends any other one."""
        start = self._driver.restart_uid
        if not start:
            self._driver.reached(self, self._elements[-1].uid)
            self._finish(succeeded=True)
            return
        self._start = start
        wait = max(0.0, self._sent + SHORTEST_ROUND - self._ends.loop.now())
        self._ends.loop.call_later(wait, self._next_round)

    def _next_round(self) -> None:
        if self._goal is None:
            self._proceed()

    def _finish(self, *, succeeded: bool) -> None:
        self._start = None
        self._cancel()
        self._driver.finished(self, succeeded=succeeded)
