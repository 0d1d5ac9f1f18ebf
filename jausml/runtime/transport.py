"""JAUS over UDP (AS5669A, JUDP version 2)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

from .address_book import AddressBook
from .duplicates import DuplicateWindow
from .outbox import Outbox
from .packet import AckNak, DataFlags, Packet, Priority, parse_datagram
from .reassembly import Reassembly
from .sender import Sender
from .shared_port import SharedPort, forwarded_frame, present_frame, read_forwarded, read_present

if TYPE_CHECKING:
    import socket

    from .address import JausAddress
    from .counters import Counters
    from .loop import Loop, Timer
    from .settings import Endpoint, TransportSettings

_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_WAKE_UP = 32
_MESSAGE_CODE_SIZE = 2


class ReceivedMessage(NamedTuple):
    """One JAUS message as it arrived.

    Attributes:
        source: Component that sent it.
        destination: Component or wildcard that it was sent to.
        payload: Little-endian 16-bit message code and body.
        priority: Priority that the sender chose.
        sequence: Sequence number of its (first) packet.
    """

    source: JausAddress
    destination: JausAddress
    payload: bytes
    priority: Priority
    sequence: int


Receive = Callable[[ReceivedMessage], None]
"""Takes a message for one component; runs on the loop's thread and holds the loop's lock."""

OnResult = Callable[[bool], None]
"""Told whether a message went out; runs on the loop's thread and holds the loop's lock."""


class Transport(Protocol):
    """What components need to exchange messages; ``JudpTransport`` is the one over UDP."""

    @property
    def loop(self) -> Loop:
        """The loop on which messages are received."""

    @property
    def counters(self) -> Counters:
        """Where drops are counted."""

    def attach(self, address: JausAddress, receive: Receive) -> None:
        """Receive messages for a component of this process from now on."""

    def detach(self, address: JausAddress) -> None:
        """Stop to receive messages for a component; no effect when it is unknown."""

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: OnResult | None = None,
    ) -> None:
        """Send one message; callable from any thread, never blocks."""


class JudpTransport:
    """Components of this process on one JUDP port (AS5669A).

    Destinations with a wildcard go to the multicast group and to the matching components of this
    process, except the sender. A component of this process is reached without the network. An
    unknown destination is multicast with a request for acknowledgement, as Junior does; the
    acknowledgement teaches its endpoint. Whatever arrives and cannot be used is counted.
    """

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        """Prepare a transport; ``open`` puts it on the network.

        Args:
            settings: Interface, port, peers and time-outs.
            loop: Loop on which messages are received; its counters are used.
        """
        self.loop = loop
        self.counters: Counters = loop.counters
        self._settings = settings
        self._port = SharedPort(settings)
        self._book = AddressBook(settings.address_lifetime, self.counters)
        self._duplicates = DuplicateWindow(settings.duplicate_window, settings.duplicate_history)
        self._reassembly = Reassembly(
            settings.reassembly_timeout, settings.reassembly_limit, self.counters
        )
        self._sender = Sender(settings, loop, self._port, self._book)
        self._outbox = Outbox(settings, loop, self._sender.transmit, self._book.suspect)
        self._receivers: dict[JausAddress, Receive] = {}
        self._takeover: Timer | None = None
        self._expiry: Timer | None = None

    def open(self) -> None:
        """Open the sockets and begin to receive.

        Raises:
            OSError: The interface or the multicast group cannot be used.
        """
        self._book.configure(self._settings.address_book)
        with self.loop.lock:
            self._port.open()
            for sock in (self._port.multicast, self._port.unicast):
                self._watch(sock)
            self._share_port()

    def close(self) -> None:
        """Close the sockets; messages that wait for acknowledgement are reported as lost."""
        with self.loop.lock:
            for timer in (self._takeover, self._expiry):
                if timer is not None:
                    timer.cancel()
            self._takeover = self._expiry = None
            for sock in (self._port.multicast, self._port.unicast, self._port.former):
                if sock is not None:
                    self.loop.unregister(sock)
            self._sender.close()
            self._outbox.close()

    @property
    def endpoint(self) -> Endpoint | None:
        """Where this process sends from and is reached, while open."""
        unicast = self._port.unicast
        return None if unicast is None else unicast.getsockname()

    def attach(self, address: JausAddress, receive: Receive) -> None:
        """Receive messages for a component of this process from now on.

        Args:
            address: The component.
            receive: Takes each message, on the loop's thread.

        Raises:
            ValueError: The address is not one component, or is attached already.
        """
        if not address.is_concrete:
            raise ValueError(f"{address} does not name one component")
        with self.loop.lock:
            if address in self._receivers:
                raise ValueError(f"{address} is attached already")
            # Copied, not changed: send() reads it on other threads without a lock.
            self._receivers = {**self._receivers, address: receive}
            self._announce()

    def detach(self, address: JausAddress) -> None:
        """Stop to receive messages for a component; no effect when it is unknown."""
        with self.loop.lock:
            self._receivers = {
                known: receive for known, receive in self._receivers.items() if known != address
            }

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: OnResult | None = None,
    ) -> None:
        """Send one message; callable from any thread, sends on it, never blocks.

        Failures of the network are counted and reported to ``on_result``.

        Args:
            source: Component that sends, of this process.
            destination: Component, or a wildcard for several.
            payload: Little-endian 16-bit message code and body.
            priority: Priority of the message.
            acknowledge: Repeat until acknowledged; of several receivers one is enough.
            on_result: Told once whether the message was acknowledged or received in this
                process; without ``acknowledge``, whether it was put on the network.

        Raises:
            ValueError: The source is not one component or the payload has no message code.
        """
        if not source.is_concrete:
            raise ValueError(f"{source} does not name one component")
        if len(payload) < _MESSAGE_CODE_SIZE:
            raise ValueError("a payload begins with a message code of two bytes")
        payload = bytes(payload)
        refusal = self._sender.refusal(destination, len(payload))
        if refusal:
            self.counters.count(refusal, f"{len(payload)} bytes from {source} to {destination}")
            self._report(on_result, success=False)
            return
        if destination in self._receivers:
            number = self._sender.reserve(source, 1)
            self._send_here(Packet(destination, source, payload, number, priority), on_result)
            return
        wanted = AckNak.REQUESTED if acknowledge else AckNak.NONE
        packets = self._sender.packets(source, destination, payload, priority, wanted)
        if destination.is_wildcard and self._receivers_of(packets[0]):
            self._send_here(packets[0], on_result)
            on_result = None
        self._send_out(packets, on_result)

    def _send_here(self, packet: Packet, on_result: OnResult | None) -> None:
        """Deliver to components of this process, in the next round of the loop."""
        self.loop.call_soon(partial(self._arrive_here, packet, on_result))

    def _arrive_here(self, packet: Packet, on_result: OnResult | None) -> None:
        receivers = self._receivers_of(packet)
        self._deliver(packet, receivers)
        self._report(on_result, success=bool(receivers))

    def _send_out(self, packets: list[Packet], on_result: OnResult | None) -> None:
        if packets[0].acknowledge:
            self._outbox.send(packets, on_result)
            return
        sent = [self._sender.transmit(packet) for packet in packets]
        self._report(on_result, success=all(sent))

    def _report(self, on_result: OnResult | None, *, success: bool) -> None:
        if on_result is not None:
            self.loop.call_soon(partial(on_result, success))

    def _watch(self, sock: socket.socket | None) -> None:
        if sock is not None:
            self.loop.register(sock, partial(self._read, sock))

    def _read(self, sock: socket.socket) -> None:
        """Read what has arrived, but no more than lets timers stay punctual."""
        by_multicast = sock is self._port.multicast
        count = 0
        while count < _DATAGRAMS_PER_WAKE_UP:
            try:
                data, sender = sock.recvfrom(_LARGEST_DATAGRAM)
            except BlockingIOError:
                break
            except OSError as error:
                self.counters.count("judp.receive_failed", str(error))
                break
            count += 1
            self._on_datagram(data, sender, by_multicast=by_multicast)
        self.counters.add("judp.received", count)

    def _on_datagram(self, data: bytes, sender: Endpoint, *, by_multicast: bool = False) -> None:
        if sender in self._port.endpoints:
            return  # our own multicast
        if data[:1] == b"\0" and sender[0] == self._settings.interface:
            self._on_neighbour(data, sender)
            return
        for packet in parse_datagram(data, self.counters):
            self._on_packet(packet, sender, may_forward=not by_multicast)

    def _on_packet(self, packet: Packet, sender: Endpoint, *, may_forward: bool) -> None:
        source, now = packet.source, self.loop.now()
        if not source.is_concrete or source in self._receivers:
            name = "judp.own_source" if source.is_concrete else "judp.bad_source"
            self.counters.count(name, f"{source} at {sender}")
            return
        self._book.learn(source, sender, now)
        receivers = self._receivers_of(packet)
        if not receivers:
            self._on_stray(packet, sender, may_forward=may_forward)
        elif packet.acknowledge >= AckNak.NAK:
            self._on_acknowledgement(packet)
        elif len(packet.payload) < _MESSAGE_CODE_SIZE and packet.data_flags <= DataFlags.FIRST:
            self.counters.count("judp.no_message_code", f"{source} at {sender}")
        else:
            if packet.acknowledge:
                self._acknowledge(packet, receivers, sender)
            self._accept(packet, receivers, now)

    def _accept(
        self, packet: Packet, receivers: list[tuple[JausAddress, Receive]], now: float
    ) -> None:
        if self._duplicates.is_duplicate(packet.source, packet.sequence, now):
            self.counters.add("judp.duplicate")
            return
        if packet.data_flags:
            whole = self._reassembly.add(packet, now)
            self._plan_expiry()
            if whole is None:
                return
            packet = whole
        self._deliver(packet, receivers)

    def _deliver(self, packet: Packet, receivers: list[tuple[JausAddress, Receive]]) -> None:
        message = ReceivedMessage(
            packet.source, packet.destination, packet.payload, packet.priority, packet.sequence
        )
        for address, receive in receivers:
            try:
                receive(message)
            except Exception as error:  # one component must not silence the others
                self.counters.count("judp.receiver_failed", f"{address}: {error!r}", error=error)

    def _receivers_of(self, packet: Packet) -> list[tuple[JausAddress, Receive]]:
        """Return the components of this process that a packet is meant for."""
        destination, source = packet.destination, packet.source
        receive = self._receivers.get(destination)
        if receive is not None:
            return [(destination, receive)]
        if not destination.is_wildcard:
            return []
        return [
            (address, receive)
            for address, receive in self._receivers.items()
            if destination.matches(address) and address != source
        ]

    def _acknowledge(
        self, packet: Packet, receivers: list[tuple[JausAddress, Receive]], sender: Endpoint
    ) -> None:
        for address, _ in receivers:
            answer = Packet(packet.source, address, b"", packet.sequence, packet.priority)
            answer = answer._replace(acknowledge=AckNak.ACK)
            self._sender.put(answer.encode(), sender)

    def _on_acknowledgement(self, packet: Packet) -> None:
        if packet.acknowledge is AckNak.NAK:
            self.counters.add("judp.nak")  # nobody sends it; the repetition goes on
        elif not self._outbox.acknowledged(packet):
            self.counters.add("judp.unmatched_acknowledgement")

    def _plan_expiry(self) -> None:
        if self._reassembly.size and self._expiry is None:
            pause = self._settings.reassembly_timeout / 2
            self._expiry = self.loop.call_later(pause, self._expire_fragments)

    def _expire_fragments(self) -> None:
        self._expiry = None
        self._reassembly.expire(self.loop.now())
        self._plan_expiry()

    def _on_stray(self, packet: Packet, sender: Endpoint, *, may_forward: bool) -> None:
        """Pass a packet that is not for this process to a neighbour that shares the port."""
        endpoint = self._book.find(packet.destination)
        if (
            may_forward
            and endpoint is not None
            and endpoint[0] == self._settings.interface
            and self._port.is_owner
        ):
            self._sender.put(forwarded_frame(sender, packet.encode()), endpoint)
            self.counters.add("judp.forwarded")
        else:
            self.counters.add("judp.not_for_us")

    def _on_neighbour(self, frame: bytes, sender: Endpoint) -> None:
        """Take a frame from another process of this host that shares the port."""
        forwarded = read_forwarded(frame) if sender == self._port.well_known else None
        present = read_present(frame)
        if forwarded is not None:
            origin, datagram = forwarded
            for packet in parse_datagram(datagram, self.counters):
                self._on_packet(packet, origin, may_forward=False)
        elif present is not None:
            for address in present:
                if address.is_concrete and address not in self._receivers:
                    self._book.learn(address, sender, self.loop.now())
        else:
            self.counters.count("judp.bad_version", f"{frame[:32].hex()} from {sender}")

    def _share_port(self) -> None:
        """Try to own the port; until then tell its owner again and again who lives here."""
        self._takeover = None
        if not self._port.is_owner and self._port.take_over():
            self._watch(self._port.unicast)
            self.counters.add("judp.port_taken_over")
        if not self._port.is_owner:
            self._announce()
            self._takeover = self.loop.call_later(
                self._settings.takeover_interval, self._share_port
            )

    def _announce(self) -> None:
        if self._receivers and self._port.unicast is not None and not self._port.is_owner:
            self._sender.put(present_frame(self._receivers), self._port.well_known)
