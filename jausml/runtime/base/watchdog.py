"""Tells systemd that the loop turns, where it watches the process (sd_notify(3), WatchdogSec=)."""

from __future__ import annotations

import logging
import os
import socket
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .standstill import Waiting

LOGGER = logging.getLogger("jausml")

_WORDS_IN_TIME = 3
"""So often within the time after which a silent process is killed and started again."""


def feed_watchdog(loop: Waiting, environment: Mapping[str, str] = os.environ) -> None:
    """Say again and again that the loop turns; nothing where nobody watches this process.

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
    _Feeder(loop, address, int(time_out) / 1e6 / _WORDS_IN_TIME).feed()


class _Feeder:
    def __init__(self, loop: Waiting, address: str, every: float) -> None:
        self._loop = loop
        self._address = address
        self._every = every

    def feed(self) -> None:
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
                sender.sendto(b"WATCHDOG=1", self._address)
        except OSError as error:
            LOGGER.warning("the watchdog at %s cannot be told: %s", self._address, error)
            return
        self._loop.call_later(self._every, self.feed)
