"""Reads datagrams from sockets, and counts those that the kernel has dropped."""

from __future__ import annotations

import socket
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.counters import Counters
    from ...base.loop import Loop
    from ...base.settings import Endpoint

    Receiver = Callable[[int], tuple[bytes, Endpoint]]
    """Receives a datagram of at most so many bytes; tells where it came from."""


# An option of Linux that the socket module does not name: how its memory stands. Of nine numbers
# (SK_MEMINFO) the last one counts the drops.
_SO_MEMINFO = 55
_MEMINFO = struct.Struct("9I")
_DROPS = 8


class KernelDrops:
    """Counts what the kernel drops at the sockets of one process, as ``judp.kernel_dropped``.

    To have it told with each datagram costs 5 us after a pause; so the kernel is asked now and
    then, where it answers (Linux).
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._known: dict[socket.socket, int] = {}

    def watch(self, sock: socket.socket) -> None:
        """Count the drops of a socket from now on."""
        self._known.setdefault(sock, 0)

    def look(self) -> None:
        """Count what was dropped since the last time; sockets that do not tell are forgotten."""
        for sock, known in list(self._known.items()):
            try:
                memory_info = sock.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, _MEMINFO.size)
                self._known[sock] = total = _MEMINFO.unpack(memory_info)[_DROPS]
            except (OSError, struct.error):
                del self._known[sock]
                continue
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


_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_TURN = 32
_PAUSE_S = 0.0002  # after which what comes has likely come alone


def reader(
    receive: Receiver, loop: Loop, take: Callable[[bytes, Endpoint], None]
) -> Callable[[], None]:
    """Return what reads the datagrams that have arrived at a socket, a few at a time."""
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
