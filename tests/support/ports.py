"""Ports and ROS domains that nobody has, and that nobody is given meanwhile.

A port that the system chose and that was let go may go to the next socket that asks for any. So
ports come from above those that it gives away, each worker has its own share of them, and each
comes but once in a process until they have all been given.
"""

import os
import socket
from itertools import count
from pathlib import Path

MOST_WORKERS = 16
"""So many processes run tests at once, at most."""

_HIGHEST = 65535
_GIVEN_AWAY = Path("/proc/sys/net/ipv4/ip_local_port_range")
_USUAL_END = 60999
_DOMAINS = 5
"""ROS domains of each worker beside its own (see `isolation.own_domain`).

As far as 101 their ports are below those that the system gives away.
"""

_numbers = count(os.getpid() * 37)
_domain_numbers = count(os.getpid())


def worker() -> int:
    """Returns the number of this process among those that run tests."""
    return int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % MOST_WORKERS


def free_port() -> int:
    """Returns a port of loopback that is free for UDP and TCP, another one each time."""
    start = _end_of_given_away() + 1
    share = (_HIGHEST + 1 - start) // MOST_WORKERS
    for number in _numbers:
        port = start + worker() * share + number % share
        if _is_free(port, socket.SOCK_DGRAM) and _is_free(port, socket.SOCK_STREAM):
            return port
    raise AssertionError("numbers do not end")


def free_domain() -> str:
    """Returns a ROS domain that no other worker uses, another one than last time."""
    return str(1 + worker() + MOST_WORKERS * (1 + next(_domain_numbers) % _DOMAINS))


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
