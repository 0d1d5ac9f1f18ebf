"""What waited in the sockets while the process stood still is not obeyed any more."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterable

    from ...base.loop import Loop, Timer

_LOOKS = 4
_MOST = 1 << 16


class Standstill:
    """Notices that the loop did not turn for long, and throws away what waited meanwhile.

    A datagram does not say when it arrived, and to have the kernel tell costs each of them. So a
    process that was stopped, or starved, cannot know which of those that wait are commands of long
    ago: all are thrown away and counted as ``judp.too_old``. What is acknowledged is sent again.

    Attributes:
        turned: When the loop was last seen to turn, by its clock.
        limit: Seconds without a turn that are a standstill; infinite when none is.
    """

    __slots__ = ("_loop", "_sockets", "_timer", "limit", "turned")

    def __init__(
        self, loop: Loop, sockets: Callable[[], Iterable[socket.socket]], limit: float
    ) -> None:
        """Look at nothing before ``start``.

        Args:
            loop: The loop; on a clock other than the system's no time passes unseen.
            sockets: Returns the sockets that are open.
            limit: Seconds without a turn that are a standstill; 0 for never.
        """
        self._loop = loop
        self._sockets = sockets
        self.limit = limit if limit and loop.now is time.monotonic else math.inf
        self.turned = loop.now()
        self._timer: Timer | None = None

    def start(self) -> None:
        """Begin to look."""
        self.turned = self._loop.now()
        if self.limit < math.inf:
            self._timer = self._loop.call_later(self.limit / _LOOKS, self._look)

    def stop(self) -> None:
        """End."""
        if self._timer is not None:
            self._timer.cancel()

    def end(self, now: float) -> None:
        """Throw away what waits, as the loop turns again after a standstill.

        Args:
            now: Time of the loop.
        """
        still, self.turned = now - self.turned, now
        count = sum(map(_emptied, self._sockets()))
        if count:
            self._loop.counters.count(
                "judp.too_old",
                f"{count} datagrams waited while this process stood still for {still:.1f} s",
                amount=count,
            )

    def _look(self) -> None:
        now = self._loop.now()
        if now - self.turned > self.limit:
            self.end(now)
        self.turned = now
        self._timer = self._loop.call_later(self.limit / _LOOKS, self._look)


def _emptied(sock: socket.socket) -> int:
    """Throws away what waits in a socket, which may be filled meanwhile; returns how much."""
    for count in range(_MOST):
        try:
            sock.recv(1)
        except OSError:
            return count
    return _MOST
