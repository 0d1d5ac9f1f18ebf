"""Messenger: the message layer that all transports share."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Generic

from ..delivery import MESSAGE_CODE_SIZE, report
from .carrier import Carrier, Origin, ReliableCarrier
from .inbox import Inbox
from .outbox import Outbox
from .packet import AckNak, Packet, Priority
from .packetizer import Packetizer

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...base.loop import Loop
    from ...base.settings import TransportSettings
    from ..delivery import OnResult


class Messenger(Generic[Origin]):
    """Messages of the components of one process: numbers, repeats, receives, acknowledges.

    Components of this process are reached without the network. A transport supplies how packets
    leave and gives what arrives to ``inbox``.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        carrier: Carrier[Origin],
    ) -> None:
        """Start with no components and nothing to wait for.

        Args:
            settings: Sizes, time-outs and limits.
            loop: Loop on which messages are received; its counters are used.
            carrier: Puts packets on the network. Messages are repeated until acknowledged unless
                it is reliable by itself.
        """
        self._loop = loop
        self._transmit = carrier.transmit
        self._packet_size = settings.fragment_size
        self._packetizer = Packetizer(settings.fragment_size)
        self._outbox = Outbox(settings, loop, carrier)
        self._is_reliable = isinstance(carrier, ReliableCarrier)
        self._send_all = (
            carrier.transmit_all if isinstance(carrier, ReliableCarrier) else self._send_out
        )
        self.inbox: Inbox[Origin] = Inbox(settings, loop, self._outbox.acknowledged, carrier)

    def close(self) -> None:
        """Report what waits for acknowledgement as lost."""
        self.inbox.close()
        self._outbox.close()

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        priority: Priority,
        acknowledge: bool,  # noqa: FBT001 - one caller
        on_result: OnResult | None,
    ) -> None:
        """Send one message; see ``Transport.send``.

        Raises:
            ValueError: The source is not one component or the payload has no message code.
        """
        if not source.is_concrete:
            raise ValueError(f"{source} does not name one component")
        if len(payload) < MESSAGE_CODE_SIZE:
            raise ValueError("a payload begins with a message code of two bytes")
        payload = bytes(payload)
        refusal = self._packetizer.refusal(destination, len(payload))
        if refusal:
            detail = f"{len(payload)} bytes from {source} to {destination} are not sent"
            if destination.is_wildcard:
                detail += f"; a broadcast goes in one packet, of {self._packet_size} bytes at most"
            self._loop.counters.count(refusal, detail)
            report(self._loop, on_result, success=False)
            return
        if destination in self.inbox.receivers:
            number = self._packetizer.reserve(source, 1)
            self._send_here(Packet(destination, source, payload, number, priority), on_result)
            return
        wanted = AckNak.REQUESTED if acknowledge and not self._is_reliable else AckNak.NONE
        packets = self._packetizer.packets(source, destination, payload, priority, wanted)
        if destination.is_wildcard and self.inbox.receivers_of(packets[0]):
            self._send_here(packets[0], on_result)
            on_result = None
        self._send_all(packets, on_result)

    def _send_here(self, packet: Packet, on_result: OnResult | None) -> None:
        """Deliver to components of this process, in the next round of the loop."""
        self._loop.call_soon(partial(self._arrive_here, packet, on_result))

    def _arrive_here(self, packet: Packet, on_result: OnResult | None) -> None:
        receivers = self.inbox.receivers_of(packet)
        self.inbox.deliver(packet, receivers)
        report(self._loop, on_result, success=bool(receivers))

    def _send_out(self, packets: list[Packet], on_result: OnResult | None) -> None:
        if packets[0].acknowledge:
            self._outbox.send(packets, on_result)
            return
        sent = [self._transmit(packet) for packet in packets]
        report(self._loop, on_result, success=all(sent))
