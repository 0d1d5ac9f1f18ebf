"""A vehicle of JAUS over loopback that notes what it is told: a real component in this process."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from jausml import Component

if TYPE_CHECKING:
    from collections.abc import Callable

VEHICLE = "100.1.10"
SERVICES = ("PrimitiveDriver", "VelocityStateSensor", "LocalPoseSensor", "LocalWaypointListDriver")


class Vehicle:
    """Takes efforts, tells its velocity and pose, and keeps all of it with the time."""

    def __init__(self, port: int) -> None:
        self.efforts: list[tuple[float, float]] = []
        self.speed = 0.0
        self.place = (0.0, 0.0)
        self._component = Component(VEHICLE, provides=SERVICES, name="vehicle", port=port)
        self._observer = Component(name="observer", port=port)
        self._component.obey("SetWrenchEffort", self._drive)
        self._component.answer("WrenchEffort", self._effort)
        self._component.answer("VelocityState", lambda: {"Velocity_X": self.speed})
        self._component.answer("LocalPose", self._pose)

    def __enter__(self) -> Vehicle:
        self._component.start()
        self._observer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._observer.stop()
        self._component.stop()

    @property
    def last(self) -> float | None:
        """The last effort, in percent."""
        return self.efforts[-1][1] if self.efforts else None

    @property
    def status(self) -> str | None:
        """Its state, as others see it."""
        return self._observer.status(VEHICLE).state

    @property
    def controller(self) -> str | None:
        """Who controls it, as others see it."""
        return self._observer.status(VEHICLE).controller

    def _drive(self, received: Any) -> None:
        [fields] = received.fields.values() if len(received.fields) == 1 else [received.fields]
        effort = fields if isinstance(fields, float) else fields.get("PropulsiveLinearEffortX", 0.0)
        self.efforts.append((time.monotonic(), round(effort, 1)))
        self.speed = effort / 10

    def _effort(self) -> dict[str, Any]:
        return {"PropulsiveLinearEffortX": self.last or 0.0}

    def _pose(self) -> dict[str, Any]:
        x, y = self.place
        return {"X": x, "Y": y}


def until(holds: Callable[[], Any], seconds: float = 30.0) -> Any:
    """Waits until something holds, and returns it."""
    end = time.monotonic() + seconds
    while not (found := holds()):
        assert time.monotonic() < end, "it does not come to hold"
        time.sleep(0.02)
    return found
