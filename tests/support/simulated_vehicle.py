"""A vehicle of JAUS over loopback that notes what it is told: a real component in this process."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from studio_client import Page, RefusedError

import jausml
from jausml import Component
from jausml.runtime import JausComponent, ListElement
from jausml.runtime.services.definitions import Status

VEHICLE = "100.1.10"
SERVICES = ("PrimitiveDriver", "VelocityStateSensor", "LocalPoseSensor", "LocalWaypointListDriver")


LEASE, TIMEOUT = 2.0, 0.6
STOP = f"SetWrenchEffort {TIMEOUT} PropulsiveLinearEffortX=0"
"""What the studios say that operate it: seconds of a silent page and of a silent stick."""


class Vehicle:
    """Takes efforts, tells its velocity and pose, and keeps all of it with the time."""

    def __init__(self, port: int) -> None:
        self.efforts: list[tuple[float, float]] = []
        self.speed = 0.0
        self.place = (0.0, 0.0)
        self.executed: list[tuple[float, int | None]] = []
        self._active = 0
        self._component = Component(VEHICLE, provides=SERVICES, name="vehicle", port=port)
        self._observer = Component(name="observer", port=port)
        self._component.obey("SetWrenchEffort", self._drive)
        self._component.answer("WrenchEffort", self._effort)
        self._component.answer("VelocityState", lambda: {"Velocity_X": self.speed})
        self._component.answer("LocalPose", self._pose)
        self._component.obey("ExecuteList", self._execute)
        self._component.answer("ActiveElement", lambda: {"ElementUID": self.active})

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
    def _itself(self) -> JausComponent:
        return self._component._operator._component

    @property
    def list(self) -> list[ListElement]:
        """The elements that it was given, in their order."""
        return list(self._itself.elements)

    @property
    def active(self) -> int:
        """The element that it drives to: none unless it is Ready, and has that element."""
        is_ready = self._itself.status is Status.READY
        return self._active if is_ready and self._active in self._itself.elements else 0

    def reach(self) -> None:
        """Is at the active element, and drives to the next one."""
        element = self._itself.elements.get(self.active)
        assert element is not None, "it drives to no element"
        where = jausml.decode(element.data).fields["LocalWaypointRec"]
        self.place = (where["X"], where["Y"])
        self._active = element.next_uid

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

    def _execute(self, received: Any) -> None:
        speed, uid = received.fields["Speed"], received.fields.get("ElementUID")
        self.executed.append((round(speed, 2), uid))
        self._active = 0 if speed == 0 else uid or self._active

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


def take(page: Page, component: str = VEHICLE) -> None:
    """Takes control; whoever commanded in the test before is released meanwhile."""

    def taken() -> bool:
        try:
            page.ask("take", component=component, authority=205)
        except RefusedError:
            return False
        return True

    until(taken)
