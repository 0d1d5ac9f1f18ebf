"""Inbox: assembles received packets to messages, and delivers these to components."""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable
from typing import Generic

from ...base.address import JausAddress
from ...base.clocks import Alarm, HostClock
from ...base.counters import LOGGER
from ...base.loop import Loop
from ...base.quirks import Quirk, Quirks
from ...base.settings import MAX_FRAGMENT_SIZE, TransportSettings
from ..delivery import MESSAGE_CODE_SIZE, Arrival, Carrier, Double, Origin, Take
from .duplicates import DuplicateWindow
from .packet import AckNak, Broadcast, DataFlags, Packet, Priority
from .reassembly import Reassembly

Receivers = list[tuple[JausAddress, Take]]
_MAX_SOURCES = 256


# JAUS-DEVIATION: in AS5669A a packet with these flags is an acknowledgement. Junior sets all eight
# bits when its API is called with priority 0, for a message of low priority.
class FlaglessMessages:
    """Distinguishes whole messages and fragments among packets whose flags are all set.

    Junior sends a long message as full packets and a shorter last one, without any mark. A short
    packet is taken for a whole message unless its source has sent a full one lately. If all full
    packets were lost, a last one is wrongly taken for a message, whose body will hardly be valid.
    """

    def __init__(self, seconds: float) -> None:
        """Rejects short packets of a source for `seconds` after a full one."""
        self._seconds = seconds
        self._fragmenting: OrderedDict[JausAddress, float] = OrderedDict()

    def whole(self, packet: Packet, now: float) -> Packet | None:
        """Returns a packet with the flags of a whole message; None if it may be a fragment."""
        if (packet.priority, packet.broadcast, packet.acknowledge, packet.data_flags) != (
            Priority.SAFETY_CRITICAL,
            Broadcast.RESERVED,
            AckNak.ACK,
            DataFlags.LAST,
        ):
            return None
        source = packet.source
        if len(packet.payload) >= MAX_FRAGMENT_SIZE:
            self._fragmenting[source] = now
            self._fragmenting.move_to_end(source)
            if len(self._fragmenting) > _MAX_SOURCES:
                self._fragmenting.popitem(last=False)
            return None
        last_full = self._fragmenting.get(source)
        if last_full is not None and now - last_full < self._seconds:
            return None
        return packet._replace(
            priority=Priority.LOW,
            broadcast=Broadcast.NONE,
            acknowledge=AckNak.NONE,
            data_flags=DataFlags.SINGLE,
        )


class Inbox(Generic[Origin]):
    """Receives packets for the components of one process (AS5669A).

    Each packet is delivered, kept as a fragment, an acknowledgement, or dropped and counted.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        acknowledged: Callable[[int, int, int], bool],
        carrier: Carrier[Origin],
        quirks: Quirks,
    ) -> None:
        """Starts without components.

        Args:
            acknowledged: Called with each acknowledgement: the component of this process, the
                number, and the sender. Returns whether a packet was waiting for it.
        """
        self._loop = loop
        self._counters = loop.counters
        self._timeout = settings.reassembly_timeout
        self._acknowledged = acknowledged
        self._matched = loop.counters.tally("transport.acknowledgement")
        self._carrier = carrier
        self._quirks = quirks
        self.arrival = Arrival()
        self.duplicates = DuplicateWindow(
            settings.duplicate_window, settings.duplicate_history, changed=loop.revision.changed
        )
        self.reassembly = Reassembly(
            settings.reassembly_timeout, settings.reassembly_limit, loop.counters
        )
        self._flagless = FlaglessMessages(settings.reassembly_timeout)
        self._expiry = Alarm(loop)  # set while there are incomplete messages
        self.doubles: dict[JausAddress, Double] = {}  # other components with an address of ours
        # Components of this process; replaced, not changed, so that any thread may read it.
        self.receivers: dict[JausAddress, Take] = {}
        # Called with sender and number of another acknowledgement: whether it proves an endpoint.
        self.proves: Callable[[int, int], bool] = lambda _by, _sequence: False

    def attach(self, address: JausAddress, take: Take) -> None:
        """Receives messages for a component from now on; raises ValueError for a bad address."""
        if not address.is_concrete:
            raise ValueError(f"{address} does not name one component")
        if address in self.receivers:
            raise ValueError(f"{address} is attached already")
        self.receivers = {**self.receivers, address: take}
        self._loop.revision.changed()

    def detach(self, address: JausAddress) -> None:
        """Stops receiving messages for a component; no effect for an unknown one."""
        self.receivers = {known: take for known, take in self.receivers.items() if known != address}
        self._loop.revision.changed()

    def close(self) -> None:
        """Cancels the timer of incomplete messages."""
        self._expiry.cancel()

    def refuses(self, packet: Packet, origin: Origin) -> bool:
        """Returns whether the source of a packet is impossible; counts such a packet."""
        source = packet.source
        if source.is_concrete and source not in self.receivers:
            return False
        if source.is_concrete:
            self._note_double(source, origin)
        else:
            self._counters.count("transport.bad_source", f"{source} at {origin}")
        return True

    def _note_double(self, source: JausAddress, origin: Origin) -> None:
        """Logs once that another component has the address of one of this process."""
        former = self.doubles.get(source)
        place = ":".join(map(str, origin)) if isinstance(origin, tuple) else str(origin)
        first = HostClock(self._loop).utc() if former is None else former.first_heard
        double = self.doubles[source] = Double(source, place, first, self._loop.now())
        if former is None:
            LOGGER.error("%s", double)
        # At a low level, as the error was logged once.
        self._counters.count("transport.own_source", place, level=logging.DEBUG)

    def take(self, packet: Packet, origin: Origin, now: float) -> bool:
        """Takes a packet of another process; returns False if it is for no component here."""
        receivers = self.receivers_of(packet)
        if not receivers:
            return False
        self.arrival.origin = origin
        if packet.acknowledge >= AckNak.NAK:
            self._on_acknowledgement(packet, receivers, origin, now)
        # Only the first packet of a message has a code, so later ones may be shorter.
        elif len(packet.payload) < MESSAGE_CODE_SIZE and packet.data_flags <= DataFlags.FIRST:
            self.duplicates.is_duplicate(packet, now)  # to count its number
            self._counters.count("transport.no_message_code", f"{packet.source} at {origin}")
        else:
            if packet.acknowledge:
                # Also repetitions, since the first acknowledgement may have been lost.
                self._acknowledge(packet, receivers, origin)
            self._accept(packet, receivers, now)
        return True

    def receivers_of(self, packet: Packet) -> Receivers:
        """Returns the components of this process to which a packet is addressed."""
        destination, source = packet.destination, packet.source
        take = self.receivers.get(destination)
        if take is not None:
            return [(destination, take)]
        if not destination.is_wildcard:
            return []
        return [
            (address, take)
            for address, take in self.receivers.items()
            if destination.matches(address) and address != source
        ]

    def deliver(self, packet: Packet, receivers: Receivers) -> None:
        """Delivers a whole message to components."""
        # Messages to wildcards may have a sequence of their own.
        self.arrival.number = None if packet.destination.is_wildcard else packet.sequence
        self.arrival.wants_acknowledgement = bool(packet.acknowledge)
        for address, take in receivers:
            try:
                take(packet.payload, packet.source)
            except Exception as error:  # other components must still get the message
                detail = f"{address}: {error!r}"
                self._counters.count("transport.receiver_failed", detail, error=error)

    def _accept(self, packet: Packet, receivers: Receivers, now: float) -> None:
        if self.duplicates.is_duplicate(packet, now):
            self._counters.add("transport.duplicate")
            return
        whole: Packet | None = packet
        if packet.data_flags:
            whole = self.reassembly.add(packet, now)
            self._plan_expiry()
        if whole is not None:
            self.deliver(whole, receivers)

    def _acknowledge(self, packet: Packet, receivers: Receivers, origin: Origin) -> None:
        for address, _ in receivers:
            answer = Packet(packet.source, address, b"", packet.sequence, packet.priority)
            self._carrier.answer(answer._replace(acknowledge=AckNak.ACK), origin)

    def _on_acknowledgement(
        self, packet: Packet, receivers: Receivers, origin: Origin, now: float
    ) -> None:
        if packet.acknowledge is AckNak.NAK:
            self._counters.add("transport.nak")  # unused in practice; repetitions go on
        elif packet.payload:
            self._on_marked_payload(packet, receivers, origin, now)
        elif self._acknowledged(packet.destination, packet.sequence, packet.source):
            self._matched.count += 1
        elif not self.proves(packet.source, packet.sequence):
            self._counters.add("transport.unmatched_acknowledgement")

    def _on_marked_payload(
        self, packet: Packet, receivers: Receivers, origin: Origin, now: float
    ) -> None:
        """Takes a packet with the flags of an acknowledgement and a payload, as of Junior."""
        message = None
        if len(packet.payload) >= MESSAGE_CODE_SIZE:
            message = self._flagless.whole(packet, now)
        self._counters.count(
            "transport.bad_acknowledgement" if message is None else "transport.flagless",
            f"{packet.source} at {origin} sends a payload marked as acknowledgement; "
            "if it is Junior, it must send with a priority above 0",
        )
        if message is not None:
            self._quirks.learn(packet.source, Quirk.FLAGLESS, "Junior does so with priority 0")
            self._accept(message, receivers, now)

    def _plan_expiry(self) -> None:
        """Sets the timer of incomplete messages, if there are any."""
        if self.reassembly.size and not self._expiry.is_set:
            self._expiry.set(self._timeout / 2, self._expire_fragments)

    def _expire_fragments(self) -> None:
        self.reassembly.expire(self._loop.now())
        self._plan_expiry()
