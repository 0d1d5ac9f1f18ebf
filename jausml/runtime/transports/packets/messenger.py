"""The message layer that all transports share."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Generic

from ..transport import MESSAGE_CODE_SIZE, report
from .inbox import Inbox, Origin
from .outbox import Outbox
from .packet import AckNak, Packet, Priority
from .packetizer import Packetizer

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...base.loop import Loop
    from ...base.settings import TransportSettings
    from ..transport import OnResult


class Messenger(Generic[Origin]):
    """Messages of the components of one process: numbers, repeats, receives, acknowledges.

    Components of this process are reached without the network. A transport supplies how packets
    leave and gives what arrives to ``inbox``.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        *,
        transmit: Callable[[Packet], bool],
        answer: Callable[[Packet, Origin], object],
        suspect: Callable[[JausAddress], None],
        send_all: Callable[[list[Packet], OnResult | None], None] | None = None,
    ) -> None:
        """Start with no components and nothing to wait for.

        Args:
            settings: Sizes, time-outs and limits.
            loop: Loop on which messages are received; its counters are used.
            transmit: Puts a packet on the network; returns whether that worked.
            answer: Sends a packet back to where one came from.
            suspect: Told a destination that fails to acknowledge.
            send_all: Sends the packets of a message reliably and reports; replaces repetition
                until acknowledged where the network itself is reliable.
        """
        self._loop = loop
        self._transmit = transmit
        self._packet_size = settings.fragment_size
        self._packetizer = Packetizer(settings.fragment_size)
        self._outbox = Outbox(settings, loop, transmit, suspect)
        self._send_all = self._send_out if send_all is None else send_all
        self.is_reliable = send_all is not None
        self.inbox: Inbox[Origin] = Inbox(settings, loop, self._outbox.acknowledged, answer)

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
        *,
        acknowledge: bool,
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
        wanted = AckNak.REQUESTED if acknowledge and not self.is_reliable else AckNak.NONE
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
