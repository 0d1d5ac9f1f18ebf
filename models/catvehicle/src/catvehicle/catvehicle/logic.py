"""What the controllers do, free of any middleware: reports in, commands out.

ROS nodes, JAUS components and stand-ins of tests wrap these two classes and add nothing but
messages, so that systems that carry them differently drive by the same laws. Units are metres,
seconds and radians in ROS convention; time stamps are milliseconds of the vehicle's time of day.
"""

from __future__ import annotations

import math
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
    received: float


@dataclass(frozen=True)
class SteeringStep:
    """Answer of the steering to one state of the vehicle.

    Attributes:
        report: The speed report that the step is of.
        measured_angle: Tyre angle at that time, rad.
        pose: Dead-reckoned pose of the rear axle.
        command: Tyre angle to ask for, rad.
    """

    report: SpeedReport
    measured_angle: float
    pose: Pose
    command: float


class AngleSignal:
    """The tyre angle between its reports, which name no time and come at their own phase."""

    def __init__(self, parameters: VehicleParameters) -> None:
        """Begins with straight tyres."""
        self._period = 1.0 / parameters.report_rate
        self._rate_limit = parameters.steering_rate_limit
        self._time = -math.inf
        self._angle = self._rate = 0.0

    def take(self, angle: float, received: float) -> None:
        """Takes a report: the angle (rad) and when it came (s); what came late says no rate."""
        passed = received - self._time
        if 0.5 * self._period <= passed <= 2.0 * self._period:
            rate = (angle - self._angle) / passed
            self._rate = min(max(rate, -self._rate_limit), self._rate_limit)
        else:
            self._rate = 0.0
        self._time, self._angle = received, angle

    def at(self, time: float) -> float:
        """Returns the angle (rad) at a time (s): it goes on as it changed, for a period at most."""
        return self._angle + self._rate * min(max(time - self._time, 0.0), self._period)


class SteeringLogic:
    """Follows the path by dead reckoning: a tyre angle for each speed that the vehicle reports.

    The tyre angle comes in messages of its own at the same rate, but at another phase: up to a
    period before the speed. Taken as it came, it would make the dead reckoning turn too late by
    that much, 0.2 m in a turn; waiting for the next would delay the command. So it is carried on to
    the time of the speed.
    """

    def __init__(self, parameters: VehicleParameters) -> None:
        """Starts in the origin, before the first report."""
        path = StraightArcStraight.right_turn(parameters)
        self._controller = SteeringController(parameters, path)
        self._dead_reckoning = DeadReckoning(parameters)
        self._angle = AngleSignal(parameters)

    def take_angle(self, angle: float, received: float) -> None:
        """Keeps a tyre angle (rad) that came at a time (s on the controller's clock)."""
        self._angle.take(angle, received)

    def take_speed(self, report: SpeedReport) -> SteeringStep:
        """Takes a speed report; returns the step that answers it."""
        angle = self._angle.at(report.received)
        pose = self._dead_reckoning.update(report.stamp_ms / 1000, report.speed, angle)
        command = self._controller.command(pose, report.speed)
        return SteeringStep(report, angle, pose, command)


class SpeedLogic:
    """Keeps the ride comfortable: the operator's cruise speed or less for each pose."""

    def __init__(self, parameters: VehicleParameters) -> None:
        """Starts without an operator, who alone lets the vehicle move."""
        self._path = StraightArcStraight.right_turn(parameters)
        self._controller = VelocityController(parameters)
        self._cruise_speed = 0.0
        self._measured_angle = 0.0
        self._commanded_angle = 0.0

    def take_cruise_speed(self, speed: float) -> None:
        """Keeps the speed that the operator allows, m/s; negative ones are standstill."""
        self._cruise_speed = max(speed, 0.0)

    def take_measured_angle(self, angle: float) -> None:
        """Keeps the tyre angle that the vehicle reports, rad."""
        self._measured_angle = angle

    def take_commanded_angle(self, angle: float) -> None:
        """Keeps the tyre angle that the steering asks for, rad."""
        self._commanded_angle = angle

    def command(self, x: float, y: float) -> float:
        """Returns the speed to ask for (m/s) at a position of the rear axle (m)."""
        comfortable = self._controller.command(
            self._measured_angle, self._commanded_angle, self._path.remaining(x, y)
        )
        return min(self._cruise_speed, comfortable)
