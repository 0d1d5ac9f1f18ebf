"""Control of other components (AS5710, AccessControl and Management, client side)."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..messages import ConfirmControl, RejectControl, ReportControl, ReportStatus, ReportTimeout
from ..services.definitions import Status
from ..services.host import Host
from .control_state import ControlState, Releases
from .controlled_target import ControlledTarget
from .event_client import EventClient


class ControlSession:
    """Control of a target for one user; made by ``JausComponent.control``."""

    def __init__(
        self,
        control: ControlledTarget,
        authority: int,
        resume: bool,  # noqa: FBT001
        on_change: Callable[[ControlState], None] | None,
    ) -> None:
        self.target = control.target
        self.authority = authority
        self.resume = resume
        self._control = control
        self._on_change = on_change

    @property
    def state(self) -> ControlState:
        """State of the control."""
        return self._control.state

    @property
    def status(self) -> Status | None:
        """Last reported Management state of the target (AS5710, ReportStatus); None before."""
        return self._control.status

    @property
    def controller(self) -> JausAddress | None:
        """Last reported controller of the target; None without one or a report."""
        return self._control.controller

    @property
    def reason(self) -> str:
        """Why the target does not obey, in words; empty while it does."""
        return self._control.reason

    def release(self) -> None:
        """Ends the session; control is released with the last session."""
        with self._control.component.loop.lock:
            self._control.leave(self)

    def changed(self) -> None:
        """Calls `on_change` with the present state, unless the session was released."""
        if self._on_change is not None and self._control.has(self):
            self._control.component.call(self._on_change, self._control.state)


class ControlClient:
    """All control sessions of one component, and their messages."""

    def __init__(self, component: Host) -> None:
        self._component = component
        component.part(EventClient)  # its subscriptions are cancelled after control is released
        self._releases = Releases(component, self._released)
        self._controls: dict[JausAddress, ControlledTarget] = {}
        component.on_message(ConfirmControl, self._confirmed)
        component.on_message(RejectControl, self._rejected)
        component.on_message(ReportControl, self._reported)
        component.on_message(ReportTimeout, self._timeout_reported)
        component.on_message(ReportStatus, self._reported)
        component.when_permitted(self._permit)
        component.when_stopped(self.stop)

    def control(
        self,
        target: JausAddress,
        authority: int,
        *,
        resume: bool = True,
        on_change: Callable[[ControlState], None] | None = None,
    ) -> ControlSession:
        """Returns a session; the first one of a target requests control. Raises ValueError."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        if not 0 <= authority <= 255:
            raise ValueError(f"authority {authority} is outside 0..255")
        control = self._controls.get(target)
        if control is None:
            control = ControlledTarget(self._component, target, self._releases, self._forget)
            self._controls[target] = control
        session = ControlSession(control, authority, resume, on_change)
        control.join(session)
        return session

    def _permit(self, permitted: bool) -> None:  # noqa: FBT001
        """Releases all targets while the component may not command, and acquires them again."""
        for control in list(self._controls.values()):
            control.permit(permitted)

    def holds(self, target: JausAddress) -> bool:
        """Returns whether this component controls a target, by its last report."""
        return any(control.holds for control in self._controls_of(target))

    def hand_over(self, target: JausAddress) -> None:
        """Stops requesting control of a target, in favour of another component."""
        for control in self._controls_of(target):
            control.hand_over()

    def take_over(self, target: JausAddress) -> None:
        """Requests control of a target again, after another component has handed it over."""
        for control in self._controls_of(target):
            control.take_over()

    def stop(self) -> None:
        """Releases all control."""
        for control in list(self._controls.values()):
            control.stop()

    def _forget(self, control: ControlledTarget) -> None:
        self._controls.pop(control.target, None)

    def _controls_of(self, target: JausAddress) -> tuple[ControlledTarget, ...]:
        control = self._controls.get(target)
        return () if control is None else (control,)

    def _released(self, target: JausAddress) -> None:
        for control in self._controls_of(target):
            control.returned()

    def _confirmed(self, message: ConfirmControl, sender: JausAddress) -> None:
        for control in self._controls_of(sender):
            control.confirmed(message.response_code)

    def _rejected(self, _message: RejectControl, sender: JausAddress) -> None:
        for control in self._controls_of(sender):
            control.rejected()

    def _timeout_reported(self, message: ReportTimeout, sender: JausAddress) -> None:
        for control in self._controls_of(sender):
            control.timeout_reported(message.timeout)

    def _reported(self, message: ReportControl | ReportStatus, sender: JausAddress) -> None:
        for control in self._controls_of(sender):
            control.reported(message)
