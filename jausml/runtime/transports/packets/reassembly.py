"""Reassembly of messages of several packets (fragments)."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field

from ...base.address import address_of
from ...base.counters import Counters
from .packet import FLAGS, PLACE_MASK, DataFlags, Packet

Pair = tuple[int, int]  # source and destination
Whole = tuple[bytes, int, int]  # payload of a message, and number and flags of its first packet

_FIRST, _MIDDLE, _LAST = (place << 6 for place in list(DataFlags)[1:])
_FRAGMENT_OVERHEAD = 400  # bytes counted for each fragment besides its payload
_MAX_STREAMS = 256
_MAX_FRAGMENTS = 32768
_TOTAL_FACTOR = 4


class _OrderedFragments:
    """Fragments of one message that have come in order, from the first one on."""

    __slots__ = ("flags", "following", "parts", "size", "start", "updated")

    def __init__(self, flags: int, start: int, payload: bytes, now: float) -> None:
        self.flags = flags
        self.start = start
        self.following = start + 1 & 0xFFFF
        self.parts = [payload]
        self.size = len(payload) + _FRAGMENT_OVERHEAD
        self.updated = now

    def __len__(self) -> int:
        return len(self.parts)


@dataclass(slots=True, eq=False)
class _Run:
    """Fragments with consecutive sequence numbers, from ``start`` to ``end``."""

    start: int
    end: int
    updated: float
    flags: int = 0  # of the first packet of a message, if the run has it
    closed: bool = False  # whether the run has the last packet of a message


@dataclass(slots=True, eq=False)
class _Stream:
    """Fragments of one pair in any order, and the runs that they form."""

    fragments: dict[int, bytes] = field(default_factory=dict)
    by_start: dict[int, _Run] = field(default_factory=dict)
    by_end: dict[int, _Run] = field(default_factory=dict)
    size: int = 0

    @classmethod
    def of(cls, ordered: _OrderedFragments) -> _Stream:
        """Returns a stream with fragments that have come in order so far."""
        stream, flags = cls(), ordered.flags
        for number, payload in enumerate(ordered.parts, ordered.start):
            stream.add(flags, number & 0xFFFF, payload, ordered.updated)
            flags = _MIDDLE
        return stream

    def __len__(self) -> int:
        return len(self.fragments)

    def add(self, flags: int, number: int, payload: bytes, now: float) -> _Run:
        """Adds a fragment, and returns its run."""
        by_start, by_end, place = self.by_start, self.by_end, flags & PLACE_MASK
        self.fragments[number] = payload
        self.size += len(payload) + _FRAGMENT_OVERHEAD
        # A first packet never continues a run.
        run = None if place == _FIRST else by_end.get(number - 1 & 0xFFFF)
        if run is None or run.closed:
            run = by_start[number] = _Run(number, number, now)
            if place == _FIRST:
                run.flags = flags
        else:
            del by_end[run.end]
            run.end, run.updated = number, now
        if place == _LAST:
            run.closed = True
        else:
            after = by_start.get(number + 1 & 0xFFFF)
            if after is not None and not after.flags:
                # A run with a first packet would be another message.
                del by_start[after.start]
                run.end, run.closed = after.end, after.closed
        by_end[run.end] = run
        return run

    def run_of(self, number: int) -> _Run:
        while number not in self.by_start:
            number = number - 1 & 0xFFFF
        return self.by_start[number]

    def remove(self, run: _Run) -> list[bytes]:
        del self.by_start[run.start], self.by_end[run.end]
        count = (run.end - run.start & 0xFFFF) + 1
        take = self.fragments.pop
        parts = [take(number & 0xFFFF) for number in range(run.start, run.start + count)]
        self.size -= sum(map(len, parts)) + count * _FRAGMENT_OVERHEAD
        return parts


class Reassembly:
    """Collects the fragments of each pair until a message is complete (AS5669A, data flags).

    Fragments have neither an offset nor a total: a message is a run of consecutive sequence numbers
    from a first to a last packet, which may come in any order. Discards are counted as
    ``transport.reassembly_timeout``, ``transport.reassembly_overflow``, or
    ``transport.reassembly_stale`` (a number came again with other content). Each fragment, counted
    as ``transport.fragments``, is held, or counted as ``transport.fragments_assembled`` or
    ``transport.fragments_discarded``.
    """

    def __init__(self, timeout: float, limit: int, counters: Counters) -> None:
        """Discards incomplete messages after `timeout` seconds, or beyond `limit` bytes."""
        self._timeout = timeout
        self.limit = limit
        self._counters = counters
        self._taken = counters.tally("transport.fragments")
        self._assembled = counters.tally("transport.fragments_assembled")
        self._finished = counters.tally("transport.reassembled")
        self._held: OrderedDict[Pair, _OrderedFragments | _Stream] = OrderedDict()
        self.size = 0

    def note_whole(self, count: int) -> None:
        """Counts a message of so many fragments that the core has reassembled."""
        self._taken.count += count
        self._assembled.count += count
        self._finished.count += 1

    def __len__(self) -> int:
        return sum(map(len, self._held.values()))

    def add(self, packet: Packet, now: float) -> Packet | None:
        """Takes a fragment; returns the message that it completes, or None.

        The message has the sequence number, priority and destination of its first packet.
        """
        pair = packet.source, packet.destination
        whole = self._put(pair, packet.flags, packet.sequence, packet.payload, now)
        if whole is None:
            return None
        payload, sequence, first = whole
        flags = FLAGS[first & ~PLACE_MASK]
        return Packet(packet.destination, packet.source, payload, sequence, *flags)

    def _put(
        self, pair: Pair, flags: int, sequence: int, payload: bytes, now: float
    ) -> Whole | None:
        """Takes a fragment, which usually comes in order."""
        place, held = flags & PLACE_MASK, self._held
        ordered = held.get(pair)
        if ordered is None and place == _FIRST:
            ordered = held[pair] = _OrderedFragments(flags, sequence, payload, now)
            self.size += ordered.size
        elif (
            type(ordered) is _OrderedFragments and ordered.following == sequence and place != _FIRST
        ):
            ordered.parts.append(payload)
            if place == _LAST:
                del held[pair]
                self.size -= ordered.size
                self._taken.count += 1
                return self._whole(ordered.parts, ordered.start, ordered.flags)
            ordered.following, ordered.updated = sequence + 1 & 0xFFFF, now
            cost = len(payload) + _FRAGMENT_OVERHEAD
            ordered.size += cost
            self.size += cost
            held.move_to_end(pair)
        else:
            return self._put_in_stream(pair, flags, sequence, payload, now)
        self._taken.count += 1
        # Cheap comparisons first, below which no limit can be exceeded.
        if (
            self.size > self.limit
            or len(ordered.parts) > _MAX_FRAGMENTS
            or len(held) > _MAX_STREAMS
        ):
            self._enforce_limits(pair, ordered)
        return None

    def _put_in_stream(
        self, pair: Pair, flags: int, sequence: int, payload: bytes, now: float
    ) -> Whole | None:
        stream = self._held.get(pair)
        if not isinstance(stream, _Stream):
            # Out of order: fragments are kept by number from here on.
            stream = self._held[pair] = _Stream() if stream is None else _Stream.of(stream)
        if sequence in stream.fragments:
            if stream.fragments[sequence] == payload:
                self._counters.add("transport.duplicate")
                return None
            self._discard_stale(pair, stream, sequence)
        self._held.move_to_end(pair)
        self._taken.count += 1
        self.size += len(payload) + _FRAGMENT_OVERHEAD
        run = stream.add(flags, sequence, payload, now)
        if run.closed and run.flags:
            parts = self._remove(stream, run)
            if not stream.fragments:
                del self._held[pair]
            return self._whole(parts, run.start, run.flags)
        self._enforce_limits(pair, stream)
        return None

    def _whole(self, parts: list[bytes], start: int, flags: int) -> Whole:
        self._assembled.count += len(parts)
        self._finished.count += 1
        return b"".join(parts), start, flags

    def expire(self, now: float) -> None:
        """Discards messages that have made no progress for the timeout."""
        for pair, held in list(self._held.items()):
            if isinstance(held, _OrderedFragments):
                if now - held.updated >= self._timeout:
                    del self._held[pair]
                    self.size -= held.size
                    self._count_expired(pair, len(held))
                continue
            runs = held.by_start.values()
            for run in [run for run in runs if now - run.updated >= self._timeout]:
                self._count_expired(pair, len(self._remove(held, run)))
            if not held.fragments:
                del self._held[pair]

    def _count_expired(self, pair: Pair, count: int) -> None:
        self._counters.add("transport.fragments_discarded", count)
        self._counters.count(
            "transport.reassembly_timeout", f"{count} fragments of {address_of(pair[0])}"
        )

    def _discard_stale(self, pair: Pair, stream: _Stream, sequence: int) -> None:
        """Discards a run of a source that has restarted and uses its numbers again."""
        count = len(self._remove(stream, stream.run_of(sequence)))
        self._counters.add("transport.fragments_discarded", count)
        self._counters.count(
            "transport.reassembly_stale", f"{count} fragments of {address_of(pair[0])}"
        )

    def _remove(self, stream: _Stream, run: _Run) -> list[bytes]:
        before = stream.size
        parts = stream.remove(run)
        self.size -= before - stream.size
        return parts

    def _enforce_limits(self, pair: Pair, held: _OrderedFragments | _Stream) -> None:
        if held.size > self.limit or len(held) > _MAX_FRAGMENTS:
            self._discard(pair)
        while self.size > self.limit * _TOTAL_FACTOR or len(self._held) > _MAX_STREAMS:
            # The longest silent pair is first.
            self._discard(next(iter(self._held)))

    def _discard(self, pair: Pair) -> None:
        held = self._held.pop(pair)
        self.size -= held.size
        self._counters.add("transport.fragments_discarded", len(held))
        self._counters.count(
            "transport.reassembly_overflow", f"{held.size} bytes of {address_of(pair[0])}"
        )
