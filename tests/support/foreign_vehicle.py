"""A vehicle as stacks of other makes have it, and the transport of JAUS++ (two of the families).

What JAUS++ 5 does otherwise than the standard has it, as it behaves on the wire:

- an acknowledgement lacks its first byte, the version of JUDP, and is right otherwise;
- a packet that is repeated is obeyed again;
- UpdateEvent brings it to a standstill, for ever;
- QueryServices is answered for the component that it names, and with an empty report for wildcards;
- an event that is asked for again is the one that it has.

``JuniorPeer`` (``junior_peer.py``) is the transport of Junior; on it, a vehicle whose author wrote
the events by himself makes another event of each CreateEvent.
"""

from __future__ import annotations

import select
import socket
import struct
import threading
import time
from typing import TYPE_CHECKING

from junior_peer import JuniorPeer

from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress

if TYPE_CHECKING:
    from collections.abc import Callable

CORE = ("Transport", "Events", "AccessControl", "Management", "Discovery")
SERVICES = (
    *(f"urn:jaus:jss:core:{name}" for name in CORE),
    "urn:jaus:jss:mobility:PrimitiveDriver",
    "urn:jaus:jss:mobility:VelocityStateSensor",
)
READY, STANDBY = 1, 2
COMPONENT, VEHICLE = 4, 10001
_HEADER = struct.Struct("<BHBII")
_SMALLEST = _HEADER.size + 2
_WILDCARD = 255
_INPUTS = {
    each.CODE: each
    for each in (
        core.CancelEvent,
        core.CreateEvent,
        core.QueryControl,
        core.QueryEventTimeout,
        core.QueryIdentification,
        core.QueryServices,
        core.QueryStatus,
        core.QueryTimeout,
        core.ReleaseControl,
        core.RequestControl,
        core.Resume,
        core.Standby,
        core.UpdateEvent,
    )
}

Told = list[tuple[JausAddress, bytes]]
"""Messages with whom they are for."""


class Vehicle:
    """Obeys one controller, and reports at the rate that is asked for.

    Attributes:
        dies_of_updates: Whether UpdateEvent brings it to a standstill.
        doubles_events: Whether it makes another event of each CreateEvent.
        is_dead: Whether it stands still.
    """

    def __init__(
        self,
        address: JausAddress,
        report: Callable[[int], bytes | None],
        obey: Callable[[bytes], None],
        *,
        dies_of_updates: bool = False,
        doubles_events: bool = False,
    ) -> None:
        """Stands by.

        Args:
            address: Its component.
            report: Returns what answers a query of its code.
            obey: Takes a command of the controller, in Ready.
        """
        self.address = address
        self.dies_of_updates, self.doubles_events = dies_of_updates, doubles_events
        self.is_dead = False
        self._report, self._obey = report, obey
        self._state = STANDBY
        self._controller: JausAddress | None = None
        self._events: dict[int, list] = {}  # client, query, period, due, number

    def take(self, payload: bytes, source: JausAddress) -> Told:
        """Answers a message."""
        if len(payload) < 2 or self.is_dead:
            return []
        (code,) = struct.unpack_from("<H", payload)
        report = self._report(code)
        if report is not None:
            return [(source, report)]
        kind = _INPUTS.get(code)
        if kind is not None:
            return [(source, each.encode()) for each in self._answers(kind.decode(payload), source)]
        if source == self._controller and self._state == READY:
            self._obey(payload)
        return []

    def due(self) -> Told:
        """Returns the reports whose time has come."""
        now, told = time.monotonic(), []
        for number, event in self._events.items():
            client, query, period, due, sequence = event
            if now >= due and not self.is_dead:
                ((_, report),) = self.take(query, client)
                told.append((client, core.Event(number, sequence, report).encode()))
                event[3:] = max(due + period, now), sequence + 1 & 0xFF
        return told

    def _answers(self, message, source: JausAddress) -> list:
        if isinstance(message, core.QueryStatus):
            return [core.ReportStatus(self._state)]
        if isinstance(message, core.QueryTimeout):
            return [core.ReportTimeout(5)]
        if isinstance(message, core.QueryEventTimeout):
            return [core.ReportEventTimeout(1)]
        if isinstance(message, core.QueryIdentification) and message.query_type == COMPONENT:
            return [core.ReportIdentification(COMPONENT, VEHICLE, "vehicle")]
        if isinstance(message, core.QueryServices):
            return [self._services(message)]
        if isinstance(message, core.CreateEvent):
            return self._create(message, source)
        if isinstance(message, core.CancelEvent):
            self._events.pop(message.event_id, None)
        if isinstance(message, core.UpdateEvent):
            self.is_dead = self.dies_of_updates
        return self._controlled(message, source)

    def _controlled(self, message, source: JausAddress) -> list:
        if isinstance(message, core.QueryControl):
            by = self._controller
            parts = (by.subsystem, by.node, by.component) if by else (0, 0, 0)
            return [core.ReportControl(*parts, 127)]
        if isinstance(message, core.RequestControl):
            if self._controller not in (None, source):
                return [core.ConfirmControl(1)]
            self._controller = source
            return [core.ConfirmControl(0)]
        if source != self._controller:
            return []
        if isinstance(message, core.ReleaseControl):
            self._controller, self._state = None, STANDBY
            return [core.RejectControl(0)]
        if isinstance(message, core.Resume):
            self._state = READY
        elif isinstance(message, core.Standby):
            self._state = STANDBY
        return []

    def _create(self, message: core.CreateEvent, source: JausAddress) -> list:
        if not self.take(message.query_message, source):
            return [core.RejectEventRequest(message.request_id, 5)]
        number = next(each for each in range(255) if each not in self._events)
        for known, (client, query, *_) in self._events.items():
            if not self.doubles_events and (client, query) == (source, message.query_message):
                number = known
        rate = message.requested_periodic_rate or 2.0
        due = time.monotonic() + 1 / rate
        self._events[number] = [source, message.query_message, 1 / rate, due, 0]
        return [core.ConfirmEventRequest(message.request_id, number, rate)]

    def _services(self, query: core.QueryServices) -> core.ReportServices:
        kind = core.ReportServices
        own = self.address
        for node in query.node_list:
            for component in node.component_list:
                if (node.node_rec.node_id, component.component_id) == (own.node, own.component):
                    records = [kind.ServiceRec(urn, 1, 0) for urn in SERVICES]
                    parts = [kind.ComponentSeq(kind.ComponentRec(own.component, 0), records)]
                    return kind([kind.NodeSeq(kind.NodeRec(own.node), parts)])
        return kind(node_list=[])


class JausPlusPlus:
    """A component on JAUS++: sends and receives for a vehicle, on a thread.

    Attributes:
        obeyed_again: Packets that came again, and were obeyed again.
    """

    def __init__(self, vehicle: Vehicle, port: int, host: str = "127.0.0.2") -> None:
        """Listens on a port of a host, and to the multicast group on it."""
        self.obeyed_again = 0
        self._vehicle = vehicle
        self._book: dict[int, tuple[str, int]] = {}
        self._seen: set[tuple[int, int, bytes]] = set()
        self._number = 0
        self._unicast = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._unicast.bind((host, port))
        self._group = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._group.bind(("239.255.0.1", port))
        member = socket.inet_aton("239.255.0.1") + socket.inet_aton("127.0.0.1")
        self._group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the component."""
        self._running = False
        self._thread.join(10)
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
        place = JausAddress(destination >> 16, destination >> 8 & 0xFF, destination & 0xFF)
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
        client = JausAddress(source >> 16, source >> 8 & 0xFF, source & 0xFF)
        self._send(self._vehicle.take(payload, client))

    def _send(self, told: Told) -> None:
        for client, payload in told:
            self._number = self._number + 1 & 0xFFFF
            own = self._vehicle.address.packed
            head = _HEADER.pack(0, _SMALLEST + len(payload), 0, client.packed, own)
            datagram = b"\2" + head + payload + struct.pack("<H", self._number)
            self._unicast.sendto(datagram, self._book[client.packed])


class JuniorVehicle(JuniorPeer):
    """A vehicle on Junior's API."""

    def __init__(self, vehicle: Vehicle, port: int) -> None:
        """Joins a node manager of a host of its own."""
        self._vehicle = vehicle
        super().__init__(vehicle.address, port)
        self._reporter = threading.Thread(target=self._report, daemon=True)
        self._reporter.start()

    def close(self) -> None:
        """Ends it."""
        self._running = False
        self._reporter.join(10)
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
