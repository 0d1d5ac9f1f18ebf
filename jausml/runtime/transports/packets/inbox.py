"""Inbox: makes messages of received packets, and gives them to the components of this process."""

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


# JAUS-DEVIATION: by AS5669A a packet with these flags is an acknowledgement. Junior sets all eight
# bits when its API is called with priority 0; what it means is a message of low priority.
class FlaglessMessages:
    """Tells whole messages from fragments among packets whose flags are all set.

    A message longer than Junior's packets comes as full packets and a shorter tail, and nothing
    marks them. A short packet is taken for a whole message, unless its source sent a full one
    lately: it may then be the tail. A tail is taken for a message when all that came before it
    was lost on the way; its body will hardly be one that its first two bytes call for.
    """

    def __init__(self, seconds: float) -> None:
        """Doubts the short packets of a source for so many seconds after a full one."""
        self._seconds = seconds
        self._fragmenting: OrderedDict[JausAddress, float] = OrderedDict()

    def whole(self, packet: Packet, now: float) -> Packet | None:
        """Returns the message that a packet with a payload is, or None if it may be a fragment."""
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
        doubted = self._fragmenting.get(source)
        if doubted is not None and now - doubted < self._seconds:
            return None
        return packet._replace(
            priority=Priority.LOW,
            broadcast=Broadcast.NONE,
            acknowledge=AckNak.NONE,
            data_flags=DataFlags.SINGLE,
        )


class Inbox(Generic[Origin]):
    """Receives for the components of one process, over whatever transport (AS5669A).

    Every packet that it takes ends in exactly one way: delivered; kept as a fragment; an
    acknowledgement; or dropped and counted.
    """

    def __init__(
        self,
        settings: TransportSettings,
        loop: Loop,
        acknowledged: Callable[[int, int, int], bool],
        carrier: Carrier[Origin],
        quirks: Quirks,
    ) -> None:
        """Starts with no components.

        Who was acknowledged, which number and by whom is told; the answer is whether a packet
        waited.
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
        self._expiry = Alarm(loop)  # set while incomplete messages are watched
        # Who else was heard with the address of a component of this process.
        self.doubles: dict[JausAddress, Double] = {}
        self.receivers: dict[JausAddress, Take] = {}
        """Components of this process; replaced when it changes, so any thread may read it."""
        self.proves: Callable[[int, int], bool] = lambda _by, _sequence: False
        """Told of an acknowledgement that no packet waits for; returns whether it proves who is
        where."""

    def attach(self, address: JausAddress, take: Take) -> None:
        """Receives messages for a component from now on."""
        if not address.is_concrete:
            raise ValueError(f"{address} does not name one component")
        if address in self.receivers:
            raise ValueError(f"{address} is attached already")
        self.receivers = {**self.receivers, address: take}
        self._loop.revision.changed()

    def detach(self, address: JausAddress) -> None:
        """Stops to receive messages for a component; no effect when it is unknown."""
        self.receivers = {known: take for known, take in self.receivers.items() if known != address}
        self._loop.revision.changed()

    def close(self) -> None:
        """Stops to watch for incomplete messages."""
        self._expiry.cancel()

    def refuses(self, packet: Packet, origin: Origin) -> bool:
        """Returns whether the source of a packet cannot be true; it is counted then."""
        source = packet.source
        if source.is_concrete and source not in self.receivers:
            return False
        if source.is_concrete:
            self._note_double(source, origin)
        else:
            self._counters.count("transport.bad_source", f"{source} at {origin}")
        return True

    def _note_double(self, source: JausAddress, origin: Origin) -> None:
        """Tells once, as an error, that somebody else has the address of a component here."""
        known = self.doubles.get(source)
        place = ":".join(map(str, origin)) if isinstance(origin, tuple) else str(origin)
        first = HostClock(self._loop).utc() if known is None else known.first_heard
        double = self.doubles[source] = Double(source, place, first, self._loop.now())
        if known is None:
            LOGGER.error("%s", double)
        # The error was logged once; somebody who keeps talking must not fill the log.
        self._counters.count("transport.own_source", place, level=logging.DEBUG)

    def take(self, packet: Packet, origin: Origin, now: float) -> bool:
        """Takes a packet of another process; returns False when it is for nobody here."""
        receivers = self.receivers_of(packet)
        if not receivers:
            return False
        self.arrival.origin = origin
        if packet.acknowledge >= AckNak.NAK:
            self._on_acknowledgement(packet, receivers, origin, now)
        # A later packet of a message may be that short: only the first begins with a code.
        elif len(packet.payload) < MESSAGE_CODE_SIZE and packet.data_flags <= DataFlags.FIRST:
            self.duplicates.is_duplicate(packet, now)  # it is not lost, and has a number
            self._counters.count("transport.no_message_code", f"{packet.source} at {origin}")
        else:
            if packet.acknowledge:
                # Repetitions too: the acknowledgement before may have been lost.
                self._acknowledge(packet, receivers, origin)
            self._accept(packet, receivers, now)
        return True

    def receivers_of(self, packet: Packet) -> Receivers:
        """Returns the components of this process that a packet is meant for."""
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
        """Hands a whole message to components."""
        # What goes to a wildcard may be numbered apart from the rest.
        self.arrival.number = None if packet.destination.is_wildcard else packet.sequence
        self.arrival.is_sure = bool(packet.acknowledge)
        for address, take in receivers:
            try:
                take(packet.payload, packet.source)
            except Exception as error:  # one component must not silence the others
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
            self._counters.add("transport.nak")  # nobody sends it; the repetition goes on
        elif packet.payload:
            self._on_marked_payload(packet, receivers, origin, now)
        elif self._acknowledged(packet.destination, packet.sequence, packet.source):
            self._matched.count += 1
        elif not self.proves(packet.source, packet.sequence):
            self._counters.add("transport.unmatched_acknowledgement")

    def _on_marked_payload(
        self, packet: Packet, receivers: Receivers, origin: Origin, now: float
    ) -> None:
        """Takes what is marked as an acknowledgement and yet must be a message of Junior."""
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
        """Watches for incomplete messages, if there are any."""
        if self.reassembly.size and not self._expiry.is_set:
            self._expiry.set(self._timeout / 2, self._expire_fragments)

    def _expire_fragments(self) -> None:
        self.reassembly.expire(self._loop.now())
        self._plan_expiry()
