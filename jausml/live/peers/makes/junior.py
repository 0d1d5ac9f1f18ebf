"""A component on Junior's API and the node manager below it, as other peers see them.

It is modelled on Junior's behaviour on the wire, with its own sockets and thread, and has these
habits of Junior:

- a receive buffer of 70,000 bytes, of which a manager takes ten datagrams in each round, with a
  pause of a millisecond between two; a datagram above 5000 bytes is cut, and so lost;
- an address book that learns from every datagram and never forgets, not even with ``restart``;
- 50 loose packets kept, of all sources together; each one more pushes out the oldest;
- of the same source and number, one packet in 3 seconds (of the latest 50), whatever its bytes; an
  acknowledgement is sent before anything is dropped;
- numbers that start at 1 in each process; packets of 4079 bytes, each sent after the one before was
  acknowledged, four times at most, 100 ms apart; without acknowledgement ten in a millisecond;
- a message for an unknown component is multicast with a request for acknowledgement.

A vehicle whose author wrote the events by himself makes another event of each CreateEvent.

Components of the JAUS Tool Set are based on Junior. Such a component is a waypoint
driver with AccessControl and Management, which announces its leaf services alone:

- ReportServices has one record of the node for each service, in all of them the same component.
- QueryIdentification is answered with query type 2, whatever was asked.
- QueryControl, QueryTimeout and all of Events stay unanswered.
- A message without a message code ends it; ``restart`` starts it again.
"""

from __future__ import annotations

import struct
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

from jausml.runtime.base.address import address_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import Self

    from jausml.live.peers.makes.vehicle import Place, Vehicle
    from jausml.runtime.base.address import JausAddress


RECEIVE_BUFFER = 70_000
LARGEST_DATAGRAM = 5000
DATAGRAMS_IN_A_ROUND = 10
PAUSE_S = 0.001
PACKET_SIZE = 4079
HISTORY = 50
MEMORY_S = 3.0
ACKNOWLEDGE_TIMEOUT_S = 0.1
TRANSMISSIONS = 4

_HEADER = struct.Struct("<BHBII")
_SEQUENCE = struct.Struct("<H")
_MESSAGE_SIZE = _HEADER.size + _SEQUENCE.size
SINGLE, FIRST, MIDDLE, LAST = range(4)
NONE, REQUESTED, NAK, ACK = range(4)
GLOBAL = 2


class Loose(NamedTuple):
    """A packet that waits for the other packets of its message (`place`: FIRST to LAST)."""

    source: int
    sequence: int
    place: int
    payload: bytes


class JuniorPeer:
    """One component of another host that runs Junior.

    Attributes:
        thrown_away: Number of loose packets that were dropped for newer ones.
        alive: Whether the component runs; its node manager runs without it, too.
        transmissions: Greatest number of sendings of an acknowledged packet; tests on a busy
            computer need more than Junior's four.
    """

    def __init__(self, address: JausAddress, place: Place) -> None:
        """Starts the component, and the node manager of its host."""
        self.address = address
        self.endpoint = place.endpoint
        self.transmissions = TRANSMISSIONS
        self._group = place.group
        self._book: dict[int, tuple[str, int]] = {}
        self._state = threading.Condition(threading.RLock())
        self._start_component()
        self._unicast, self._multicast = place.sockets(RECEIVE_BUFFER)
        self._running = True
        self._thread = threading.Thread(target=self._run, name=f"junior-{address}", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the component and its node manager."""
        self._running = False
        self._thread.join()
        self._unicast.close()
        self._multicast.close()

    def restart(self) -> None:
        """Restarts the component, with sequence number 1 and no loose packets."""
        with self._state:
            self._start_component()

    def end(self) -> None:
        """Ends the component, but not its node manager: acknowledgements stop."""
        self.alive = False

    def send(self, destination: JausAddress, payload: bytes, *, acknowledge: bool = False) -> bool:
        """Sends a message and waits for that; returns False without acknowledgement."""
        parts = [payload[at : at + PACKET_SIZE] for at in range(0, len(payload), PACKET_SIZE)]
        places = [FIRST, *[MIDDLE] * (len(parts) - 2), LAST] if len(parts) > 1 else [SINGLE]
        for count, (part, place) in enumerate(zip(parts, places, strict=True), 1):
            sequence = self._next_sequence()
            if acknowledge:
                if not self._send_until_acknowledged(destination.packed, part, sequence, place):
                    return False
            else:
                self._transmit(destination.packed, part, sequence, place, NONE)
                if count % DATAGRAMS_IN_A_ROUND == 0:
                    time.sleep(PAUSE_S)
        return True

    def knows(self, address: JausAddress) -> tuple[str, int] | None:
        """Returns the endpoint of a component in the address book of the node manager."""
        return self._book.get(address.packed)

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Is called with each whole message, on the thread of the peer."""

    # ---- the component ----------------------------------------------------------------------

    def _start_component(self) -> None:
        self.alive = True
        self.thrown_away = 0
        self._number = 1
        self._recent: deque[tuple[float, int, int]] = deque(maxlen=HISTORY)
        self._loose: list[Loose] = []
        self._acknowledged: set[int] = set()

    def _next_sequence(self) -> int:
        with self._state:
            self._number = self._number + 1 & 0xFFFF
            return self._number - 1 & 0xFFFF

    def _send_until_acknowledged(
        self, destination: int, part: bytes, sequence: int, place: int
    ) -> bool:
        with self._state:
            self._acknowledged.discard(sequence)
            for _ in range(self.transmissions):
                self._transmit(destination, part, sequence, place, REQUESTED)
                if self._state.wait_for(
                    lambda: sequence in self._acknowledged, ACKNOWLEDGE_TIMEOUT_S
                ):
                    return True
        return False

    def _take(self, flags: int, packet: Loose) -> None:
        acknowledgement = flags >> 4 & 3
        if acknowledgement == REQUESTED:
            self._transmit(packet.source, b"", packet.sequence, SINGLE, ACK, priority=flags & 3)
        if acknowledgement == ACK:
            self._acknowledged.add(packet.sequence)
            self._state.notify_all()
        if acknowledgement >= NAK or self._is_known(packet):
            return
        if packet.place == SINGLE:
            self.on_message(address_of(packet.source), packet.payload)
            return
        self._loose.append(packet)
        self._assemble()
        if len(self._loose) > HISTORY:
            del self._loose[0]
            self.thrown_away += 1

    def _is_known(self, packet: Loose) -> bool:
        now = time.monotonic()
        for when, source, sequence in self._recent:
            if (source, sequence) == packet[:2] and now - when < MEMORY_S:
                return True
        self._recent.append((now, packet.source, packet.sequence))
        return False

    def _assemble(self) -> None:
        """Delivers a whole message: packets with consecutive numbers from a first to a last."""
        loose = {(packet.source, packet.sequence): packet for packet in self._loose}
        for first in (packet for packet in self._loose if packet.place == FIRST):
            parts = [first]
            while parts[-1].place != LAST:
                following = loose.get((first.source, parts[-1].sequence + 1 & 0xFFFF))
                if following is None:
                    break
                parts.append(following)
            else:
                self._loose = [packet for packet in self._loose if packet not in parts]
                payload = b"".join(part.payload for part in parts)
                self.on_message(address_of(first.source), payload)
                return

    # ---- the node manager -------------------------------------------------------------------

    def _run(self) -> None:
        while self._running:
            time.sleep(PAUSE_S)
            for sock in (self._unicast, self._multicast):
                for _ in range(DATAGRAMS_IN_A_ROUND):
                    try:
                        data, sender = sock.recvfrom(LARGEST_DATAGRAM)
                    except BlockingIOError:
                        break
                    if sender != self.endpoint:
                        self._on_datagram(data, sender)

    def _on_datagram(self, data: bytes, sender: tuple[str, int]) -> None:
        at = 1
        while data[:1] == b"\x02" and len(data) - at >= _MESSAGE_SIZE:
            _, size, flags, destination, source = _HEADER.unpack_from(data, at)
            if not _MESSAGE_SIZE <= size <= len(data) - at:
                return
            payload = data[at + _HEADER.size : at + size - _SEQUENCE.size]
            (sequence,) = _SEQUENCE.unpack_from(data, at + size - _SEQUENCE.size)
            at += size
            with self._state:
                self._book[source] = sender
                if self.alive and address_of(destination).matches(self.address):
                    self._take(flags, Loose(source, sequence, flags >> 6, payload))

    def _transmit(
        self,
        destination: int,
        payload: bytes,
        sequence: int,
        place: int,
        acknowledge: int,
        *,
        priority: int = 1,
    ) -> None:
        endpoint = self._book.get(destination)
        flags = priority | acknowledge << 4 | place << 6
        if endpoint is None:
            endpoint = self._group
            flags |= GLOBAL << 2
            if not address_of(destination).is_wildcard:
                flags |= REQUESTED << 4
        size = _MESSAGE_SIZE + len(payload)
        header = _HEADER.pack(0, size, flags, destination, self.address.packed)
        datagram = b"\x02" + header + payload + _SEQUENCE.pack(sequence)
        self._unicast.sendto(datagram, endpoint)


class JuniorVehicle(JuniorPeer):
    """A vehicle on Junior's API."""

    def __init__(self, vehicle: Vehicle, place: Place) -> None:
        """Starts the vehicle and the node manager of its host."""
        self._vehicle = vehicle
        super().__init__(vehicle.address, place)
        self._reporter = threading.Thread(target=self._report, daemon=True)
        self._reporter.start()

    def close(self) -> None:
        """Ends the vehicle."""
        self._running = False
        self._reporter.join()
        super().close()

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Answers or obeys."""
        for client, answer in self._vehicle.take(payload, source):
            self.send(client, answer)

    def _report(self) -> None:
        while self._running:
            for client, report in self._vehicle.due():
                self.send(client, report)
            time.sleep(0.01)


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
        self._report, self._further = report, obey
        self._reset()
        super().__init__(address, place)

    def restart(self) -> None:
        """Restarts the component, in Standby and without a controller."""
        self._reset()
        super().restart()

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Answers or obeys a message; ends on one without a message code."""
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
