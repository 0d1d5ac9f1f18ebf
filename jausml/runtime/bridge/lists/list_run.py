"""One list that the bridge has a JAUS peer execute, from setting it to its end.

AS6009 has no message that ends the execution of a list. Two together do, and leave nothing that
could go on: ExecuteList without an element and with speed 0, by which the vehicle stands ("modifies
the travel speed"), and DeleteElement of all elements (AS5710, ListManager). How a list has ended is
not said either: the active element is 0 after an end of any kind. So a list is done when its last
element was active before that; peers with command events (AS5710 v1.1) tell of a failure besides.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from ...services.element_list import ALL_UIDS, NO_UID, chain
from ..connections.connection import FILTERED, Connection
from ..connections.transcoding import Form, uses_ros_classes
from ..ends.actions import Outcome
from ..light_message import is_light

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ...base.address import JausAddress
    from ...base.loop import Timer
    from ...clients.command_client import PendingCommand
    from ...clients.event_subscription import EventSubscription
    from ...clients.list_client import ListRequest
    from ...component.component import JausComponent
    from ...wire.message import Message
    from ..connections.controlled_peers import RepeatedStops
    from ..ends.actions import ListAction
    from ..ends.ends import Ends
    from ..ends.list_driver import ListMessages
    from ..reports.states import StopReason

LONGEST_LIST = 30 * 24 * 3600
"""Seconds that a peer is given for a list: a month, which is to say as long as it takes."""

RETRIES = 3
"""Repetitions of a request without an answer; all of them fit into the timeout."""

PATIENCE = 3
"""Timeouts in which a peer must begin with a list."""


class Settled(Protocol):
    """Whoever is told whether a peer has emptied its list; the code is that of a refusal."""

    def __call__(self, code: int | None, *, confirmed: bool) -> None:
        """Takes it."""


class RunWatcher(Protocol):
    """Whoever is told how a list goes on: on the loop, with its lock."""

    def reached(self, run: ListRun, index: int) -> None:
        """An element is active, from 0."""

    def ended(self, run: ListRun, outcome: Outcome, reason: str) -> None:
        """The list is not executed any more."""


class ListRun:
    """A list that a peer executes. All of it happens on the loop, or with its lock."""

    def __init__(
        self,
        component: JausComponent,
        peer: JausAddress,
        messages: ListMessages,
        watcher: RunWatcher,
        timeout: float,
        stops: RepeatedStops,
        former: ListRun | None = None,
    ) -> None:
        """Sends nothing before `start`.

        Args:
            timeout: Seconds in which the peer must answer.
            former: The last list of the peer, which this one replaces.
        """
        self.peer = peer
        self._component = component
        self._messages = messages
        self._watcher = watcher
        self._timeout = timeout
        self._stops = stops
        self._is_followed = former is not None and former.may_go_on
        self._stands = self._is_empty = False
        self._uids: list[int] = []
        self._speed = 0.0
        self._last = -1  # index of the element that was active last
        self._has_ended = False
        self._is_stopping = False
        self._request: ListRequest | None = None
        self._events: EventSubscription | None = None
        self._command: PendingCommand | None = None
        self._begun = 0.0  # when the peer was told to begin
        self._poll: Timer | None = None

    def start(self, payloads: Sequence[bytes], first: int, speed: float) -> None:
        """Sets the list of the peer, and then has it executed.

        Args:
            first: UID of the first one; the others follow it. UIDs that the former list had not
                keep late words about that one apart.
            speed: Metres per second.
        """
        self._uids = list(range(first, first + len(payloads)))
        self._speed = speed
        contents = ((uid, data, 0) for uid, data in zip(self._uids, payloads, strict=True))
        self._request = self._component.set_list(
            self.peer,
            chain(contents),
            on_done=self._execute,
            on_refused=self._refused,
            timeout=self._timeout / (RETRIES + 1),
            retries=RETRIES,
        )

    @property
    def may_go_on(self) -> bool:
        """Whether the peer may follow it, or the one before, whatever was told of its end."""
        return self._is_followed and not (self._stands and self._is_empty)

    def leave(self, outcome: Outcome, reason: str) -> None:
        """Ends it without a word to the peer: another list takes its place, or it is gone."""
        self._end(outcome, reason)

    def stop(self, outcome: Outcome, reason: str) -> None:
        """Has the peer stop, and ends when that is confirmed."""
        if self._is_stopping or self._has_ended:
            return
        self._is_stopping = True
        self._drop_requests()

        def settled(code: int | None, *, confirmed: bool) -> None:
            answer = "did not answer" if code is None else f"refused it with code {code}"
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

    def send_stop(self, on_settled: Settled | None = None) -> None:
        """Makes the vehicle stand, and the list empty; some drivers know no speed.

        Args:
            on_settled: Told whether the list is empty, or how that was refused.
        """
        component, execute = self._component, self._messages.execute
        if "speed" in _fields_of(execute):
            stop: Any = execute
            component.transport.send(
                component.address,
                self.peer,
                stop(speed=0.0).encode(),
                acknowledge=True,
                on_result=self._stood,
            )
        else:
            self._stands = True

        def settled(code: int | None = None, *, confirmed: bool = False) -> None:
            self._is_empty = self._is_empty or confirmed or code is not None
            self._stops.sent(self.peer, not self.may_go_on)
            if on_settled is not None:
                on_settled(code, confirmed=confirmed)

        component.delete_elements(
            self.peer,
            [ALL_UIDS],
            on_done=partial(settled, confirmed=True),
            on_refused=settled,
            timeout=self._timeout / (RETRIES + 1),
            retries=RETRIES,
        )

    def _stood(self, acknowledged: bool) -> None:  # noqa: FBT001 - as transports tell
        self._stands = self._stands or self._stops.has_arrived(self.peer, acknowledged)

    # ------------------------------------------------------------------ answers of the peer

    def _refused(self, code: int | None) -> None:
        answer = "does not answer" if code is None else f"refuses the list with code {code}"
        end = self._give_up if self.may_go_on else partial(self._end, Outcome.ABORTED)
        end(f"{self.peer} {answer}")

    def _execute(self) -> None:
        component, messages = self._component, self._messages
        self._is_followed = True
        self._events = component.subscribe(
            self.peer, messages.query(), messages.report, self._reported
        )
        self._begun = component.loop.now()
        # A peer of core v1.0 knows no command events, and executes the plain command.
        self._command = component.command(
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
        made: Message = execute(element_uid=self._uids[0], **own)
        return made

    def _command_done(self, succeeded: bool) -> None:  # noqa: FBT001 - as the client calls it
        if not succeeded and not self._is_stopping:
            self._is_followed = False
            self._end(Outcome.ABORTED, f"{self.peer} could not do it")

    def _ask(self) -> None:
        """Asks for the active element too: events may be refused or lost, and the peer may die."""
        self._component.query(
            self.peer,
            self._messages.query(),
            self._messages.report,
            self._reported,
            on_failure=self._silent,
            timeout=self._timeout / (RETRIES + 1),
            retries=RETRIES,
        )
        self._poll = self._component.loop.call_later(self._timeout, self._ask)

    def _silent(self) -> None:
        self._give_up(f"{self.peer} is silent")

    def _reported(self, report: Any, _sender: JausAddress) -> None:
        if self._has_ended or self._is_stopping:
            return
        uid = report.element_uid
        if uid in self._uids:
            index = self._uids.index(uid)
            if index != self._last:
                self._last = index
                self._watcher.reached(self, index)
        elif self._last >= 0:
            self._end_at(uid)
        elif self._component.loop.now() - self._begun > PATIENCE * self._timeout:
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

    def _end(self, outcome: Outcome, reason: str) -> None:
        if self._has_ended:
            return
        self._has_ended = True
        self._drop_requests()
        self._watcher.ended(self, outcome, reason)

    def _drop_requests(self) -> None:
        for each in (self._request, self._events, self._command, self._poll):
            if each is not None:
                each.cancel()
        self._request = self._events = self._command = self._poll = None


def _fields_of(message: type[Message]) -> frozenset[str]:
    return frozenset(getattr(message, "__dataclass_fields__", ()))


SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")


class ListConnection(Connection[SourceT, TargetT]):
    """A connection whose messages are elements of lists, which pass together or not at all."""

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        action: ListAction,
    ) -> None:
        super().__init__(name, translate, is_command=True)
        self._action = action

    def declare(self, ends: Ends) -> None:
        """Declares nothing: lists have no silence, and their latency is not measured."""

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures nothing: lists are rare."""

    def watch(self) -> None:
        """Nothing is to be stopped before there is a list."""

    def deliver(self, payload: bytes) -> bool:  # noqa: ARG002
        """Elements alone go nowhere."""
        return False

    def classes(self) -> Form:
        """Returns which classes of ROS the translation has to do with."""
        is_real = uses_ros_classes(self._translate) or not is_light(self._action.element)
        return Form.ROS_CLASSES if is_real else Form.LIGHT

    def note_stop(self, reason: StopReason) -> None:
        """Counts that a list was stopped."""
        self.stopped = reason
        counts = self.statistics.stops
        counts[reason] = counts.get(reason, 0) + 1

    def all_transcoded(self, elements: Iterable[bytes]) -> list[bytes] | None:
        """Returns the elements of a list, translated; None, counted, when one cannot be."""
        made: list[bytes] = []
        try:
            for each in elements:
                payload = self._transcode(each)
                if payload is None:
                    self.drop(FILTERED)
                    return None
                made.append(payload)
        except Exception as error:
            self.fail(error)
            return None
        return made
