"""One JTCP connection: packets to and from a stream (AS5669A)."""

from __future__ import annotations

import os
import resource
import socket
import sys
from collections import deque
from collections.abc import Callable, Iterator

from ..base.api import JausError
from ..base.clocks import Alarm
from ..base.counters import LOGGER, Counters
from ..base.loop import Loop
from ..base.settings import LEAST_CONNECTIONS, Endpoint
from .delivery import OnResult, report
from .packets.packet import (
    EMPTY_MESSAGE_SIZE,
    JUDP_VERSION,
    Broadcast,
    Packet,
    message_size,
    parse_message,
)

_OTHER_DESCRIPTORS = 64  # kept for other uses than connections; a small bridge needs 24
_SIZE_END = 3
_BACKLOG = 64


class StreamError(JausError):
    """A stream cannot be read any more; `counter` names the reason."""

    def __init__(self, counter: str, detail: str) -> None:
        super().__init__(detail)
        self.counter = counter


class StreamReader:
    """Cuts received chunks of a stream into packets."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._data = b""
        self._is_version_known = False

    @property
    def pending(self) -> int:
        """Bytes of an incomplete packet; less than 65536."""
        return len(self._data)

    def feed(self, data: bytes) -> Iterator[Packet | None]:
        """Yields the packets that are complete now; None for one that cannot be read.

        The iterator must be exhausted before the next call.

        Raises:
            StreamError: The version is another one, or a packet is too small.
        """
        data, offset = self._data + data, 0
        if data and not self._is_version_known:
            if data[0] != JUDP_VERSION:
                raise StreamError("jtcp.bad_version", data[:32].hex())
            self._is_version_known = True
            offset = 1
        end = len(data)
        while end - offset >= _SIZE_END:
            size = message_size(data, offset)
            if size < EMPTY_MESSAGE_SIZE:
                raise StreamError("jtcp.bad_size", f"a message of {size} bytes")
            if end - offset < size:
                break
            yield parse_message(data, offset, size, self._counters)
            offset += size
        self._data = data[offset:]


_READ_SIZE = 65536
_READS_PER_WAKE_UP = 8
_VERSION = bytes([JUDP_VERSION])

_KEEPALIVE_IDLE_S = 5
_KEEPALIVE_INTERVAL_S = 2
_KEEPALIVE_PROBES = 3
_VANISHED_S = _KEEPALIVE_IDLE_S + _KEEPALIVE_PROBES * _KEEPALIVE_INTERVAL_S


class TcpConnection:
    """A stream of packets in each direction; everything runs on the thread of the loop.

    The version byte is sent once in each direction, before the first packet. The next packet begins
    where the size of the present one says, so that a stream is closed after an error.

    Attributes:
        is_neighbour: Whether the peer is a process of this host for which packets are relayed.
        has_spoken: Whether a packet has come.
    """

    def __init__(
        self,
        sock: socket.socket,
        peer: Endpoint,
        loop: Loop,
        *,
        connecting: bool,
        buffer: int,
        timeout: float,
        idle: float,
        on_packet: Callable[[Packet, TcpConnection], None],
        on_close: Callable[[TcpConnection], None],
    ) -> None:
        """Takes over a socket.

        Args:
            connecting: Whether the socket is not connected yet.
            buffer: Bytes that may wait for a slow peer, besides one message.
            timeout: Seconds within which the socket must connect, and a peer must take some of the
                waiting bytes.
            idle: Seconds within which the first packet must come; 0 for any time.
        """
        self.peer = peer
        self.is_neighbour = False
        self.is_connected = not connecting
        self.is_closed = False
        self._socket = sock
        self._loop = loop
        self._buffer = buffer
        self._timeout = timeout
        self.has_spoken = False
        # Replaced by `_then` with the first packet, so that later ones cost no comparison.
        self._on_packet: Callable[[Packet, TcpConnection], None] = self._take_first
        self._then = on_packet
        self._idle = Alarm(loop)
        if idle:
            self._idle.set(idle, self._on_idle)
        self._on_close = on_close
        self._reader = StreamReader(loop.counters)
        self._outgoing: deque[tuple[bytes, OnResult | None]] = deque([(_VERSION, None)])
        self._waiting = len(_VERSION)
        self._sent = 0
        self._watchdog = Alarm(loop)
        sock.settimeout(0)
        _keep_alive(sock)
        loop.register(sock, self._on_ready)
        # A socket becomes writable when it is connected; the version byte waits for that.
        loop.watch_writable(sock, wanted=True)
        self._restart_watchdog()  # also bounds the time to connect

    def __str__(self) -> str:
        return f"{self.peer[0]}:{self.peer[1]}"

    def write(self, data: bytes, on_result: OnResult | None = None) -> bool:
        """Sends packets, or queues them; returns False if the peer is too slow.

        Args:
            data: Packets without version byte.
            on_result: Called once with whether the system has sent them.
        """
        if self.is_closed or self._waiting > self._buffer:
            if not self.is_closed:
                self._loop.counters.count("jtcp.buffer_full", f"{self._waiting} bytes for {self}")
            report(self._loop, on_result, success=False)
            return False
        # Otherwise the loop waits for the socket already.
        was_idle = not self._outgoing
        self._outgoing.append((data, on_result))
        self._waiting += len(data)
        if was_idle:
            self._flush()
            if self._outgoing and not self.is_closed:
                self._loop.watch_writable(self._socket, wanted=True)
                self._restart_watchdog()
        return True

    def close(self) -> None:
        """Closes the connection; waiting messages are reported as not sent."""
        if self.is_closed:
            return
        self.is_closed = True
        self._watchdog.cancel()
        self._idle.cancel()
        self._loop.unregister(self._socket)
        self._socket.close()
        # By identity, as the version byte is no message.
        waiting = [entry for entry in self._outgoing if entry[0] is not _VERSION]
        self._outgoing.clear()
        if waiting:
            self._loop.counters.count("jtcp.unsent", f"{len(waiting)} messages for {self}")
        for _, on_result in waiting:
            report(self._loop, on_result, success=False)
        self._on_close(self)

    def _end(self, counter: str, detail: str) -> None:
        self._loop.counters.count(counter, f"{self}: {detail}")
        self.close()

    def _on_ready(self) -> None:
        if not self.is_connected:
            error = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            if error:
                self._end("jtcp.connect_failed", os.strerror(error))
                return
            self.is_connected = True
        if self._outgoing:
            self._flush()
            if not self._outgoing and not self.is_closed:
                self._loop.watch_writable(self._socket, wanted=False)
        if not self.is_closed:
            self._read()

    def _flush(self) -> None:
        while self._outgoing and self.is_connected:
            data, on_result = self._outgoing[0]
            try:
                # A view, so that the rest of a large message is not copied.
                count = self._socket.send(memoryview(data)[self._sent :])
            except BlockingIOError:
                return
            except OSError as error:
                self._end("jtcp.lost", str(error))
                return
            self._sent += count
            self._waiting -= count
            self._restart_watchdog()
            if self._sent == len(data):
                self._sent = 0
                self._outgoing.popleft()
                report(self._loop, on_result, success=True)

    def _restart_watchdog(self) -> None:
        """Restarts the time within which the peer must take bytes, if any wait."""
        self._watchdog.cancel()
        if self._waiting:
            self._watchdog.set(self._timeout, self._on_stalled)

    def _take_first(self, packet: Packet, connection: TcpConnection) -> None:
        """Takes the first packet; later ones go to `_then` directly."""
        self.has_spoken = True
        self._on_packet = self._then
        self._then(packet, connection)

    def _on_idle(self) -> None:
        if not self.has_spoken:
            self._end("jtcp.never_spoke", "said nothing")

    def _on_stalled(self) -> None:
        if self.is_connected:
            self._end("jtcp.stalled", f"takes nothing; {self._waiting} bytes wait")
        else:
            self._end("jtcp.connect_failed", "no answer")

    def _read(self) -> None:
        # Watchers of standstills are called before waiting packets are taken.
        self._loop.standstill.check()
        # Limited, so that other callbacks have their turn; the socket stays ready.
        for _ in range(_READS_PER_WAKE_UP):
            try:
                data = self._socket.recv(_READ_SIZE)
            except BlockingIOError:
                return
            except OSError as error:
                self._end("jtcp.lost", str(error))
                return
            if not data:
                if self._reader.pending:
                    self._loop.counters.count("jtcp.truncated", f"{self} ended within a message")
                self.close()
                return
            try:
                self._take(data)
            except StreamError as error:
                self._end(error.counter, str(error))
            if self.is_closed:
                return

    def _take(self, data: bytes) -> None:
        for packet in self._reader.feed(data):
            self._loop.counters.add("jtcp.received")
            if packet is not None:
                self._on_packet(packet, self)
                # The callback may have closed the connection.
                if self.is_closed:
                    return


def connect(endpoint: Endpoint) -> socket.socket:
    """Returns a socket that connects to an endpoint; raises OSError."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    sock.settimeout(0)
    try:
        sock.connect(endpoint)
    except BlockingIOError:
        pass  # the loop notices when it is connected
    except OSError:
        sock.close()
        raise
    return sock


def affordable(wanted: int) -> int:
    """Returns the number of connections that the system allows, at most `wanted`; logs fewer."""
    limit, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = max(LEAST_CONNECTIONS, limit - _OTHER_DESCRIPTORS)
    if limit == resource.RLIM_INFINITY or most >= wanted:
        return wanted
    LOGGER.warning(
        "this process may have %d descriptors (ulimit -n): %d TCP connections instead of %d",
        *(limit, most, wanted),
    )
    return most


def _keep_alive(sock: socket.socket) -> None:
    """Enables probes, by which a vanished peer is noticed, and sends small packets at once."""
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    if sys.platform == "linux":
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, _KEEPALIVE_IDLE_S)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, _KEEPALIVE_INTERVAL_S)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, _KEEPALIVE_PROBES)
        # There are no probes while data waits for the peer, by default for a quarter of an hour.
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, 1000 * _VANISHED_S)


def octets_of(packet: Packet) -> bytes:
    """Returns a packet as octets of a stream."""
    if packet.destination.is_wildcard:
        packet = packet._replace(broadcast=Broadcast.GLOBAL)
    # Without the version byte of a datagram.
    return packet.encode()[1:]


def listen(endpoint: Endpoint) -> socket.socket:
    """Returns a socket that accepts connections; raises OSError."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        # Connections of a former owner in TIME_WAIT must not keep the port.
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind(endpoint)
        sock.listen(_BACKLOG)
        sock.settimeout(0)
    except OSError:
        sock.close()
        raise
    return sock
