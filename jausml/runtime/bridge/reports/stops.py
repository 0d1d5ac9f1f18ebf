"""Why commands end: what a bridge may not pass on any more, and when it sends the stop instead."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from ...services.definitions import Status

if TYPE_CHECKING:
    from ...base.address import JausAddress


class StopReason(Enum):
    """Why the stop stands on the other side; the value is what logs and diagnostics say."""

    START = "no message yet"
    SILENCE = "the source is silent"
    CONTROL_RELEASED = "control was released"
    CONTROL_LAPSED = "control lapsed: its client did not request it again in time"
    TAKEN_OVER = "another component took control"
    INACTIVE = "the bridge is inactive"
    CLOCK = "nobody says the time on /clock"
    STANDBY = "the bridge stands by"
    RESET = "the bridge is reset"
    EMERGENCY = "emergency"
    FAILURE = "the bridge has failed"
    STOOD_STILL = "the bridge stood still, and its guardian has stopped what it commands"
    END = "the bridge ends"


_HALTS = {
    Status.INITIALIZE: StopReason.RESET,
    Status.EMERGENCY: StopReason.EMERGENCY,
    Status.FAILURE: StopReason.FAILURE,
    Status.SHUTDOWN: StopReason.END,
}
"""States in which nothing is commanded, whoever wants to."""


@dataclass(frozen=True)
class Standing:
    """What the JAUS side of a bridge may do.

    Attributes:
        has_lapsed: Whether nobody controls the bridge since its controller let control lapse.
    """

    status: Status
    controller: JausAddress | None
    is_active: bool = True
    has_lapsed: bool = False

    @property
    def halt(self) -> StopReason | None:
        """Why the bridge commands nothing of its own now; None when it does.

        A bridge that somebody controls commands in Ready alone. One that nobody controls works by
        itself: the Standby of a bridge that nobody ever resumes forbids nothing.
        """
        if not self.is_active:
            return _HALTS.get(self.status, StopReason.INACTIVE)
        if self.status is Status.STANDBY and self.controller is not None:
            return StopReason.STANDBY
        return _HALTS.get(self.status)

    @property
    def without_controller(self) -> StopReason:
        """Why the former controller has control no more, where nobody took it over."""
        return StopReason.CONTROL_LAPSED if self.has_lapsed else StopReason.CONTROL_RELEASED

    def lost_since(self, former: Standing) -> StopReason | None:
        """Returns why what the former controller commanded must not stand; None when it may."""
        if former.is_active and not self.is_active:
            return StopReason.INACTIVE
        if self.status is not former.status and self.status in _HALTS:
            return _HALTS[self.status]
        if former.status in _HALTS:
            return None  # what stood then ended with that state
        if former.controller not in (None, self.controller):
            return StopReason.TAKEN_OVER if self.controller else self.without_controller
        left_ready = former.status is Status.READY and self.status is not Status.READY
        return StopReason.STANDBY if left_ready else None
