"""JAUS over TCP (AS5669A, JTCP)."""

from __future__ import annotations

import errno
import math
import socket
from collections import Counter, OrderedDict, deque
from functools import partial

from ..base.address import BROADCAST, JausAddress
from ..base.budgets import Held, who_gives_way
from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..base.loop import Loop
from ..base.settings import Endpoint, TransportKind, TransportSettings
from .address_book import SOURCE_REFUSED, AllowedHosts, resolve
from .delivery import OnResult, ReliableCarrier, Take, report
from .packets.duplicates import DuplicateWindow
from .packets.messenger import Messenger
from .packets.packet import AckNak, Packet
from .ports import advice
from .tcp_connection import TcpConnection, affordable, connect, listen, octets_of
from .transport import Transport

_ACCEPTS_PER_WAKE_UP = 16
_FIRST_PAUSE_S = 0.1
_LONGEST_PAUSE_S = 5.0
_ACCEPT_PAUSE_S = 0.5  # seconds without accepting connections after an error of the system


class _Line:
    """An outgoing connection, and the growing pause before it is tried again."""

    def __init__(self, endpoint: Endpoint, loop: Loop) -> None:
        self.endpoint = endpoint
        self.connection: TcpConnection | None = None
        self.pause = _FIRST_PAUSE_S
        self.retry = Alarm(loop)


class JtcpTransport(Transport, ReliableCarrier[TcpConnection]):
    """Components of this process on JTCP connections (AS5669A).

    A message goes over the connection of the last packet of its destination, or over one that is
    made on demand to the endpoint in the address book. There is no multicast: a message to a
    wildcard goes to every peer that is connected or in the address book. As TCP repeats lost
    packets, messages are sent without a request for acknowledgement, and count as acknowledged
    when the system has sent them; requests of peers are acknowledged.

    One process of a host owns the port. The others connect to it, and it relays their messages.
    When it ends, another one takes over.
    """

    KIND = TransportKind.JTCP

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        super().__init__(settings, loop)
        self._well_known: Endpoint = (settings.interface, settings.port)
        self._messenger: Messenger[TcpConnection] = Messenger(settings, loop, self, self.quirks)
        self._inbox = self._messenger.inbox
        # Apart from those of the inbox, which are for this process.
        self._relayed = DuplicateWindow(settings.duplicate_window, settings.duplicate_history)
        self._allowed = AllowedHosts(settings, self.counters)
        self._book: dict[JausAddress, Endpoint] = {}
        self._routes: OrderedDict[JausAddress, TcpConnection] = OrderedDict()
        self._kept: dict[JausAddress, JausAddress | None] = {}
        self._lines: dict[Endpoint, _Line] = {}
        self._connections: list[TcpConnection] = []
        self._unsent: deque[tuple[list[Packet], OnResult | None]] = deque()
        self._max_connections = settings.max_connections
        self._listener: socket.socket | None = None
        self._accept_alarm = Alarm(loop)
        self._takeover_alarm = Alarm(loop)
        self._is_open = False

    def open(self) -> None:
        """Listens on the port, or connects to the process of this host that owns it."""
        self._book = resolve(self._settings.address_book, self.counters)
        with self.loop.lock:
            self._is_open = True
            self._max_connections = affordable(self._settings.max_connections)
            self._share_port()

    def close(self) -> None:
        """Closes the connections; messages that wait are reported as lost."""
        with self.loop.lock:
            # Before the connections close.
            self._send_unsent()
            self._is_open = False
            for timer in (
                self._takeover_alarm,
                self._accept_alarm,
                *(line.retry for line in self._lines.values()),
            ):
                timer.cancel()
            if self._listener is not None:
                self.loop.unregister(self._listener)
                self._listener.close()
                self._listener = None
            # A copy, as each connection removes itself when it closes.
            for connection in list(self._connections):
                connection.close()
            self._lines.clear()
            self._messenger.close()

    @property
    def endpoint(self) -> Endpoint | None:
        """The endpoint at which this process listens; None if it does not own the port."""
        return None if self._listener is None else self._listener.getsockname()

    def _attach(self, address: JausAddress, take: Take) -> None:
        self._inbox.attach(address, take)
        line = self._lines.get(self._well_known)
        if line is not None and line.connection is not None:
            self._announce(line.connection)

    def _messenger_of(self, source: JausAddress) -> Messenger[TcpConnection]:
        del source  # one messenger for all components
        return self._messenger

    # ---- sending ----------------------------------------------------------------------------

    def transmit_all(self, packets: list[Packet], on_result: OnResult | None) -> None:
        """Sends packets on the thread of the loop, which alone uses the connections."""
        self._unsent.append((packets, on_result))
        self.loop.call_soon(self._send_unsent)

    def _send_unsent(self) -> None:
        while self._unsent:
            self._send_now(*self._unsent.popleft())

    def _send_now(self, packets: list[Packet], on_result: OnResult | None) -> None:
        destination = packets[0].destination
        data = b"".join([octets_of(packet) for packet in packets])
        if destination.is_wildcard:
            sent = [connection.write(data) for connection in self._all_connections()]
            report(self.loop, on_result, success=any(sent))
            if not sent:
                self.counters.add("jtcp.nobody_connected")
            return
        route = self._connection_to(destination)
        if route is not None:
            route.write(data, on_result)
            return
        self.counters.count("jtcp.not_connected", f"no connection to {destination}")
        report(self.loop, on_result, success=False)

    def answer(self, packet: Packet, origin: TcpConnection) -> None:
        """Sends a packet over the connection of another one."""
        origin.write(octets_of(packet))

    def _connection_to(self, destination: JausAddress) -> TcpConnection | None:
        """Returns the connection to a component, which may not be up yet; None without one."""
        connection = self._routes.get(destination)
        if connection is None and destination in self._book:
            connection = self._connect(self._book[destination])
        # The owner of the port may have a connection, and relays.
        if connection is None and self._well_known in self._lines:
            connection = self._lines[self._well_known].connection
        return connection

    def _all_connections(self) -> list[TcpConnection]:
        for endpoint in self._book.values():
            self._connect(endpoint)
        return list(self._connections)

    # ---- connections ------------------------------------------------------------------------

    def _connect(self, endpoint: Endpoint) -> TcpConnection | None:
        """Returns the connection to an endpoint, made on demand; None while it is down."""
        # The address book may contain this process itself.
        if not self._is_open or endpoint == self.endpoint:
            return None
        line = self._lines.get(endpoint)
        if line is None:
            line = self._lines[endpoint] = _Line(endpoint, self.loop)
            self._dial(line)
        return line.connection

    def _dial(self, line: _Line) -> None:
        try:
            sock = connect(line.endpoint)
        except OSError as error:
            self.counters.count("jtcp.connect_failed", f"{line.endpoint}: {error}")
            self._plan_retry(line)
            return
        line.connection = self._adopt(sock, line.endpoint, connecting=True)
        if line.endpoint == self._well_known:
            self._announce(line.connection)

    def _plan_retry(self, line: _Line) -> None:
        line.retry.set(line.pause, partial(self._dial, line))
        line.pause = min(line.pause * 2, _LONGEST_PAUSE_S)

    def _accept(self) -> None:
        for _ in range(_ACCEPTS_PER_WAKE_UP):
            if self._listener is None:
                return
            try:
                sock, peer = self._listener.accept()
            except BlockingIOError:
                return
            except OSError as error:
                self.counters.count("jtcp.accept_failed", str(error))
                self._pause_listening()
                return
            if not self._allowed.admits(peer):
                sock.close()
            elif not self._has_room_for(peer):
                self.counters.count("jtcp.too_many_connections", f"refused {peer[0]}:{peer[1]}")
                sock.close()
            else:
                self._adopt(sock, peer, connecting=False)

    def _pause_listening(self) -> None:
        """Accepts no connections for a while: waiting ones would make the loop spin."""
        if self._listener is not None:
            self.loop.unregister(self._listener)
            self._accept_alarm.set(_ACCEPT_PAUSE_S, self._resume_listening)

    def _resume_listening(self) -> None:
        if self._listener is not None:
            self.loop.register(self._listener, self._accept)

    def _has_room_for(self, peer: Endpoint) -> bool:
        """Returns whether there is room for a connection; may close another one for it.

        Connections without any packet are closed first. Outgoing ones, and those of components that
        are always kept, are not closed.
        """
        if len(self._connections) < self._max_connections:
            return True
        kept = {id(route) for address, route in self._routes.items() if self.is_kept(address)}
        kept |= {id(line.connection) for line in self._lines.values()}
        configured = {host for host, _ in self._book.values()}
        held = [
            Held(
                connection,
                (*_place(connection.peer), connection.peer),
                connection.has_spoken,
                id(connection) in kept,
            )
            for connection in self._connections
        ]
        # A host in the address book is always accepted.
        asker: Held[object] = Held(None, (*_place(peer), peer), is_kept=peer[0] in configured)
        loser = who_gives_way(held, asker)
        if loser is None:
            return False
        self.counters.count("jtcp.gave_way", f"{loser} to {peer[0]}:{peer[1]}")
        loser.close()
        return True

    def _adopt(self, sock: socket.socket, peer: Endpoint, *, connecting: bool) -> TcpConnection:
        connection = TcpConnection(
            sock,
            peer,
            self.loop,
            connecting=connecting,
            buffer=self._settings.send_buffer,
            timeout=self._settings.connection_timeout,
            # An incoming connection without packets is closed; an outgoing one is not.
            idle=0.0 if connecting else self._settings.idle_timeout,
            on_packet=self._on_packet,
            on_close=self._on_close,
        )
        self._connections.append(connection)
        return connection

    def _on_close(self, connection: TcpConnection) -> None:
        self._connections.remove(connection)
        for address in [known for known, route in self._routes.items() if route is connection]:
            del self._routes[address]
        line = self._lines.get(connection.peer)
        if line is not None and line.connection is connection:
            line.connection = None
            # It was up, so the peer lives: pauses begin anew.
            if connection.is_connected:
                line.pause = _FIRST_PAUSE_S
            if self._is_open:
                self._plan_retry(line)

    # ---- receiving --------------------------------------------------------------------------

    def _on_packet(self, packet: Packet, connection: TcpConnection) -> None:
        if self._inbox.refuses(packet, connection):
            return
        if not self._learn(packet, connection):
            return
        # An announcement of a component of another process; see the deviation below.
        is_announced = packet.acknowledge is AckNak.ACK and not packet.payload
        if is_announced and packet.destination.is_wildcard:
            self.counters.add("jtcp.present")
            # Only processes of this host are relayed for.
            connection.is_neighbour = connection.peer[0] == self._settings.interface
            return
        is_relayed = self._relay(packet, connection)
        is_taken = self._inbox.take(packet, connection, self.loop.now())
        if not is_taken and not is_relayed:
            self.counters.add("transport.not_for_us")

    def _learn(self, packet: Packet, connection: TcpConnection) -> bool:
        """Learns the route to the sender of a packet; returns False if the packet is refused."""
        address = packet.source
        former = self._routes.get(address)
        if self._settings.fixed_sources and former not in (None, connection):
            reason = f"it is heard from {former}"
            self.counters.count(SOURCE_REFUSED, f"{address} at {connection}: {reason}")
            return False
        # A broadcast may come over several connections, none of which is better than the known one.
        if former is connection or (former is not None and packet.destination.is_wildcard):
            self._routes.move_to_end(address)
            return True
        if former is not None:
            self.counters.count(
                "transport.address_changed", f"{address} from {former} to {connection}"
            )
        elif len(self._routes) >= self._settings.max_peers:
            self._forget_route()
        self._routes[address] = connection
        self._routes.move_to_end(address)
        return True

    def _forget_route(self) -> None:
        """Forgets the longest silent component of the connection with most components."""
        addresses = [address for address in self._routes if not self.is_kept(address)]
        sizes = Counter(id(self._routes[address]) for address in addresses)
        if len(addresses) < self._settings.max_peers:
            return
        largest = max(sizes, key=lambda size: sizes[size])
        forgotten = next(known for known in addresses if id(self._routes[known]) == largest)
        del self._routes[forgotten]
        self.counters.count("transport.address_book_full", f"forgot {forgotten}")

    # ---- strangers --------------------------------------------------------------------------

    def place_of(self, address: JausAddress) -> tuple[str, str]:
        """Returns host and endpoint of a component; see ``Transport.place_of``."""
        route = self._routes.get(address)
        return ("", "") if route is None else _place(route.peer)

    def is_kept(self, address: JausAddress) -> bool:
        """Returns whether a component is always kept; see ``Transport.is_kept``."""
        return address in self._book or address in self._kept.values()

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        """Keeps a controller; see ``Transport.keep_place``."""
        self._kept[owner] = address

    def silence_of(self, address: JausAddress) -> float:
        """Returns 0 seconds for a connected component, and infinity for another one."""
        return 0.0 if address in self._routes else math.inf

    # ---- several processes on one host ------------------------------------------------------

    # JAUS-DEVIATION: in AS5669A a port has one process. Here the owner of the port relays messages
    # between other processes of its host and their peers. These announce their components to the
    # owner by an acknowledgement to all components, which other stacks ignore.

    def _share_port(self) -> None:
        """Takes the port, or connects to its owner and tries again later."""
        try:
            self._listener = listen(self._well_known)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise OSError(
                    error.errno,
                    f"JTCP port {self._settings.port} of {self._settings.interface}: "
                    f"{error.strerror}",
                ) from error
            if self._well_known not in self._lines:
                LOGGER.info(
                    "TCP port %d is taken; this process connects to who has it: %s",
                    self._settings.port,
                    advice("tcp", self._settings),
                )
            self._connect(self._well_known)
            self._takeover_alarm.set(self._settings.takeover_interval, self._share_port)
            return
        self.loop.register(self._listener, self._accept)
        line = self._lines.pop(self._well_known, None)
        if line is not None:
            line.retry.cancel()
            self.counters.add("jtcp.port_taken_over")

    def _announce(self, connection: TcpConnection) -> None:
        for address in self._inbox.receivers:
            announcement = Packet(BROADCAST, address, acknowledge=AckNak.ACK)
            connection.write(octets_of(announcement))

    def _relay(self, packet: Packet, origin: TcpConnection) -> bool:
        """Relays a packet from or to another process of this host; returns whether it did."""
        if self._listener is None or packet.destination in self._inbox.receivers:
            return False
        route = self._routes.get(packet.destination)
        routes = self._connections if packet.destination.is_wildcard else [route] if route else []
        # Only from or to a process of this host, as it is no router between others.
        connections = [
            connection
            for connection in routes
            if connection is not origin and (connection.is_neighbour or origin.is_neighbour)
        ]
        # Owners with several connections must not relay a message in a circle for ever.
        if not connections or (
            # An acknowledgement has the number of its message, and is no duplicate of that.
            packet.acknowledge < AckNak.NAK and self._relayed.is_duplicate(packet, self.loop.now())
        ):
            return False
        data = octets_of(packet)
        for connection in connections:
            connection.write(data)
        self.counters.add("jtcp.relayed")
        return True


def _place(peer: Endpoint) -> tuple[str, str]:
    """Returns host and endpoint of a peer, for budgets."""
    return peer[0], f"{peer[0]}:{peer[1]}"
