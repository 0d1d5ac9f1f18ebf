"""Outbox: packets that wait for their acknowledgement."""

from __future__ import annotations

import threading
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...base.loop import Loop, Timer
    from ...base.settings import TransportSettings
    from .carrier import Carrier
    from .packet import Packet

_MAX_WAITING = 4096


class _Waiting:
    """A message whose packets are sent one by one, each after the one before was acknowledged."""

    __slots__ = ("on_result", "packets", "position", "repetitions", "timer")

    def __init__(self, packets: list[Packet], on_result: Callable[[bool], None] | None) -> None:
        self.packets = packets
        self.on_result = on_result
        self.position = 0
        self.repetitions = 0
        self.timer: Timer | None = None

    @property
    def packet(self) -> Packet:
        return self.packets[self.position]


class Outbox:
    """Repeats packets until they are acknowledged (AS5669A, acknowledge and retry).

    A packet is repeated with its sequence number after ``acknowledge_timeout`` and given up
    after ``acknowledge_retries`` repetitions, of which the last one also searches by multicast.
    Callable from any thread; results are reported on the loop's thread.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        carrier: Carrier[Any],
    ) -> None:
        """Start with nothing to wait for.

        Args:
            settings: Time-out and number of repetitions.
            loop: Runs the time-outs.
            carrier: Puts packets on the network; told the destination before the last repetition,
                which may thus search for it.
        """
        self._settings = settings
        self._loop = loop
        self._carrier = carrier
        self._lock = threading.Lock()
        self._waiting: dict[tuple[JausAddress, int], _Waiting] = {}

    def __len__(self) -> int:
        """Return how many messages wait."""
        return len(self._waiting)

    def send(self, packets: list[Packet], on_result: Callable[[bool], None] | None) -> None:
        """Send the packets of one message, which ask for acknowledgement, one by one.

        Args:
            packets: Fragments in order, or the only packet.
            on_result: Told once whether all packets were acknowledged.
        """
        waiting = _Waiting(packets, on_result)
        if len(self._waiting) >= _MAX_WAITING:
            self._loop.counters.count(
                "transport.too_many_unacknowledged", str(packets[0].destination)
            )
            self._report(waiting, acknowledged=False)
            return
        with self._lock:
            self._wait_for(waiting)
        self._carrier.transmit(packets[0])  # the loop may have gone on to a later one meanwhile

    def acknowledged(self, packet: Packet) -> bool:
        """Take an acknowledgement; return whether a packet waited for it."""
        key = (packet.destination, packet.sequence)
        with self._lock:
            waiting = self._waiting.get(key)
            if waiting is None or not waiting.packet.destination.matches(packet.source):
                return False
            del self._waiting[key]
            if waiting.timer is not None:
                waiting.timer.cancel()
            waiting.position += 1
            is_last = waiting.position == len(waiting.packets)
            if not is_last:
                waiting.repetitions = 0
                self._wait_for(waiting)
        if is_last:
            self._report(waiting, acknowledged=True)
        else:
            self._carrier.transmit(waiting.packet)
        return True

    def close(self) -> None:
        """Give up everything; the results are reported."""
        with self._lock:
            abandoned = list(self._waiting.values())
            self._waiting.clear()
        for waiting in abandoned:
            if waiting.timer is not None:
                waiting.timer.cancel()
            self._report(waiting, acknowledged=False)

    def _wait_for(self, waiting: _Waiting) -> None:
        packet = waiting.packet
        self._waiting[packet.source, packet.sequence] = waiting
        waiting.timer = self._loop.call_later(
            self._settings.acknowledge_timeout, partial(self._expired, waiting, waiting.position)
        )

    def _expired(self, waiting: _Waiting, position: int) -> None:
        with self._lock:
            packet = waiting.packets[position]
            key = (packet.source, packet.sequence)
            if waiting.position != position or self._waiting.get(key) is not waiting:
                return
            repeat = waiting.repetitions < self._settings.acknowledge_retries
            if repeat:
                waiting.repetitions += 1
                self._wait_for(waiting)
            else:
                del self._waiting[key]
        if waiting.repetitions == self._settings.acknowledge_retries:
            self._carrier.suspect(packet.destination)
        if repeat:
            self._loop.counters.add("transport.repeated")
            self._carrier.transmit(packet)
        else:
            self._loop.counters.count("transport.unacknowledged", f"{packet.destination}")
            self._report(waiting, acknowledged=False)

    def _report(self, waiting: _Waiting, *, acknowledged: bool) -> None:
        if waiting.on_result is not None:
            self._loop.call_soon(partial(waiting.on_result, acknowledged))
