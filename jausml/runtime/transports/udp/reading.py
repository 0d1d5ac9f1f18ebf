"""Reads datagrams from sockets, and counts those that the kernel has dropped."""

from __future__ import annotations

import socket
import struct
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.counters import Counters
    from ...base.loop import Loop
    from ...base.settings import Endpoint

    Receiver = Callable[[int], tuple[bytes, Endpoint]]
    """Receives a datagram of at most so many bytes; tells where it came from."""


# Options of Linux that the socket module does not name.
SO_RXQ_OVFL = 40  # each datagram tells how many were dropped so far
SO_MEMINFO = 55  # the same and more is told on request, since 4.12

# SK_MEMINFO of Linux: nine numbers, of which the last one counts the drops.
_MEMINFO = struct.Struct("9I")
_DROPS = 8
_DROPPED = struct.Struct("I")
_NOTES_SIZE = socket.CMSG_SPACE(_DROPPED.size)


class KernelDrops:
    """Counts what the kernel drops at the sockets of one process, as ``judp.kernel_dropped``.

    To have it told with each datagram costs 5 us after a pause; so the kernel is asked now and
    then, where it answers.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._known: dict[socket.socket, int] = {}

    def receiver(self, sock: socket.socket, option: int = SO_MEMINFO) -> Receiver:
        """Return what receives from a socket, whose drops are counted from now on."""
        if sys.platform != "linux":
            return sock.recvfrom
        if len(_socket_option(sock, option)) == _MEMINFO.size:
            self._known[sock] = 0
            return sock.recvfrom
        return self._noting(sock)

    def look(self) -> None:
        """Count what was dropped since the last time; sockets that are closed are forgotten."""
        for sock, known in list(self._known.items()):
            memory_info = _socket_option(sock, SO_MEMINFO)
            if memory_info:
                self._known[sock] = self._counted(known, _MEMINFO.unpack(memory_info)[_DROPS])
            else:
                del self._known[sock]

    def _noting(self, sock: socket.socket) -> Receiver:
        """Return what receives, and reads the notes of the kernel that come with datagrams."""
        try:
            sock.setsockopt(socket.SOL_SOCKET, SO_RXQ_OVFL, 1)
        except OSError:
            return sock.recvfrom
        known = 0

        def receive(size: int) -> tuple[bytes, Endpoint]:
            nonlocal known
            data, notes, _, origin = sock.recvmsg(size, _NOTES_SIZE)
            for level, kind, note in notes:
                if (level, kind) == (socket.SOL_SOCKET, SO_RXQ_OVFL):
                    known = self._counted(known, *_DROPPED.unpack(note))
            return data, origin

        return receive

    def _counted(self, known: int, total: int) -> int:
        # The kernel counts in 32 bits, and begins again at 0.
        amount = total - known & 0xFFFFFFFF
        if amount:
            self._counters.count(
                "judp.kernel_dropped",
                f"{amount} datagrams; the receive buffer was full: this process stood "
                "still or too much comes at once; the kernel allows no larger buffer "
                "than net.core.rmem_max",
                amount=amount,
            )
        return total


def _socket_option(sock: socket.socket, option: int) -> bytes:
    """Returns what the kernel says of a socket; nothing where it does not, as of a closed one."""
    try:
        return sock.getsockopt(socket.SOL_SOCKET, option, _MEMINFO.size)
    except OSError:
        return b""


_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_TURN = 32
_PAUSE_S = 0.0002  # after which what comes has likely come alone


def reader(
    receive: Receiver, loop: Loop, take: Callable[[bytes, Endpoint], None]
) -> Callable[[], None]:
    """Return what reads the datagrams that have arrived at a socket, a few at a time.

    Args:
        receive: Receives from the socket, which does not block.
        take: Takes a datagram; never raises.
    """
    counters = loop.counters
    received = counters.tally("judp.received")
    most, latest = 1, loop.now()

    def read() -> None:
        nonlocal most, latest
        now = loop.now()
        if now - latest > _PAUSE_S:
            # To ask the socket again and find nothing costs 30 us, more than a datagram: after a
            # pause one is read, and more in a turn only while one follows the other.
            most = 1
            # The process may have stood still, and what waited meanwhile is thrown away unread.
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
        # Others of the loop have their turn now and then, however much comes.
        most = min(2 * most, _DATAGRAMS_PER_TURN)

    return read
