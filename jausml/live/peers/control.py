"""Control of components that an operator holds, and requests for its handoff (IOP)."""

from __future__ import annotations

from collections.abc import Callable
from queue import Empty, SimpleQueue
from threading import Condition

from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.runtime import (
    ControlSession,
    ControlState,
    HandoffAnswer,
    HandoffDecision,
    HandoffRequest,
    JausComponent,
)
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ReportStatus
from jausml.runtime.services.definitions import Status

HELD = (ControlState.CONTROLLED, ControlState.READY)
PATIENCE = 20.0  # seconds of silence after which a component that lets us wait counts as lost
_WAITS = (HandoffAnswer.QUEUED, HandoffAnswer.DEFERRED)

# The words for a new state, by whether control was held before.
_CHANGES = {
    (True, ControlState.READY): "is READY again",
    (True, ControlState.CONTROLLED): "is READY no more",
    (False, ControlState.READY): "is controlled again, and READY",
    (False, ControlState.CONTROLLED): "is controlled again, and not READY",
}


class Hold:
    """Control of one component, from the request on, and the messages sent under it.

    Attributes:
        sent: Number of sent messages.
        doubtful: Number of them that the component may have ignored, as it was not Ready or not
            controlled by us.
        is_lost: Whether it ever left Ready, or control was lost, other than by our command.
        was_ready: Whether it was Ready under our control; False again after our Standby.
        session: Control in the runtime; None before the request.
        last_change: The last change of control, in words; empty without one.
    """

    def __init__(self, target: JausAddress, on_change: Callable[[str], None] | None) -> None:
        self.target = target
        self.sent = 0
        self.doubtful = 0
        self.is_lost = False
        self.was_ready = False
        self.session: ControlSession | None = None
        self.last_change = ""
        self._on_change = on_change
        self._first: SimpleQueue[ControlState] = SimpleQueue()
        self._state = ControlState.SEEKING
        self._was_given = False
        self._confirmed = 0
        self._news = Condition()

    @property
    def is_held(self) -> bool:
        """Whether the component is controlled."""
        return self.session is not None and self.session.state in HELD

    @property
    def is_obeyed(self) -> bool:
        """Whether the component takes our commands, as far as known."""
        return self._obeys(self._state)

    def answer(self, timeout: float) -> ControlState | None:
        """Waits for the first answer to the request; None when none comes in time (seconds)."""
        try:
            return self._first.get(timeout=timeout)
        except Empty:
            return None

    def count(self) -> None:
        """Counts a message that is sent now."""
        self.sent += 1
        if not self._obeys(self._state):
            self.doubtful += 1
            self._confirmed = self.sent

    def expect_standby(self) -> None:
        """Notes that the component leaves Ready by our command."""
        self.was_ready = False

    def wait_for_loss(self, seconds: float) -> bool:
        """Waits for a loss, at most so many seconds; returns whether control is lost."""
        with self._news:
            return self._news.wait_for(lambda: self.is_lost, max(0.0, seconds))

    def lose(self) -> None:
        """Notes a loss; messages since the last sign of control become doubtful."""
        with self._news:
            self.is_lost = True
            self.doubtful += self.sent - self._confirmed
            self._confirmed = self.sent
            self._news.notify_all()

    # ---- on the loop's thread ---------------------------------------------------------------

    def changed(self, state: ControlState) -> None:
        """Takes the next state of control."""
        before, self._state = self._state, state
        if not self._was_given:
            self._was_given = state in HELD
            self._first.put(state)
            return
        if self._obeys(before) and not self._obeys(state):
            self.lose()
        if not self._obeys(before) or not self._obeys(state):
            self._report_change(before, state)
        self.was_ready |= state is ControlState.READY

    def status_reported(self, report: ReportStatus) -> None:
        """Takes a status of the component; one under our control confirms earlier messages."""
        if self.is_held and (report.status == Status.READY or not self.was_ready):
            self._confirmed = self.sent

    def rejected(self) -> None:
        """Notes that the component has ended our control, after it took all messages."""
        self._confirmed = self.sent

    def _obeys(self, state: ControlState) -> bool:
        return state is ControlState.READY or (state in HELD and not self.was_ready)

    def _report_change(self, before: ControlState, state: ControlState) -> None:
        if state is ControlState.REFUSED:
            self.last_change = "gives us no control any more"
        elif state is ControlState.SEEKING:
            self.last_change = "is not controlled by us any more"
        else:
            self.last_change = _CHANGES[before in HELD, state]
        if self._on_change is not None:
            self._on_change(self.last_change)


class Handoffs:
    """Requests for handoff of control: those that a person has to decide, and our own.

    Attributes:
        on_news: Is called with news for people.
    """

    def __init__(self, component: JausComponent) -> None:
        self._component = component
        self._waiting: dict[JausAddress, tuple[HandoffRequest, ...]] = {}
        self.on_news: Callable[[str], None] = lambda _: None

    @property
    def waiting(self) -> tuple[HandoffRequest, ...]:
        """The undecided requests for components that we control or did control."""
        waiting = tuple(self._waiting.values())
        return tuple(request for requests in waiting for request in requests)

    def take_requests(self, target: JausAddress, requests: tuple[HandoffRequest, ...]) -> None:
        """Takes all open requests for control of a component; on the loop's thread."""
        self._waiting[target] = requests
        for request in requests:
            self.on_news(
                f"{request.client} asks for control of {target} with authority "
                f"{request.authority}: {request.explanation!r}; "
                f"'grant {target} {request.number}', 'deny' or 'defer'"
            )
        if not requests:
            self.on_news(f"nobody asks for control of {target} any more")

    def decide(self, target: JausAddress, number: int, decision: HandoffDecision) -> HandoffRequest:
        """Sends a decision to a component, and returns the request.

        Raises:
            JausError: The request has ended.
            Refused: There is no request with the number.
        """
        for request in self._waiting.get(target, ()):
            if request.number == number:
                self._component.decide_handoff(request, decision)
                if decision is not HandoffDecision.WAIT:
                    left = (other for other in self._waiting[target] if other is not request)
                    self._waiting[target] = tuple(left)
                return request
        raise Refused(f"nobody asks for control of {target} under number {number}")

    def request(
        self,
        target: JausAddress,
        authority: int,
        explanation: str,
        unanswered: Callable[[], NoAnswer],
        timeout: float,
    ) -> None:
        """Requests a handoff, and waits until the controller has granted it.

        Args:
            unanswered: Returns the error for a component that does not answer.
            timeout: Seconds to wait for the first answer.

        Raises:
            NoAnswer: The component does not answer, or no longer.
            Refused: The request is denied.
        """
        answers: SimpleQueue[HandoffAnswer] = SimpleQueue()
        pending = self._component.request_handoff(
            target, authority=authority, explanation=explanation, on_answer=answers.put
        )
        last, patience = None, timeout
        try:
            while (answer := answers.get(timeout=patience)) in _WAITS:
                if answer is not last:
                    self.on_news(f"{target} lets us wait: {answer.name}")
                last, patience = answer, PATIENCE
        except Empty:
            raise unanswered() from None
        finally:
            pending.cancel()
        if answer is not HandoffAnswer.GRANTED:
            raise Refused(f"{target} is not handed over: {answer.name}")
