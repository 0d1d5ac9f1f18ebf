"""Messages of several packets: putting their fragments together."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

from .packet import DataFlags, Packet

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...base.counters import Counters

    Way = tuple[JausAddress, JausAddress]
    """Source and destination."""

_FRAGMENT_OVERHEAD = 400
_MAX_STREAMS = 256
_MAX_FRAGMENTS = 32768
_TOTAL_FACTOR = 4


class _Run:
    """Fragments with consecutive sequence numbers, from ``start`` to ``end``."""

    __slots__ = ("end", "start", "updated")

    def __init__(self, start: int, end: int, updated: float) -> None:
        self.start = start
        self.end = end
        self.updated = updated


class _Stream:
    """Fragments of one source to one destination, and the runs that they form."""

    __slots__ = ("by_end", "by_start", "fragments", "size")

    def __init__(self) -> None:
        self.fragments: dict[int, Packet] = {}
        self.by_start: dict[int, _Run] = {}
        self.by_end: dict[int, _Run] = {}
        self.size = 0

    def add(self, packet: Packet, now: float) -> _Run:
        """Keep a fragment and return the run that it belongs to now."""
        number = packet.sequence
        self.fragments[number] = packet
        self.size += _cost(packet)
        run = _Run(number, number, now)
        before = None
        if packet.data_flags != DataFlags.FIRST:
            before = self.by_end.get(_following(number, -1))
        if before and self.fragments[before.end].data_flags != DataFlags.LAST:
            del self.by_end[before.end]
            run = before
            run.end, run.updated = number, now
        after = None
        if packet.data_flags != DataFlags.LAST:
            after = self.by_start.get(_following(number))
        if after and self.fragments[after.start].data_flags != DataFlags.FIRST:
            del self.by_start[after.start]
            run.end = after.end
        self.by_start[run.start] = run
        self.by_end[run.end] = run
        return run

    def run_of(self, number: int) -> _Run:
        """Return the run that a kept fragment belongs to."""
        while number not in self.by_start:
            number = _following(number, -1)
        return self.by_start[number]

    def is_complete(self, run: _Run) -> bool:
        """Return whether a run is a whole message."""
        first, last = self.fragments[run.start], self.fragments[run.end]
        return first.data_flags == DataFlags.FIRST and last.data_flags == DataFlags.LAST

    def remove(self, run: _Run) -> list[Packet]:
        """Forget a run and return its fragments in order."""
        del self.by_start[run.start], self.by_end[run.end]
        count = (run.end - run.start & 0xFFFF) + 1
        packets = [self.fragments.pop(_following(run.start, n)) for n in range(count)]
        self.size -= sum(map(_cost, packets))
        return packets


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
        """Start with no fragments.

        Args:
            timeout: Seconds without progress after which fragments are discarded.
            limit: Bytes kept for one way (with bookkeeping); four times as many in total.
            counters: Where discarded fragments are counted.
        """
        self._timeout = timeout
        self._limit = limit
        self._counters = counters
        self._streams: OrderedDict[Way, _Stream] = OrderedDict()
        self._size = 0

    @property
    def size(self) -> int:
        """Bytes held for incomplete messages, with bookkeeping."""
        return self._size

    def __len__(self) -> int:
        """Return how many fragments are held."""
        return sum(len(stream.fragments) for stream in self._streams.values())

    def add(self, packet: Packet, now: float) -> Packet | None:
        """Take a fragment and return the whole message that it completes, if it does.

        The message has the sequence number, priority and destination of its first packet.
        """
        way = (packet.source, packet.destination)
        stream = self._streams.get(way)
        if stream is None:
            stream = self._streams[way] = _Stream()
        elif packet.sequence in stream.fragments:
            if stream.fragments[packet.sequence].payload == packet.payload:
                self._counters.add("transport.duplicate")
                return None
            self._discard_stale(stream, packet)
        self._counters.add("transport.fragments")
        self._streams.move_to_end(way)
        self._size += _cost(packet)
        run = stream.add(packet, now)
        if stream.is_complete(run):
            return self._finish(way, stream, run)
        self._enforce_limits(way, stream)
        return None

    def expire(self, now: float) -> None:
        """Discard what has not grown for the timeout."""
        for way, stream in list(self._streams.items()):
            runs = stream.by_start.values()
            for run in [run for run in runs if now - run.updated >= self._timeout]:
                count = len(self._remove(stream, run))
                self._counters.add("transport.fragments_discarded", count)
                self._counters.count(
                    "transport.reassembly_timeout", f"{count} fragments of {way[0]}"
                )
            if not stream.fragments:
                del self._streams[way]

    def _discard_stale(self, stream: _Stream, packet: Packet) -> None:
        """Discard what a source left behind that restarted, and uses its numbers again."""
        count = len(self._remove(stream, stream.run_of(packet.sequence)))
        self._counters.add("transport.fragments_discarded", count)
        self._counters.count("transport.reassembly_stale", f"{count} fragments of {packet.source}")

    def _finish(self, way: Way, stream: _Stream, run: _Run) -> Packet:
        packets = self._remove(stream, run)
        if not stream.fragments:
            del self._streams[way]
        self._counters.add("transport.fragments_assembled", len(packets))
        self._counters.add("transport.reassembled")
        payload = b"".join([packet.payload for packet in packets])
        return packets[0]._replace(payload=payload, data_flags=DataFlags.SINGLE)

    def _remove(self, stream: _Stream, run: _Run) -> list[Packet]:
        before = stream.size
        packets = stream.remove(run)
        self._size -= before - stream.size
        return packets

    def _enforce_limits(self, way: Way, stream: _Stream) -> None:
        if stream.size > self._limit or len(stream.fragments) > _MAX_FRAGMENTS:
            self._discard(way)
        while self._size > self._limit * _TOTAL_FACTOR or len(self._streams) > _MAX_STREAMS:
            self._discard(next(iter(self._streams)))

    def _discard(self, way: Way) -> None:
        stream = self._streams.pop(way)
        self._size -= stream.size
        self._counters.add("transport.fragments_discarded", len(stream.fragments))
        self._counters.count("transport.reassembly_overflow", f"{stream.size} bytes of {way[0]}")


def _cost(packet: Packet) -> int:
    return len(packet.payload) + _FRAGMENT_OVERHEAD


def _following(number: int, steps: int = 1) -> int:
    return number + steps & 0xFFFF
