"""Outbox: repeats packets until they are acknowledged, and gives up in the end."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any

from ...base.address import JausAddress, address_of
from ...base.loop import Loop, Timer
from ...base.quirks import Quirk, Quirks
from ...base.settings import TransportSettings
from ..delivery import MESSAGE_CODE_SIZE, Carrier, OnResult, report
from .outgoing import Flight, Key, Lane, Message, key_of
from .packet import Packet

_MAX_MESSAGES = 4096
_MAX_BYTES = 16 << 20
_MAX_IDLE_LANES = 256
_MOST_OUTCOMES = 4096
_BEST_EFFORT_PATIENCE_S = 1.0

PATIENCE = 4
"""How many times as often a packet of a large message is repeated while its destination lives: a
packet in three frames is lost often where one frame in five is."""

OFTEN_ANSWERED = 3
"""Answers without any acknowledgement after which a peer is taken for one that sends none."""


@dataclass(slots=True)
class Outcome:
    """How many messages from one component to another were acknowledged, late, or never.

    Those that are answered instead have arrived; those of which nothing came may have as well.
    """

    acknowledged: int = 0
    answered: int = 0
    late: int = 0  # messages that were acknowledged when they had been given up
    unacknowledged: int = 0


class Outbox:
    """Repeats packets until they are acknowledged (AS5669A, acknowledge and retry).

    A packet is repeated with its sequence number after ``acknowledge_timeout`` and given up after
    ``acknowledge_retries`` repetitions, of which the last one also searches by multicast; one of
    several packets of a message is given more of them while its destination lives. With it goes all
    that waits for a destination of which nothing was heard meanwhile. The lane of each destination
    says which packets are under way at once. What is given up though its destination lives is
    watched for a while: over a long way the acknowledgement is late, and the message is not lost.
    An answer is as good as an acknowledgement, which may be on its way as well: instead of being
    repeated when its time has come, what was answered is done. Callable from any thread; results
    are reported on the loop's thread.
    """

    def __init__(
        self, settings: TransportSettings, loop: Loop, carrier: Carrier[Any], quirks: Quirks
    ) -> None:
        """Starts with nothing to wait for; the carrier may search for a destination in the end."""
        self._timeout = settings.acknowledge_timeout
        self._retries = settings.acknowledge_retries
        self._patience = PATIENCE * (self._retries + 1) * self._timeout
        self._loop = loop
        self._carrier = carrier
        self._quirks = quirks
        # By source and destination, of 4,096 pairs at most.
        self.outcomes: dict[tuple[int, int], Outcome] = {}
        self._lock = threading.Lock()
        self._lanes: dict[JausAddress, Lane] = {}
        self._flights: dict[Key, Flight] = {}  # in the order in which they are due
        self._timer: Timer | None = None
        self._overdue: dict[Key, tuple[float, Message]] = {}  # in the order of their ends
        self._overdue_timer: Timer | None = None
        self._messages: dict[Message, None] = {}  # in the order of sending
        self._size = 0

    def __len__(self) -> int:
        return len(self._messages)

    def has_large(self, destination: JausAddress) -> bool:
        """Returns whether a message of several packets is under way to a destination."""
        lane = self._lanes.get(destination)
        return lane is not None and lane.has_large

    def send(
        self,
        packets: list[Packet],
        on_result: OnResult | None,
        *,
        best_effort: bool = False,
        supersedes: bool = False,
    ) -> None:
        """Sends the packets of one message, which ask for acknowledgement, when it is their turn.

        Args:
            on_result: Told once whether all packets were acknowledged.
            best_effort: Whether it must be quick or not at all: as many packets as the destination
                takes are under way at once instead of one, and it waits a second for its turn.
            supersedes: Whether those before it with its code are withdrawn, and it goes in front.
        """
        if supersedes:
            first = packets[0]
            code = first.payload[:MESSAGE_CODE_SIZE]
            self.withdraw(first.source, first.destination, code)
        message = Message(packets, on_result, is_best_effort=best_effort, is_urgent=supersedes)
        if best_effort:
            message.latest = self._loop.now() + _BEST_EFFORT_PATIENCE_S
        destination = packets[0].destination
        with self._lock:
            is_taken = self._has_room_for(message)
            ready = self._put(message, destination) if is_taken else []
        if not is_taken:
            self._loop.counters.count("transport.too_many_unacknowledged", str(destination))
            report(self._loop, message.on_result, success=False)
        self._transmit(ready)

    def acknowledged(self, component: int, sequence: int, by: int) -> bool:
        """Takes an acknowledgement; returns whether a packet waited for it."""
        with self._lock:
            flights = self._flights
            # What went to a wildcard is acknowledged by a component, whose key it does not have.
            flight = flights.get((component, by, sequence)) or flights.get((component, 0, sequence))
            if flight is None:
                return self._is_late((component, by, sequence), (component, 0, sequence))
            message, destination = flight.message, flight.packet.destination
            # Somebody acknowledges what went to others.
            if destination != by and not destination.matches(address_of(by)):
                return False
            del self._flights[flight.key]
            message.under_way -= 1
            lane = self._lanes[destination]
            lane.heard = self._loop.now()
            is_done = message.is_done
            if is_done:
                self._forget(message, lane)
                lane.arrived(message)
                self._outcome_of(message).acknowledged += 1
            ready = self._take_off(lane, destination) if lane.waits else []
        if is_done:
            report(self._loop, message.on_result, success=True)
        self._transmit(ready)
        return True

    def answered(self, source: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Learns that a message that begins so was answered; no effect when it does not wait."""
        with self._lock:
            for flight in self._flights.values():
                packet = flight.packet
                if (
                    (packet.source, packet.destination) == (source, peer)
                    and not flight.message.is_large
                    and packet.payload.startswith(start)
                ):
                    flight.is_answered = True

    def withdraw(self, source: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Gives up messages that begin so: none is repeated, and those that wait are not sent."""
        now = self._loop.now()
        withdrawn: list[tuple[Message, Flight | None]] = []
        ready: list[Packet] = []
        with self._lock:
            lane = self._lanes.get(peer)
            if lane is None:
                return
            for message in tuple(self._messages):
                first = message.packets[0]
                ends = first.source, first.destination
                if ends == (source, peer) and first.payload.startswith(start):
                    withdrawn.append((message, self._flights.get(key_of(first))))
                    self._abandon(message, lane)
            if withdrawn:
                ready = self._take_off(lane, peer)
        for message, flight in withdrawn:
            self._end_unacknowledged(message, flight, now)
        self._transmit(ready)

    def close(self) -> None:
        """Gives up everything; the results are reported."""
        with self._lock:
            abandoned = list(self._messages)
            self._flights.clear()
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            if self._overdue_timer is not None:
                self._overdue_timer.cancel()
                self._overdue_timer = None
            overdue = [message for _, message in self._overdue.values()]
            self._overdue.clear()
            self._messages.clear()
            self._lanes.clear()
            self._size = 0
        for message in overdue:
            self._count_unacknowledged(message)
        for message in abandoned:
            report(self._loop, message.on_result, success=False)

    def _has_room_for(self, message: Message) -> bool:
        """Whether a message may wait; one alone may be of any size."""
        fits = self._size + message.size <= _MAX_BYTES or not self._size
        return fits and len(self._messages) < _MAX_MESSAGES

    def _put(self, message: Message, destination: JausAddress) -> list[Packet]:
        lane = self._lanes.get(destination)
        if lane is None:
            lane = self._add_lane(destination)
        self._messages[message] = None
        self._size += message.size
        lane.add(message)
        return self._take_off(lane, destination)

    def _add_lane(self, destination: JausAddress) -> Lane:
        if len(self._lanes) >= _MAX_IDLE_LANES:
            self._lanes = {
                address: lane for address, lane in self._lanes.items() if not lane.is_empty
            }
        lane = self._lanes[destination] = Lane()
        return lane

    def _take_off(self, lane: Lane, destination: JausAddress) -> list[Packet]:
        """Returns the packets that are to be transmitted now."""
        now = self._loop.now()
        if lane.has_large:
            self._give_up_late(lane, destination, now)
        ready = lane.ready()
        due = now + self._timeout
        for message, packet in ready:
            flight = Flight(message, packet, key_of(packet), now, due)
            self._flights[flight.key] = flight
        if ready and self._timer is None:
            self._timer = self._loop.call_later(self._timeout, self._expire)
        return [packet for _, packet in ready]

    def _give_up_late(self, lane: Lane, destination: JausAddress, now: float) -> None:
        for message in lane.give_up_late(now):
            self._drop(message)
            self._loop.counters.count("transport.too_late", f"a message to {destination}")
            report(self._loop, message.on_result, success=False)

    def _land(self, flight: Flight) -> None:
        del self._flights[flight.key]
        flight.message.under_way -= 1

    def _forget(self, message: Message, lane: Lane) -> None:
        lane.remove(message)
        self._drop(message)

    def _drop(self, message: Message) -> None:
        self._messages.pop(message, None)
        self._size -= message.size

    def _expire(self) -> None:
        """Repeats or gives up what is due; the next flight that will be has the timer then.

        One timer serves all: each flight waits for the same time, from when it was sent last.
        """
        now = self._loop.now()
        while True:
            # The lock is free between two flights: others send meanwhile.
            with self._lock:
                flight = next(iter(self._flights.values()), None)
                if flight is None:
                    self._timer = None
                    return
                if flight.due > now:
                    self._timer = self._loop.call_at(flight.due, self._expire)
                    return
            self._expired(flight, now)

    def _expired(self, flight: Flight, now: float) -> None:
        given_up: list[Message] = []
        ready: list[Packet] = []
        packet = flight.packet
        with self._lock:
            # Acknowledged or given up since it was looked at.
            if self._flights.get(flight.key) is not flight:
                return
            is_patient = flight.message.is_large and self._is_alive(flight, now)
            patience = PATIENCE if is_patient else 1
            if flight.is_answered:
                self._end_answered(flight)
                ready = self._take_off(self._lanes[packet.destination], packet.destination)
            elif flight.repetitions < patience * self._retries:
                flight.repetitions += 1
                flight.message.is_repeated = True
                flight.due = now + self._timeout
                # To the end, which keeps flights in the order in which they are due.
                self._flights[flight.key] = self._flights.pop(flight.key)
                ready = [packet]
                self._loop.counters.add("transport.repeated")
            else:
                given_up = self._give_up(flight)
                ready = self._take_off(self._lanes[packet.destination], packet.destination)
        if flight.is_answered:
            report(self._loop, flight.message.on_result, success=True)
        elif flight.repetitions == self._retries and not is_patient:
            self._carrier.suspect(packet.destination, flight.since)
        for message in given_up:
            self._end_unacknowledged(message, flight, now)
        self._transmit(ready)

    def _end_answered(self, flight: Flight) -> None:
        """Is done with a message whose answer came, and no acknowledgement in its time."""
        self._land(flight)
        self._forget(flight.message, self._lanes[flight.packet.destination])
        outcome = self._outcome_of(flight.message)
        outcome.answered += 1
        if outcome.answered >= OFTEN_ANSWERED and not outcome.acknowledged:
            how = f"{outcome.answered} answers and no acknowledgement"
            self._quirks.learn(flight.packet.destination, Quirk.NO_ACKNOWLEDGEMENTS, how)

    def _count_unacknowledged(self, message: Message) -> None:
        self._loop.counters.count("transport.unacknowledged", f"{message.packets[0].destination}")
        self._outcome_of(message).unacknowledged += 1

    def _end_unacknowledged(self, message: Message, flight: Flight | None, now: float) -> None:
        """Reports a message that was given up; one that was under way is watched."""
        if flight is None or not self._watch(message, flight, now):
            self._count_unacknowledged(message)
        report(self._loop, message.on_result, success=False)

    def _watch(self, message: Message, flight: Flight, now: float) -> bool:
        """Waits on for the acknowledgement of a message that was given up, if it may come."""
        with self._lock:
            if message.is_large or message is not flight.message or not self._is_alive(flight, now):
                return False
            if len(self._overdue) >= _MAX_MESSAGES:
                return False
            self._overdue[flight.key] = now + self._patience, message
            if self._overdue_timer is None:
                self._overdue_timer = self._loop.call_later(self._patience, self._end_overdue)
            return True

    def _is_late(self, *keys: Key) -> bool:
        """Whether an acknowledgement is of a message that was given up and is watched."""
        for key in keys:
            if key in self._overdue:
                self._outcome_of(self._overdue.pop(key)[1]).late += 1
                self._loop.counters.add("transport.acknowledged_late")
                return True
        return False

    def _end_overdue(self) -> None:
        now = self._loop.now()
        with self._lock:
            ended = [key for key, (end, _) in self._overdue.items() if end <= now]
            messages = [self._overdue.pop(key)[1] for key in ended]
            self._overdue_timer = None
            if self._overdue:
                end, _ = next(iter(self._overdue.values()))
                self._overdue_timer = self._loop.call_at(end, self._end_overdue)
        for message in messages:
            self._count_unacknowledged(message)

    def _is_alive(self, flight: Flight, now: float) -> bool:
        """Returns whether the destination was heard in the time that a packet may take."""
        destination = flight.packet.destination
        heard, lane = self._carrier.heard(destination), self._lanes.get(destination)
        if lane is not None:  # where nothing waits it may have made room for others since
            heard = max(heard, lane.heard)
        return heard >= now - self._patience

    def _give_up(self, flight: Flight) -> list[Message]:
        """Forgets a message, and what waits behind it if its destination is silent."""
        message = flight.message
        lane = self._lanes[flight.packet.destination]
        self._abandon(message, lane)
        is_alive = self._is_alive(flight, self._loop.now())
        waiting = [] if is_alive else lane.waiting
        for queued_message in waiting:
            self._abandon(queued_message, lane)
        return [message, *waiting]

    def _abandon(self, message: Message, lane: Lane) -> None:
        """Forgets a message with what is under way of it."""
        for packet in message.packets[: message.sent]:
            flight = self._flights.get(key_of(packet))
            # Numbers come again: the key may be that of a newer message.
            if flight is not None and flight.message is message:
                self._land(flight)
        self._forget(message, lane)

    def _outcome_of(self, message: Message) -> Outcome:
        packet = message.packets[0]
        pair = packet.source, packet.destination
        known = self.outcomes.get(pair)
        if known is None:
            known = Outcome()
            # Beyond the limit nobody is remembered: strangers must not fill the memory.
            if len(self.outcomes) < _MOST_OUTCOMES:
                self.outcomes[pair] = known
        return known

    def _transmit(self, packets: list[Packet]) -> None:
        """Puts packets on the network; without the lock, since the loop may be waiting for it."""
        for packet in packets:
            self._carrier.transmit(packet)
