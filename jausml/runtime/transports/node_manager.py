"""Transport by the node manager of the host, which owns the port (Junior's local protocol)."""

from __future__ import annotations

import socket
import struct
import tempfile
import threading
from collections import deque
from enum import Enum, auto
from pathlib import Path

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.loop import Loop
from ..base.quirks import Quirks
from ..base.settings import TransportKind, TransportSettings
from .delivery import Carrier, Take
from .packets.messenger import Messenger
from .packets.packet import Broadcast, Packet, parse_datagram
from .ports import MANAGER, is_alive
from .transport import Transport

_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_WAKE_UP = 32
_MAX_WAITING_BYTES = 8 << 20
_DATAGRAM_OVERHEAD = 100
_BUSY_PAUSE_S = 0.001
_CONNECT_INTERVAL_S = 0.025
_CONNECT_ATTEMPTS = 4
_FIRST_PAUSE_S = 0.1
_LONGEST_PAUSE_S = 5.0

# JAUS-DEVIATION: to attach, clients and node managers exchange headers of AS5669 version 1, which
# are not in AS5669A (Junior; fkie does the same).
_CONNECT, _ACCEPT, _CANCEL = 1, 2, 3
_MANAGER_SOURCE = 0
_HEAD = struct.Struct("<BHH")
_BODY = struct.Struct("<BBHIIHH")
_COMMAND_SIZE = _HEAD.size + _BODY.size
_SIZE_AFTER_HEAD = 16
_STANDARD_PRIORITY = 6
_MESSAGE_VERSION = 2


class _State(Enum):
    CLOSED = auto()
    ATTACHING = auto()
    ATTACHED = auto()
    WAITING = auto()


class NodeManagerClient(Carrier[str]):
    """Local socket of one component, its handshake with the manager, and its messages."""

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        folder: Path,
        manager: str,
        address: JausAddress,
        quirks: Quirks,
    ) -> None:
        self.address = address
        self._loop = loop
        self._counters = loop.counters
        self._manager = folder / manager
        self._path = folder / str(address.packed)
        self._lock = threading.Lock()
        self._state = _State.CLOSED
        self._socket: socket.socket | None = None
        self._identity = 0
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._attempts = 0
        self._pause = _FIRST_PAUSE_S
        self._timer = Alarm(loop)
        self._retry = Alarm(loop)
        self.messenger: Messenger[str] = Messenger(settings, loop, self, quirks)

    @property
    def is_attached(self) -> bool:
        """Whether the manager has accepted the component."""
        return self._state is _State.ATTACHED

    def open(self) -> None:
        """Creates the socket and requests to attach; raises OSError."""
        if is_alive(self._path):
            raise OSError(f"{self._path}: another process runs component {self.address}")
        self._path.unlink(missing_ok=True)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.settimeout(0)
        try:
            self._socket.bind(str(self._path))
        except OSError as error:
            self._socket.close()
            self._socket = None
            raise OSError(error.errno, f"{self._path}: {error.strerror}") from error
        self._loop.register(self._socket, self._read)
        self._attach()

    def close(self) -> None:
        """Detaches from the manager and removes the socket."""
        with self._lock:
            was_attached = self.is_attached
            self._send_waiting()
            self._state = _State.CLOSED
            self._clear_waiting()
        self._cancel_timer()
        if self._socket is not None:
            if was_attached:
                self._command(_CANCEL)
            self._loop.unregister(self._socket)
            with self._lock:
                self._socket.close()
                self._socket = None
            self._path.unlink(missing_ok=True)
        self.messenger.close()

    def check(self) -> None:
        """Attaches again if the manager has ended or was replaced."""
        if self.is_attached and not (
            is_alive(self._manager) and _identity(self._manager) == self._identity
        ):
            self._on_lost("it ended or restarted")

    # ---- attaching --------------------------------------------------------------------------

    def _attach(self) -> None:
        self._attempts = 0
        self._state = _State.ATTACHING
        self._request()

    def _request(self) -> None:
        if self._attempts == _CONNECT_ATTEMPTS:
            self._give_up()
            return
        self._attempts += 1
        self._identity = _identity(self._manager)
        self._command(_CONNECT)
        self._timer.set(_CONNECT_INTERVAL_S, self._request)

    def _give_up(self) -> None:
        with self._lock:
            self._state = _State.WAITING
            lost = len(self._waiting)
            self._clear_waiting()
        self._counters.count(
            "node_manager.no_answer",
            f"nobody accepts {self.address} at {self._manager}; {lost} messages are lost; "
            "is the node manager running?",
        )
        self._timer.set(self._pause, self._attach)
        self._pause = min(self._pause * 2, _LONGEST_PAUSE_S)

    def _on_lost(self, reason: str) -> None:
        self._counters.count("node_manager.lost", f"{self._manager} for {self.address}: {reason}")
        self._cancel_timer()
        self._attach()

    def _on_command(self, code: int) -> None:
        if code == _ACCEPT and self._state in (_State.ATTACHING, _State.WAITING):
            self._cancel_timer()
            self._pause = _FIRST_PAUSE_S
            with self._lock:
                self._state = _State.ATTACHED
            self._flush()
        elif code == _ACCEPT:
            self._counters.add("node_manager.accepted_again")
        elif code == _CANCEL and self.is_attached:
            self._on_lost("it cancelled the connection")
        else:
            self._counters.count("node_manager.bad_command", f"code {code}")

    def _command(self, code: int) -> None:
        body = _BODY.pack(_STANDARD_PRIORITY, _MESSAGE_VERSION, code, 0, self.address.packed, 0, 0)
        # Only the size is big-endian.
        size = int.from_bytes(_SIZE_AFTER_HEAD.to_bytes(2, "big"), "little")
        with self._lock:
            self._sendto(_HEAD.pack(1, 0, size) + body)

    def _cancel_timer(self) -> None:
        self._timer.cancel()
        self._retry.cancel()

    # ---- sending ----------------------------------------------------------------------------

    def answer(self, packet: Packet, origin: str) -> None:  # noqa: ARG002
        """Sends a packet to the manager, from which all packets come."""
        self._put(packet.encode())

    def transmit(self, packet: Packet) -> bool:
        """Sends a packet to the manager, which finds its destination."""
        if packet.destination.is_wildcard:
            packet = packet._replace(broadcast=Broadcast.GLOBAL)
        return self._put(packet.encode())

    def _put(self, datagram: bytes) -> bool:
        """Sends a datagram, or queues it while the manager is busy or has not accepted yet."""
        with self._lock:
            if self._state in (_State.CLOSED, _State.WAITING):
                name = "node_manager.not_attached"
            elif self._waiting_bytes >= _MAX_WAITING_BYTES:
                name = "node_manager.queue_full"
            else:
                is_first = not self._waiting
                self._waiting.append(datagram)
                self._waiting_bytes += len(datagram) + _DATAGRAM_OVERHEAD
                if is_first and self.is_attached:
                    self._send_waiting()
                return True
        self._counters.count(name, f"a message of {self.address} is lost")
        return False

    def _flush(self) -> None:
        with self._lock:
            self._send_waiting()

    def _send_waiting(self) -> None:
        while self._waiting and self.is_attached:
            if not self._sendto(self._waiting[0]):
                self._retry.set(_BUSY_PAUSE_S, self._flush)
                return
            self._waiting_bytes -= len(self._waiting.popleft()) + _DATAGRAM_OVERHEAD

    def _clear_waiting(self) -> None:
        self._waiting.clear()
        self._waiting_bytes = 0

    def _sendto(self, datagram: bytes) -> bool:
        """Sends to the manager; returns False when it is busy."""
        if self._socket is None:
            return True
        try:
            self._socket.sendto(datagram, str(self._manager))
        except BlockingIOError:
            return False
        except OSError as error:
            self._counters.count("node_manager.send_failed", f"{self._manager}: {error}")
            if self.is_attached:
                self._loop.call_soon(self.check)
            return True
        self._counters.add("node_manager.sent")
        return True

    # ---- receiving --------------------------------------------------------------------------

    def _read(self) -> None:
        self._loop.standstill.check()
        for _ in range(_DATAGRAMS_PER_WAKE_UP):
            if self._socket is None:
                return
            try:
                data = self._socket.recv(_LARGEST_DATAGRAM)
            except BlockingIOError:
                return
            except OSError as error:
                self._counters.count("node_manager.receive_failed", str(error))
                return
            self._counters.add("node_manager.received")
            self._on_datagram(data)

    def _on_datagram(self, data: bytes) -> None:
        if data[:1] == b"\x01" and len(data) >= _COMMAND_SIZE:
            _, _, code, _, source, _, _ = _BODY.unpack_from(data, _HEAD.size)
            if source == _MANAGER_SOURCE:
                self._on_command(code)
                return
        inbox, origin = self.messenger.inbox, self._manager.name
        for packet in parse_datagram(data, self._counters):
            if inbox.refuses(packet, origin):
                continue
            if not inbox.take(packet, origin, self._loop.now()):
                self._counters.add("transport.not_for_us")


def _identity(path: Path) -> int:
    """Returns the inode of a socket, by which a new one is noticed; 0 without one."""
    try:
        return path.stat().st_ino
    except OSError:
        return 0


_WATCH_INTERVAL_S = 1.0


class NodeManagerTransport(Transport):
    """Components of this process as clients of the node manager of their host.

    The manager finds peers, sends and receives for its clients, and relays messages between them.
    Each component is a client, which acknowledges and repeats packets itself. When the manager ends
    or restarts, the components attach again, with growing pauses while there is none.
    """

    KIND = TransportKind.NODE_MANAGER

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        """Makes a transport, which attaches no component before ``open``."""
        super().__init__(settings, loop)
        self._folder = Path(settings.node_manager_directory or tempfile.gettempdir())
        self._clients: dict[JausAddress, NodeManagerClient] = {}
        self._watch = Alarm(loop)
        self._is_open = False

    def open(self) -> None:
        """Attaches the components, and from now on each new one.

        Raises:
            OSError: The folder of the local sockets cannot be used, or another process has attached
                a component with the same address.
        """
        if not self._folder.is_dir():
            raise OSError(f"there is no folder {self._folder} for the node manager's sockets")
        with self.loop.lock:
            self._is_open = True
            self._plan_watch()
            try:
                for client in self._clients.values():
                    client.open()
            except OSError:
                self.close()
                raise

    def close(self) -> None:
        """Detaches from the manager; waiting messages are reported as lost."""
        with self.loop.lock:
            self._is_open = False
            self._watch.cancel()
            for client in self._clients.values():
                client.close()

    def is_attached(self, address: JausAddress) -> bool:
        """Returns whether the manager has accepted a component."""
        client = self._clients.get(address)
        return client is not None and client.is_attached

    def _attach(self, address: JausAddress, take: Take) -> None:
        if address in self._clients:
            raise ValueError(f"{address} is attached already")
        client = NodeManagerClient(
            self._settings, self.loop, self._folder, MANAGER, address, self.quirks
        )
        client.messenger.inbox.attach(address, take)
        if self._is_open:
            client.open()
        # A new dictionary, as send() reads it on other threads without a lock.
        self._clients = {**self._clients, address: client}

    def _detach(self, address: JausAddress) -> None:
        clients = dict(self._clients)
        client = clients.pop(address, None)
        self._clients = clients
        if client is not None:
            client.close()

    def _messenger_of(self, source: JausAddress) -> Messenger[str] | None:
        client = self._clients.get(source)
        return None if client is None else client.messenger

    def _plan_watch(self) -> None:
        self._watch.set(_WATCH_INTERVAL_S, self._check_clients)

    def _check_clients(self) -> None:
        """Notices the end or restart of the manager even while no messages are sent."""
        for client in self._clients.values():
            client.check()
        self._plan_watch()
