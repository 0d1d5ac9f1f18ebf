"""JUDP on other ports: what processes that share the port of a host say to each other.

Only one process of a host owns the port; the others have one of a known range, or one that the
system picks, which peers learn from their datagrams (AS5669A). Multicast shows these ports, since
it goes to the known one.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

_VERSION = 2
_LEAST_SIZE = 14
_HEADER = struct.Struct("<BH")
_MESSAGE_TYPE = 0x3F
_MOST_ENDPOINTS = 4096


class Endpoint(NamedTuple):
    """An IP address and a UDP port."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


class Elsewhere:
    """Endpoints that speak JUDP, learnt from what was seen.

    Attributes:
        unclaimed: Datagrams that look like JUDP, between endpoints of which none is known.
    """

    def __init__(self, port: int) -> None:
        """Starts with no endpoint."""
        self.unclaimed = 0
        # Hex needs no runtime, captures do.
        from jausml.runtime.transports.udp.shared_port import neighbour_ports  # noqa: PLC0415

        self._neighbours = neighbour_ports(port)
        self._known: set[Endpoint] = set()

    def learn(self, *endpoints: Endpoint) -> None:
        """Takes that endpoints speak JUDP."""
        if len(self._known) < _MOST_ENDPOINTS:
            self._known.update(endpoints)

    def takes(self, source: Endpoint, destination: Endpoint) -> bool:
        """Whether a datagram on other ports, which has the form of JUDP, is of a speaker."""
        if source in self._known or destination in self._known:
            return True
        if source.port in self._neighbours or destination.port in self._neighbours:
            return True
        self.unclaimed += 1
        return False


def is_judp(data: bytes) -> bool:
    """Returns whether a datagram has the form of JUDP from its first to its last byte."""
    offset = 1
    if data[:1] != bytes([_VERSION]) or len(data) < 1 + _LEAST_SIZE:
        return False
    while offset + _LEAST_SIZE <= len(data):
        kind, size = _HEADER.unpack_from(data, offset)
        if kind & _MESSAGE_TYPE or size < _LEAST_SIZE:
            return False
        offset += size
    return offset == len(data)
