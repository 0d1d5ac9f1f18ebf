"""Handoff of control between operators (IOP, HandoffController): requests and decisions."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..base.api import JausError
from ..base.clocks import Alarm
from ..messages import (
    ConfirmHandoffRequest,
    ConfirmReleaseControl,
    QueryEnhancedTimeout,
    RemoveHandoffRequest,
    ReportEnhancedTimeout,
    RequestHandoff,
    RequestReleaseControl,
)
from ..messages.handoff import HandoffDecision
from ..services.definitions import HandoffRequest
from ..services.host import Host
from .control_session import ControlClient
from .query import QueryClient

RENEWALS = 3  # how often a request is sent within the timeout after which it lapses
RENEWAL = 3.0  # seconds between two requests to a component that has not reported its timeout
QUERY_PAUSE = 0.3  # seconds between two queries for that timeout

# How often a decision is given to the transport, which repeats it each time. A lost GRANTED would
# leave the target without a controller.
DECISION_TRIES = 3

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
        self.target = target
        self.number: int | None = None
        self._pause = RENEWAL
        self._has_ended = self._is_withdrawn = False
        self._host = host
        self._message = message
        self._on_answer = on_answer
        self._timer = Alarm(host.loop)

    def cancel(self) -> None:
        """Withdraws the request; no effect once it is decided."""
        with self._host.loop.lock:
            if self._has_ended:
                return
            self.end()
            self._is_withdrawn = True
            if self.number is not None:
                self._remove(self.number)
            else:
                # If it is on its way already, its answer says the number to remove.
                host, payload = self._host, self._message.encode()
                host.transport.withdraw(host.address, self.target, payload)

    def _remove(self, number: int) -> None:
        self._host.send(RemoveHandoffRequest(id_=number), self.target, acknowledge=True)

    def end(self) -> None:
        """Stops sending the request."""
        self._has_ended = True
        self._timer.cancel()

    def ask(self) -> None:
        """Sends the request now, and again before it lapses."""
        if self._has_ended:
            return  # before the start
        self._timer.set(self._pause, self.ask)
        self._host.send(self._message, self.target, acknowledge=True)

    def renew(self, timeout: int) -> None:
        """Sends the request so often that it does not lapse after a time-out in seconds."""
        if timeout:
            self._pause = timeout / RENEWALS
            if self._timer.is_set:
                self._timer.set(self._pause, self.ask)

    def answered(self, message: ConfirmHandoffRequest) -> bool:
        """Takes an answer; returns whether it grants control."""
        answer = HandoffAnswer(message.response_code)
        if self._is_withdrawn and answer in _GOES_ON:
            self._remove(message.id_)
        if self._has_ended:
            return False
        if answer in _GOES_ON:
            self.number = message.id_
        else:
            self.end()
        if self._on_answer is not None:
            self._host.call(self._on_answer, answer)
        return answer is HandoffAnswer.GRANTED


class HandoffClient:
    """Handoff requests by one component, and those that it decides as a controller."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._control = host.part(ControlClient)
        self._pending: dict[JausAddress, PendingHandoff] = {}
        self._undecided: dict[JausAddress, tuple[HandoffRequest, ...]] = {}
        host.on_message(ConfirmHandoffRequest, self._answered)
        host.on_message(RequestReleaseControl, self._take_requests)
        host.when_stopped(self.stop)

    def request(
        self,
        target: JausAddress,
        authority: int,
        explanation: str,
        on_answer: Callable[[HandoffAnswer], None] | None,
    ) -> PendingHandoff:
        """Requests control of a target; replaces a former request to it."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        message = RequestHandoff(authority_code=authority, explanation=explanation)
        message.encode()
        former = self._pending.get(target)
        if former is not None:
            former.end()
        handoff = self._pending[target] = PendingHandoff(self._host, target, message, on_answer)
        self._host.when_started(handoff.ask)
        self._host.part(QueryClient).ask(
            target,
            QueryEnhancedTimeout(),
            ReportEnhancedTimeout,
            lambda report, _sender: handoff.renew(report.timeout),
            timeout=QUERY_PAUSE,
            retries=RENEWALS,
        )
        return handoff

    def decide(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Sends the decision on a request to its target; GRANTED gives up control of it.

        At most one request can be granted; all others are denied then (IOP).
        """
        waiting = self._undecided.get(request.target, ())
        if request not in waiting:
            raise JausError(f"{request.client} does not ask for {request.target} any more")
        decisions = {request: decision}
        if decision is HandoffDecision.GRANTED:
            decisions = dict.fromkeys(waiting, HandoffDecision.DENIED) | decisions
        record = ConfirmReleaseControl.ReleaseControlRec
        records = [record(decided.number, code) for decided, code in decisions.items()]
        message = ConfirmReleaseControl(release_control_list=records)
        self._send_decision(request.target, message, DECISION_TRIES)
        if decision is not HandoffDecision.WAIT:
            self._undecided[request.target] = tuple(
                undecided for undecided in waiting if undecided not in decisions
            )
        if decision is HandoffDecision.GRANTED:
            self._control.hand_over(request.target)

    def _send_decision(
        self, target: JausAddress, message: ConfirmReleaseControl, tries: int
    ) -> None:
        """Sends a decision, and again when the transport got no acknowledgement."""

        def ended(acknowledged: bool) -> None:  # noqa: FBT001
            if not acknowledged and tries > 1 and self._host.running:
                self._send_decision(target, message, tries - 1)

        self._host.transport.send(
            self._host.address, target, message.encode(), acknowledge=True, on_result=ended
        )

    def stop(self) -> None:
        """Ends all requests."""
        for pending_handoff in self._pending.values():
            pending_handoff.end()
        self._pending.clear()
        self._undecided.clear()

    def _answered(self, message: ConfirmHandoffRequest, sender: JausAddress) -> None:
        pending = self._pending.get(sender)
        if message.response_code not in tuple(HandoffAnswer):
            self._host.counters.count("handoff_client.bad_answer", f"{message} of {sender}")
        elif pending is not None and pending.answered(message):
            self._control.take_over(sender)

    def _take_requests(self, message: RequestReleaseControl, sender: JausAddress) -> None:
        if not self._control.holds(sender):
            self._host.counters.add("handoff_client.not_controlled")
            return
        before = self._undecided.get(sender, ())
        self._undecided[sender] = waiting = tuple(
            HandoffRequest(
                sender,
                record.id_,
                JausAddress(record.src_subsystem_id, record.src_node_id, record.src_component_id),
                record.authority_code,
                record.explanation,
            )
            for record in message.request_release_control_list
        )
        if waiting != before:
            self._host.call(self._host.on_handoff_requested, sender, waiting)
