"""What the controllers do, free of any middleware: reports in, commands out.

ROS nodes, JAUS components and stand-ins of tests wrap these two classes and add nothing but
messages, so that systems that carry them differently drive by the same laws. Units are metres,
seconds and radians in ROS convention; time stamps are milliseconds of the vehicle's time of day.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .deadreckoning import DeadReckoning
from .path import Pose, StraightArcStraight
from .steering import SteeringController
from .velocity import VelocityController

if TYPE_CHECKING:
    from .parameters import VehicleParameters


@dataclass(frozen=True)
class SpeedReport:
    """Speed that the vehicle reported.

    Attributes:
        stamp_ms: When the vehicle sensed it, ms.
        speed: Speed, m/s.
        received: When it came, s on the controller's clock.
    """

    stamp_ms: int
    speed: float
    received: float = 0.0


@dataclass(frozen=True)
class SteeringStep:
    """Answer of the steering to one state of the vehicle.

    Attributes:
        report: The speed report that the step is of.
        measured_angle: Tyre angle that went with it, rad.
        pose: Dead-reckoned pose of the rear axle.
        command: Tyre angle to ask for, rad.
    """

    report: SpeedReport
    measured_angle: float
    pose: Pose
    command: float


class SteeringLogic:
    """Follows the path by dead reckoning: a tyre angle for each state that the vehicle reports.

    Speed and tyre angle come in messages of their own at the same rate. A step waits for both,
    since an angle of the period before would make the dead reckoning drift. Which angle is of the
    same period, only the times tell at which both came: in order, each angle is before one speed
    and behind another.
    """

    def __init__(self, parameters: VehicleParameters) -> None:
        """Start in the origin, before the first report."""
        path = StraightArcStraight.right_turn(parameters)
        self._controller = SteeringController(parameters, path)
        self._dead_reckoning = DeadReckoning(parameters)
        self._angle = 0.0
        self._angle_is_new = False
        self._angle_received = 0.0
        self._same_period = 0.5 / parameters.report_rate
        self._waiting: SpeedReport | None = None

    def take_angle(self, angle: float, received: float) -> SteeringStep | None:
        """Take a tyre angle (rad); return the step of the speed report that waited for it.

        Args:
            angle: The angle, rad.
            received: When it came, s on the clock of the speed reports.
        """
        waiting = self._waiting
        if waiting is not None and received - waiting.received > self._same_period:
            # Its own angle was lost; this one is that of the next speed.
            step = self._step(waiting)
            self._keep(angle, received)
            return step
        self._keep(angle, received)
        return None if waiting is None else self._step(waiting)

    def _keep(self, angle: float, received: float) -> None:
        self._angle = angle
        self._angle_received = received
        self._angle_is_new = True

    def take_speed(self, report: SpeedReport) -> SteeringStep | None:
        """Take a speed report; return the step that it makes possible.

        It waits for its angle. One that got none before the next report came is used without.
        """
        if self._waiting is not None:
            step = self._step(self._waiting)
            self._waiting = report
            return step
        if self._angle_is_new and report.received - self._angle_received <= self._same_period:
            return self._step(report)
        self._waiting = report
        return None

    def _step(self, report: SpeedReport) -> SteeringStep:
        self._waiting = None
        self._angle_is_new = False
        pose = self._dead_reckoning.update(report.stamp_ms / 1000, report.speed, self._angle)
        command = self._controller.command(pose, report.speed)
        return SteeringStep(report, self._angle, pose, command)


class SpeedLogic:
    """Keeps the ride comfortable: the operator's cruise speed or less for each pose."""

    def __init__(self, parameters: VehicleParameters) -> None:
        """Start without an operator, who alone lets the vehicle move."""
        self._path = StraightArcStraight.right_turn(parameters)
        self._controller = VelocityController(parameters)
        self._cruise_speed = 0.0
        self._measured_angle = 0.0
        self._commanded_angle = 0.0

    def take_cruise_speed(self, speed: float) -> None:
        """Keep the speed that the operator allows, m/s; negative ones are standstill."""
        self._cruise_speed = max(speed, 0.0)

    def take_measured_angle(self, angle: float) -> None:
        """Keep the tyre angle that the vehicle reports, rad."""
        self._measured_angle = angle

    def take_commanded_angle(self, angle: float) -> None:
        """Keep the tyre angle that the steering asks for, rad."""
        self._commanded_angle = angle

    def command(self, x: float, y: float) -> float:
        """Return the speed to ask for (m/s) at a position of the rear axle (m)."""
        comfortable = self._controller.command(
            self._measured_angle, self._commanded_angle, self._path.remaining(x, y)
        )
        return min(self._cruise_speed, comfortable)
