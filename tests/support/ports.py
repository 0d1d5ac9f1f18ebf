"""Ports that nobody has, and that the system gives to nobody meanwhile.

A port that the system chose and that was let go may go to the next socket that asks for any. So
ports come from above those that it gives away, and each but once in a process.
"""

from __future__ import annotations

import os
import socket
from itertools import count
from pathlib import Path

_HIGHEST = 65535
_GIVEN_AWAY = Path("/proc/sys/net/ipv4/ip_local_port_range")
_USUAL_END = 60999
_numbers = count(os.getpid() * 37)


def free_port() -> int:
    """Returns a port of loopback that is free for UDP and TCP, another one each time."""
    first = _end_of_given_away() + 1
    for number in _numbers:
        port = first + number % (_HIGHEST + 1 - first)
        if _is_free(port, socket.SOCK_DGRAM) and _is_free(port, socket.SOCK_STREAM):
            return port
    raise AssertionError("numbers do not end")


def _end_of_given_away() -> int:
    """Returns the highest port that the system chooses by itself."""
    try:
        end = int(_GIVEN_AWAY.read_text("ascii").split()[1])
    except OSError:
        return _USUAL_END
    return end if end < _HIGHEST - 1000 else 1024


def _is_free(port: int, kind: socket.SocketKind) -> bool:
    with socket.socket(socket.AF_INET, kind) as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True
