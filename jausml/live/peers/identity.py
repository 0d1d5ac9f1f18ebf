"""Identity of a live tool: a JAUS id that no other tool of this host has."""

from __future__ import annotations

import errno
import os
import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace

from jausml.live.peers.network import TOOL_SUBSYSTEM, Network
from jausml.runtime.base.address import JausAddress

_LAST = 254  # the greatest number of a node or component that is one


@contextmanager
def identified(network: Network, count: int = 1) -> Iterator[Network]:
    """Yields the network with our id, which is marked as used for other tools of this host.

    An id that the user chose stays; `is_shared` is set if another tool has it. Otherwise the id is
    65000, the last number of the interface, which differs between hosts of a network, and the first
    free number on this host.

    Args:
        count: How many ids in a row must be free, of which ours is the first.
    """
    with ExitStack() as claims:
        if network.is_own_given:
            is_free = _claimed(network.own, count, claims)
            yield replace(network, is_shared=not is_free)
            return
        for own in _candidates(network.settings.interface, count):
            if _claimed(own, count, claims):
                break
            claims.close()
        yield replace(network, own=own)


def _candidates(interface: str, count: int) -> Iterator[JausAddress]:
    """Yields the ids that a tool may have, which leave room for some behind them."""
    last_number = int(interface.rpartition(".")[2])
    node = last_number if 0 < last_number <= _LAST else 1
    # Where ids cannot be claimed, the process id usually makes them different.
    first = 1 if sys.platform == "linux" else os.getpid() % (_LAST - count) + 1
    for component in range(first, _LAST - count + 2):
        yield JausAddress(TOOL_SUBSYSTEM, node, component)


def _claimed(own: JausAddress, count: int, claims: ExitStack) -> bool:
    """Claims ids until the stack is closed, and returns whether all of them were free."""
    if sys.platform != "linux":
        return True
    for offset in range(count):
        address = JausAddress(own.subsystem, own.node, (own.component - 1 + offset) % _LAST + 1)
        # An abstract socket, one for each network namespace: the system frees it with the process.
        claim = claims.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        try:
            claim.bind(f"\0jausml tool {address}")
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            return False
    return True
