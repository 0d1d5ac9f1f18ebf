"""Handoff of control between operators (IOP, HandoffController): to ask for it, and to decide."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.address import JausAddress
from ..base.api import JausError
from ..messages import (
    ConfirmHandoffRequest,
    ConfirmReleaseControl,
    QueryEnhancedTimeout,
    RemoveHandoffRequest,
    ReportEnhancedTimeout,
    RequestHandoff,
    RequestReleaseControl,
)
from ..messages.access_control import HandoffDecision
from ..services.definitions import HandoffRequest

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.loop import Timer
    from ..services.host import Host
    from .control_session import ControlClient

RENEWALS = 3
"""How often a request is sent again in the time in which it would lapse."""

RENEWAL = 3.0
"""Seconds between two requests to a component that has not said when they lapse."""

DECISION_TRIES = 3
"""How often a decision is given to the transport, which repeats it each time: who has granted
commands no more, and control would lapse."""

HandoffAnswer = ConfirmHandoffRequest.ResponseCode

_GOES_ON = (HandoffAnswer.QUEUED, HandoffAnswer.DEFERRED)


class PendingHandoff:
    """A request for control of a target; made by ``JausComponent.request_handoff``."""

    def __init__(
        self,
        host: Host,
        target: JausAddress,
        message: RequestHandoff,
        on_answer: Callable[[HandoffAnswer], None] | None,
    ) -> None:
        """Use ``JausComponent.request_handoff`` instead."""
        self.target = target
        self.number: int | None = None
        self.pause = RENEWAL
        self._host = host
        self._message = message
        self._on_answer = on_answer
        self._timer: Timer | None = None

    def cancel(self) -> None:
        """Take the request back; no effect once it is decided."""
        with self._host.loop.lock:
            if self._timer is not None and self.number is not None:
                removal = RemoveHandoffRequest(id_=self.number)
                self._host.send(removal, self.target, acknowledge=True)
            self.end()

    def end(self) -> None:
        """Ask no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def ask(self) -> None:
        """Send the request, and again before it lapses."""
        self._timer = self._host.loop.call_later(self.pause, self.ask)
        self._host.send(self._message, self.target, acknowledge=True)

    def answered(self, message: ConfirmHandoffRequest) -> bool:
        """Take an answer; return whether it grants control."""
        if self._timer is None:
            return False
        answer = HandoffAnswer(message.response_code)
        if answer in _GOES_ON:
            self.number = message.id_
        else:
            self.end()
        if self._on_answer is not None:
            self._host.call(self._on_answer, answer)
        return answer is HandoffAnswer.GRANTED


class HandoffClient:
    """Requests of one component, and those that it is to decide."""

    def __init__(self, host: Host, control: ControlClient) -> None:
        self._host = host
        self._control = control
        self._pending: dict[JausAddress, PendingHandoff] = {}
        self._open: dict[JausAddress, tuple[HandoffRequest, ...]] = {}
        host.on_message(ConfirmHandoffRequest, self._answered)
        host.on_message(ReportEnhancedTimeout, self._timeout_reported)
        host.on_message(RequestReleaseControl, self._asked)

    def request(
        self,
        target: JausAddress,
        authority: int,
        explanation: str,
        on_answer: Callable[[HandoffAnswer], None] | None,
    ) -> PendingHandoff:
        """Ask for control; a request of the same target before is replaced."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        message = RequestHandoff(authority_code=authority, explanation=explanation)
        message.encode()
        former = self._pending.get(target)
        if former is not None:
            former.end()
        made = self._pending[target] = PendingHandoff(self._host, target, message, on_answer)
        self._host.when_started(made.ask)
        self._host.when_started(lambda: self._host.send(QueryEnhancedTimeout(), target))
        return made

    def decide(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Tell the target of a request what was decided of it; who grants gives control up.

        At most one request can be granted, and all others are denied then (IOP).
        """
        waiting = self._open.get(request.target, ())
        if request not in waiting:
            raise JausError(f"{request.client} does not ask for {request.target} any more")
        decided = {request: decision}
        if decision is HandoffDecision.GRANTED:
            decided = dict.fromkeys(waiting, HandoffDecision.DENIED) | decided
        record = ConfirmReleaseControl.ReleaseControlRec
        records = [record(each.number, code) for each, code in decided.items()]
        message = ConfirmReleaseControl(release_control_list=records)
        self._tell(request.target, message, DECISION_TRIES)
        if decision is not HandoffDecision.WAIT:
            self._open[request.target] = tuple(each for each in waiting if each not in decided)
        if decision is HandoffDecision.GRANTED:
            self._control.hand_over(request.target)

    def _tell(self, target: JausAddress, message: ConfirmReleaseControl, tries: int) -> None:
        """Tell a decision, again when no repetition of the transport was acknowledged."""

        def ended(acknowledged: bool) -> None:  # noqa: FBT001
            if not acknowledged and tries > 1 and self._host.running:
                self._tell(target, message, tries - 1)

        self._host.transport.send(
            self._host.address, target, message.encode(), acknowledge=True, on_result=ended
        )

    def stop(self) -> None:
        """Ask for nothing any more."""
        for each in self._pending.values():
            each.end()
        self._pending.clear()
        self._open.clear()

    def _answered(self, message: ConfirmHandoffRequest, sender: JausAddress) -> None:
        pending = self._pending.get(sender)
        if pending is not None and pending.answered(message):
            self._control.take_over(sender)

    def _timeout_reported(self, message: ReportEnhancedTimeout, sender: JausAddress) -> None:
        pending = self._pending.get(sender)
        if pending is not None and message.timeout:
            pending.pause = message.timeout / RENEWALS

    def _asked(self, message: RequestReleaseControl, sender: JausAddress) -> None:
        if not self._control.holds(sender):
            self._host.counters.add("handoff_client.not_controlled")
            return
        before = self._open.get(sender, ())
        self._open[sender] = waiting = tuple(
            HandoffRequest(
                sender,
                each.id_,
                JausAddress(each.src_subsystem_id, each.src_node_id, each.src_component_id),
                each.authority_code,
                each.explanation,
            )
            for each in message.request_release_control_list
        )
        if waiting != before:
            self._host.call(self._host.on_handoff_requested, sender, waiting)
