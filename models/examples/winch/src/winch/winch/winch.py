"""The winch: a drum behind the service Winch."""

from __future__ import annotations

from jausml_runtime import ComponentSettings, JausAddress, Transport

from .drum import Drum
from .messages import QueryWinchState, RejectWinchCommand, ReportWinchState, SetWinchCommand
from .winch_base import ADDRESS, SETTINGS, WinchBase

STEP = 0.02
"""Seconds between two looks at the drum."""

STANDSTILL = 0.01
"""Metres per second below which a commanded speed is none."""

Activity = ReportWinchState.Activity
Reason = RejectWinchCommand.Reason

ACTIVITIES = {
    "Idle": Activity.IDLE,
    "PayingOut": Activity.PAYING_OUT,
    "PayingIn": Activity.PAYING_IN,
    "Locked": Activity.LOCKED,
}
"""What the winch does in the innermost states of the model."""


class Winch(WinchBase):
    """Turns the drum as the modelled states and their actions say."""

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._drum = Drum()

    def start(self) -> None:
        """Starts the component and the drum."""
        super().start()
        self._step()

    def _step(self) -> None:
        """Moves the drum and tells the state machine what became of it."""
        if not self.running:
            return
        had_load = self._drum.has_load
        self._drum.step(STEP)
        if had_load and not self._drum.has_load:
            self.raise_load_lost()
        elif self._drum.is_at_end:
            self.raise_end_stop()
        self.report_changed(ReportWinchState)
        self.loop.call_later(STEP, self._step)

    def pays_out(self, message: SetWinchCommand, sender: JausAddress) -> bool:
        """Tells whether the command pays the rope out."""
        return message.rope_speed > STANDSTILL

    def pays_in(self, message: SetWinchCommand, sender: JausAddress) -> bool:
        """Tells whether the command pays the rope in."""
        return message.rope_speed < -STANDSTILL

    def leads_beyond_rope(self, message: SetWinchCommand, sender: JausAddress) -> bool:
        """Tells whether there is no rope left in the commanded direction."""
        return self._drum.leads_beyond(message.rope_speed)

    def set_speed(self, message: SetWinchCommand, sender: JausAddress) -> None:
        """Turns the drum at the commanded speed."""
        self._drum.turn(message.rope_speed)

    def stop_motor(self) -> None:
        """Stops the motor: the winch does not move any more."""
        self._drum.stop()

    def engage_brake(self) -> None:
        """Engages the brake: Ready was left, or the drum is locked."""
        self._drum.brake()

    def release_brake(self) -> None:
        """Releases the brake."""
        self._drum.release()

    def reject_command(self, message: SetWinchCommand, sender: JausAddress) -> RejectWinchCommand:
        """Returns why a command has no effect."""
        locked = self.winch_receive_fsm.state.endswith("Locked")
        return RejectWinchCommand(reason=Reason.LOCKED if locked else Reason.END_OF_ROPE)

    def report_winch_state(self, message: QueryWinchState, sender: JausAddress) -> ReportWinchState:
        """Returns what the winch does, and where the rope is."""
        innermost = self.winch_receive_fsm.state.rpartition(".")[2]
        return ReportWinchState(
            activity=ACTIVITIES.get(innermost, Activity.OUT_OF_WORK),
            rope_length=self._drum.length,
            rope_speed=self._drum.speed,
            tension=self._drum.tension,
        )
