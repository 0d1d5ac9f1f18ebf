"""A vehicle above the transports of other makes, and the network endpoints of a peer."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.wire.message import DecodeError, Message

CORE = ("Transport", "Events", "AccessControl", "Management", "Discovery")
SERVICES = (
    *(f"urn:jaus:jss:core:{name}" for name in CORE),
    "urn:jaus:jss:mobility:PrimitiveDriver",
    "urn:jaus:jss:mobility:VelocityStateSensor",
)
READY, STANDBY = 1, 2
COMPONENT, VEHICLE = 4, 10001
_INPUTS = {
    message_class.CODE: message_class
    for message_class in (
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


@dataclass(frozen=True)
class Place:
    """The endpoints of a peer: on a loopback address of its own, or an interface of this host.

    Attributes:
        multicast_group: The group of JUDP.
    """

    interface: str = "127.0.0.2"
    port: int = 3794
    multicast_group: str = "239.255.0.1"

    @property
    def endpoint(self) -> tuple[str, int]:
        """The endpoint of unicast messages."""
        return self.interface, self.port

    @property
    def group(self) -> tuple[str, int]:
        """The endpoint of multicast messages."""
        return self.multicast_group, self.port

    def sockets(self, buffer: int) -> tuple[socket.socket, socket.socket]:
        """Opens non-blocking sockets for unicast and multicast (`buffer`: bytes of each)."""
        own, group = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        # Multicast on loopback uses 127.0.0.1 only.
        is_loopback = self.interface.startswith("127.")
        by = socket.inet_aton("127.0.0.1" if is_loopback else self.interface)
        try:
            for udp_socket in (own, group):
                udp_socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
                udp_socket.settimeout(0)
            own.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, by)
            own.bind(self.endpoint)
            group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            group.bind(self.group)
            member = socket.inet_aton(self.multicast_group) + by
            group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        except OSError:
            own.close()
            group.close()
            raise
        return own, group


@dataclass
class _Event:
    """An event that a client has created (`period`, `due`: seconds)."""

    client: JausAddress
    query: bytes
    period: float
    due: float
    sequence: int = 0


class Vehicle:
    """A vehicle that obeys one controller, and sends events at the requested rate.

    Attributes:
        dies_of_updates: Whether UpdateEvent stops it for ever.
        doubles_events: Whether each CreateEvent makes another event, also for the same query.
    """

    def __init__(
        self,
        address: JausAddress,
        report: Callable[[int], bytes | None],
        obey: Callable[[bytes, JausAddress], None],
        *,
        dies_of_updates: bool = False,
        doubles_events: bool = False,
    ) -> None:
        self.address = address
        self.dies_of_updates, self.doubles_events = dies_of_updates, doubles_events
        self.is_dead = False
        self._report, self._obey = report, obey
        self._state = STANDBY
        self._controller: JausAddress | None = None
        self._events: dict[int, _Event] = {}

    def take(self, payload: bytes, source: JausAddress) -> list[tuple[JausAddress, bytes]]:
        """Takes a message; returns answers with their receivers."""
        if len(payload) < 2 or self.is_dead:
            return []
        (code,) = struct.unpack_from("<H", payload)
        report = self._report(code)
        if report is not None:
            return [(source, report)]
        kind = _INPUTS.get(code)
        if kind is not None:
            try:
                message = kind.decode(payload)
            except DecodeError:
                return []
            return [(source, answer.encode()) for answer in self._answers(message, source)]
        if source == self._controller and self._state == READY:
            self._obey(payload, source)
        return []

    def due(self) -> list[tuple[JausAddress, bytes]]:
        """Returns the events that are due, with their receivers."""
        now, reports = time.monotonic(), []
        for number, event in tuple(self._events.items()):  # as another thread adds events
            if now >= event.due and not self.is_dead:
                ((_, report),) = self.take(event.query, event.client)
                reports.append((event.client, core.Event(number, event.sequence, report).encode()))
                event.due = max(event.due + event.period, now)
                event.sequence = event.sequence + 1 & 0xFF
        return reports

    def _answers(  # noqa: C901 - a branch for each message
        self, message: Message, source: JausAddress
    ) -> Sequence[Message]:
        match message:
            case core.QueryStatus():
                return [core.ReportStatus(self._state)]
            case core.QueryTimeout():
                return [core.ReportTimeout(5)]
            case core.QueryEventTimeout():
                return [core.ReportEventTimeout(1)]
            case core.QueryIdentification() if message.query_type == COMPONENT:
                return [core.ReportIdentification(COMPONENT, VEHICLE, "vehicle")]
            case core.QueryServices():
                return [self._services(message)]
            case core.CreateEvent():
                return self._create(message, source)
            case core.CancelEvent():
                self._events.pop(message.event_id, None)
            case core.UpdateEvent():
                self.is_dead = self.dies_of_updates
            case core.QueryControl():
                by = self._controller
                parts = (by.subsystem, by.node, by.component) if by else (0, 0, 0)
                return [core.ReportControl(*parts, 127)]
            case core.RequestControl() if self._controller not in (None, source):
                return [core.ConfirmControl(1)]
            case core.RequestControl():
                self._controller = source
                return [core.ConfirmControl(0)]
            case core.ReleaseControl() if source == self._controller:
                self._controller, self._state = None, STANDBY
                return [core.RejectControl(0)]
            case core.Resume() | core.Standby() if source == self._controller:
                self._state = READY if isinstance(message, core.Resume) else STANDBY
        return []

    def _create(self, message: core.CreateEvent, source: JausAddress) -> Sequence[Message]:
        query = message.query_message
        # A command would be obeyed, and again for each report.
        if not (0x20 <= query[1] < 0x40 and self.take(query, source)):
            return [core.RejectEventRequest(message.request_id, 5)]
        number = next((index for index in range(255) if index not in self._events), None)
        if number is None:
            return [core.RejectEventRequest(message.request_id, 3)]
        asked = (source, query)
        for known, event in self._events.items():
            if not self.doubles_events and (event.client, event.query) == asked:
                number = known
        rate = message.requested_periodic_rate or 2.0
        due = time.monotonic() + 1 / rate
        self._events[number] = _Event(*asked, 1 / rate, due)
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
