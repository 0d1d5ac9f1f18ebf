"""Control of other components (AS5710, AccessControl and Management, client side)."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from ..messages import (
    ConfirmControl,
    QueryStatus,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportStatus,
    ReportTimeout,
    RequestControl,
    Resume,
)
from ..services.definitions import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Timer
    from ..services.host import Host
    from ..wire.message import Message

MISSED_CHECKS = 3
"""Checks without confirmation after which control is taken for lost."""


class ControlState(Enum):
    """What a component knows of its control over another one."""

    SEEKING = "seeking"
    """The target does not answer, or control was lost; it is requested."""
    CONTROLLED = "controlled"
    """The target is controlled, and not (yet) Ready."""
    READY = "ready"
    """The target is controlled and obeys every command."""
    REFUSED = "refused"
    """The target is not available or has a controller of the same or higher authority."""


class ControlSession:
    """One user's share in the control of a target; made by ``JausComponent.control``.

    Attributes:
        target: The component to control.
        authority: Authority code that was asked for.
        resume: Whether the target is to be resumed.
    """

    def __init__(
        self,
        control: _Control,
        authority: int,
        resume: bool,  # noqa: FBT001
        on_change: Callable[[ControlState], None] | None,
    ) -> None:
        """Use ``JausComponent.control`` instead."""
        self.target = control.target
        self.authority = authority
        self.resume = resume
        self._control = control
        self._on_change = on_change

    @property
    def state(self) -> ControlState:
        """What is known now."""
        return self._control.state

    def release(self) -> None:
        """End the session; control is released with the last session."""
        with self._control.component.loop.lock:
            self._control.leave(self)

    def changed(self) -> None:
        """Tell the user the present state, unless the session was released."""
        if self._on_change is not None and self._control.has(self):
            self._control.component.call(self._on_change, self._control.state)


class ControlClient:
    """All control sessions of one component, and the messages that concern them."""

    def __init__(self, component: Host) -> None:
        """Listen to the answers of targets."""
        self._component = component
        self._controls: dict[JausAddress, _Control] = {}
        component.on_message(ConfirmControl, self._confirmed)
        component.on_message(RejectControl, self._rejected)
        component.on_message(ReportTimeout, self._timeout_reported)
        component.on_message(ReportStatus, self._status_reported)

    def control(
        self,
        target: JausAddress,
        authority: int,
        resume: bool,  # noqa: FBT001
        on_change: Callable[[ControlState], None] | None,
    ) -> ControlSession:
        """Join the control of a target, which begins with the first session."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        if not 0 <= authority <= 255:
            raise ValueError(f"authority {authority} is outside 0..255")
        control = self._controls.get(target)
        if control is None:
            control = self._controls[target] = _Control(self, self._component, target)
        session = ControlSession(control, authority, resume, on_change)
        control.join(session)
        return session

    def forget(self, control: _Control) -> None:
        """Drop a control without sessions."""
        self._controls.pop(control.target, None)

    def stop(self) -> None:
        """Release all control."""
        for control in list(self._controls.values()):
            control.stop()

    def _confirmed(self, message: ConfirmControl, sender: JausAddress) -> None:
        control = self._controls.get(sender)
        if control is not None:
            control.confirmed(message.response_code)

    def _rejected(self, _message: RejectControl, sender: JausAddress) -> None:
        control = self._controls.get(sender)
        if control is not None:
            control.rejected()

    def _timeout_reported(self, message: ReportTimeout, sender: JausAddress) -> None:
        control = self._controls.get(sender)
        if control is not None:
            control.timeout_reported(message.timeout)

    def _status_reported(self, message: ReportStatus, sender: JausAddress) -> None:
        control = self._controls.get(sender)
        if control is not None:
            control.status_reported(message.status)


class _Control:
    """Keeps control of one target: requests, confirms in time, resumes.

    Attributes:
        component: The component that controls.
        target: The component to control.
        state: What is known now.
    """

    def __init__(self, client: ControlClient, component: Host, target: JausAddress) -> None:
        self.component = component
        self.target = target
        self.state = ControlState.SEEKING
        self._client = client
        self._loop = component.loop
        self._settings = component.settings
        self._sessions: list[ControlSession] = []
        self._delay = self._settings.retry_min
        self._timeout: int | None = None
        self._missed = 0
        self._resumed_at = float("-inf")
        self._requested = False
        self._awaits_answer = False
        self._timer: Timer | None = None

    @property
    def _holds(self) -> bool:
        return self.state in (ControlState.CONTROLLED, ControlState.READY)

    def join(self, session: ControlSession) -> None:
        self._sessions.append(session)
        if len(self._sessions) == 1:
            self.component.when_started(self._start)
        elif self._requested:
            self._check()
        if self.state is not ControlState.SEEKING:
            self._loop.call_soon(session.changed)

    def has(self, session: ControlSession) -> bool:
        return session in self._sessions

    def leave(self, session: ControlSession) -> None:
        if session in self._sessions:
            self._sessions.remove(session)
            if not self._sessions:
                self.stop()

    def stop(self) -> None:
        """Release control; also when a request may just be on its way."""
        self._sessions.clear()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._requested and (self._awaits_answer or self.state is not ControlState.REFUSED):
            self._send(ReleaseControl())
        self._client.forget(self)
        self.state = ControlState.SEEKING

    # ---- what the target says ---------------------------------------------------------------

    def confirmed(self, code: int) -> None:
        self._awaits_answer = False
        if code != ConfirmControl.ResponseCode.CONTROL_ACCEPTED:
            self.component.counters.add("control_client.refused")
            if self._change(ControlState.REFUSED):
                self._check_in(self._settings.refused_retry)
            return
        self._missed = 0
        if not self._holds:
            self._delay = self._settings.retry_min
            if self._change(ControlState.CONTROLLED):
                self._send(QueryTimeout())
                self._send(QueryStatus())
                self._check_in(self._interval())

    def rejected(self) -> None:
        if self._holds:
            self.component.counters.add("control_client.lost")
            if self._change(ControlState.SEEKING):
                self._check_in(self._settings.retry_min)

    def timeout_reported(self, seconds: int) -> None:
        self._timeout = seconds
        if self._holds:
            self._check_in(self._interval())

    def status_reported(self, status: int) -> None:
        if not self._holds:
            return
        ready = status == Status.READY
        self._change(ControlState.READY if ready else ControlState.CONTROLLED)
        if status == Status.STANDBY and any(session.resume for session in self._sessions):
            self._resume()

    # ---- what is sent to the target ---------------------------------------------------------

    def _start(self) -> None:
        if self._sessions:
            self._check()

    def _check(self) -> None:
        """Request control, for the first time or to confirm it, and look after the target."""
        self._requested = self._awaits_answer = True
        self._send(RequestControl(authority_code=max(each.authority for each in self._sessions)))
        if not self._holds:
            refused = self.state is ControlState.REFUSED
            self._check_in(self._settings.refused_retry if refused else self._delay)
            self._delay = min(self._delay * 2, self._settings.retry_max)
            return
        self._missed += 1
        if self._missed > MISSED_CHECKS:
            self.component.counters.add("control_client.lost")
            if not self._change(ControlState.SEEKING):
                return
        if self._timeout is None:
            self._send(QueryTimeout())
        self._send(QueryStatus())
        self._check_in(self._interval())

    def _resume(self) -> None:
        """Resume the target, but not again at every answer of one that does not obey."""
        now = self._loop.now()
        if now >= self._resumed_at + self._settings.retry_min:
            self._resumed_at = now
            self._send(Resume())
            self._send(QueryStatus())

    def _interval(self) -> float:
        """Seconds to the next check: at most half of the target's timeout."""
        watch = self._settings.watch_interval
        return min(watch, self._timeout / 2) if self._timeout else watch

    def _check_in(self, delay: float) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_later(delay, self._check)

    def _send(self, message: Message) -> None:
        self.component.send(message, self.target)

    def _change(self, state: ControlState) -> bool:
        """Tell the sessions a new state; return whether control is wanted any longer then."""
        if state is not self.state:
            self.state = state
            for session in tuple(self._sessions):
                session.changed()
        return bool(self._sessions)
