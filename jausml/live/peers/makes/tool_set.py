"""A component as the JAUS Tool Set generates it, on Junior: what it answers, and what it does not.

It is a waypoint driver with AccessControl and Management, which announces its leaf services alone:

- ReportServices has one record of the node for each service, in all of them the same component.
- QueryIdentification is answered with query type 2, whatever was asked.
- QueryControl, QueryTimeout and all of Events stay unanswered.
- A message without a message code ends it; ``restart`` starts it again.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from jausml.live.peers.makes.junior import JuniorPeer

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.makes.vehicle import Place
    from jausml.runtime.base.address import JausAddress

SERVICES = (
    "urn:jaus:jss:mobility:LocalPoseSensor",
    "urn:jaus:jss:mobility:LocalWaypointListDriver",
)
READY, STANDBY, EMERGENCY = 1, 2, 5
RESUME, STAND_BY, SET_EMERGENCY, CLEAR_EMERGENCY = 0x0004, 0x0003, 0x0006, 0x0007
REQUEST_CONTROL, RELEASE_CONTROL, CONFIRM_CONTROL, REJECT_CONTROL = 0x0D, 0x0E, 0x0F, 0x10
QUERY_STATUS, REPORT_STATUS = 0x2002, 0x4002
QUERY_IDENTIFICATION, REPORT_IDENTIFICATION = 0x2B00, 0x4B00
QUERY_SERVICES, REPORT_SERVICES = 0x2B03, 0x4B03
QUERY_LOCAL_POSE, REPORT_LOCAL_POSE = 0x2403, 0x4403
ACCEPTED, NOT_AVAILABLE = 0, 1
_SUBSYSTEM, _VEHICLE = 2, 10001


class JtsComponent(JuniorPeer):
    """A waypoint driver of the JAUS Tool Set."""

    def __init__(
        self,
        address: JausAddress,
        place: Place,
        report: Callable[[int], bytes | None] = lambda _: None,
        obey: Callable[[bytes, JausAddress], None] = lambda *_: None,
    ) -> None:
        """Stands by."""
        self._report, self._further = report, obey
        self._reset()
        super().__init__(address, place)

    def restart(self) -> None:
        """Starts it again, in standby and uncontrolled."""
        self._reset()
        super().restart()

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Answers, obeys, or dies."""
        if len(payload) < 2:
            self.end()
            return
        (code,) = struct.unpack_from("<H", payload)
        answer = self._report(code) or self._answer(code, source)
        if answer is not None:
            self.send(source, answer)
        elif source == self.controller and self.state == READY:
            self._further(payload, source)

    def _reset(self) -> None:
        self.state = STANDBY
        self.controller: JausAddress | None = None
        self._before = STANDBY

    def _answer(self, code: int, source: JausAddress) -> bytes | None:
        if code == QUERY_IDENTIFICATION:
            name = b"WaypointDriver"
            head = struct.pack("<HBHB", REPORT_IDENTIFICATION, _SUBSYSTEM, _VEHICLE, len(name))
            return head + name
        if code == QUERY_SERVICES:
            return self._report_services()
        if code == QUERY_STATUS:
            return struct.pack("<HBI", REPORT_STATUS, self.state, 0)
        if code == QUERY_LOCAL_POSE:
            return struct.pack("<HH", REPORT_LOCAL_POSE, 0)
        return self._obey(code, source)

    def _report_services(self) -> bytes:
        report = struct.pack("<HB", REPORT_SERVICES, len(SERVICES))
        for urn in SERVICES:
            report += bytes([self.address.node, 1, self.address.component, 0, 1, len(urn)])
            report += urn.encode() + bytes([1, 0])
        return report

    def _obey(self, code: int, source: JausAddress) -> bytes | None:
        if code == REQUEST_CONTROL:
            if self.controller not in (None, source):
                return struct.pack("<HB", CONFIRM_CONTROL, NOT_AVAILABLE)
            self.controller = source
            return struct.pack("<HB", CONFIRM_CONTROL, ACCEPTED)
        if code == SET_EMERGENCY and self.state != EMERGENCY:
            self._before, self.state = self.state, EMERGENCY
        if source != self.controller:
            return None
        if code == RELEASE_CONTROL:
            self.controller = None
            return struct.pack("<HB", REJECT_CONTROL, 0)
        if code == CLEAR_EMERGENCY and self.state == EMERGENCY:
            self.state = self._before
        elif code in (RESUME, STAND_BY) and self.state != EMERGENCY:
            self.state = READY if code == RESUME else STANDBY
        return None
