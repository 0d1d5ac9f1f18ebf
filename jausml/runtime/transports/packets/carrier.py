"""Carrier of packets: what the message layer needs of a network."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ..delivery import OnResult
    from .packet import Packet

Origin = TypeVar("Origin")
"""Where a packet came from and answers to it go: an endpoint, a connection, a socket."""


class Carrier(ABC, Generic[Origin]):
    """Puts packets on a network; callable from any thread."""

    @abstractmethod
    def transmit(self, packet: Packet) -> bool:
        """Put a packet on the network; return whether that worked."""

    @abstractmethod
    def answer(self, packet: Packet, origin: Origin) -> None:
        """Send a packet back to where one came from."""

    def heard(self, destination: JausAddress) -> float:  # noqa: ARG002
        """Return when a destination was heard last, on the loop's clock; never if nobody knows."""
        return -math.inf

    def suspect(self, destination: JausAddress, since: float) -> None:
        """Learn that a destination fails to acknowledge, before the last repetition.

        Args:
            since: When the packet was sent first.
        """


class ReliableCarrier(Carrier[Origin]):
    """Puts packets on a network that repeats by itself what gets lost, and reports what it sent."""

    @abstractmethod
    def transmit_all(self, packets: list[Packet], on_result: OnResult | None) -> None:
        """Send the packets of a message, and report whether that worked."""

    def transmit(self, packet: Packet) -> bool:
        """Send a packet whose result nobody asks for."""
        self.transmit_all([packet], None)
        return True
