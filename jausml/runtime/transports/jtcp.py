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
_REST_S = 0.5  # seconds without looking for connections, when the system could give none


class _Line:
    """A connection to an endpoint, made again and again, more and more seldom."""

    def __init__(self, endpoint: Endpoint, loop: Loop) -> None:
        self.endpoint = endpoint
        self.connection: TcpConnection | None = None
        self.pause = _FIRST_PAUSE_S
        self.retry = Alarm(loop)


class JtcpTransport(Transport, ReliableCarrier[TcpConnection]):
    """Components of this process on JTCP connections (AS5669A).

    A message goes over the connection from which its destination was heard last, or over one
    that is made on demand to the endpoint in the address book. There is no multicast: a wildcard
    destination goes to every peer that is connected or in the address book. TCP itself repeats
    what gets lost, so that messages are sent without a request for acknowledgement, and a
    message counts as acknowledged when the system sent it; requests of peers are answered.

    One process of a host owns the port. The others connect to it, and it passes on what is not
    for itself. Another one takes over when it ends.
    """

    KIND = TransportKind.JTCP

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        super().__init__(settings, loop)
        self._well_known: Endpoint = (settings.interface, settings.port)
        self._messenger: Messenger[TcpConnection] = Messenger(settings, loop, self, self.quirks)
        self._inbox = self._messenger.inbox
        # Apart from the inbox, as what is passed on is not for this process.
        self._relayed = DuplicateWindow(settings.duplicate_window, settings.duplicate_history)
        self._allowed = AllowedHosts(settings, self.counters)
        self._book: dict[JausAddress, Endpoint] = {}
        self._routes: OrderedDict[JausAddress, TcpConnection] = OrderedDict()
        self._kept: dict[JausAddress, JausAddress | None] = {}
        self._lines: dict[Endpoint, _Line] = {}
        self._connections: list[TcpConnection] = []
        self._unsent: deque[tuple[list[Packet], OnResult | None]] = deque()
        self._most_connections = settings.max_connections
        self._listener: socket.socket | None = None
        self._rest = Alarm(loop)
        self._takeover_alarm = Alarm(loop)
        self._is_open = False

    def open(self) -> None:
        """Listens on the port, or connects to the process of this host that owns it."""
        self._book = resolve(self._settings.address_book, self.counters)
        with self.loop.lock:
            self._is_open = True
            self._most_connections = affordable(self._settings.max_connections)
            self._share_port()

    def close(self) -> None:
        """Closes the connections; messages that wait are reported as lost."""
        with self.loop.lock:
            # While the connections are there: what was handed over is sent, or reported as lost.
            self._send_unsent()
            self._is_open = False
            for timer in (
                self._takeover_alarm,
                self._rest,
                *(line.retry for line in self._lines.values()),
            ):
                timer.cancel()
            if self._listener is not None:
                self.loop.unregister(self._listener)
                self._listener.close()
                self._listener = None
            # A list, as each of them takes itself out when it closes.
            for connection in list(self._connections):
                connection.close()
            self._lines.clear()
            self._messenger.close()

    @property
    def endpoint(self) -> Endpoint | None:
        """Where this process listens, if it owns the port."""
        return None if self._listener is None else self._listener.getsockname()

    def _attach(self, address: JausAddress, take: Take) -> None:
        self._inbox.attach(address, take)
        line = self._lines.get(self._well_known)
        if line is not None and line.connection is not None:
            self._announce(line.connection)

    def _messenger_of(self, source: JausAddress) -> Messenger[TcpConnection]:
        del source  # one for all components
        return self._messenger

    # ---- sending ----------------------------------------------------------------------------

    def transmit_all(self, packets: list[Packet], on_result: OnResult | None) -> None:
        """Sends on the loop's thread, which alone uses the connections."""
        self._unsent.append((packets, on_result))
        self.loop.call_soon(self._send_unsent)

    def _send_unsent(self) -> None:
        while self._unsent:
            self._send_now(*self._unsent.popleft())

    def _send_now(self, packets: list[Packet], on_result: OnResult | None) -> None:
        destination = packets[0].destination
        data = b"".join([octets_of(packet) for packet in packets])
        if destination.is_wildcard:
            sent = [open_connection.write(data) for open_connection in self._everyone()]
            report(self.loop, on_result, success=any(sent))
            if not sent:
                self.counters.add("jtcp.nobody_connected")
            return
        connection = self._way_to(destination)
        if connection is not None:
            connection.write(data, on_result)
            return
        self.counters.count("jtcp.not_connected", f"no connection to {destination}")
        report(self.loop, on_result, success=False)

    def answer(self, packet: Packet, origin: TcpConnection) -> None:
        """Sends a packet back over the connection that one came from."""
        origin.write(octets_of(packet))

    def _way_to(self, destination: JausAddress) -> TcpConnection | None:
        """Returns the connection to a component, which may be on its way."""
        connection = self._routes.get(destination)
        if connection is None and destination in self._book:
            connection = self._connect(self._book[destination])
        # The owner of the port may know the way, and passes on.
        if connection is None and self._well_known in self._lines:
            connection = self._lines[self._well_known].connection
        return connection

    def _everyone(self) -> list[TcpConnection]:
        for endpoint in self._book.values():
            self._connect(endpoint)
        return list(self._connections)

    # ---- connections ------------------------------------------------------------------------

    def _connect(self, endpoint: Endpoint) -> TcpConnection | None:
        """Returns the connection to an endpoint, made on demand; None while it is down."""
        # The book may name this process itself.
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
        """Looks for connections after a while: who waits would have this one called without end."""
        if self._listener is not None:
            self.loop.unregister(self._listener)
            self._rest.set(_REST_S, self._go_on_listening)

    def _go_on_listening(self) -> None:
        if self._listener is not None:
            self.loop.register(self._listener, self._accept)

    def _has_room_for(self, peer: Endpoint) -> bool:
        """Returns whether there is room for a connection, for which another one may be closed.

        Those over which nothing has come go first. One that was made from here, or that a
        component with a place of its own uses, gives way to nobody.
        """
        if len(self._connections) < self._most_connections:
            return True
        used = {id(way) for address, way in self._routes.items() if self.is_kept(address)}
        used |= {id(line.connection) for line in self._lines.values()}
        stated = {host for host, _ in self._book.values()}
        held = [
            Held(
                open_connection,
                (*_place(open_connection.peer), open_connection.peer),
                open_connection.has_spoken,
                id(open_connection) in used,
            )
            for open_connection in self._connections
        ]
        # Whoever the address book names gets in, however many strangers are there.
        asker: Held[object] = Held(None, (*_place(peer), peer), is_kept=peer[0] in stated)
        connection = who_gives_way(held, asker)
        if connection is None:
            return False
        self.counters.count("jtcp.gave_way", f"{connection} to {peer[0]}:{peer[1]}")
        connection.close()
        return True

    def _adopt(self, sock: socket.socket, peer: Endpoint, *, connecting: bool) -> TcpConnection:
        connection = TcpConnection(
            sock,
            peer,
            self.loop,
            connecting=connecting,
            buffer=self._settings.send_buffer,
            timeout=self._settings.connection_timeout,
            # A peer that was called need not speak; a silent caller only takes a place.
            idle=0.0 if connecting else self._settings.idle_timeout,
            on_packet=self._on_packet,
            on_close=self._on_close,
        )
        self._connections.append(connection)
        return connection

    def _on_close(self, connection: TcpConnection) -> None:
        self._connections.remove(connection)
        for address in [known for known, way in self._routes.items() if way is connection]:
            del self._routes[address]
        line = self._lines.get(connection.peer)
        if line is not None and line.connection is connection:
            line.connection = None
            # It was up, so whoever is there is alive: the pauses begin small again.
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
        # Tells which components live in a neighbour; see the deviation below.
        is_announced = packet.acknowledge is AckNak.ACK and not packet.payload
        if is_announced and packet.destination.is_wildcard:
            self.counters.add("jtcp.present")
            # From this host alone: for nobody else are messages passed on.
            connection.is_neighbour = connection.peer[0] == self._settings.interface
            return
        is_relayed = self._relay(packet, connection)
        is_taken = self._inbox.take(packet, connection, self.loop.now())
        if not is_taken and not is_relayed:
            self.counters.add("transport.not_for_us")

    def _learn(self, packet: Packet, connection: TcpConnection) -> bool:
        """Notes the way to the sender of a packet; returns whether it may be heard by this one."""
        address = packet.source
        former = self._routes.get(address)
        if self._settings.fixed_sources and former not in (None, connection):
            reason = f"it is heard from {former}"
            self.counters.count(SOURCE_REFUSED, f"{address} at {connection}: {reason}")
            return False
        # A broadcast may come by several ways, of which none is better than the one known.
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
        """Forgets who is silent longest of the connection that most components came by."""
        lent = [route for route in self._routes if not self.is_kept(route)]
        sizes = Counter(id(self._routes[address]) for address in lent)
        if len(lent) < self._settings.max_peers:
            return
        largest = max(sizes, key=lambda size: sizes[size])
        forgotten = next(address for address in lent if id(self._routes[address]) == largest)
        del self._routes[forgotten]
        self.counters.count("transport.address_book_full", f"forgot {forgotten}")

    # ---- strangers --------------------------------------------------------------------------

    def place_of(self, address: JausAddress) -> tuple[str, str]:
        """Returns where a component is; see ``Transport.place_of``."""
        way = self._routes.get(address)
        return ("", "") if way is None else _place(way.peer)

    def is_kept(self, address: JausAddress) -> bool:
        """Returns whether a component has a place of its own; see ``Transport.is_kept``."""
        return address in self._book or address in self._kept.values()

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        """Keeps the place of a controller; see ``Transport.keep_place``."""
        self._kept[owner] = address

    def silence_of(self, address: JausAddress) -> float:
        """Returns how long a component was silent: a connected one is there."""
        return 0.0 if address in self._routes else math.inf

    # ---- several processes on one host ------------------------------------------------------

    # JAUS-DEVIATION: AS5669A knows one process per port. The owner of the port passes messages
    # on between the other processes of its host and their peers. These tell the owner by an
    # acknowledgement to everybody, which other stacks ignore, which components live in them.

    def _share_port(self) -> None:
        """Tries to own the port; until then stays connected to its owner."""
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
            present = Packet(BROADCAST, address, acknowledge=AckNak.ACK)
            connection.write(octets_of(present))

    def _relay(self, packet: Packet, origin: TcpConnection) -> bool:
        """Passes a packet on to another process of this host; returns whether it went there."""
        if self._listener is None or packet.destination in self._inbox.receivers:
            return False
        if packet.destination.is_wildcard:
            connections = [
                connection for connection in self._connections if connection is not origin
            ]
        else:
            way = self._routes.get(packet.destination)
            connections = [] if way is None or way is origin else [way]
        # Only from or to a process of this host: it is no router between others.
        connections = [
            connection
            for connection in connections
            if connection.is_neighbour or origin.is_neighbour
        ]
        # Owners that know each other by several ways must not pass a message round forever.
        if not connections or (
            # An acknowledgement bears the number of what it answers, and is no duplicate of that.
            packet.acknowledge < AckNak.NAK and self._relayed.is_duplicate(packet, self.loop.now())
        ):
            return False
        data = octets_of(packet)
        for way in connections:
            way.write(data)
        self.counters.add("jtcp.relayed")
        return True


def _place(peer: Endpoint) -> tuple[str, str]:
    """Returns host and endpoint of a peer, as budgets take them."""
    return peer[0], f"{peer[0]}:{peer[1]}"
