"""The EnhancedAccessControl service: the controller hands control to another client (IOP).

The component never decides: it lets clients wait, tells its controller who waits, and does as the
controller answers. Where the public descriptions of the service are silent, the comments say so.
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

NO_REQUEST = 255  # number in the answer to a client that has no request; requests have others
MAX_REQUESTS = 16  # clients that wait at a time; a flood of false ones must not bury the controller
PAUSE = 0.1  # seconds in which changes are collected before the controller is told

Confirm = ConfirmHandoffRequest.ResponseCode


class _Request:
    """A client that waits, when its controller was asked first, and when it said so last."""

    __slots__ = ("asked_at", "authority", "client", "explanation", "number", "renewed_at")

    def __init__(self, number: int, client: JausAddress, now: float) -> None:
        self.number = number
        self.client = client
        self.authority = 0
        self.explanation = ""
        self.asked_at = self.renewed_at = now


class HandoffService:
    """Keeps who asks the controller for control (IOP, EnhancedAccessControl, behaviour)."""

    urns = frozenset(["urn:jaus:jss:iop:EnhancedAccessControl"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._access = component.part(AccessControlService)
        self._handoff_timeout = component.settings.handoff_timeout
        self._enhanced_timeout = component.settings.enhanced_timeout
        self._requests: dict[JausAddress, _Request] = {}
        self._last_number = NO_REQUEST - 1
        self._expiry = Alarm(component.loop)
        self._telling = Alarm(component.loop)

    def attach(self) -> None:
        """Takes the messages of EnhancedAccessControl."""
        component = self._component
        self._access.on_changed = self._controller_changed
        component.handle(RequestHandoff, self._request)
        component.handle(RemoveHandoffRequest, self._remove)
        component.handle(ConfirmReleaseControl, self._decided)
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

    # ---- what clients want --------------------------------------------------------------------

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
        """Tells a client why it waits no longer, if it does, and the controller who is left."""
        request = self._requests.pop(client, None)
        self._confirm(client, NO_REQUEST if request is None else request.number, code)
        if request is not None:
            self._changed()

    def _confirm(self, client: JausAddress, number: int, code: Confirm) -> None:
        answer = ConfirmHandoffRequest(id_=number, response_code=code)
        # Whoever waits sends its request again; what ends that is repeated until it is heard.
        self._component.send(answer, client, acknowledge=number != NO_REQUEST)

    def _free_number(self) -> int:
        """Returns the next number, so that a late decision meets no newer request."""
        taken = {request.number for request in self._requests.values()}
        number = self._last_number
        while True:
            number = (number + 1) % NO_REQUEST
            if number not in taken:
                self._last_number = number
                return number

    # ---- what the controller decides ----------------------------------------------------------

    def _decided(self, message: ConfirmReleaseControl, sender: JausAddress) -> None:
        if sender != self._access.controller or not self._access.available:
            self._component.counters.add("handoff.decision_ignored")
            return
        waiting = {
            pending_request.number: pending_request for pending_request in self._requests.values()
        }
        granted: _Request | None = None
        for decision in message.release_control_list:
            request = waiting.pop(decision.id_, None)
            if request is None:
                self._component.counters.add("handoff.decision_ignored")
            elif decision.response_code == Decision.WAIT:
                request.asked_at = self._component.loop.now()
                self._confirm(request.client, request.number, Confirm.DEFERRED)
            elif decision.response_code == Decision.GRANTED and granted is None:
                granted = request
            else:
                self._end(request.client, Confirm.DENIED)
        if granted is not None:
            self._hand_over(granted)
        self._watch()

    def _hand_over(self, granted: _Request) -> None:
        """Gives control to one client; the others are denied (IOP, ConfirmReleaseControl)."""
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
        """Begins anew with another controller; without one there is nobody to ask.

        The descriptions do not say what becomes of those that wait.
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
        """Tells the controller soon who waits, and watches how long they do."""
        if not self._telling.is_set:
            self._telling.set(PAUSE, self._tell)
        self._watch()

    def _tell(self) -> None:
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
        """Returns when a request has waited too long, and when its client is taken for gone."""
        handoff, enhanced = self._handoff_timeout, self._enhanced_timeout
        return (
            request.asked_at + handoff if handoff else float("inf"),
            request.renewed_at + enhanced if enhanced else float("inf"),
        )

    def _expire(self) -> None:
        now = self._component.loop.now()
        for request in list(self._requests.values()):
            undecided, gone = self._ends_of(request)
            if undecided <= now:
                self._end(request.client, Confirm.TIMEOUT)
            elif gone <= now:
                self._end(request.client, Confirm.DENIED)
        self._watch()
