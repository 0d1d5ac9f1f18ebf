"""A rover of each make, to try an operator or a bridge, and a component on JAUS++ 5.

A component on JAUS++ differs from the standard:

- an acknowledgement lacks its first byte, the version of JUDP;
- a repeated packet is obeyed again;
- UpdateEvent stops it for ever;
- QueryServices is answered for the component that it names, and with an empty report for wildcards;
- a second CreateEvent with the same query yields the same event.
"""

from __future__ import annotations

import select
import struct
import threading
from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

from jausml.live.messages import Catalogue, MessageEntry, MessageError
from jausml.live.peers.makes.junior import JtsComponent, JuniorVehicle
from jausml.live.peers.makes.vehicle import Place, Vehicle
from jausml.runtime.base.address import JausAddress, address_of

OnCommand: TypeAlias = "Callable[[JausAddress, MessageEntry, dict[str, Any]], None]"


_HEADER = struct.Struct("<BHBII")
_SMALLEST = _HEADER.size + 2
_BUFFER = 1 << 18


class JausPlusPlus:
    """A component on JAUS++, which sends and receives for a vehicle on a thread.

    Attributes:
        obeyed_again: Number of repeated packets that were obeyed again.
    """

    def __init__(self, vehicle: Vehicle, place: Place) -> None:
        """Starts the component."""
        self.obeyed_again = 0
        self._vehicle = vehicle
        self._book: dict[int, tuple[str, int]] = {}
        self._seen: set[tuple[int, int, bytes]] = set()
        self._number = 0
        self._unicast, self._group = place.sockets(_BUFFER)
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the component."""
        self._running = False
        self._thread.join()
        self._unicast.close()
        self._group.close()

    def _run(self) -> None:
        while self._running:
            readable, _, _ = select.select([self._unicast, self._group], [], [], 0.01)
            for sock in readable:
                data, sender = sock.recvfrom(65535)
                if sender != self._unicast.getsockname():
                    self._on_datagram(data, sender)
            self._send(self._vehicle.due())

    def _on_datagram(self, data: bytes, sender: tuple[str, int]) -> None:
        if data[:1] != b"\2" or len(data) <= _SMALLEST:
            return
        _, size, flags, destination, source = _HEADER.unpack_from(data, 1)
        place = address_of(destination)
        if size != len(data) - 1 or flags & 0x20 or not place.matches(self._vehicle.address):
            return
        number, payload = data[-2:], data[1 + _HEADER.size : -2]
        self._book[source] = sender
        if flags & 0x10 and not self._vehicle.is_dead:
            head = _HEADER.pack(0, _SMALLEST, flags | 0x30, source, self._vehicle.address.packed)
            self._unicast.sendto(head + number, sender)
        packet = source, int.from_bytes(number, "little"), payload
        self.obeyed_again += packet in self._seen
        self._seen.add(packet)
        self._send(self._vehicle.take(payload, address_of(source)))

    def _send(self, messages: Iterable[tuple[JausAddress, bytes]]) -> None:
        for client, payload in messages:
            self._number = self._number + 1 & 0xFFFF
            own = self._vehicle.address.packed
            head = _HEADER.pack(0, _SMALLEST + len(payload), 0, client.packed, own)
            datagram = b"\2" + head + payload + struct.pack("<H", self._number)
            self._unicast.sendto(datagram, self._book[client.packed])


FULL_SPEED = 2.0  # metres per second at an effort of 100 percent
FULL_TURN = 1.0  # radians per second at a rotational effort of 100 percent


class Rover:
    """A rover that obeys SetWrenchEffort, and reports its velocity, without delay (AS6009)."""

    def __init__(self, catalogue: Catalogue, on_command: OnCommand) -> None:
        self._effort = catalogue.message("SetWrenchEffort")
        self._velocity = catalogue.message("ReportVelocityState")
        self._query = catalogue.message("QueryVelocityState")
        self._on_command = on_command
        self._speed = self._turn = 0.0

    def report(self, code: int) -> bytes | None:
        """Returns the report for the code of its query, None for other codes."""
        if code != self._query.code:
            return None
        moves = {"Velocity_X": self._speed, "YawRate": self._turn}
        return self._velocity.encode({"ReportVelocityStateRec": moves})

    def obey(self, payload: bytes, source: JausAddress) -> None:
        """Obeys SetWrenchEffort; ignores other messages."""
        if int.from_bytes(payload[:2], "little") != self._effort.code:
            return
        try:
            fields = self._effort.decode(payload)
        except MessageError:
            return
        efforts = fields["WrenchEffortRec"]
        self._speed = FULL_SPEED * efforts.get("PropulsiveLinearEffortX", 0.0) / 100
        self._turn = FULL_TURN * efforts.get("PropulsiveRotationalEffortZ", 0.0) / 100
        self._on_command(source, self._effort, fields)


def _junior(address: JausAddress, rover: Rover, place: Place) -> JuniorVehicle:
    return JuniorVehicle(Vehicle(address, rover.report, rover.obey, doubles_events=True), place)


def _tool_set(address: JausAddress, rover: Rover, place: Place) -> JtsComponent:
    return JtsComponent(address, place, rover.report, rover.obey)


def _jaus_plus_plus(address: JausAddress, rover: Rover, place: Place) -> JausPlusPlus:
    return JausPlusPlus(Vehicle(address, rover.report, rover.obey, dies_of_updates=True), place)


MAKES: dict[str, Callable[[JausAddress, Rover, Place], JuniorVehicle | JtsComponent | JausPlusPlus]]
# Functions that start a rover by make. It runs on threads of its own until ``close``.
MAKES = {"junior": _junior, "jts": _tool_set, "jaus++": _jaus_plus_plus}
