"""The AccessControl service: one client at a time controls the component (AS5710)."""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.loop import Loop
from ..messages import (
    ConfirmControl,
    QueryAuthority,
    QueryControl,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportAuthority,
    ReportControl,
    ReportTimeout,
    RequestControl,
    SetAuthority,
)
from ..wire.message import Message
from .definitions import CORE, VERSION_1_1, Guard
from .host import Host

LIMIT = 10  # refusals with the same code that a requester gets at once in each period
PERIOD = 1.0  # seconds
MAX_REQUESTERS = 256  # requesters that are counted; false ones must not fill the memory


@dataclass(slots=True)
class _Count:
    """Refusals of one requester with the same code in the present period."""

    waiting: Alarm
    code: int = -1
    since: float = 0.0
    number: int = 0


class Refusals:
    """Counts the refusals of each requester, and delays those over the limit.

    Some clients request again as soon as they are refused, as fast as the network allows.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._counts: dict[JausAddress, _Count] = {}

    def put_off(self, requester: JausAddress, code: int, again: Callable[[], None]) -> bool:
        """Returns whether a refusal is over the limit, and so delayed until the period ends.

        Then `again` is called, for the last one of several delayed requests. A refusal with another
        code is never delayed.
        """
        now = self._loop.now()
        count = self._counts.get(requester) or self._begin(requester, now)
        if count is None:
            return False
        if count.code != code or now >= count.since + PERIOD:
            count.code, count.since, count.number = code, now, 0
        count.number += 1
        if count.number <= LIMIT:
            return False
        count.waiting.set_at(count.since + PERIOD, again)
        return True

    def forget(self, requester: JausAddress) -> None:
        """Drops the delayed request of a requester, which has sent a newer one or has control."""
        count = self._counts.get(requester)
        if count is not None:
            count.waiting.cancel()

    def _begin(self, requester: JausAddress, now: float) -> _Count | None:
        if len(self._counts) >= MAX_REQUESTERS:
            self._counts = {
                requester: count
                for requester, count in self._counts.items()
                if count.waiting.is_set or now < count.since + PERIOD
            }
            if len(self._counts) >= MAX_REQUESTERS:
                return None
        count = self._counts[requester] = _Count(Alarm(self._loop))
        return count


Confirm = ConfirmControl.ResponseCode
Reject = RejectControl.ResponseCode


class AccessControlService:
    """Decides which client controls the component (AS5710, AccessControl, protocol behaviour).

    A component that provides AccessControl v1.0 answers ReleaseControl as in v1.0.

    Attributes:
        authority: Authority code of the controller; the default authority without one.
        offered: Whether the component itself offers control.
        managed: Whether its Management state allows control.
        has_lapsed: Whether the last controller did not request control again in time.
        kept: Whether the controller keeps control while it is not available to others.
        on_lost: Called when control ends, before the controller is told.
        on_changed: Called after the controller has changed.
    """

    urns = frozenset([CORE + "AccessControl"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._timer = Alarm(component.loop)
        self._timeout = component.settings.control_timeout
        self._default = component.settings.default_authority
        self.controller: JausAddress | None = None
        self.authority = self._default
        self.offered = True
        self.managed = True
        self.has_lapsed = False
        self.kept = False
        self.emergency_clients: Set[JausAddress] = frozenset()
        self.on_lost: Callable[[], None] = _nothing
        self.on_changed: Callable[[], None] = _nothing
        self._refusals = Refusals(component.loop)
        self._is_1_0 = component.core_version("AccessControl") < VERSION_1_1

    def attach(self) -> None:
        """Takes the messages of AccessControl."""
        component = self._component
        component.handle(RequestControl, self._request)
        component.handle(ReleaseControl, self._release)
        component.handle(SetAuthority, self._set_authority, when=Guard.CONTROLLED)
        component.provide(QueryControl, ReportControl, self._report_control)
        component.provide(
            QueryAuthority, ReportAuthority, lambda *_: ReportAuthority(self.authority)
        )
        component.provide(QueryTimeout, ReportTimeout, lambda *_: ReportTimeout(self._timeout))

    @property
    def available(self) -> bool:
        """Whether control may be requested now."""
        return self.offered and self.managed

    @property
    def default_authority(self) -> int:
        """The lowest authority code that may control the component."""
        return self._default

    def drop(self, reason: Reject) -> None:
        """Ends control and sends the controller RejectControl; no effect without one."""
        former = self.controller
        if former is None:
            return
        self._timer.cancel()
        self.controller = None
        self.authority = self._default
        self.on_lost()
        self._component.call(self._component.on_control_lost)
        self._component.send(RejectControl(response_code=reason), former, acknowledge=True)
        self._controller_changed()

    def restore(self, controller: JausAddress, authority: int) -> None:
        """Gives control back to the controller before an emergency (AS5710 v1.0, Management)."""
        self.controller = controller
        self.authority = authority
        self._restart_timer()
        self._controller_changed()

    def _request(self, message: RequestControl, sender: JausAddress) -> None:
        self._refusals.forget(sender)
        code = message.authority_code
        if not self.available and not (self.kept and sender == self.controller):
            self._refuse(message, sender, Confirm.NOT_AVAILABLE)
        elif sender == self.controller:
            if code < self._default:
                self.drop(Reject.CONTROL_RELEASED)
            else:
                self._grant(sender, code)
        elif code < self._default or (self.controller is not None and code <= self.authority):
            self._refuse(message, sender, Confirm.INSUFFICIENT_AUTHORITY)
        else:
            self._grant(sender, code)

    def _grant(self, sender: JausAddress, code: int) -> None:
        self.pass_control(sender, code, lambda: self._confirm(sender, Confirm.CONTROL_ACCEPTED))

    def pass_control(self, client: JausAddress, code: int, confirm: Callable[[], None]) -> None:
        """Makes a client the controller; rejects the former one, then calls `confirm`."""
        self._refusals.forget(client)
        former, self.controller = self.controller, client
        self.has_lapsed = False
        has_changed, self.authority = self.authority != code, code
        self._restart_timer()
        if former is not None and former != client:
            self._component.call(self._component.on_control_lost)
            reject = RejectControl(response_code=Reject.CONTROL_RELEASED)
            self._component.send(reject, former, acknowledge=True)
        confirm()
        if former != client:
            self._controller_changed()
        elif has_changed:
            self._authority_changed()

    def _release(self, _message: ReleaseControl, sender: JausAddress) -> None:
        self._refusals.forget(sender)
        if self.controller is None:
            is_refused = not (self.available or self._is_1_0 or sender in self.emergency_clients)
            reason = Reject.NOT_AVAILABLE if is_refused else Reject.CONTROL_RELEASED
            self._component.send(RejectControl(response_code=reason), sender)
        elif sender == self.controller and self.available:
            self.drop(Reject.CONTROL_RELEASED)
        elif not self.available and (self._is_1_0 or sender == self.controller):
            self._component.send(RejectControl(response_code=Reject.NOT_AVAILABLE), sender)
        else:
            self._component.counters.add("access_control.release_ignored")

    def _set_authority(self, message: SetAuthority, _sender: JausAddress) -> None:
        if self._default <= message.authority_code <= self.authority:
            self.change_authority(message.authority_code)
        else:
            self._component.counters.add("access_control.authority_ignored")

    def change_authority(self, code: int) -> None:
        """Sets the authority code of the controller."""
        self.authority = code
        self._authority_changed()

    def _timed_out(self) -> None:
        if self.available:
            self._component.counters.add("access_control.timed_out")
            self._component.core_event("Timedout")
            self.has_lapsed = True
            self.drop(Reject.CONTROL_RELEASED)
        else:
            self._restart_timer()

    def _restart_timer(self) -> None:
        if self._timeout:
            self._timer.set(self._timeout, self._timed_out)

    def _refuse(self, message: RequestControl, sender: JausAddress, code: Confirm) -> None:
        """Refuses control, now or after a delay for a client with too many requests."""
        if self._refusals.put_off(sender, code, lambda: self._request(message, sender)):
            self._component.counters.add("access_control.request_put_off")
        else:
            self._confirm(sender, code)

    def _confirm(self, client: JausAddress, code: Confirm) -> None:
        self._component.send(ConfirmControl(response_code=code), client)

    def _controller_changed(self) -> None:
        self._component.transport.keep_place(self._component.address, self.controller)
        self._component.call(self._component.on_controller_changed, self.controller)
        self._component.permissions_changed()
        self._component.core_state_changed()
        self._authority_changed()
        self.on_changed()

    def _authority_changed(self) -> None:
        self._component.report_changed(ReportControl)
        self._component.report_changed(ReportAuthority)

    def _report_control(self, _query: Message, _sender: JausAddress) -> ReportControl:
        client = self.controller
        if client is None:
            return ReportControl(authority_code=self.authority)
        return ReportControl(client.subsystem, client.node, client.component, self.authority)


def _nothing() -> None:
    """Does nothing, for a component without the other service."""
