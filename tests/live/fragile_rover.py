"""A rover whose owner has overridden more than is good: it loses ROS on the way."""

from jausml_runtime import run_bridge
from rover.rover import Rover


class FragileRover(Rover):
    """Refuses a top speed of 20 m/s, leaves at the next command at 25, shuts ROS down at 30."""

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

    def translate_drive(self, source):
        if self.max_speed == 25.0:
            raise SystemExit("the owner has left")
        return super().translate_drive(source)


if __name__ == "__main__":
    raise SystemExit(run_bridge(FragileRover()))
