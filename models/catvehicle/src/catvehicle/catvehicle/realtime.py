"""The plant on the wall clock, with the dead-man switch of the drive by wire kit."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from .metrics import Sample
from .plant import BicyclePlant, VehicleState

if TYPE_CHECKING:
    from collections.abc import Callable

    from .parameters import VehicleParameters
    from .path import Pose


class RealTimePlant:
    """Advances a plant to the present whenever it is asked.

    When no speed was commanded for the dead-man time, the speed command becomes 0 from that
    instant on; the tyre angle keeps its command.
    """

    def __init__(self, parameters: VehicleParameters, clock: Callable[[], float]) -> None:
        """Start at rest in the origin; `clock` returns monotonic seconds."""
        self._parameters = parameters
        self._plant = BicyclePlant(parameters)
        self._clock = clock
        self._start = self._time = clock()
        self._deadline = math.inf

    def state(self) -> VehicleState:
        """Return the state now."""
        now = self._clock()
        if self._deadline <= now:
            self._advance_to(max(self._deadline, self._time))
            self._plant.command(0.0, self._plant.steering_command)
            self._deadline = math.inf
        self._advance_to(now)
        return self._plant.state

    @property
    def yaw_rate(self) -> float:
        """Yaw rate at the last state, rad/s, counter-clockwise."""
        return self._plant.yaw_rate

    def command_speed(self, speed: float) -> None:
        """Ask for a speed, m/s; it holds for the dead-man time."""
        self.state()
        self._plant.command(speed, self._plant.steering_command)
        self._deadline = self._time + self._parameters.deadman_timeout

    def command_steering(self, angle: float) -> None:
        """Ask for a tyre angle, rad; negative is right."""
        self.state()
        self._plant.command(self._plant.speed_command, angle)

    def stop(self) -> None:
        """Ask for standstill."""
        self.state()
        self._plant.command(0.0, self._plant.steering_command)
        self._deadline = math.inf

    def place(self, pose: Pose) -> None:
        """Say where the vehicle is; its motion and its commands go on."""
        state = replace(self.state(), x=pose.x, y=pose.y, psi=pose.psi)
        commands = self._plant.speed_command, self._plant.steering_command
        self._plant = BicyclePlant(self._parameters, state)
        self._plant.command(*commands)

    def sample(self) -> Sample:
        """Return the present state as a row of a log; time counts from the start."""
        state = self.state()
        return Sample(
            t=self._time - self._start,
            x=state.x,
            y=state.y,
            psi=state.psi,
            v=state.v,
            delta=state.delta,
            delta_cmd=self._plant.steering_command,
            v_cmd=self._plant.speed_command,
        )

    def _advance_to(self, time: float) -> None:
        self._plant.advance(time - self._time)
        self._time = time
