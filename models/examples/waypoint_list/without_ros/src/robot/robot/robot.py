"""The robot as a JAUS component: follows a list by itself, and reports where it is.

The file `driving.py` of the example waypoint_list belongs beside this one.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TextIO

from jausml_runtime import Completion, ComponentSettings, JausAddress, Transport

from .driving import COLUMNS, PERIOD, Body, Course
from .messages import (
    ExecuteList,
    QueryActiveElement,
    QueryLocalPose,
    QueryLocalWaypoint,
    QueryTravelSpeed,
    ReportActiveElement,
    ReportLocalPose,
    ReportLocalWaypoint,
    ReportTravelSpeed,
    SetLocalPose,
    SetLocalWaypoint,
)
from .robot_base import ADDRESS, SETTINGS, RobotBase

LOG_FOLDER = "WAYPOINT_LOG"
"""Environment variable that names the folder to which the true state is written."""


class Robot(RobotBase):
    """Drives along its list while its controller is there.

    JAUS axes are x forward, y right, z down; those of the body are x forward, y left. So y and yaw
    change their sign on the way in and out.
    """

    def __init__(
        self,
        transport: Transport,
        address: JausAddress = ADDRESS,
        settings: ComponentSettings = SETTINGS,
    ) -> None:
        super().__init__(transport, address, settings)
        self._body = Body()
        self._wanted = (0.0, 0.0)
        self._course: Course | None = None
        self._waypoints: dict[int, tuple[float, float]] = {}  # by element, m, y to the left
        self._uids: list[int] = []
        self._active = 0
        self._speed = 0.0
        self._completion = Completion()
        self._now = self.clock.now()
        self._rows: TextIO | None = None
        if folder := os.environ.get(LOG_FOLDER):
            self._rows = (Path(folder) / "wheels.csv").open("w", encoding="utf-8", buffering=1)
            self._rows.write(f"{COLUMNS}\n")

    def start(self) -> None:
        """Starts the component, and moves on from then on."""
        super().start()
        self._now = self.clock.now()
        self._step()

    def on_execute_list(self, message: ExecuteList, sender: JausAddress) -> Completion | None:
        """Begins at an element; without one it stands at speed 0, and goes on at another."""
        if message.element_uid is None:
            self._speed = message.speed
            self.report_changed(ReportTravelSpeed)
            return None
        self._finish(succeeded=False)
        self._waypoints = self._from(message.element_uid)
        self._uids = list(self._waypoints)
        self._course = Course(list(self._waypoints.values()))
        self._speed = message.speed
        self._completion = Completion()
        self._reach(next(iter(self._uids), 0))
        return self._completion

    def on_set_local_waypoint(
        self, message: SetLocalWaypoint, sender: JausAddress
    ) -> Completion | None:
        """Follows no waypoint outside of a list."""
        return super().on_set_local_waypoint(message, sender)

    def on_set_local_pose(self, message: SetLocalPose, sender: JausAddress) -> None:
        """Takes the parts of a pose that are present as where the robot is."""
        body = self._body
        body.x = body.x if message.x is None else message.x
        body.y = body.y if message.y is None else -message.y
        body.psi = body.psi if message.yaw is None else -message.yaw

    def on_not_ready(self) -> None:
        """Stops: nobody may drive."""
        self._finish(succeeded=False)

    def on_control_lost(self) -> None:
        """Stops: who takes over gives a list of their own."""
        self._finish(succeeded=False)

    def report_active_element(
        self, query: QueryActiveElement, sender: JausAddress
    ) -> ReportActiveElement:
        """Returns the element to which the robot drives, or 0."""
        return ReportActiveElement(element_uid=self._active)

    def report_travel_speed(
        self, query: QueryTravelSpeed, sender: JausAddress
    ) -> ReportTravelSpeed:
        """Returns the speed that was asked for, or 0 while no list is followed."""
        return ReportTravelSpeed(speed=self._speed)

    def report_local_waypoint(
        self, query: QueryLocalWaypoint, sender: JausAddress
    ) -> ReportLocalWaypoint | None:
        """Returns the waypoint to which the robot drives."""
        if not self._active:
            return None
        x, y = self._waypoints[self._active]
        return ReportLocalWaypoint(x=x, y=-y)

    def report_local_pose(self, query: QueryLocalPose, sender: JausAddress) -> ReportLocalPose:
        """Returns the pose of the middle of the axle."""
        body = self._body
        return ReportLocalPose(x=body.x, y=-body.y, yaw=-math.remainder(body.psi, math.tau))

    def _from(self, uid: int) -> dict[int, tuple[float, float]]:
        """Returns the waypoints from an element of the list on, by their elements; 0 is all."""
        elements = list(self.elements)
        uids = [each.uid for each in elements]
        first = 0 if uid == 0 else uids.index(uid) if uid in uids else len(uids)
        waypoints = [SetLocalWaypoint.decode(each.data) for each in elements[first:]]
        return {at: (each.x, -each.y) for at, each in zip(uids[first:], waypoints, strict=True)}

    def _step(self) -> None:
        """Moves on, and answers where the robot is by what its wheels shall do."""
        self.loop.call_later(PERIOD, self._step)
        now = self.clock.now()
        self._body.advance(*self._wanted, now - self._now)
        self._now = now
        self._note(now, self._body)
        if self._active and self._active not in self.elements:
            self._finish(succeeded=False)
        if self._course is not None:
            self._follow(self._course)

    def _follow(self, course: Course) -> None:
        body = self._body
        self._wanted = course.command(body.x, body.y, body.psi) if self._speed else (0.0, 0.0)
        if course.is_over:
            self._finish(succeeded=True)
        else:
            self._reach(self._uids[course.active])

    def _reach(self, uid: int) -> None:
        if uid != self._active:
            self._active = uid
            self.report_changed(ReportActiveElement)
            self.report_changed(ReportLocalWaypoint)

    def _finish(self, *, succeeded: bool) -> None:
        """Stands, and ends the list that is followed, if there is one."""
        self._wanted = (0.0, 0.0)
        if self._course is None:
            return
        self._course, self._speed = None, 0.0
        self._reach(0)
        self._completion.succeed() if succeeded else self._completion.fail()

    def _note(self, now: float, body: Body) -> None:
        """Writes the true state down."""
        if self._rows is not None:
            self._rows.write(body.row(now))
