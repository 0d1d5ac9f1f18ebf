"""A rover whose owner has overridden more than is good: it loses ROS on the way."""

from __future__ import annotations

from jausml_runtime import run_bridge
from rover.rover import Rover


class FragileRover(Rover):
    """Dies of a top speed of 20 m/s, and shuts ROS down at 30 m/s."""

    @property
    def max_speed(self) -> float:
        return self._max_speed

    @max_speed.setter
    def max_speed(self, value: float) -> None:
        if value == 20.0:
            raise RuntimeError("so fast no rover is")
        if value == 30.0:
            self.ros._context.shutdown()
        self._max_speed = value


if __name__ == "__main__":
    raise SystemExit(run_bridge(FragileRover()))
