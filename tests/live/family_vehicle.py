"""A vehicle of another make: `family_vehicle.py FAMILY PORT`, on a host of its own of loopback.

One line of JSON for each command that it obeys. The families: `jauspp`, `junior`, `jts`.
"""

from __future__ import annotations

import sys
import threading

from foreign_vehicle import JausPlusPlus, JuniorVehicle, Vehicle
from jts_component import READY, JtsComponent
from roles import say
from tolerant.messages import QueryVelocityState, ReportVelocityState, SetWrenchEffort

from jausml.runtime.base.address import JausAddress

ADDRESS = JausAddress(152, 1, 1)
SPEED = 1.5


def report(code: int) -> bytes | None:
    """Returns the speed to who asks for it."""
    if code != QueryVelocityState.CODE:
        return None
    return ReportVelocityState(velocity_x=SPEED).encode()


def obey(payload: bytes) -> None:
    """Tells of an effort; it has nothing else to obey."""
    if int.from_bytes(payload[:2], "little") != SetWrenchEffort.CODE:
        return
    effort = SetWrenchEffort.decode(payload)
    say("effort", linear=round(effort.propulsive_linear_effort_x or 0.0))


class JtsVehicle(JtsComponent):
    """A component of the JAUS Tool Set that drives; it knows no events."""

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Answers, obeys, or dies."""
        code = int.from_bytes(payload[:2], "little")
        answer = report(code)
        if answer is not None:
            self.send(source, answer)
        elif code == SetWrenchEffort.CODE:
            if source == self.controller and self.state == READY:
                obey(payload)
        else:
            super().on_message(source, payload)


def main() -> None:
    """Drives until the process is ended."""
    family, port = sys.argv[1], int(sys.argv[2])
    if family == "jts":
        JtsVehicle(ADDRESS, port)
    elif family == "junior":
        JuniorVehicle(Vehicle(ADDRESS, report, obey, doubles_events=True), port)
    else:
        JausPlusPlus(Vehicle(ADDRESS, report, obey, dies_of_updates=True), port)
    say("ready")
    threading.Event().wait()


if __name__ == "__main__":
    main()
