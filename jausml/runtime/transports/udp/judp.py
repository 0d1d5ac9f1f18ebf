"""JAUS over UDP (AS5669A, JUDP version 2): the sockets of one process."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable
from functools import partial

from ...base.address import JausAddress
from ...base.clocks import Alarm
from ...base.counters import LOGGER, Counters
from ...base.loop import Loop
from ...base.quirks import Quirk
from ...base.settings import JUDP_PORT, Endpoint, TransportSettings
from ...base.standstill import Watch
from ..address_book import AllowedHosts
from ..delivery import Take
from ..packets.packet import (
    EMPTY_MESSAGE_SIZE,
    JUDP_VERSION,
    AckNak,
    Packet,
    Priority,
    parse_datagram,
)
from ..ports import (
    FRAME,
    SharedPort,
    forwarded_frame,
    manager_folder,
    present_frame,
    read_forwarded,
    read_present,
)
from .datagrams import DatagramTransport

# receives a datagram up to a size, and its origin
Receiver = Callable[[int], tuple[bytes, Endpoint]]

# An option of Linux that is not in the socket module: the last of its nine numbers (SK_MEMINFO)
# counts dropped datagrams.
_SO_MEMINFO = 55
_MEMINFO = struct.Struct("9I")
_DROPS = 8


class KernelDrops:
    """Counts datagrams that the kernel has dropped, as ``judp.kernel_dropped`` (Linux).

    The kernel is queried periodically: the number with each datagram would cost 5 us.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._totals: dict[socket.socket, int] = {}

    def watch(self, sock: socket.socket) -> None:
        """Counts the drops of a socket from now on."""
        self._totals.setdefault(sock, 0)

    def update(self) -> None:
        """Counts the drops since the last call; sockets without the option are ignored."""
        for sock, former in list(self._totals.items()):
            try:
                memory_info = sock.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, _MEMINFO.size)
                self._totals[sock] = total = _MEMINFO.unpack(memory_info)[_DROPS]
            except (OSError, struct.error):
                del self._totals[sock]
                continue
            # The counter of the kernel has 32 bits.
            amount = total - former & 0xFFFFFFFF
            if amount:
                self._counters.count(
                    "judp.kernel_dropped",
                    f"{amount} datagrams; the receive buffer was full: this process stood "
                    "still or too much comes at once; the kernel allows no larger buffer "
                    "than net.core.rmem_max",
                    amount=amount,
                )


_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_TURN = 32
_PAUSE_S = 0.0002  # after which a datagram has likely come alone


def reader(
    receive: Receiver, loop: Loop, take: Callable[[bytes, Endpoint], None]
) -> Callable[[], None]:
    """Returns a function that reads waiting datagrams, a limited number at once."""
    counters = loop.counters
    received = counters.tally("judp.received")
    most, latest = 1, loop.now()

    def read() -> None:
        nonlocal most, latest
        now = loop.now()
        if now - latest > _PAUSE_S:
            # One datagram after a pause, and more only while others follow: a call that finds none
            # costs 30 us, more than a datagram.
            most = 1
            # Datagrams that waited while the process stood still are discarded.
            if now > loop.standstill.due:
                loop.standstill.end()
        latest = now
        for _ in range(most):
            try:
                data, origin = receive(_LARGEST_DATAGRAM)
            except BlockingIOError:
                most = 1
                return
            except OSError as error:
                counters.count("judp.receive_failed", str(error))
                return
            received.count += 1
            take(data, origin)
        # Limited, so that other callbacks have their turn.
        most = min(2 * most, _DATAGRAMS_PER_TURN)

    return read


_MANAGER_INTERVAL_S = 5.0
_CHECK_INTERVAL_S = 1.0


class JudpTransport(DatagramTransport):
    """Components of this process on one JUDP port (AS5669A)."""

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        self._port = SharedPort(settings)
        super().__init__(settings, loop, self._port)
        self._allowed = AllowedHosts(settings, self.counters)
        self._drops = KernelDrops(self.counters)
        self._receive_by: Callable[[socket.socket, bool], Receiver] | None = None
        self._standstill_watch: Watch | None = None
        self._takeover_alarm = Alarm(loop)
        self._check_alarm = Alarm(loop)
        self._manager_alarm = Alarm(loop)

    def open(self) -> None:
        """Opens the sockets and begins to receive."""
        self.address_book.configure(self._settings.address_book)
        with self.loop.lock:
            self._port.open()
            for sock in (self._port.multicast, self._port.unicast):
                self._listen_at(sock)
            self._share_port()
            self._check_manager()
            self._check_sockets()
            self._standstill_watch = self.loop.standstill.watch(
                self._settings.standstill, self._discard_waiting
            )

    def close(self) -> None:
        """Closes the sockets; messages that wait for acknowledgement are reported as lost."""
        with self.loop.lock:
            for timer in (self._takeover_alarm, self._manager_alarm, self._check_alarm):
                timer.cancel()
            if self._standstill_watch is not None:
                self._standstill_watch.cancel()
            self._drops.update()  # before the sockets are closed
            for sock in self._port.sockets:
                self.loop.unregister(sock)
            self._sender.close()
            self._messenger.close()

    @property
    def own_endpoints(self) -> frozenset[Endpoint]:
        """The endpoints of this process, from which its own multicasts come."""
        return self._port.endpoints

    @property
    def endpoint(self) -> Endpoint | None:
        """The endpoint of this process; None while the transport is not open."""
        unicast = self._port.unicast
        return None if unicast is None else unicast.getsockname()

    def datagram(
        self, source: JausAddress, destination: JausAddress, payload: bytes, priority: Priority
    ) -> tuple[bytes, Endpoint] | None:
        """Returns a datagram for another process to send; see ``Transport.datagram``."""
        with self.loop.lock:
            endpoint = self.address_book.find(destination)
        # A message of several packets has several datagrams.
        if endpoint is None or len(payload) > self._settings.fragment_size:
            return None
        packet = Packet(destination, source, payload, priority=priority)
        return packet._replace(acknowledge=AckNak.REQUESTED).encode(), endpoint

    def next_number(self, source: JausAddress, destination: JausAddress) -> int:
        """Returns the number of the next packet; see ``Transport.next_number``."""
        return self._messenger.packetizer.next_number(source, destination)

    def _attach(self, address: JausAddress, take: Take) -> None:
        super()._attach(address, take)
        self._announce()

    def _listen_at(self, sock: socket.socket | None) -> None:
        if sock is not None:
            self.loop.register(sock, self._reader(sock, by_multicast=sock is self._port.multicast))

    def receive_by(self, make: Callable[[socket.socket, bool], Receiver] | None) -> None:
        """Sets how datagrams are received; None restores the sockets.

        Args:
            make: Returns the receiver for a socket; its second argument is whether the socket is
                that of the multicast group.
        """
        with self.loop.lock:
            self._receive_by = make
            for sock in self._port.sockets:
                self.loop.unregister(sock)
                self._listen_at(sock)

    def _reader(self, sock: socket.socket, *, by_multicast: bool) -> Callable[[], None]:
        take = partial(self.receive_datagram, by_multicast=by_multicast)
        self._drops.watch(sock)
        by_core = self._receive_by
        receive = sock.recvfrom if by_core is None else by_core(sock, by_multicast)
        return reader(receive, self.loop, take)

    def receive_datagram(
        self, data: bytes, sender: Endpoint, *, by_multicast: bool = False
    ) -> None:
        """Takes a datagram, with the lock of the loop; never raises."""
        if sender in self._port.endpoints:
            self.counters.add("judp.own_multicast")
            return
        if not self._allowed.admits(sender):
            return
        # Frames are only exchanged between processes of this host.
        if data.startswith(FRAME) and sender[0] == self._settings.interface:
            self._on_neighbour(data, sender)
            return
        for packet in parse_datagram(data, self.counters):
            if data[0] != JUDP_VERSION:
                self._note_version(packet, data)
            # Multicasts have reached the other processes of this host, too.
            self._on_packet(packet, sender, may_forward=not by_multicast)

    def _note_version(self, packet: Packet, data: bytes) -> None:
        """Learns the quirk of a known peer whose acknowledgement has no or another version."""
        if packet.source in self.address_book.learnt:
            how = f"version {data[0]}" if len(data) > EMPTY_MESSAGE_SIZE else "no version"
            self.quirks.learn(packet.source, Quirk.OTHER_VERSION, how)

    def _on_packet(self, packet: Packet, sender: Endpoint, *, may_forward: bool) -> None:
        if not self._take_packet(packet, sender):
            self._on_stray(packet, sender, may_forward=may_forward)

    def _on_stray(self, packet: Packet, sender: Endpoint, *, may_forward: bool) -> None:
        """Forwards a packet to another process of this host that shares the port, or drops it."""
        endpoint = self.address_book.find(packet.destination)
        if (
            may_forward
            and endpoint is not None
            and endpoint[0] == self._settings.interface
            and self._port.is_owner
        ):
            self._sender.put(forwarded_frame(sender, packet.encode()), endpoint)
            self.counters.add("judp.forwarded")
        else:
            self.counters.add("transport.not_for_us")

    def _on_neighbour(self, frame: bytes, sender: Endpoint) -> None:
        """Takes a frame from another process of this host that shares the port."""
        # Only the owner of the port may forward, as others could forge the origin.
        forwarded = read_forwarded(frame) if sender == self._port.well_known else None
        present = read_present(frame)
        if forwarded is not None:
            origin, datagram = forwarded
            if not self._allowed.admits(origin):
                return
            for packet in parse_datagram(datagram, self.counters):
                # Forwarded once, so that no packet circles between two processes.
                self._on_packet(packet, origin, may_forward=False)
        elif present is not None:
            self.counters.add("judp.present")
            for address in present:
                if address.is_concrete and address not in self.inbox.receivers:
                    self.address_book.learn(address, sender, self.loop.now())
        else:
            self.counters.count("judp.bad_version", f"{frame[:32].hex()} from {sender}")

    def _share_port(self) -> None:
        """Takes over the port, or announces the components of this process to its owner."""
        if not self._port.is_owner and self._port.take_over():
            # The compiled core relies on the socket and on the own endpoints, which have changed.
            self.loop.revision.changed()
            self._listen_at(self._port.unicast)
            self.counters.add("judp.port_taken_over")
        if not self._port.is_owner:
            self._announce()
            self._takeover_alarm.set(self._settings.takeover_interval, self._share_port)

    def _check_manager(self) -> None:
        """Warns once of a node manager that cannot have the standard port of this process.

        Junior's node manager runs without a network then.
        """
        if self._settings.port != JUDP_PORT:
            return
        folder = manager_folder(self._settings) if self._port.is_owner else None
        if folder is None:
            self._manager_alarm.set(_MANAGER_INTERVAL_S, self._check_manager)
            return
        LOGGER.warning(
            "a node manager runs on this host (its socket is in %s), but this process owns UDP "
            "port %d, so that the manager reaches nobody; start it first, and this process with "
            "--jaus-transport node-manager",
            folder,
            JUDP_PORT,
        )

    def _check_sockets(self) -> None:
        """Counts what the kernel has dropped and rejoins the group, if needed, each second."""
        self._drops.update()
        if self._port.rejoin():
            LOGGER.warning("%s is back; multicasts were lost", self._settings.interface)
            self.counters.add("judp.rejoined")
        self._check_alarm.set(_CHECK_INTERVAL_S, self._check_sockets)

    def _discard_waiting(self, still: float) -> None:
        """Discards datagrams that waited while the process stood still for `still` seconds.

        They may be old commands, and not all components have a time-out. Messages with a request
        for acknowledgement are repeated.
        """
        count = self._port.empty()
        if count:
            self.counters.count(
                "judp.too_old",
                f"{count} datagrams waited while this process stood still for {still:.1f} s",
                amount=count,
            )

    def _announce(self) -> None:
        if self.inbox.receivers and self._port.unicast is not None and not self._port.is_owner:
            self._sender.put(present_frame(self.inbox.receivers), self._port.well_known)
