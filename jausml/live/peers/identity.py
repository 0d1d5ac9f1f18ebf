"""JAUS ids of our tools: one that no other tool of this host has, or the one that the user says."""

from __future__ import annotations

import errno
import os
import socket
import sys
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.live.peers.network import SUBSYSTEM, Network
from jausml.runtime.base.address import JausAddress

if TYPE_CHECKING:
    from collections.abc import Iterator


_LAST = 254


@contextmanager
def identified(network: Network, count: int = 1) -> Iterator[Network]:
    """Yields the network with an id of ours, which other tools of this host see to be in use.

    An id that the user says stays as it is; `is_shared` tells that another tool has it. Otherwise
    it is 65000, the last number of the interface, which tells hosts of a network apart, and the
    first number that is free on this host.

    Args:
        count: Ids that are needed, one after the other.
    """
    with ExitStack() as claims:
        if network.is_own_given:
            free = _claimed(network.own, count, claims)
            yield replace(network, is_shared=not free)
            return
        for own in _candidates(network.settings.interface, count):
            if _claimed(own, count, claims):
                break
            claims.close()
        yield replace(network, own=own)


def _candidates(interface: str, count: int) -> Iterator[JausAddress]:
    node = int(interface.rpartition(".")[2])
    node = node if 0 < node <= _LAST else 1
    # Where ids cannot be claimed the number of the process makes them different, as a rule.
    first = 1 if sys.platform == "linux" else os.getpid() % (_LAST - count) + 1
    for component in range(first, _LAST - count + 2):
        yield JausAddress(SUBSYSTEM, node, component)


def _claimed(own: JausAddress, count: int, claims: ExitStack) -> bool:
    """Claims ids until the stack is closed, and returns whether all of them were free."""
    if sys.platform != "linux":
        return True
    for offset in range(count):
        address = JausAddress(own.subsystem, own.node, (own.component - 1 + offset) % _LAST + 1)
        # A name without a file: the system frees it with the process, in each network namespace.
        claim = claims.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        try:
            claim.bind(f"\0jausml tool {address}")
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            return False
    return True
