"""The operator: works through a list of commands and says what the winch does."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

from jausml_runtime import ComponentSettings, JausAddress, Message, Priority, Transport
from jausml_runtime.messages import ClearEmergency, SetEmergency

from .messages import (
    LockBrake,
    RejectWinchCommand,
    ReleaseBrake,
    ReportWinchState,
    SetWinchCommand,
)
from .winch_operator_base import ADDRESS, SETTINGS, WinchOperatorBase

AUTHORITY = 200
"""Authority code to control the winch with."""

Activity = ReportWinchState.Activity
Reason = RejectWinchCommand.Reason

_log = logging.getLogger("operator")


@dataclass(frozen=True)
class Step:
    """A part of the operator's work.

    Attributes:
        name: What is done.
        do: Does it.
        until: Tells from a report and from the last reason for a refusal whether it is done.
    """

    name: str
    do: Callable[[], None]
    until: Callable[[ReportWinchState, int | None], bool]


class WinchOperator(WinchOperatorBase):
    """Leads the winch through all its states."""

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self.on_message(RejectWinchCommand, self._refused)
        self._steps = self._program()
        self._has_begun = False
        self._reason: int | None = None

    def _program(self) -> list[Step]:
        return [
            Step("control the winch", lambda: None, _activity(Activity.IDLE)),
            Step("pay out", self._speed(1.0), _activity(Activity.PAYING_OUT)),
            Step("wait for the end of the rope", lambda: None, _activity(Activity.IDLE)),
            Step("pay out further", self._speed(1.0), _refusal(Reason.END_OF_ROPE)),
            Step("pay in", self._speed(-0.5), _activity(Activity.PAYING_IN)),
            Step("lock", self._command(LockBrake()), _activity(Activity.LOCKED)),
            Step("pay in while locked", self._speed(-0.5), _refusal(Reason.LOCKED)),
            Step("release the brake", self._command(ReleaseBrake()), _activity(Activity.IDLE)),
            Step("pay in again", self._speed(-0.5), _activity(Activity.PAYING_IN)),
            Step("let go of control", self._let_go, _activity(Activity.OUT_OF_WORK)),
            Step("take control again", self._take_control, _activity(Activity.IDLE)),
            Step("pay in slowly", self._speed(-0.2), _activity(Activity.PAYING_IN)),
            Step("set an emergency", self._emergency, _activity(Activity.OUT_OF_WORK)),
            Step("clear the emergency", self._all_clear, _activity(Activity.IDLE)),
            Step("pay in too fast", self._speed(-2.0), _activity(Activity.LOCKED)),
        ]

    def _speed(self, speed: float) -> Callable[[], None]:
        return self._command(SetWinchCommand(rope_speed=speed))

    def _command(self, message: Message) -> Callable[[], None]:
        return lambda: self.send(message, self.WINCH)

    def _let_go(self) -> None:
        self.control_of_winch.release()

    def _take_control(self) -> None:
        self.control_of_winch = self.control(self.WINCH, authority=AUTHORITY)

    def _emergency(self) -> None:
        self.send(SetEmergency(), self.WINCH, priority=Priority.SAFETY_CRITICAL)

    def _all_clear(self) -> None:
        self.send(ClearEmergency(), self.WINCH, priority=Priority.SAFETY_CRITICAL)

    def _refused(self, message: RejectWinchCommand, sender: JausAddress) -> None:
        self._reason = message.reason

    def on_winch_state(self, report: ReportWinchState, provider: JausAddress) -> None:
        """Goes on with the next step when the present one is done."""
        if not self._steps:
            return
        step = self._steps[0]
        if not self._has_begun:
            self._begin(step)
        elif step.until(report, self._reason):
            _log.info(
                "%s: %s, %.2f m out at %.2f m/s, load %.0f N",
                step.name,
                _told(report, self._reason),
                report.rope_length,
                report.rope_speed,
                report.tension,
            )
            del self._steps[0]
            if self._steps:
                self._begin(self._steps[0])
            else:
                _log.info("all done")

    def _begin(self, step: Step) -> None:
        self._has_begun = True
        self._reason = None
        step.do()

    def on_winch_state_silent(self, provider: JausAddress) -> None:
        """Says that the winch stopped reporting."""
        _log.warning("the winch does not report")


def _activity(activity: int) -> Callable[[ReportWinchState, int | None], bool]:
    return lambda report, _reason: report.activity == activity


def _refusal(wanted: int) -> Callable[[ReportWinchState, int | None], bool]:
    return lambda _report, reason: reason == wanted


def _told(report: ReportWinchState, reason: int | None) -> str:
    refused = "" if reason is None else f"refused ({Reason(reason).name}), "
    return refused + Activity(report.activity).name
