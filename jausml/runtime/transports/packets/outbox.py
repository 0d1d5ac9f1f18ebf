"""Outbox: repeats packets until they are acknowledged or given up."""

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

_MAX_MESSAGES = 4096  # unacknowledged messages, and as many that wait for a late acknowledgement
_MAX_BYTES = 16 << 20  # bytes of unacknowledged messages
_MAX_IDLE_LANES = 256
_MAX_OUTCOMES = 4096  # pairs of source and destination whose outcomes are counted
_BEST_EFFORT_PATIENCE_S = 1.0  # seconds that a best-effort message waits in the queue

# Factor of repetitions for a packet of a large message while its destination lives: such a packet
# may take three frames, and is lost more often.
PATIENCE = 4
OFTEN_ANSWERED = 3  # answers without any acknowledgement after which a peer is known to send none


@dataclass(slots=True)
class Outcome:
    """Counts of messages from one component to another by their acknowledgement.

    Answered messages have arrived; unacknowledged ones may have arrived too.
    """

    acknowledged: int = 0
    answered: int = 0
    late: int = 0  # acknowledged after they were given up
    unacknowledged: int = 0


class Outbox:
    """Repeats packets until they are acknowledged (AS5669A, acknowledge and retry).

    A packet is repeated with its sequence number after ``acknowledge_timeout`` and given up after
    ``acknowledge_retries`` repetitions, the last of which also searches for its destination by
    multicast. Packets of large messages are repeated more often while their destination lives. With
    a packet, all messages to its destination are given up if that was silent meanwhile.

    The `Lane` of each destination decides which packets are under way at once. A late
    acknowledgement of a message that was given up is counted for a while. A message that was
    answered is not repeated, even without an acknowledgement.

    Callable from any thread; results are reported on the thread of the loop.
    """

    def __init__(
        self, settings: TransportSettings, loop: Loop, carrier: Carrier[Any], quirks: Quirks
    ) -> None:
        """Starts without messages."""
        self._timeout = settings.acknowledge_timeout
        self._retries = settings.acknowledge_retries
        self._patience = PATIENCE * (self._retries + 1) * self._timeout
        self._loop = loop
        self._carrier = carrier
        self._quirks = quirks
        self.outcomes: dict[tuple[int, int], Outcome] = {}  # by source and destination
        self._lock = threading.Lock()
        self._lanes: dict[JausAddress, Lane] = {}
        self._flights: dict[Key, Flight] = {}  # in the order of their due times
        self._timer: Timer | None = None
        self._overdue: dict[Key, tuple[float, Message]] = {}  # given up; in the order of their ends
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
        """Sends the packets of one message, which request acknowledgement, in its turn.

        Args:
            on_result: Called once with whether all packets were acknowledged.
            best_effort: Whether as many packets as the destination takes are under way at once,
                instead of one, and the message is dropped after a second in the queue.
            supersedes: Whether earlier messages with the same code are withdrawn, and this one is
                sent first.
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
            fits = self._has_room_for(message)
            ready = self._put(message, destination) if fits else []
        if not fits:
            self._loop.counters.count("transport.too_many_unacknowledged", str(destination))
            report(self._loop, message.on_result, success=False)
        self._transmit(ready)

    def acknowledged(self, component: int, sequence: int, by: int) -> bool:
        """Takes an acknowledgement; returns whether a packet was waiting for it."""
        with self._lock:
            flights = self._flights
            # A packet to a wildcard is acknowledged by a component, but has the key 0.
            flight = flights.get((component, by, sequence)) or flights.get((component, 0, sequence))
            if flight is None:
                return self._is_late((component, by, sequence), (component, 0, sequence))
            message, destination = flight.message, flight.packet.destination
            # Acknowledged by a component that is not its destination.
            if destination != by and not destination.matches(address_of(by)):
                return False
            del self._flights[flight.key]
            message.under_way -= 1
            lane = self._lanes[destination]
            lane.heard = self._loop.now()
            is_done = message.is_done
            if is_done:
                self._forget(message, lane)
                lane.widen(message)
                self._outcome_of(message).acknowledged += 1
            ready = self._next_packets(lane, destination) if lane.waits else []
        if is_done:
            report(self._loop, message.on_result, success=True)
        self._transmit(ready)
        return True

    def answered(self, source: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Marks waiting messages with a begin of their payload as answered by a peer."""
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
        """Gives up messages with a begin of their payload: they are neither sent nor repeated."""
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
                ready = self._next_packets(lane, peer)
        for message, flight in withdrawn:
            self._end_unacknowledged(message, flight, now)
        self._transmit(ready)

    def close(self) -> None:
        """Gives up all messages, and reports their results."""
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
        """Returns whether the queue has room for a message; a single one may have any size."""
        fits = self._size + message.size <= _MAX_BYTES or not self._size
        return fits and len(self._messages) < _MAX_MESSAGES

    def _put(self, message: Message, destination: JausAddress) -> list[Packet]:
        lane = self._lanes.get(destination)
        if lane is None:
            lane = self._add_lane(destination)
        self._messages[message] = None
        self._size += message.size
        lane.add(message)
        return self._next_packets(lane, destination)

    def _add_lane(self, destination: JausAddress) -> Lane:
        if len(self._lanes) >= _MAX_IDLE_LANES:
            self._lanes = {
                address: lane for address, lane in self._lanes.items() if not lane.is_empty
            }
        lane = self._lanes[destination] = Lane()
        return lane

    def _next_packets(self, lane: Lane, destination: JausAddress) -> list[Packet]:
        """Returns the packets to be transmitted now, which are under way then."""
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
        """Repeats or gives up packets that are due, and sets the timer for the next one.

        One timer suffices, as each packet waits for the same time after it was sent.
        """
        now = self._loop.now()
        while True:
            # The lock is free between two flights, so that other threads can send.
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
            # Acknowledged or given up meanwhile.
            if self._flights.get(flight.key) is not flight:
                return
            is_patient = flight.message.is_large and self._is_alive(flight, now)
            patience = PATIENCE if is_patient else 1
            if flight.is_answered:
                self._end_answered(flight)
                ready = self._next_packets(self._lanes[packet.destination], packet.destination)
            elif flight.repetitions < patience * self._retries:
                flight.repetitions += 1
                flight.message.is_repeated = True
                flight.due = now + self._timeout
                # To the end, in the order of due times.
                self._flights[flight.key] = self._flights.pop(flight.key)
                ready = [packet]
                self._loop.counters.add("transport.repeated")
            else:
                given_up = self._give_up(flight)
                ready = self._next_packets(self._lanes[packet.destination], packet.destination)
        if flight.is_answered:
            report(self._loop, flight.message.on_result, success=True)
        elif flight.repetitions == self._retries and not is_patient:
            self._carrier.suspect(packet.destination, flight.since)
        for message in given_up:
            self._end_unacknowledged(message, flight, now)
        self._transmit(ready)

    def _end_answered(self, flight: Flight) -> None:
        """Ends a message that was answered, but not acknowledged in time."""
        self._land(flight)
        self._forget(flight.message, self._lanes[flight.packet.destination])
        outcome = self._outcome_of(flight.message)
        outcome.answered += 1
        if outcome.answered >= OFTEN_ANSWERED and not outcome.acknowledged:
            evidence = f"{outcome.answered} answers and no acknowledgement"
            self._quirks.learn(flight.packet.destination, Quirk.NO_ACKNOWLEDGEMENTS, evidence)

    def _count_unacknowledged(self, message: Message) -> None:
        self._loop.counters.count("transport.unacknowledged", f"{message.packets[0].destination}")
        self._outcome_of(message).unacknowledged += 1

    def _end_unacknowledged(self, message: Message, flight: Flight | None, now: float) -> None:
        """Reports a message that was given up; waits for a late acknowledgement if one may come."""
        if flight is None or not self._watch(message, flight, now):
            self._count_unacknowledged(message)
        report(self._loop, message.on_result, success=False)

    def _watch(self, message: Message, flight: Flight, now: float) -> bool:
        """Waits for a late acknowledgement of a message; returns False if none may come."""
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
        """Returns whether an acknowledgement is a late one, which is counted."""
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
        """Returns whether the destination was heard while a packet may be repeated."""
        destination = flight.packet.destination
        heard, lane = self._carrier.heard(destination), self._lanes.get(destination)
        if lane is not None:  # an idle lane may have been removed
            heard = max(heard, lane.heard)
        return heard >= now - self._patience

    def _give_up(self, flight: Flight) -> list[Message]:
        """Returns a message to give up, with all waiting ones if its destination is silent."""
        message = flight.message
        lane = self._lanes[flight.packet.destination]
        self._abandon(message, lane)
        is_alive = self._is_alive(flight, self._loop.now())
        waiting = [] if is_alive else lane.waiting
        for queued_message in waiting:
            self._abandon(queued_message, lane)
        return [message, *waiting]

    def _abandon(self, message: Message, lane: Lane) -> None:
        """Forgets a message and its packets under way."""
        for packet in message.packets[: message.sent]:
            flight = self._flights.get(key_of(packet))
            # Numbers wrap, so that the key may be that of a newer message.
            if flight is not None and flight.message is message:
                self._land(flight)
        self._forget(message, lane)

    def _outcome_of(self, message: Message) -> Outcome:
        packet = message.packets[0]
        pair = packet.source, packet.destination
        outcome = self.outcomes.get(pair)
        if outcome is None:
            outcome = Outcome()
            # Limited, as strangers must not fill the memory.
            if len(self.outcomes) < _MAX_OUTCOMES:
                self.outcomes[pair] = outcome
        return outcome

    def _transmit(self, packets: list[Packet]) -> None:
        """Sends packets; called without the lock, for which the loop may be waiting."""
        for packet in packets:
            self._carrier.transmit(packet)
