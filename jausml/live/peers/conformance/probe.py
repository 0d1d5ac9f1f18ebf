"""Exchange with one target: finding it, sending to it, sorting what it sends."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable
from datetime import datetime, timezone
from typing import NamedTuple

from jausml.live.peers.conformance.client import Client, ReceivedMessage
from jausml.live.peers.conformance.evidence import Trace
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.settings import Endpoint, TransportSettings
from jausml.runtime.transports.packets.packet import (
    AckNak,
    Broadcast,
    DataFlags,
    Packet,
    parse_datagram,
)
from jausml.runtime.transports.packets.reassembly import Reassembly
from jausml.runtime.transports.ports import SharedPort

_LARGEST_DATAGRAM = 65535
_NEIGHBOUR_FRAME = b"\0"

ATTEMPTS_TO_FIND = 3
_REASSEMBLY_TIMEOUT = 5.0
_REASSEMBLY_LIMIT = 1 << 24
_RECENT = 512


class ReceivedDatagram(NamedTuple):
    """One datagram as it arrived (`time`: monotonic time of its arrival in seconds)."""

    time: float
    sender: Endpoint
    data: bytes


class RawEndpoint:
    """The sockets of a tool on the JUDP port, without any protocol (AS5669A), and its clock.

    Takes the well-known port when it is free; otherwise another one, which peers learn from our
    datagrams. Nothing is acknowledged, repeated or put together here.
    """

    def __init__(self, settings: TransportSettings) -> None:
        """Opens the sockets; an OSError says that the interface or the group cannot be used."""
        self._port = SharedPort(settings)
        self._port.open()

    def close(self) -> None:
        """Closes the sockets."""
        self._port.close()

    @property
    def group(self) -> Endpoint:
        """The multicast group, which reaches whoever listens."""
        return self._port.group

    @property
    def well_known(self) -> Endpoint:
        """The JUDP port of our interface, where the first stack of this host is reached."""
        return self._port.well_known

    def now(self) -> float:
        """Returns monotonic seconds."""
        return time.monotonic()

    def utc(self) -> datetime:
        """Returns the time of day of this host."""
        return datetime.now(timezone.utc)

    def put(self, datagram: bytes, endpoint: Endpoint) -> None:
        """Sends one datagram."""
        if self._port.unicast is not None:
            self._port.unicast.sendto(datagram, endpoint)

    def receive(self, deadline: float) -> ReceivedDatagram | None:
        """Returns the next datagram of another process, or None at a monotonic time in seconds.

        What has arrived by then is still returned.
        """
        while True:
            wait = max(0.0, deadline - time.monotonic())
            readable, _, _ = select.select(self._sockets(), [], [], wait)
            for sock in readable:
                arrival = self._read(sock)
                if arrival is not None:
                    return arrival
            if not readable and time.monotonic() >= deadline:
                return None

    def _sockets(self) -> list[socket.socket]:
        both = (self._port.unicast, self._port.multicast)
        return [sock for sock in both if sock is not None]

    def _read(self, sock: socket.socket) -> ReceivedDatagram | None:
        try:
            data, sender = sock.recvfrom(_LARGEST_DATAGRAM)
        except OSError:
            return None  # an earlier datagram reached nobody; the kernel says so here
        if sender in self._port.endpoints or data[:1] == _NEIGHBOUR_FRAME:
            return None  # our own multicast, or what processes sharing the port tell its owner
        return ReceivedDatagram(time.monotonic(), sender, data)


def report_code(query_code: int) -> int:
    """Returns the code of the report that answers a query (AS5710: 2xxx and 4xxx)."""
    return query_code - 0x2000 + 0x4000


class Probe:
    """Several clients of ours and the one component that they test.

    Attributes:
        endpoint: Where it is; None until it was heard.
    """

    def __init__(
        self,
        wire: RawEndpoint,
        target: JausAddress,
        own: JausAddress,
        trace: Trace,
        *,
        timeout: float,
        quiet: float,
        known: Endpoint | None = None,
    ) -> None:
        """Prepares an exchange; nothing is sent.

        Args:
            quiet: Seconds of silence that stand for "nothing comes".
        """
        self.target = target
        self.endpoint = known
        self.timeout = timeout
        self.quiet = quiet
        self.malformed: list[str] = []
        self.others: set[JausAddress] = set()
        self._wire = wire
        self._trace = trace
        self._own = own
        self._known = known
        self._clients: dict[JausAddress, Client] = {}
        self._bystanders: list[tuple[Endpoint, Packet]] = []
        self._recent: list[tuple[JausAddress, JausAddress, int, bytes]] = []
        self._reassembly = Reassembly(_REASSEMBLY_TIMEOUT, _REASSEMBLY_LIMIT, Counters())

    def client(self, index: int) -> Client:
        """Returns one of our clients."""
        last = (self._own.component - 1 + index) % 254 + 1
        address = type(self._own)(self._own.subsystem, self._own.node, last)
        return self._clients.setdefault(address, Client(self, address))

    # ---- sending ----------------------------------------------------------------------------

    def put(self, packet: Packet, endpoint: Endpoint | None = None) -> None:
        """Sends a packet to the target, or to another place."""
        datagram = packet.encode()
        self._trace.packet("sent", packet, datagram)
        self._wire.put(datagram, endpoint or self._place)

    def put_raw(self, datagram: bytes, text: str) -> None:
        """Sends any bytes to the target."""
        self._trace.raw("sent", text, datagram)
        self._wire.put(datagram, self._place)

    def put_to_group(self, packet: Packet) -> None:
        """Sends a packet to everybody who listens to the multicast group."""
        self.put(packet._replace(broadcast=Broadcast.GLOBAL), self._wire.group)

    @property
    def _place(self) -> Endpoint:
        return self.endpoint or self._known or self._wire.well_known

    # ---- finding the target -----------------------------------------------------------------

    def find_target(self) -> bool:
        """Looks for the target and returns whether it was heard.

        Asks at the place that is known, at the JUDP port of this host and by multicast with the
        target's own id, as stacks do that do not know where a component is.
        """
        client = self.client(0)
        self.endpoint = None
        queries = (core.QueryIdentification(query_type=4), core.QueryControl(), core.QueryStatus())
        for _ in range(ATTEMPTS_TO_FIND):
            for query in queries:
                packet = client.packet(query.encode(), acknowledge=AckNak.REQUESTED)
                self.put(packet)
                if self._known is None:
                    self.put_to_group(packet)
            if self.wait(lambda: self.endpoint is not None, self.timeout):
                return True
        return False

    def servers(self, everyone: JausAddress) -> dict[JausAddress, Endpoint]:
        """Returns the Discovery servers that answer within the time of one query."""
        self._bystanders.clear()
        query = core.QueryIdentification(query_type=2).encode()
        self.put_to_group(self.client(0).packet(query, destination=everyone))
        self.wait(lambda: False, self.timeout)
        return {packet.source: sender for sender, packet in self._bystanders}

    def ask_bystander(self, server: JausAddress, endpoint: Endpoint, query: bytes) -> bytes | None:
        """Returns the payload with which another component answers, or None."""
        self._bystanders.clear()
        code = report_code(int.from_bytes(query[:2], "little"))
        self.put(self.client(0).packet(query, destination=server), endpoint)

        def answers() -> list[bytes]:
            payloads = [packet.payload for _, packet in self._bystanders]
            return [
                payload for payload in payloads if int.from_bytes(payload[:2], "little") == code
            ]

        self.wait(lambda: bool(answers()), self.timeout)
        return answers()[0] if answers() else None

    # ---- receiving --------------------------------------------------------------------------

    def now(self) -> float:
        """Returns the time in seconds, as the wire counts it."""
        return self._wire.now()

    def utc(self) -> datetime:
        """Returns the time of day."""
        return self._wire.utc()

    def wait(self, done: Callable[[], bool], seconds: float) -> bool:
        """Receives until a condition holds, and returns whether it does in time."""
        deadline = self.now() + seconds
        while not done():
            arrival = self._wire.receive(deadline)
            if arrival is None:
                return done()
            self._take(arrival)
        return True

    def _take(self, arrival: ReceivedDatagram) -> None:
        counters = Counters()
        packets = parse_datagram(arrival.data, counters)
        faults = counters.drops()
        if faults and arrival.sender == self.endpoint:
            reason = ", ".join(faults)
            self.malformed.append(f"{reason}: {arrival.data[:64].hex()}")
            self._trace.raw("received", f"unreadable ({reason})", arrival.data)
        for packet in packets:
            if packet.source == self.target:
                self._from_target(arrival, packet)
                continue
            self.others.add(packet.source)
            if packet.destination in self._clients and packet.acknowledge < AckNak.NAK:
                payload = self._whole(arrival, packet)
                if payload is not None:
                    self._bystanders.append((arrival.sender, packet._replace(payload=payload)))

    def _from_target(self, arrival: ReceivedDatagram, packet: Packet) -> None:
        self.endpoint = arrival.sender
        client = self._clients.get(packet.destination)
        if client is None:
            return
        self._trace.packet("received", packet, arrival.data)
        if packet.acknowledge >= AckNak.NAK:
            client.acknowledgements.append(packet)
            return
        payload = self._whole(arrival, packet)
        if payload is not None:
            client.take(ReceivedMessage(arrival.time, packet, payload))

    def _whole(self, arrival: ReceivedDatagram, packet: Packet) -> bytes | None:
        """Returns the payload of a message that is complete now; acknowledges what asks for it."""
        if packet.acknowledge is AckNak.REQUESTED:
            self._acknowledge(packet, arrival.sender)
        if self._is_repetition(packet):
            return None
        if packet.data_flags is DataFlags.SINGLE:
            return packet.payload
        whole = self._reassembly.add(packet, arrival.time)
        return None if whole is None else whole.payload

    def _acknowledge(self, packet: Packet, endpoint: Endpoint) -> None:
        answer = Packet(
            packet.source,
            packet.destination,
            b"",
            packet.sequence,
            packet.priority,
            acknowledge=AckNak.ACK,
        )
        self.put(answer, endpoint)

    def _is_repetition(self, packet: Packet) -> bool:
        """Whether this packet came again since its source missed our acknowledgement."""
        if packet.acknowledge is not AckNak.REQUESTED:
            return False
        key = (packet.source, packet.destination, packet.sequence, packet.payload)
        if key in self._recent:
            return True
        self._recent = [*self._recent[-_RECENT:], key]
        return False
