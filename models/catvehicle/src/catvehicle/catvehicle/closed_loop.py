"""Closed loop of plant and laws alone, with pure delays and the quanta of the messages.

It tells what a delay does to a drive, without any middleware.
"""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .logic import SpeedLogic, SpeedReport, SteeringLogic
from .metrics import Sample
from .plant import BicyclePlant

if TYPE_CHECKING:
    from collections.abc import Callable

    from .parameters import VehicleParameters

EFFORT_QUANTUM = (
    200.0 / 65535
)  # percent; SetWrenchEffort scales -100..100 over an unsigned 16-bit integer
SPEED_QUANTUM = 655.35 / (
    2**32 - 1
)  # m/s; ReportVelocityState scales over an unsigned 32-bit integer
LOG_PERIOD = 0.01  # s


def quantised(value: float, quantum: float) -> float:
    """Round to the nearest multiple of a quantum, in the unit of both."""
    return round(value / quantum) * quantum


@dataclass(frozen=True)
class Loop:
    """A closed loop to simulate.

    Attributes:
        plant: Parameters of the vehicle.
        controller: Parameters of the controllers.
        delay: One-way delay of reports and likewise of commands, s.
        skew: How much later than the speed the tyre angle is reported, s, within a period.
        phase: Time of the first report, s.
        duration: Length of the run, s.
    """

    plant: VehicleParameters
    controller: VehicleParameters
    delay: float = 0.0002
    skew: float = 0.0
    phase: float = 0.0
    duration: float = 20.0

    def run(self) -> list[Sample]:
        """Returns the log of the run: the true state every 10 ms."""
        return _Run(self).samples


class _Run:
    """One run: an ordered queue of events, between which the plant is integrated."""

    def __init__(self, loop: Loop) -> None:
        self.samples: list[Sample] = []
        self._loop = loop
        self._plant = BicyclePlant(loop.plant)
        self._steering = SteeringLogic(loop.controller)
        self._speed = SpeedLogic(loop.controller)
        self._speed.take_cruise_speed(loop.controller.reference_speed)
        self._order = itertools.count()
        self._events: list[tuple[float, int, Callable[[float], None]]] = []
        self._fill()
        self._drain()

    def _at(self, time: float, action: Callable[[float], None]) -> None:
        heapq.heappush(self._events, (time, next(self._order), action))

    def _fill(self) -> None:
        loop = self._loop
        for index in range(round(loop.duration * loop.plant.report_rate)):
            time = loop.phase + index / loop.plant.report_rate
            self._at(time + loop.skew, self._report_angle)
            self._at(time, self._report_speed)
        for index in range(round(loop.duration / LOG_PERIOD) + 1):
            self._at(index * LOG_PERIOD, self._log)

    def _drain(self) -> None:
        now = 0.0
        while self._events:
            time, _, action = heapq.heappop(self._events)
            if time > self._loop.duration:
                return
            self._plant.advance(time - now)
            now = time
            action(time)

    def _log(self, time: float) -> None:
        plant, state = self._plant, self._plant.state
        self.samples.append(
            Sample(
                time,
                state.x,
                state.y,
                state.psi,
                state.v,
                state.delta,
                plant.steering_command,
                plant.speed_command,
            )
        )

    def _report_angle(self, time: float) -> None:
        angle = self._angle_through_effort(self._plant.state.delta)
        self._at(time + self._loop.delay, lambda now: self._take_angle(now, angle))

    def _take_angle(self, now: float, angle: float) -> None:
        self._speed.take_measured_angle(angle)
        self._steering.take_angle(angle, now)

    def _report_speed(self, time: float) -> None:
        speed = quantised(self._plant.state.v, SPEED_QUANTUM)
        self._at(time + self._loop.delay, lambda now: self._control(now, time, speed))

    def _control(self, now: float, sensed: float, speed: float) -> None:
        step = self._steering.take_speed(SpeedReport(math.floor(sensed * 1000), speed, now))
        self._speed.take_commanded_angle(step.command)
        wanted = self._speed.command(step.pose.x, step.pose.y)
        sent_angle = self._angle_through_effort(step.command)
        sent_speed = self._speed_through_effort(wanted)
        self._at(now + self._loop.delay, lambda _: self._plant.command(sent_speed, sent_angle))

    def _angle_through_effort(self, angle: float) -> float:
        limit = self._loop.plant.steering_limit
        return quantised(100.0 * angle / limit, EFFORT_QUANTUM) / 100.0 * limit

    def _speed_through_effort(self, speed: float) -> float:
        highest = self._loop.plant.speed_max
        return quantised(100.0 * speed / highest, EFFORT_QUANTUM) / 100.0 * highest
