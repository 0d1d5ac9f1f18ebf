"""The EnhancedAccessControl service: the controller hands control to another client (IOP).

The component queues the requests of clients, sends the queue to its controller, and does as the
controller decides. Comments tell where the public descriptions of the service are silent.
"""

from __future__ import annotations

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..messages import (
    ConfirmHandoffRequest,
    ConfirmReleaseControl,
    QueryEnhancedTimeout,
    QueryHandoffTimeout,
    RemoveHandoffRequest,
    ReportEnhancedTimeout,
    ReportHandoffTimeout,
    RequestHandoff,
    RequestReleaseControl,
)
from ..messages.handoff import HandoffDecision as Decision
from .access_control import AccessControlService
from .host import Host

NO_REQUEST = 255  # number in the answer to a client without a request
MAX_REQUESTS = 16  # clients in the queue; false ones must not flood the controller
PAUSE = 0.1  # seconds for which changes are collected before the controller is sent the queue

Confirm = ConfirmHandoffRequest.ResponseCode


class _Request:
    """A client in the queue, and the times of its first and its last request."""

    __slots__ = ("asked_at", "authority", "client", "explanation", "number", "renewed_at")

    def __init__(self, number: int, client: JausAddress, now: float) -> None:
        self.number = number
        self.client = client
        self.authority = 0
        self.explanation = ""
        self.asked_at = self.renewed_at = now


class HandoffService:
    """Queues requests for control from the controller (IOP, EnhancedAccessControl, behaviour)."""

    urns = frozenset(["urn:jaus:jss:iop:EnhancedAccessControl"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._access = component.part(AccessControlService)
        self._handoff_timeout = component.settings.handoff_timeout
        self._enhanced_timeout = component.settings.enhanced_timeout
        self._requests: dict[JausAddress, _Request] = {}
        self._last_number = NO_REQUEST - 1
        self._expiry = Alarm(component.loop)
        self._sending = Alarm(component.loop)

    def attach(self) -> None:
        """Takes the messages of EnhancedAccessControl."""
        component = self._component
        self._access.on_changed = self._controller_changed
        component.handle(RequestHandoff, self._request)
        component.handle(RemoveHandoffRequest, self._remove)
        component.handle(ConfirmReleaseControl, self._take_decisions)
        component.provide(
            QueryHandoffTimeout,
            ReportHandoffTimeout,
            lambda *_: ReportHandoffTimeout(timeout=self._handoff_timeout),
        )
        component.provide(
            QueryEnhancedTimeout,
            ReportEnhancedTimeout,
            lambda *_: ReportEnhancedTimeout(timeout=self._enhanced_timeout),
        )

    # ---- clients ------------------------------------------------------------------------------

    def _request(self, message: RequestHandoff, client: JausAddress) -> None:
        code = message.authority_code
        if not self._access.available:
            self._confirm(client, NO_REQUEST, Confirm.NOT_AVAILABLE)
        elif self._access.controller is None:
            self._confirm(client, NO_REQUEST, Confirm.DENIED)
        elif code < self._access.default_authority:
            self._end(client, Confirm.INSUFFICIENT_AUTHORITY)
        elif client == self._access.controller:
            self._access.change_authority(code)
            self._confirm(client, NO_REQUEST, Confirm.GRANTED)
        elif client not in self._requests and len(self._requests) >= MAX_REQUESTS:
            self._component.counters.add("handoff.too_many")
            self._confirm(client, NO_REQUEST, Confirm.NOT_AVAILABLE)
        else:
            self._queue(message, client)

    def _queue(self, message: RequestHandoff, client: JausAddress) -> None:
        now = self._component.loop.now()
        request = self._requests.get(client)
        if request is None:
            request = self._requests[client] = _Request(self._free_number(), client, now)
        request.authority = message.authority_code
        request.explanation = message.explanation
        request.renewed_at = now
        self._confirm(client, request.number, Confirm.QUEUED)
        self._changed()

    def _remove(self, message: RemoveHandoffRequest, client: JausAddress) -> None:
        request = self._requests.get(client)
        if request is None and not self._access.available:
            self._confirm(client, NO_REQUEST, Confirm.NOT_AVAILABLE)
        elif request is None and self._access.controller is None:
            self._confirm(client, NO_REQUEST, Confirm.DENIED)
        elif request is None or request.number != message.id_:
            self._component.counters.add("handoff.removal_ignored")  # no answer is described
        else:
            self._end(client, Confirm.DENIED)

    def _end(self, client: JausAddress, code: Confirm) -> None:
        """Ends the request of a client, if it has one, and sends it the reason."""
        request = self._requests.pop(client, None)
        self._confirm(client, NO_REQUEST if request is None else request.number, code)
        if request is not None:
            self._changed()

    def _confirm(self, client: JausAddress, number: int, code: Confirm) -> None:
        answer = ConfirmHandoffRequest(id_=number, response_code=code)
        # Acknowledged, since it may end a request, which the client repeats until then.
        self._component.send(answer, client, acknowledge=number != NO_REQUEST)

    def _free_number(self) -> int:
        """Returns the next free number, which no late decision can mean."""
        taken = {request.number for request in self._requests.values()}
        number = self._last_number
        while True:
            number = (number + 1) % NO_REQUEST
            if number not in taken:
                self._last_number = number
                return number

    # ---- controller ---------------------------------------------------------------------------

    def _take_decisions(self, message: ConfirmReleaseControl, sender: JausAddress) -> None:
        if sender != self._access.controller or not self._access.available:
            self._component.counters.add("handoff.decision_ignored")
            return
        waiting = {request.number: request for request in self._requests.values()}
        granted: _Request | None = None
        for decision in message.release_control_list:
            decided = waiting.pop(decision.id_, None)
            if decided is None:
                self._component.counters.add("handoff.decision_ignored")
            elif decision.response_code == Decision.WAIT:
                decided.asked_at = self._component.loop.now()
                self._confirm(decided.client, decided.number, Confirm.DEFERRED)
            elif decision.response_code == Decision.GRANTED and granted is None:
                granted = decided
            else:
                self._end(decided.client, Confirm.DENIED)
        if granted is not None:
            self._hand_over(granted)
        self._watch()

    def _hand_over(self, granted: _Request) -> None:
        """Gives control to one client, and denies the others (IOP, ConfirmReleaseControl)."""
        del self._requests[granted.client]
        for client in list(self._requests):
            self._end(client, Confirm.DENIED)
        self._component.counters.add("handoff.granted")
        self._access.pass_control(
            granted.client,
            granted.authority,
            lambda: self._confirm(granted.client, granted.number, Confirm.GRANTED),
        )

    def _controller_changed(self) -> None:
        """Sends the queue to a new controller; without one, ends all requests.

        The public descriptions do not say what happens to them.
        """
        controller = self._access.controller
        if controller is None:
            code = Confirm.DENIED if self._access.available else Confirm.NOT_AVAILABLE
            for client in list(self._requests):
                self._end(client, code)
            return
        if controller in self._requests:
            self._end(controller, Confirm.GRANTED)
        now = self._component.loop.now()
        for request in self._requests.values():
            request.asked_at = now
        if self._requests:
            self._changed()

    def _changed(self) -> None:
        """Sends the controller the queue soon, and sets the timer of its time-outs."""
        if not self._sending.is_set:
            self._sending.set(PAUSE, self._send_queue)
        self._watch()

    def _send_queue(self) -> None:
        controller = self._access.controller
        if controller is None:
            return
        waiting = [
            RequestReleaseControl.RequestReleaseControlRec(
                id_=request.number,
                src_subsystem_id=request.client.subsystem,
                src_node_id=request.client.node,
                src_component_id=request.client.component,
                authority_code=request.authority,
                explanation=request.explanation,
            )
            for request in self._requests.values()
        ]
        message = RequestReleaseControl(request_release_control_list=waiting)
        self._component.send(message, controller, acknowledge=True)

    # ---- time ---------------------------------------------------------------------------------

    def _watch(self) -> None:
        self._expiry.cancel()
        due = min(
            (min(self._ends_of(request)) for request in self._requests.values()), default=None
        )
        if due is not None and due != float("inf"):
            self._expiry.set_at(due, self._expire)

    def _ends_of(self, request: _Request) -> tuple[float, float]:
        """Returns the times of a request's time-out, and of its end without a repetition."""
        handoff, enhanced = self._handoff_timeout, self._enhanced_timeout
        return (
            request.asked_at + handoff if handoff else float("inf"),
            request.renewed_at + enhanced if enhanced else float("inf"),
        )

    def _expire(self) -> None:
        now = self._component.loop.now()
        for request in list(self._requests.values()):
            timeout, lapse = self._ends_of(request)
            if timeout <= now:
                self._end(request.client, Confirm.TIMEOUT)
            elif lapse <= now:
                self._end(request.client, Confirm.DENIED)
        self._watch()
