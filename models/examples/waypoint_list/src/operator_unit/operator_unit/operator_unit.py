"""The operator: gives the robot a list, has it executed, and writes down what it is told.

What to do stands in the file `plan.json` of the folder that the environment variable
WAYPOINT_LOG names, and what happened goes to `operator.csv` there. Without it the robot drives a
square. Waypoints are in JAUS axes: x forward, y right of where the robot started.
"""

from __future__ import annotations

import json
import logging
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from jausml_runtime import ComponentSettings, ControlState, JausAddress, Transport, chain

from .messages import ExecuteList, ReportActiveElement, ReportLocalPose, SetLocalWaypoint
from .operator_unit_base import ADDRESS, SETTINGS, OperatorUnitBase

LOG_FOLDER = "WAYPOINT_LOG"
"""Environment variable that names the folder of plan and log."""

RETRY = 0.5
"""Seconds until what could not be begun yet is tried again."""

ANSWER = 5.0
"""Seconds in which the robot must say that it begins."""

MOVED = 0.05
"""Metres from the start beyond which the robot has moved."""

LONGEST = 600
"""Seconds in which the list must have been driven, for the event that tells its end."""

_log = logging.getLogger("operator")


@dataclass(frozen=True)
class Plan:
    """What the operator does.

    Attributes:
        waypoints: x and y of each, m, in JAUS axes.
        emergency_at: Number of the element, from 1, on the way to which there is an emergency; None
            for no emergency.
        emergency_after: Seconds after that element became active.
    """

    waypoints: list[list[float]]
    emergency_at: int | None = None
    emergency_after: float = 1.0


SQUARE = Plan([[2.0, 0.0], [2.0, -2.0], [0.0, -2.0], [0.0, 0.0]])


class OperatorUnit(OperatorUnitBase):
    """Sends the robot along a list, once."""

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._plan = SQUARE
        self._events: TextIO | None = None
        if folder := os.environ.get(LOG_FOLDER):
            text = (Path(folder) / "plan.json").read_text(encoding="utf-8")
            self._plan = Plan(**json.loads(text))
            # Each row at once: a killed process leaves whole rows.
            self._events = (Path(folder) / "operator.csv").open("w", encoding="utf-8", buffering=1)
            self._events.write("event,real_s,value,x_m,y_m\n")
        self._active = 0
        self._has_begun = False
        self._done: bool | None = None

    def start(self) -> None:
        """Starts the component and looks from then on whether the list can be given."""
        super().start()
        self._give()

    def on_active(self, report: ReportActiveElement, provider: JausAddress) -> None:
        """Notes which element is active, and has an emergency where the plan says so."""
        if report.element_uid == self._active:
            return
        self._active = report.element_uid
        self._note("active", self._active)
        _log.info("element %d is active", self._active)
        self._has_begun = self._has_begun or self._active > 1
        if self._active and self._active == self._plan.emergency_at:
            self.loop.call_later(self._plan.emergency_after, self._emergency)
        self._say_end()

    def on_pose(self, report: ReportLocalPose, provider: JausAddress) -> None:
        """Notes where the robot is."""
        if report.x is not None and report.y is not None:
            self._note("pose", "", report.x, report.y)
            self._has_begun = self._has_begun or math.hypot(report.x, report.y) > MOVED

    def on_pose_silent(self, provider: JausAddress) -> None:
        """Says that the robot stopped reporting."""
        _log.warning("the robot does not report")

    def _give(self) -> None:
        """Gives the list once the robot obeys."""
        if self.control_of_robot.state is not ControlState.READY:
            self.loop.call_later(RETRY, self._give)
            return
        contents = [
            (uid, SetLocalWaypoint(x=x, y=y).encode(), 0)
            for uid, (x, y) in enumerate(self._plan.waypoints, 1)
        ]
        self.set_list(self.ROBOT, chain(contents), on_done=self._execute, on_refused=self._refused)

    def _refused(self, code: int | None) -> None:
        _log.warning("the list was refused: %s", code)
        self.loop.call_later(RETRY, self._give)

    def _execute(self) -> None:
        message = ExecuteList(speed=1.0, element_uid=1)
        self.command(
            self.ROBOT,
            message,
            on_done=self._end,
            on_refused=self._not_begun,
            max_duration=LONGEST,
            timeout=ANSWER,
        )
        self._note("execute")

    def _not_begun(self, code: int | None, text: str) -> None:
        """Tries again what the robot refused, or did not answer in time."""
        _log.warning("the list was not begun: %s", text or code)
        self.loop.call_later(RETRY, self._execute)

    def _end(self, done: bool) -> None:  # noqa: FBT001 - as commands call it
        """Notes the end; a list that nobody follows yet, since ROS is still looking, is no end."""
        if not done and not self._has_begun:
            self.loop.call_later(RETRY, self._execute)
            return
        self._done = done
        self._note("ended", int(done))
        self._say_end()

    def _say_end(self) -> None:
        """Says how the list ended, once no element is active any more."""
        if self._done is not None and not self._active:
            _log.info("the list ended: %s", "done" if self._done else "not done")

    def _emergency(self) -> None:
        self._has_begun = True  # whatever ends now ends for good, though no pose may have come
        self.set_emergency(self.ROBOT)
        self._note("emergency")
        _log.info("emergency")

    def _note(
        self, event: str, value: int | str = "", x: float | str = "", y: float | str = ""
    ) -> None:
        if self._events is not None:
            self._events.write(f"{event},{self.clock.now()},{value},{x},{y}\n")
