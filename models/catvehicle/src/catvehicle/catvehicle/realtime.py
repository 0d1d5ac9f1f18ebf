"""The plant on the wall clock, with the dead-man switch of the drive by wire kit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .metrics import Sample
from .plant import BicyclePlant, VehicleState

if TYPE_CHECKING:
    from collections.abc import Callable

    from .parameters import VehicleParameters
    from .path import Pose


RECORD_PERIOD = 0.01
"""Seconds between two recorded samples."""


class RealTimePlant:
    """Advances a plant to the present whenever it is asked.

    When no speed was commanded for the dead-man time, the speed command becomes 0 from that
    instant on; the tyre angle keeps its command.
    """

    def __init__(
        self,
        parameters: VehicleParameters,
        clock: Callable[[], float],
        plant: BicyclePlant | None = None,
        record: Callable[[Sample], None] | None = None,
    ) -> None:
        """Starts now.

        Args:
            parameters: The dead-man time is used, and the rest for the default plant.
            clock: Returns monotonic seconds.
            plant: The vehicle; by default a kinematic bicycle at rest in the origin.
            record: Takes the true state at every hundredth second of the plant's time, however
                seldom anybody asks for it.
        """
        self._parameters = parameters
        self._plant = plant or BicyclePlant(parameters)
        self._clock = clock
        self._start = self._time = clock()
        self._deadline = math.inf
        self._record = record
        self._recorded = 0

    def state(self) -> VehicleState:
        """Returns the state now."""
        now = self._clock()
        if self._deadline <= now:
            self._advance_to(max(self._deadline, self._time))
            self._plant.command(0.0, self._plant.steering_command)
            self._deadline = math.inf
        self._advance_to(now)
        return self._plant.state

    @property
    def started(self) -> float:
        """When the plant was made, s on its clock: time 0 of its samples."""
        return self._start

    @property
    def yaw_rate(self) -> float:
        """Yaw rate at the last state, rad/s, counter-clockwise."""
        return self._plant.yaw_rate

    def command_speed(self, speed: float) -> None:
        """Asks for a speed, m/s; it holds for the dead-man time."""
        self.state()
        self._plant.command(speed, self._plant.steering_command)
        self._deadline = self._time + self._parameters.deadman_timeout

    def command_steering(self, angle: float) -> None:
        """Asks for a tyre angle, rad; negative is right."""
        self.state()
        self._plant.command(self._plant.speed_command, angle)

    def stop(self) -> None:
        """Asks for standstill."""
        self.state()
        self._plant.command(0.0, self._plant.steering_command)
        self._deadline = math.inf

    def place(self, pose: Pose) -> None:
        """Say where the vehicle is; its motion and its commands go on."""
        self.state()
        self._plant.place(pose)

    def sample(self) -> Sample:
        """Returns the present state as a row of a log; time counts from the start."""
        self.state()
        return self._sample(self._time - self._start)

    def _sample(self, time: float) -> Sample:
        state = self._plant.state
        return Sample(
            t=time,
            x=state.x,
            y=state.y,
            psi=state.psi,
            v=state.v,
            delta=state.delta,
            delta_cmd=self._plant.steering_command,
            v_cmd=self._plant.speed_command,
        )

    def _advance_to(self, time: float) -> None:
        while self._record is not None:
            due = self._recorded * RECORD_PERIOD
            if self._start + due > time:
                break
            self._plant.advance(max(self._start + due - self._time, 0.0))
            self._time = max(self._start + due, self._time)
            self._record(self._sample(due))
            self._recorded += 1
        self._plant.advance(time - self._time)
        self._time = time
