"""The watchdog of systemd: is told again and again that the loop of a process turns."""

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING

from ..base.counters import LOGGER

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.loop import Loop

_TIMES_IN_TIME_OUT = 3
"""Notifications within the time after which a silent process is killed and started again."""


def feed_watchdog(loop: Loop, environment: Mapping[str, str] = os.environ) -> None:
    """Tell systemd that the loop turns, as long as it does; nothing where nobody watches.

    The lock of the loop is held.
    """
    place, time_out = environment.get("NOTIFY_SOCKET", ""), environment.get("WATCHDOG_USEC", "")
    # A process that this one starts inherits the environment, and is not who is watched.
    watched = environment.get("WATCHDOG_PID", str(os.getpid()))
    is_time_out = time_out.isdecimal() and int(time_out) > 0
    if not place or not is_time_out or watched != str(os.getpid()):
        return
    # A name that begins with @ is one of Linux's abstract sockets.
    address = f"\0{place[1:]}" if place.startswith("@") else place
    _Feeder(loop, address, int(time_out) / 1e6 / _TIMES_IN_TIME_OUT).feed()


class _Feeder:
    def __init__(self, loop: Loop, address: str, period: float) -> None:
        self._loop = loop
        self._address = address
        self._period = period
        self._was_told = True

    def feed(self) -> None:
        """Notify the watchdog, and do so again after a period."""
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
                # A manager that reads nothing must not hold up the loop.
                sender.settimeout(0)
                sender.sendto(b"WATCHDOG=1", self._address)
        except OSError as error:
            if self._was_told:
                LOGGER.warning("the watchdog at %s cannot be told: %s", self._address, error)
            self._was_told = False
        else:
            self._was_told = True
        # Also where it failed: a manager that is away for a moment would kill a sound process.
        self._loop.call_later(self._period, self.feed)
