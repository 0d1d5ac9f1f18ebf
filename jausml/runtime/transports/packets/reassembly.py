"""Messages of several packets: putting their fragments together."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field

from ...base.address import address_of
from ...base.counters import Counters
from .packet import FLAGS, PLACE_MASK, DataFlags, Packet

Way = tuple[int, int]  # source and destination
Whole = tuple[bytes, int, int]  # payload of a message, and number and flags of its first packet

_FIRST, _MIDDLE, _LAST = (place << 6 for place in list(DataFlags)[1:])
# Counted for each fragment: a flood of tiny ones takes memory beyond its payload.
_FRAGMENT_OVERHEAD = 400
_MAX_STREAMS = 256
_MAX_FRAGMENTS = 32768
_TOTAL_FACTOR = 4


class _Line:
    """Fragments of one message that came in their order, from the first one on."""

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
    """Fragments with consecutive sequence numbers, from ``start`` to ``end``.

    ``flags`` are those of the first packet of a message where the run has it, else 0; it is
    ``closed`` with the last one.
    """

    start: int
    end: int
    updated: float
    flags: int = 0
    closed: bool = False


@dataclass(slots=True, eq=False)
class _Stream:
    """Fragments of one source to one destination, and the runs that they form."""

    fragments: dict[int, bytes] = field(default_factory=dict)
    by_start: dict[int, _Run] = field(default_factory=dict)
    by_end: dict[int, _Run] = field(default_factory=dict)
    size: int = 0

    @classmethod
    def of(cls, line: _Line) -> _Stream:
        """Returns a stream with what came in order so far."""
        stream, flags = cls(), line.flags
        for number, payload in enumerate(line.parts, line.start):
            stream.add(flags, number & 0xFFFF, payload, line.updated)
            flags = _MIDDLE
        return stream

    def __len__(self) -> int:
        return len(self.fragments)

    def add(self, flags: int, number: int, payload: bytes, now: float) -> _Run:
        """Keeps a fragment and returns the run that it belongs to now."""
        by_start, by_end, place = self.by_start, self.by_end, flags & PLACE_MASK
        self.fragments[number] = payload
        self.size += len(payload) + _FRAGMENT_OVERHEAD
        # A first packet continues no run, whatever number came before it.
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
                # One that begins with a first packet would be another message.
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
    """Collects the fragments of each way until a message is whole (AS5669A, data flags).

    Fragments carry neither an offset nor a total: a message is the run of consecutive sequence
    numbers from a first to a last packet, in whatever order they arrive. Discards are counted:
    ``transport.reassembly_timeout``, ``transport.reassembly_overflow``, and
    ``transport.reassembly_stale``, others of a number that came again. Of the fragments taken,
    ``transport.fragments``, each is held, or among ``transport.fragments_assembled`` or
    ``transport.fragments_discarded``.
    """

    def __init__(self, timeout: float, limit: int, counters: Counters) -> None:
        """Discards what makes no progress for so many seconds, or is of too many bytes."""
        self._timeout = timeout
        self.limit = limit
        self._counters = counters
        self._taken = counters.tally("transport.fragments")
        self._assembled = counters.tally("transport.fragments_assembled")
        self._finished = counters.tally("transport.reassembled")
        self._held: OrderedDict[Way, _Line | _Stream] = OrderedDict()
        self.size = 0

    def note_whole(self, count: int) -> None:
        """Counts a message of so many fragments that was put together elsewhere."""
        self._taken.count += count
        self._assembled.count += count
        self._finished.count += 1

    def __len__(self) -> int:
        return sum(map(len, self._held.values()))

    def add(self, packet: Packet, now: float) -> Packet | None:
        """Takes a fragment and returns the whole message that it completes, if it does.

        The message has the sequence number, priority and destination of its first packet.
        """
        way = packet.source, packet.destination
        whole = self._put(way, packet.flags, packet.sequence, packet.payload, now)
        if whole is None:
            return None
        payload, sequence, first = whole
        said = FLAGS[first & ~PLACE_MASK]
        return Packet(packet.destination, packet.source, payload, sequence, *said)

    def _put(self, way: Way, flags: int, sequence: int, payload: bytes, now: float) -> Whole | None:
        """Takes a fragment.

        Nearly all come in their order: those of a message are in a line then, which ends with it.
        """
        place, held = flags & PLACE_MASK, self._held
        line = held.get(way)
        if line is None and place == _FIRST:
            line = held[way] = _Line(flags, sequence, payload, now)
            self.size += line.size
        elif type(line) is _Line and line.following == sequence and place != _FIRST:
            line.parts.append(payload)
            if place == _LAST:
                del held[way]
                self.size -= line.size
                self._taken.count += 1
                return self._whole(line.parts, line.start, line.flags)
            line.following, line.updated = sequence + 1 & 0xFFFF, now
            cost = len(payload) + _FRAGMENT_OVERHEAD
            line.size += cost
            self.size += cost
            held.move_to_end(way)
        else:
            return self._put_in_stream(way, flags, sequence, payload, now)
        self._taken.count += 1
        # The cheap comparisons first: below these limits nothing can be too much.
        if self.size > self.limit or len(line.parts) > _MAX_FRAGMENTS or len(held) > _MAX_STREAMS:
            self._enforce_limits(way, line)
        return None

    def _put_in_stream(
        self, way: Way, flags: int, sequence: int, payload: bytes, now: float
    ) -> Whole | None:
        stream = self._held.get(way)
        if not isinstance(stream, _Stream):
            # Out of order: what came in a line is kept by its numbers from here on.
            stream = self._held[way] = _Stream() if stream is None else _Stream.of(stream)
        if sequence in stream.fragments:
            if stream.fragments[sequence] == payload:
                self._counters.add("transport.duplicate")
                return None
            self._discard_stale(way, stream, sequence)
        self._held.move_to_end(way)
        self._taken.count += 1
        self.size += len(payload) + _FRAGMENT_OVERHEAD
        run = stream.add(flags, sequence, payload, now)
        if run.closed and run.flags:
            parts = self._remove(stream, run)
            if not stream.fragments:
                del self._held[way]
            return self._whole(parts, run.start, run.flags)
        self._enforce_limits(way, stream)
        return None

    def _whole(self, parts: list[bytes], start: int, flags: int) -> Whole:
        self._assembled.count += len(parts)
        self._finished.count += 1
        return b"".join(parts), start, flags

    def expire(self, now: float) -> None:
        """Discards what has not grown for the timeout."""
        for way, held in list(self._held.items()):
            if isinstance(held, _Line):
                if now - held.updated >= self._timeout:
                    del self._held[way]
                    self.size -= held.size
                    self._count_expired(way, len(held))
                continue
            runs = held.by_start.values()
            for run in [run for run in runs if now - run.updated >= self._timeout]:
                self._count_expired(way, len(self._remove(held, run)))
            if not held.fragments:
                del self._held[way]

    def _count_expired(self, way: Way, count: int) -> None:
        self._counters.add("transport.fragments_discarded", count)
        self._counters.count(
            "transport.reassembly_timeout", f"{count} fragments of {address_of(way[0])}"
        )

    def _discard_stale(self, way: Way, stream: _Stream, sequence: int) -> None:
        """Discards what a source left behind that restarted, and uses its numbers again."""
        count = len(self._remove(stream, stream.run_of(sequence)))
        self._counters.add("transport.fragments_discarded", count)
        self._counters.count(
            "transport.reassembly_stale", f"{count} fragments of {address_of(way[0])}"
        )

    def _remove(self, stream: _Stream, run: _Run) -> list[bytes]:
        before = stream.size
        parts = stream.remove(run)
        self.size -= before - stream.size
        return parts

    def _enforce_limits(self, way: Way, held: _Line | _Stream) -> None:
        if held.size > self.limit or len(held) > _MAX_FRAGMENTS:
            self._discard(way)
        while self.size > self.limit * _TOTAL_FACTOR or len(self._held) > _MAX_STREAMS:
            # Whoever was silent longest is first.
            self._discard(next(iter(self._held)))

    def _discard(self, way: Way) -> None:
        held = self._held.pop(way)
        self.size -= held.size
        self._counters.add("transport.fragments_discarded", len(held))
        self._counters.count(
            "transport.reassembly_overflow", f"{held.size} bytes of {address_of(way[0])}"
        )
