"""A rover to try an operator or a bridge with, as each make would have it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.messages import MessageError
from jausml.live.peers.makes.jaus_plus_plus import JausPlusPlus
from jausml.live.peers.makes.junior import JuniorVehicle
from jausml.live.peers.makes.tool_set import JtsComponent
from jausml.live.peers.makes.vehicle import Vehicle

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.live.peers.makes.vehicle import Place
    from jausml.runtime.base.address import JausAddress

    OnCommand = Callable[[JausAddress, MessageEntry, dict[str, Any]], None]

FULL_SPEED = 2.0
"""Metres per second at an effort of 100 percent."""


class Rover:
    """Takes SetWrenchEffort, and reports a velocity that follows at once (AS6009)."""

    def __init__(self, catalogue: Catalogue, on_command: OnCommand) -> None:
        """Stands."""
        self._effort = catalogue.message("SetWrenchEffort")
        self._velocity = catalogue.message("ReportVelocityState")
        self._query = catalogue.message("QueryVelocityState")
        self._on_command = on_command
        self._speed = 0.0

    def report(self, code: int) -> bytes | None:
        """Returns the velocity to who asks for it."""
        if code != self._query.code:
            return None
        return self._velocity.encode({"ReportVelocityStateRec": {"Velocity_X": self._speed}})

    def obey(self, payload: bytes, source: JausAddress) -> None:
        """Takes an effort, and nothing else."""
        if int.from_bytes(payload[:2], "little") != self._effort.code:
            return
        try:
            fields = self._effort.decode(payload)
        except MessageError:
            return
        effort = fields["WrenchEffortRec"].get("PropulsiveLinearEffortX", 0.0)
        self._speed = FULL_SPEED * effort / 100
        self._on_command(source, self._effort, fields)


def _junior(address: JausAddress, rover: Rover, place: Place) -> JuniorVehicle:
    return JuniorVehicle(Vehicle(address, rover.report, rover.obey, doubles_events=True), place)


def _tool_set(address: JausAddress, rover: Rover, place: Place) -> JtsComponent:
    return JtsComponent(address, place, rover.report, rover.obey)


def _jaus_plus_plus(address: JausAddress, rover: Rover, place: Place) -> JausPlusPlus:
    return JausPlusPlus(Vehicle(address, rover.report, rover.obey, dies_of_updates=True), place)


MAKES: dict[str, Callable[[JausAddress, Rover, Place], JuniorVehicle | JtsComponent | JausPlusPlus]]
MAKES = {"junior": _junior, "jts": _tool_set, "jaus++": _jaus_plus_plus}
"""What starts a rover of each make. It runs on threads of its own until ``close``."""
